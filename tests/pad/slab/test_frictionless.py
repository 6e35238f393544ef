"""A filleted punch without friction: closed form, cells, other depths, and where it ends."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.elastic import solve_points
from dummydesign.pad.fields.solve import solve_fields
from dummydesign.pad.material.hyperelastic import neo_hookean
from dummydesign.pad.pad import Pad
from dummydesign.pad.slab.filleted import FilletedPunch, solve_filleted
from dummydesign.pad.slab.frictionless.filleted_punch import follow_sliding, solve_sliding
from dummydesign.pad.slab.frictionless.moving_mesh import SlidingMesh
from dummydesign.pad.slab.problem import Slab, first_stiffness
from dummydesign.studies.verification.edges import rounded_flat

LAW = neo_hookean(1.0)


def follow(thickness_mm: float, depths: list[float], cells: int = 2):
    mesh = SlidingMesh(Slab(7.9 / thickness_mm, 75.7 / thickness_mm), LAW, 0.5, 0.5 / thickness_mm, cells)
    return mesh, follow_sliding(mesh, np.array(depths))


def test_the_outline_is_measured_along_face_fillet_and_side():
    punch = FilletedPunch(1.0, 0.2)
    corner = np.array([0.8 + 0.2 * np.sin(0.7), -0.3 + 0.2 - 0.2 * np.cos(0.7)])
    points = np.array([[0.5, -0.3], corner, [1.0, -0.1], [1.0, 0.15]])
    assert punch.outline(points, 0.3) == pytest.approx([0.5, 0.8 + 0.14, 0.8 + 0.1 * np.pi, 0.8 + 0.1 * np.pi + 0.25])


@pytest.mark.slow
def test_small_depths_agree_with_the_closed_form_of_a_rounded_punch_on_a_thick_pad():
    # As for a glued face (test_filleted): on an incompressible half-space both are the same.
    radius, fillet = 0.1, 0.03
    flat, unit = radius - fillet, 4.0
    slab = Slab(flat, 12.0, condition="frictionless")
    sink = 1.0 / (3.0 * flat * first_stiffness(slab, LAW)) - 1.0 / (2.0 * unit * flat)
    depth, force = rounded_flat(flat, fillet, np.array([0.0725, 0.074]), unit)
    found = solve_sliding(1.0, radius, fillet, 3.0, depth + sink * force, extent_mm=12.0)
    assert found.force_N == pytest.approx(force, rel=8e-3)


@pytest.mark.slow
def test_cells_over_the_fillet_hardly_change_the_force():
    forces = [follow(10.0, [0.005, 0.1, 0.3], cells)[1].force for cells in (2, 3)]
    assert forces[0] == pytest.approx(forces[1], rel=3e-3)


@pytest.mark.slow
def test_the_columns_stay_with_the_fillet_while_the_face_slides_round_it():
    mesh, path = follow(10.0, [0.005, 0.1, 0.2, 0.3])
    assert path.stop is None
    assert mesh.edge < 0.85 * mesh.punch.flat_radius
    assert path.newton_iterations < 6 * path.load_steps


@pytest.mark.slow
@pytest.mark.parametrize("thickness_mm", [5.0, 15.0])
def test_a_fillet_of_half_a_millimetre_without_friction_is_followed_to_half_the_thickness(thickness_mm):
    depth = thickness_mm * np.array([0.1, 0.3, 0.5])
    curve = solve_sliding(thickness_mm, 7.9, 0.5, 0.025, depth)
    assert curve.notes == () and len(curve.force_N) == 3
    assert np.all(np.diff(curve.error_N / curve.force_N) > -1e-9) and np.all(curve.error_N < 0.04 * curve.force_N)
    # A face that slides carries less than a glued one, the more so the thinner the pad.
    glued = solve_filleted(thickness_mm, 7.9, 0.5, 0.025, depth)
    assert np.all(curve.force_N < 0.99 * glued.force_N)


@pytest.mark.slow
def test_a_force_does_not_depend_on_the_other_depths():
    alone = solve_sliding(10.0, 7.9, 0.5, 0.025, [2.0])
    among = solve_sliding(10.0, 7.9, 0.5, 0.025, [0.137, 0.811, 2.0])
    assert among.force_N[2] == pytest.approx(alone.force_N[0], rel=1e-6)


@pytest.mark.slow
def test_where_a_thick_pad_ends_it_says_how_far_it_got_and_how_long_the_face_has_become():
    depth = np.array([1.0, 6.0, 12.0])
    curve = solve_points(Pad(20.0, 0.025, 7.9, condition="frictionless", edge_radius_mm=0.5), depth)
    assert curve.depth_mm == pytest.approx(depth[:2])
    assert "solved to d/h = 0." in curve.notes[0] and "times as long" in curve.notes[0]


def test_what_is_not_followed_is_refused():
    with pytest.raises(InputError, match=r"condition = friction:0\.3 is not solved"):
        Pad(10.0, 0.025, 7.9, condition="friction:0.3", edge_radius_mm=0.5)
    with pytest.raises(InputError, match=r"fields .* edge_radius_mm = 0\.5 with condition = frictionless"):
        solve_fields(Pad(10.0, 0.025, 7.9, condition="frictionless", edge_radius_mm=0.5), [1.0])
    with pytest.raises(InputError, match="condition = frictionless is not solved"):
        Pad(10.0, 0.025, 7.9, condition="frictionless", edge_radius_mm=0.5, geometry=Crowned(20.0, 1.0, 8.0))

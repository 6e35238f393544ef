"""A filleted punch without friction: closed form, cells, other depths, and where it ends."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from dummydesign.design.sweep.run import whatif
from dummydesign.design.sweep.spec import Study
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad import fields as sliding
from dummydesign.pad.axisymmetric import filleted
from dummydesign.pad.axisymmetric.case import Case, first_stiffness
from dummydesign.pad.axisymmetric.filleted import (
    COARSE,
    FINE,
    FilletedPunch,
    SlidingMesh,
    follow_sliding,
    solve_under_fillet,
)
from dummydesign.pad.fields import FREE, SLIPS, Pressed, solve_fields
from dummydesign.pad.force_source import solve_points
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import ForcePath
from studies.verification.edges import rounded_flat
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)


def follow(thickness_mm: float, depths: list[float], cells: int = 2):
    mesh = SlidingMesh(Case(7.9 / thickness_mm, 75.7 / thickness_mm, edge=0.5 / thickness_mm), cells)
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
    slab = Case(flat, 12.0, condition="frictionless")
    sink = 1.0 / (3.0 * flat * first_stiffness(slab)) - 1.0 / (2.0 * unit * flat)
    depth, force = rounded_flat(flat, fillet, np.array([0.0725, 0.074]), unit)
    found = solve_under_fillet(
        Pad(1.0, 3.0, radius, extent_mm=12.0, edge_radius_mm=fillet, condition="frictionless"), depth + sink * force
    )
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
    curve = solve_under_fillet(Pad(thickness_mm, 0.025, 7.9, edge_radius_mm=0.5, condition="frictionless"), depth)
    assert curve.notes == () and len(curve.force_N) == 3
    assert np.all(np.diff(curve.error_N / curve.force_N) > -1e-9) and np.all(curve.error_N < 0.04 * curve.force_N)
    # A face that slides carries less than a glued one, the more so the thinner the pad.
    glued = solve_under_fillet(Pad(thickness_mm, 0.025, 7.9, edge_radius_mm=0.5), depth)
    assert np.all(curve.force_N < 0.99 * glued.force_N)


@pytest.mark.slow
def test_a_force_does_not_depend_on_the_other_depths():
    alone = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5, condition="frictionless"), [2.0])
    among = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5, condition="frictionless"), [0.137, 0.811, 2.0])
    assert among.force_N[2] == pytest.approx(alone.force_N[0], rel=1e-6)


@pytest.mark.slow
def test_where_a_thick_pad_ends_it_says_how_far_it_got_and_how_long_the_face_has_become():
    depth = np.array([1.0, 6.0, 12.0])
    curve = solve_points(Pad(20.0, 0.025, 7.9, condition="frictionless", edge_radius_mm=0.5), depth)
    assert curve.depth_mm == pytest.approx(depth[:2])
    assert "solved to d/h = 0." in curve.notes[0] and "times as long" in curve.notes[0]


@lru_cache
def states() -> tuple[Pressed, ...]:
    pad = Pad(10.0, 0.025, 7.9, condition="frictionless", edge_radius_mm=0.5)
    fields, notes = solve_fields(pad, [1.0, 2.7])
    assert notes == ()
    return fields


@pytest.mark.slow
def test_the_fields_have_the_force_of_the_curve():
    curve = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5, condition="frictionless"), [1.0, 2.7])
    assert [one.force_N for one in states()] == pytest.approx(curve.force_N, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 1])
def test_face_and_base_of_the_fields_carry_the_force_and_nothing_drags(number):
    found = states()[number]
    face, base = found.face, found.rest_mm[:, 1] < 1e-9
    carried = np.trapezoid(2.0 * np.pi * face.radius_mm * face.pressure_MPa, face.radius_mm)
    assert carried == pytest.approx(found.force_N, rel=5e-3)
    order = np.argsort(found.rest_mm[base, 0])
    r, stress = found.rest_mm[base, 0][order], found.cauchy_MPa[base, 1][order]
    assert np.trapezoid(-2.0 * np.pi * r * stress, r) == pytest.approx(found.force_N, rel=5e-3)
    flat = face.radius_mm < 7.0
    assert np.abs(face.shear_MPa[flat]).max() < 5e-3 * face.pressure_MPa[flat].min()
    assert set(face.state) == {FREE, SLIPS}
    assert 7.4 < face.contact_radius_mm < 7.92


def test_where_fine_cells_end_the_fields_of_coarser_ones_follow_and_it_says_so(monkeypatch):
    ends, kept = {COARSE: 0.45, FINE: 0.3}, []

    def walk(mesh, depths, visit):
        reached = depths[depths <= ends[mesh.cells]]
        for depth in reached:
            visit(depth, mesh.cells)
        stop = None if len(reached) == len(depths) else "a cell folds"
        return ForcePath(reached, reached, reached, 1, 1, 1, 0.0, stop)

    monkeypatch.setattr(filleted, "follow_sliding", walk)
    pad = Pad(10.0, 0.025, 7.9, condition="frictionless", edge_radius_mm=0.5)
    wanted = np.array([0.1, 0.29, 0.37, 0.44, 0.5])
    stop, notes = sliding._follow_under_fillet(
        Case.of(pad), wanted, 10.0, False, lambda _, cells, depth: kept.append((depth, cells))
    )
    assert kept == [(0.1, FINE), (0.29, FINE), (0.37, COARSE), (0.44, COARSE)]
    assert stop == "a cell folds"
    assert len(notes) == 1 and "from 3.7 mm on" in notes[0]


@pytest.mark.slow
def test_a_study_of_designs_has_the_force_of_the_pad_asked_for_alone():
    study = Study(
        (10.0,),
        (15.5,),
        (("round:15.8", 7.9),),
        fidelity="axisymmetric",
        conditions=("frictionless",),
        edge_radii_mm=(0.5,),
        forces_N=(5.0,),
    )
    row = whatif(study)["rows"][0]
    pad = Pad(10.0, 1e-3 * row["young_kPa"], 7.9, condition="frictionless", edge_radius_mm=0.5)
    force = solve_points(pad, np.array([row["depth_mm_at_N"]["5"]])).force_N
    assert force == pytest.approx([5.0], rel=2e-3)


def test_what_is_not_followed_is_refused_and_the_refusal_says_what_to_do():
    with raises_code("unsupported", "edge_radius_mm"):
        Pad(10.0, 0.025, 7.9, condition="frictionless", edge_radius_mm=0.5, geometry=Crowned(20.0, 1.0, 8.0))

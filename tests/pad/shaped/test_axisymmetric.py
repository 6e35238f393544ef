"""Shaped pads against closed forms and limits: caps on layers, Hertz, slabs, thinner slabs, scaling."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_pad import LEFT_TO_SHARP, sharp, solve_shaped_pad
from dummydesign.pad.axisymmetric.shaped_problem import contact_radius, shaped_problem, solve_path
from dummydesign.pad.contact.axisymmetric import FilletedPunch
from dummydesign.pad.fem.mesh_axisymmetric import Sizes, height_lines, lines_by_size
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import load_table
from studies.tables.designs import designs
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)
# F = 16/9 E sqrt(R) d^1.5 f(c), c = sqrt(R d) / h, frictionless cap on a bonded incompressible layer.
CAP = {0.417: 1.857, 0.554: 2.381, 0.748: 3.371, 1.054: 5.563}


def cap_force(press: Case, depth: float, cells: int = 16) -> float:
    """F / (E h^2) at one depth."""
    return float(solve_path(press, np.array([depth]), cells).force[0]) / 3.0


@pytest.mark.parametrize(("c", "factor"), CAP.items())
def test_a_shallow_crown_agrees_with_the_law_of_a_cap_on_a_layer(c, factor):
    # So shallow that it matters neither that the gel under the crown's side is thinner nor that strains are finite.
    radius, depth = 1200.0, c**2 / 1200.0
    crown = Crowned(radius, 6.0 * depth, np.sqrt(12.0 * radius * depth))
    press = Case(2.2 * c, 10.0 + 2.0 * c, shape=crown, thickness_mm=1.0, condition="frictionless", first=depth)
    law = 16.0 / 9.0 * np.sqrt(radius) * depth**1.5 * factor
    assert cap_force(press, depth) == pytest.approx(law, rel=7e-3)


@pytest.mark.slow
def test_on_a_thick_pad_the_first_touch_is_that_of_hertz():
    depth = 2.5e-4
    press = Case(0.02, 2.0, shape=Crowned(0.1, 5e-3), thickness_mm=1.0, condition="frictionless", first=depth)
    c = np.sqrt(0.1 * depth)
    law = 16.0 / 9.0 * np.sqrt(0.1) * depth**1.5 * (1.0 + 1.133 * c)
    assert cap_force(press, depth, 24) == pytest.approx(law, rel=7e-3)


@pytest.mark.slow
def test_cells_of_half_the_size_do_not_move_the_force_once_the_contact_is_at_the_edge():
    # With cells at the edge as large as elsewhere they moved it by 0.8 and 1.1 %.
    press = Case(0.79, 7.57, shape=Crowned(20.0, 3.0, 11.0), thickness_mm=10.0)
    usual, fine = (solve_path(press, np.array([0.2, 0.3]), cells).force for cells in (16, 32))
    assert usual == pytest.approx(fine, rel=2e-3)


@pytest.mark.slow
def test_the_contact_on_a_thick_crown_grows_as_that_of_hertz():
    depths = np.array([0.05, 0.1, 0.2])
    # Known to the spacing of the points, a third of a cell: 0.055 mm with 48 cells.
    touch = contact_radius(Pad(20.0, 0.03, 7.9, geometry=Crowned(20.0, 2.0, 9.0)), depths, 48)
    assert touch.contact_radius_mm == pytest.approx(np.sqrt(20.0 * depths), rel=0.03)
    assert touch.depth_mm == pytest.approx(depths)


@pytest.mark.slow
def test_sticking_changes_little_while_the_contact_is_small_and_stiffens_a_wide_one():
    shares = []
    for c in (0.2, 1.2):
        radius, depth = 120.0, c**2 / 120.0
        crown = Crowned(radius, 6.0 * depth, np.sqrt(12.0 * radius * depth))
        pair = [
            cap_force(Case(2.2 * c, 12.0, shape=crown, thickness_mm=1.0, condition=condition, first=depth), depth, 12)
            for condition in ("frictionless", "bonded")
        ]
        shares.append(pair[1] / pair[0])
    assert shares[0] == pytest.approx(1.0, abs=3e-3)
    assert 1.1 < shares[1] < 1.4


@pytest.mark.slow
def test_a_crown_without_height_to_speak_of_is_a_glued_slab(monkeypatch):
    monkeypatch.setattr(Crowned, "check", lambda *_: None)  # it could not be cast
    depths = np.array([1.0, 2.0])
    crowned = solve_shaped_pad(Pad(10.0, 0.03, 7.9, geometry=Crowned(1e5, 3e-3)), depths)
    slab = load_table("bonded").force(depths, 10.0, 0.03, 7.9)
    assert np.all(np.abs(crowned.force_N - slab) < crowned.error_N)
    assert crowned.force_N == pytest.approx(slab, rel=5e-3)


@pytest.mark.parametrize("shape", [Layered(4.0, 1.0), Boned(2.0, 1e-6, 2e-3)], ids=["layered", "boned"])
def test_one_modulus_or_no_bone_is_the_slab(shape):
    press = Case(0.8, 6.0, shape=shape, thickness_mm=10.0)
    pair = [solve_path(press, np.array([0.1, 0.2]), 8, 0.1, twin).force for twin in (False, True)]
    assert pair[0] == pytest.approx(pair[1], rel=1e-6)


def test_over_a_hard_lower_layer_only_the_upper_one_is_pressed():
    press = Case(0.8, 6.0, shape=Layered(4.0, 1e4), thickness_mm=10.0)
    thin = Case(2.0, 15.0, shape=Slab(), thickness_mm=4.0)
    # The same bead in mm, 0.1 of 8 and 0.2 of 4, and the same cells across.
    layered = solve_path(press, np.array([0.04]), 20, 0.1).force * 10.0**2
    slab = solve_path(thin, np.array([0.1]), 20, 0.2).force * 4.0**2
    assert layered == pytest.approx(slab, rel=0.01)


def test_a_soft_lower_layer_lies_between_two_slabs_and_scales_the_whole_pad_when_the_upper_is_thin():
    depth = np.array([0.1])
    cases = [Case(0.8, 6.0, shape=Layered(top, 0.25), thickness_mm=10.0) for top in (5.0, 0.3)]
    ratios = [
        float(np.divide(*(solve_path(case, depth, 8, 0.1, twin).force for twin in (False, True)))[0]) for case in cases
    ]
    assert 1.0 > ratios[0] > ratios[1] > 0.25
    assert ratios[1] < 0.35


def test_a_broad_flat_bone_makes_a_thinner_slab():
    bone = Boned(2000.0, 1.0)
    boned = solve_path(Case(0.8, 7.5, shape=bone, thickness_mm=10.0), np.array([0.09, 0.18]), 12, 0.1).force * 10.0**2
    thin = (
        solve_path(Case(8.0 / 9.0, 75.0 / 9.0, shape=Slab(), thickness_mm=9.0), np.array([0.1, 0.2]), 12, 0.1).force
        * 9.0**2
    )
    thick = solve_path(Case(0.8, 7.5, shape=Slab(), thickness_mm=10.0), np.array([0.09, 0.18]), 12, 0.1).force * 10.0**2
    assert np.all(np.abs(boned / thin - 1.0) < 0.1 * np.abs(thick / thin - 1.0))


def test_a_flat_topped_pad_is_its_ratio_times_the_sharp_slab():
    slab = solve_shaped_pad(Pad(10.0, 0.03, 7.9, geometry=Slab()), [1.0])
    same = solve_shaped_pad(Pad(10.0, 0.03, 7.9, geometry=Layered(5.0, 1.0)), [1.0], cells=8)
    assert same.force_N == pytest.approx(slab.force_N, rel=1e-6)
    boned = solve_shaped_pad(Pad(10.0, 0.03, 7.9, geometry=Boned(8.1, 4.0, 7.0)), [1.0], cells=8)
    assert 1.1 < boned.force_N[0] / slab.force_N[0] < 1.25


@pytest.mark.slow
def test_force_scales_with_the_modulus_and_with_the_square_of_all_lengths():
    crown = Crowned(10.0, 2.5, 6.6)
    one = solve_shaped_pad(Pad(5.0, 0.03, 7.9, geometry=crown), [1.0], cells=8)
    stiff = solve_shaped_pad(Pad(5.0, 0.09, 7.9, geometry=crown), [1.0], cells=8)
    large = solve_shaped_pad(Pad(10.0, 0.03, 15.8, extent_mm=151.39, geometry=Crowned(20.0, 5.0, 13.2)), [2.0], cells=8)
    assert stiff.force_N == pytest.approx(3.0 * one.force_N, rel=1e-9)
    assert large.force_N == pytest.approx(4.0 * one.force_N, rel=1e-3)


@pytest.mark.slow
def test_a_finer_grid_stays_within_the_stated_error():
    crown, depths = Crowned(10.0, 2.5, 6.6), np.array([0.5, 1.0])
    coarse = solve_shaped_pad(Pad(5.0, 0.03, 7.9, geometry=crown), depths, cells=8)
    fine = solve_shaped_pad(Pad(5.0, 0.03, 7.9, geometry=crown), depths, cells=16)
    assert np.all(np.abs(coarse.force_N - fine.force_N) < coarse.error_N + fine.error_N)


@pytest.mark.slow
def test_friction_lies_between_sliding_and_sticking_on_a_crown():
    crown = Crowned(10.0, 2.5, 6.6)
    forces = [
        solve_path(
            Case(1.58, 15.0, shape=crown, thickness_mm=5.0, condition=condition), np.array([0.1, 0.3]), 10
        ).force[-1]
        for condition in ("frictionless", "friction:0.1", "bonded")
    ]
    assert forces[0] < forces[1] < forces[2]


@pytest.mark.parametrize(("kind", "number", "twin"), [("boned", 1, True), ("layered", 3, False)])
def test_contact_that_flickers_at_a_glued_edge_is_followed(kind, number, twin):
    # Whole Newton steps threw the points round the fillet from touching to not touching and back without end here.
    design = designs()[kind]
    depths = design.depths[design.depths < 0.35]
    path = solve_path(design.press(design.points(number + 1)[number]), depths, design.cells, 0.1, twin)
    assert path.stop is None
    assert np.all(np.diff(np.log(path.force)) / np.diff(np.log(path.depth)) > 0.9)


@pytest.mark.slow
def test_a_steep_cone_ends_where_its_flank_folds_and_says_so(monkeypatch):
    monkeypatch.setattr(Crowned, "check", lambda *_: None)  # steeper than can be cast
    curve = solve_shaped_pad(Pad(15.0, 0.03, 7.9, geometry=Crowned(3.0, 8.0, 5.0)), [5.0, 9.0], cells=6)
    assert len(curve.depth_mm) == 1
    assert "folds on to the pad beside its foot" in curve.notes[0]


def test_forces_with_two_beads_are_carried_on_to_a_sharp_edge():
    rims = np.array([0.1, 0.05])
    exact = np.array([2.0, 3.0, 4.0])
    rough, fine = (exact * np.exp(-0.8 * rim**1.25) for rim in rims)
    value, added = sharp(rough, fine)
    assert value == pytest.approx(exact, rel=2e-4)
    assert added == pytest.approx(np.expm1(0.8 * 0.05**1.25), rel=5e-3)
    # One bead alone takes the step from the last depth at which both were solved.
    fine[-1] = np.nan
    assert sharp(rough, fine)[0] == pytest.approx(exact, rel=2e-4)
    assert sharp(rough, np.full(3, np.nan))[0] == pytest.approx(rough)
    assert LEFT_TO_SHARP == pytest.approx(1.0 / (2.0**1.25 - 1.0), rel=5e-3)


def test_the_plate_pushes_back_from_any_depth_and_its_bead_has_no_wall():
    plate = FilletedPunch(1.0, 0.1, sides=False)
    gap, normal, _ = plate.gap(np.array([[0.3, 0.4], [0.3, -0.2], [1.3, 0.4]]), 0.1)
    assert gap[:2] == pytest.approx([-0.5, 0.1])
    assert normal[0] == pytest.approx([0.0, -1.0])
    assert gap[2] > 0.0


def test_the_mesh_has_the_volume_of_the_pad():
    crown = Crowned(0.9, 0.3, 0.6)
    solid = shaped_problem(Case(1.0, 4.0, shape=crown, thickness_mm=1.0), 8).solid
    r = np.linspace(0.0, 4.0, 400001)
    volume = np.trapezoid(2.0 * np.pi * r * (1.0 - crown.drop_mm(r, 0.0 * r)), r)
    assert solid.mesh.weight.sum() == pytest.approx(volume, rel=2e-4)


def test_grid_lines_meet_kinks_and_interfaces_and_follow_the_wanted_sizes():
    r = lines_by_size(0.0, 6.0, (0.37, 1.0), Sizes((0.0, 1.0), (0.02, 0.01), 0.25, 0.1, 1.0).at, 0.2)
    assert {0.0, 0.37, 1.0, 6.0} <= set(np.round(r, 12))
    assert np.diff(r)[0] < 0.03 and np.diff(r)[np.searchsorted(r, 1.0) - 1] < 0.015
    assert np.all(np.diff(r) > 0.0)
    assert np.abs(height_lines(0.05, 0.3) - 0.3).min() < 1e-12


@pytest.mark.parametrize(
    ("shape", "changes", "code"),
    [
        (Crowned(10.0, 2.5, ridge=1.0), {}, "unsupported"),
        (Crowned(10.0, 2.5), {"condition": "glue"}, "unknown_name"),
        (Crowned(10.0, 2.5), {"condition": "friction:9"}, "unknown_name"),
        (Crowned(10.0, 2.5), {"depth_mm": [3.1]}, "out_of_range"),
        (Crowned(10.0, 2.5), {"base": "loose"}, "unknown_name"),
        (Crowned(10.0, 4.95), {}, "out_of_range"),
        (Crowned(10.0, 2.5), {"extent_mm": 9.0}, "out_of_range"),
        (Crowned(2000.0, 1.5), {}, "out_of_range"),
        (Boned(10.0, 2.5), {"base": "sliding"}, "unsupported"),
        (Layered(5.0, 2.0), {}, "out_of_range"),
    ],
)
def test_what_cannot_be_solved_round_is_refused(shape, changes, code):
    depth_mm = changes.get("depth_mm", [1.0])
    own = {name: value for name, value in changes.items() if name != "depth_mm"}
    with raises_code(code):
        solve_shaped_pad(Pad(5.0, 0.03, 7.9, geometry=shape, **own), depth_mm)

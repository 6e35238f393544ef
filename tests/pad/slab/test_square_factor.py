"""Square over circle: limit of small corner cells and fillets from made-up ratios, ratios of few cells, the twin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.filleted import filleted_problem
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.spatial import square_punch
from dummydesign.pad.spatial.square_punch import (
    CORNERS,
    FILLETED_SOUND_J,
    RIMS,
    SOUND_J,
    STEP,
    CornerCells,
    FactorCurve,
    Ratios,
    SquareProblem,
    block_problem,
    depth_of_corner,
    outline_factor,
    solve_factor,
    solve_ratios,
    twin_problem,
    useful_depths,
)

SQUARE, OBLONG = SquareProblem((0.7, 0.7), (2.1, 2.1)), SquareProblem((1.0, 0.49), (3.0, 1.6))
LOG, CORNER, RIM = (0.03, -0.05, 0.08, 0.06), (0.02, 0.03), (-0.01, 0.012)
COST = {"unknowns": 7, "load_steps": 2, "newton_iterations": 5, "seconds": 0.5}


def log_factor(depth, corner=0.0, rim=0.0, terms=4):
    """A cubic in depth, and what one unit of corner cell or fillet changes it by."""
    cubic = np.polynomial.polynomial.polyval(depth, LOG[:terms])
    return cubic + corner * (CORNER[0] + CORNER[1] * depth) + rim * (RIM[0] + RIM[1] * depth)


def made(monkeypatch, terms=4, noise=0.0, lost=()):
    """``solve_ratios`` by that law; gives what it was asked."""
    asked, rng = [], np.random.default_rng(8)

    def solve(block, depths, cells, rim=0.0):
        asked.append((block, np.asarray(depths), cells, rim))
        kept = np.asarray(depths)[: 0 if cells.corner in lost else None]
        corner = 0.0 if rim else cells.corner
        values = np.exp(log_factor(kept, corner, rim, terms) + noise * rng.standard_normal(len(kept)))
        first = float("nan") if rim else float(np.exp(log_factor(0.0, corner, rim, terms)))
        return Ratios(kept, values, first, np.ones(len(kept)), COST)

    monkeypatch.setattr(square_punch, "solve_ratios", solve)
    return asked


def test_where_sharp_corners_reach_the_deepest_depth_their_limit_is_a_parabola(monkeypatch):
    asked = made(monkeypatch, terms=3)
    curve = solve_factor(SQUARE, 0.4)
    depth = np.linspace(0.0, 0.4, 9)
    assert np.log(curve.factor(depth)[0]) == pytest.approx(log_factor(depth, terms=3), abs=2e-4)
    assert curve.correction == pytest.approx(CORNER, rel=0.05) and curve.reach == pytest.approx(0.4)
    assert curve.reach_of_corner == pytest.approx(dict.fromkeys(CORNERS, 0.4)) and curve.reach_of_rim == {}
    assert curve.scatter < 2e-5 and curve.rim_scatter == 0.0
    assert curve.solver == {"unknowns": 7, "load_steps": 6, "newton_iterations": 15, "seconds": 1.5}
    for _, depths, _, rim in asked:
        assert rim == 0.0 and depths[-1] == pytest.approx(0.4)
        assert np.diff([0.0, *depths]) == pytest.approx(np.full(len(depths), 0.4 / len(depths)))
        assert len(depths) == round(0.4 / (STEP * SQUARE.scale))
    assert len(solve_factor(SQUARE, 0.01).coefficients) == 3 and all(len(one[1]) == 4 for one in asked[3:])


@pytest.mark.parametrize("size", [1.0, 0.5])
def test_beyond_the_corner_fillets_carry_the_factor_on_as_a_cubic(monkeypatch, size):
    asked = made(monkeypatch)
    square, deepest = SquareProblem((0.7 * size,) * 2, (2.1, 2.1)), 0.95 * size
    curve = solve_factor(square, deepest)
    depth = np.linspace(0.0, deepest, 12)
    assert np.log(curve.factor(depth)[0]) == pytest.approx(log_factor(depth), abs=2e-3)
    ends = {corner: min(deepest, depth_of_corner(square, CornerCells(corner))) for corner in CORNERS}
    assert curve.reach_of_corner == pytest.approx(ends) and min(ends.values()) < 0.6 * deepest
    assert curve.reach_of_rim == pytest.approx(dict.fromkeys(RIMS, deepest)) and curve.reach == pytest.approx(deepest)
    for _, depths, cells, rim in asked[len(CORNERS) :]:
        assert cells.corner == rim in RIMS and np.all(depths >= 0.5 * np.sqrt(rim) * square.scale)
        assert np.diff(depths) == pytest.approx(np.full(len(depths) - 1, deepest / 12.0))
    # What the fit doubts is a part of what it extrapolated by.
    sharp, filleted = curve.factor(np.array([0.3 * deepest, deepest]))[1]
    assert 1e-3 < sharp < 0.02 and 1e-3 < filleted < 0.02


def test_values_that_scatter_are_stated_as_scatter(monkeypatch):
    made(monkeypatch, noise=2e-3)
    noisy = solve_factor(SQUARE, 0.95)
    made(monkeypatch)
    exact = solve_factor(SQUARE, 0.95)
    assert 0.8e-3 < noisy.scatter < 3e-3 and 0.8e-3 < noisy.rim_scatter < 3e-3
    assert exact.scatter < 0.1 * noisy.scatter and exact.rim_scatter < 0.2 * noisy.rim_scatter
    depth = np.array([0.1, 0.9])
    assert np.all(noisy.factor(depth)[1] > exact.factor(depth)[1] + 1e-3)


def test_a_size_that_ends_at_once_still_counts_at_first_touch_and_none_is_no_answer(monkeypatch):
    made(monkeypatch, terms=3, lost=(0.45,))
    curve = solve_factor(SQUARE, 0.4)
    assert curve.reach_of_corner[0.45] == 0.0 and curve.reach == pytest.approx(0.4)
    depth = np.array([0.0, 0.3])
    assert np.log(curve.factor(depth)[0]) == pytest.approx(log_factor(depth, terms=3), abs=3e-4)
    made(monkeypatch, lost=(*CORNERS, *RIMS))
    with pytest.raises(NoAnswerError):
        solve_factor(SQUARE, 0.4)


def test_what_a_slab_s_outline_changes_multiplies_the_factor_of_the_square_slab(monkeypatch):
    asked, outlines = made(monkeypatch, terms=3), []
    monkeypatch.setattr(square_punch, "outline_factor", lambda block, square: outlines.append((block, square)) or 1.01)
    plain, slab = solve_factor(SQUARE, 0.4), replace(SQUARE, half_extents=(2.8, 1.575))
    assert not outlines
    turned = solve_factor(slab, 0.4)
    depth = np.linspace(0.0, 0.4, 5)
    assert turned.factor(depth)[0] == pytest.approx(1.01 * plain.factor(depth)[0], rel=1e-12)
    assert [one.half_extents for one in outlines[0]] == [(2.8, 1.575), pytest.approx((2.1, 2.1))]
    assert asked[-1][0].half_extents == pytest.approx((2.1, 2.1)) and asked[-1][0].mirrors
    # An oblong punch is solved on its own slab.
    solve_factor(OBLONG, 0.2)
    assert len(outlines) == 1 and asked[-1][0] == OBLONG


def test_a_block_has_the_areas_of_its_circles_and_mirrors_only_where_both_are_square():
    assert np.pi * OBLONG.radius**2 == pytest.approx(4.0 * 1.0 * 0.49)
    assert np.pi * OBLONG.extent**2 == pytest.approx(4.0 * 3.0 * 1.6)
    assert OBLONG.scale == pytest.approx(OBLONG.radius) and SquareProblem((2.0, 2.0), (9.0, 9.0)).scale == 1.0
    assert SQUARE.mirrors and not OBLONG.mirrors and not replace(SQUARE, half_extents=(3.0, 2.1)).mirrors
    assert replace(SQUARE, half_extents=(3.0, 1.5)).middle_extents == pytest.approx((4.5**0.5,) * 2)
    assert OBLONG.middle_extents == OBLONG.half_extents


@pytest.mark.parametrize("size", [0.3, 0.7, 3.0])
def test_useful_depths_are_large_against_the_fillet_and_a_corner_lasts_in_proportion_to_the_punch(size):
    square = SquareProblem((size, size), (9.0, 9.0))
    depths, rim = np.linspace(0.01, 1.0, 200), 0.28
    kept = useful_depths(square, depths, rim)
    assert kept == pytest.approx(depths[4.0 * (depths / square.scale) ** 2 >= rim])
    reach = [depth_of_corner(square, CornerCells(corner)) / square.scale for corner in (0.1, 0.2, 0.45)]
    assert np.all(np.diff(reach) > 0.0) and 0.3 < reach[0] < reach[-1] < 1.0


@pytest.fixture(scope="module")
def coarse():
    return solve_ratios(SQUARE, np.array([0.02, 0.1]), CornerCells(0.45))


def test_a_ratio_is_the_whole_square_over_its_twin_at_first_touch_and_at_depth(coarse):
    cells = CornerCells(0.45)
    problems = block_problem(SQUARE, cells), twin_problem(SQUARE, cells)
    first = 4.0 * problems[0].stiffness() / problems[1].stiffness()
    assert coarse.first == pytest.approx(first, rel=1e-6) and coarse.depth == pytest.approx([0.02, 0.1])
    assert coarse.ratio[0] == pytest.approx(first, rel=1e-3)
    forces = [follow(problem, [0.02, 0.1], 0.05, 0.1, 0.01).force for problem in problems]
    assert coarse.ratio == pytest.approx(4.0 * forces[0] / forces[1], rel=1e-5)
    assert 1.01 < coarse.ratio[1] < 1.04 and np.all((coarse.smallest_J > SOUND_J) & (coarse.smallest_J < 1.0))
    assert 0.0 < coarse.smallest_J[1] < coarse.smallest_J[0]


def test_a_ratio_of_an_oblong_punch_counts_four_quarters():
    found, pair = solve_ratios(OBLONG, np.array([0.02]), CornerCells(0.45)), (block_problem, twin_problem)
    quarter, twin = (problem(OBLONG, CornerCells(0.45)).stiffness() for problem in pair)
    assert found.first == pytest.approx(4.0 * quarter / twin)
    assert found.ratio[0] == pytest.approx(found.first, rel=2e-3) and 1.0 < found.first < 1.15


def test_depths_at_which_a_corner_cell_is_near_folding_are_left_out_and_all_after_them(monkeypatch):
    monkeypatch.setattr(square_punch, "SOUND_J", 0.86)
    found = solve_ratios(SQUARE, np.array([0.02, 0.06, 0.12, 0.14]), CornerCells(0.45))
    assert 1 <= len(found.depth) == len(found.ratio) < 4 and found.smallest_J.min() >= 0.86
    assert FILLETED_SOUND_J < 0.86


@pytest.fixture(scope="module")
def filleted():
    return solve_ratios(SQUARE, np.array([0.12, 0.18]), CornerCells(0.45), 0.45)


def test_a_fillet_has_no_first_touch_and_about_the_ratio_of_sharp_edges(coarse, filleted):
    assert np.isnan(filleted.first) and filleted.depth == pytest.approx([0.12, 0.18])
    assert filleted.ratio == pytest.approx(np.full(2, coarse.ratio[1]), abs=0.015)


@pytest.mark.parametrize("condition", ["bonded", "frictionless"])
def test_the_filleted_twin_is_the_round_punch_of_equal_area_with_that_fillet(condition):
    """Against another mesh and contact where it is glued; a face that slides carries less."""
    rim, depth = 0.25, [0.1]
    block = replace(SQUARE, condition=condition)
    twin = twin_problem(block, CornerCells(0.12), rim)
    path = follow(twin, depth, 0.3 * rim * block.scale, 0.035, 2e-3)
    case = Case(block.radius, block.extent, edge=rim * block.scale)
    other = follow(filleted_problem(case, sides=False), depth, 0.01, 0.02, 1e-4).force
    assert (twin.punch.radius, twin.punch.rim) == pytest.approx((block.radius, rim * block.scale))
    reach = twin.surface.points(np.zeros(twin.solid.mesh.size))[..., 0]
    assert reach.min() < block.radius - twin.punch.rim and block.radius < reach.max()
    share = float(path.force[0] / other[0])
    assert share == pytest.approx(1.0, abs=0.01) if condition == "bonded" else 0.7 < share < 0.98


def test_a_longer_slab_of_the_same_area_is_a_little_softer_at_first_touch():
    long = replace(SQUARE, half_extents=(2.8, 1.575))
    assert 0.9 < outline_factor(long, SQUARE) < 1.0
    assert outline_factor(SQUARE, SQUARE) == pytest.approx(1.0, rel=1e-6)


def test_a_factor_is_held_beyond_its_reach_and_before_first_touch():
    curve = FactorCurve(np.array([0.1, 0.5]), np.zeros(2), np.zeros(2), 0.5, {0.2: 0.5}, {}, 0.0, 0.0, {})
    value, error = curve.factor(np.array([-0.2, 0.0, 0.5, 0.7, 0.9]))
    assert value[0] == value[1] == pytest.approx(np.exp(0.1)) and value[2] == value[3] == value[4]
    assert error[0] == error[2] and error[3] - error[2] == pytest.approx(error[4] - error[3]) and error[3] > error[2]

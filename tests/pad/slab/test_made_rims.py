"""The limit of small rims from made-up values: series and correction, paths carried on, what is solved and stated."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.pad.axisymmetric import sharp_edge
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.sharp_edge import (
    CLOSER,
    LIMIT_ERROR,
    MOST_WASTED,
    RIM_POWER,
    RIMS,
    RIMS_BY_TABLE,
    VALUE_ERROR,
    Departure,
    Limit,
    Samples,
    fit_limit,
    solve_curve,
    solve_path,
    solve_rims,
)
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.force_law import NO_COST
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import ForcePath
from dummydesign.pad.tables.slab import load_table, sharp_edge_doubt


def made(depth, force, stop=None) -> ForcePath:
    return ForcePath(np.array(depth), np.array(force), np.ones(len(depth)), 9, 2, 5, 0.5, stop)


@pytest.mark.parametrize("ratio", [0.4, 3.0])
def test_samples_count_depth_and_rim_in_the_smaller_of_radius_and_thickness(ratio):
    samples = Samples(np.array([0.1, 0.2]), np.full(2, ratio), np.array([0.1, 0.05]), np.ones(2))
    y = np.array([0.1, 0.2]) / min(ratio, 1.0)
    assert samples.scaled_depth == pytest.approx(y)
    assert samples.psi == pytest.approx(np.array([0.1, 0.05]) ** RIM_POWER * y**-0.6)
    kept = samples.take(np.array([False, True]))
    assert (kept.depth.tolist(), kept.rim.tolist()) == ([0.2], [0.05])


def of_law(ratios, terms=1.0):
    """Values of a limit linear in depth and ln(a/h), less a correction of the regression's own form."""
    depth, rim, ratio = (
        grid.ravel() for grid in np.meshgrid(np.linspace(0.08, 0.5, 10), 0.1 * 0.5 ** np.arange(5), ratios)
    )
    sharp = np.exp(0.5 + 0.8 * depth + 0.6 * np.log(ratio))
    samples = Samples(depth, ratio, rim, sharp)
    y = samples.scaled_depth
    return Samples(depth, ratio, rim, sharp * np.exp(-terms * samples.psi * (0.6 + 0.2 * y / (1.0 + y))))


@pytest.mark.parametrize("ratios", [np.array([0.8]), np.array([0.4, 0.8, 1.6])])
def test_values_of_the_regression_s_own_form_give_their_limit_and_a_small_error(ratios):
    samples, many = of_law(ratios), len(ratios) > 1
    limit = fit_limit(
        samples,
        ratios,
        np.exp(0.5 + 0.6 * np.log(ratios)),
        (0.0, 0.5),
        (ratios[0], ratios[-1]) if many else None,
        (4, 2 if many else 1),
    )
    depth = np.linspace(0.0, 0.5, 6)
    for ratio in ratios:
        exact = 0.5 + 0.8 * depth + 0.6 * np.log(ratio)
        assert limit.log_stiffness(depth, ratio) == pytest.approx(exact, abs=2e-3)
        error = limit.error(depth[1:], ratio)
        assert np.all((error > VALUE_ERROR) & (error < VALUE_ERROR + LIMIT_ERROR * 0.05))
    doubled = fit_limit(
        of_law(ratios, 2.0),
        ratios,
        np.exp(0.5 + 0.6 * np.log(ratios)),
        (0.0, 0.5),
        limit.ratio_range,
        (4, 2 if many else 1),
    )
    # Twice the correction doubles what of the error comes from it.
    share = (doubled.error(depth[1:], ratios[0]) - VALUE_ERROR) / (limit.error(depth[1:], ratios[0]) - VALUE_ERROR)
    assert share == pytest.approx(np.full(5, 2.0), rel=0.3)


def test_the_error_of_a_limit_is_the_scatter_near_by_and_a_share_of_the_best_rim_s_correction():
    depth, rim = np.array([0.1, 0.1, 0.4, 0.4]), np.array([0.1, 0.05, 0.1, 0.05])
    samples = Samples(depth, np.full(4, 0.8), rim, np.ones(4))
    residual = np.array([0.0, 0.0, 0.02, 0.02])
    limit = Limit(np.zeros((1, 1)), np.array([1.0, 0.0, 0.0, 0.0]), (0.0, 0.5), None, samples, residual)
    best = 0.05**RIM_POWER * (np.array([0.1, 0.4]) / 0.8) ** -0.6
    scatter = np.array([0.0, 0.02 / np.sqrt(2.0)])
    assert limit.error(np.array([0.1, 0.4]), 0.8) == pytest.approx(VALUE_ERROR + 2.0 * scatter + LIMIT_ERROR * best)
    # Where nothing is near, all values of that proportion count.
    alone = VALUE_ERROR + 0.02 * np.sqrt(0.5) + LIMIT_ERROR * best[1]
    assert limit.error(np.array([0.24]), 0.8) == pytest.approx([alone])


def test_a_departure_adds_to_the_table_at_first_touch_and_beyond_and_doubts_a_half_of_it():
    table, samples = load_table(), Samples(np.array([0.1, 0.4]), np.full(2, 0.8), np.full(2, 0.1), np.ones(2))
    found = Departure(table, 0.01, np.array([0.004, 0.002, 0.0]), samples, np.array([0.003, -0.001]))
    depth, share = np.array([0.1, 0.4]), np.array([0.25, 1.0])
    further = share * (0.004 + 0.002 * (2.0 * share - 1.0))
    value = found.log_stiffness(depth, np.array(0.8)) - table.log(depth, 0.8)
    assert value == pytest.approx(0.01 + further)
    error = found.error(depth, 0.8) - table.solved_error(depth, 1.0, 0.8)
    assert error == pytest.approx(2.0 * np.array([0.003, 0.001]) + 0.5 * np.abs(further))


def rims(monkeypatch, paths):
    """``solve_rims`` with made-up paths by rim and cells; gives what was followed."""
    asked = []

    def follow(case, depths, rim, resolution):
        asked.append((rim, resolution.cells, depths))
        return paths(rim, resolution.cells, depths)

    monkeypatch.setattr(sharp_edge, "solve_path", follow)
    return asked


@pytest.mark.parametrize("radius", [0.5, 1.6])
def test_every_rim_is_solved_at_depths_that_are_large_against_it(monkeypatch, radius):
    asked = rims(monkeypatch, lambda rim, cells, depths: made(depths, 6.0 * radius * depths))
    scale, depths = min(radius, 1.0), np.array([0.02, 0.1, 0.2, 0.4])
    samples, paths = solve_rims(Case(radius, 9.0), depths, (0.1, 0.025, 9.0), Resolution())
    assert [rim for rim, _, _ in asked] == pytest.approx([0.1 * scale, 0.025 * scale]) and len(paths) == 2
    for rim, _, wanted in asked:
        assert wanted == pytest.approx(depths[depths >= 0.8 * np.sqrt(rim / scale) * scale])
    # F / (E a d) with E = 3 mu: 6 mu a d over 3 mu a d.
    assert samples.stiffness == pytest.approx(np.full(len(samples.depth), 2.0)) and np.all(samples.ratio == radius)
    assert sorted(set(samples.rim)) == [0.025, 0.1]


def test_where_the_largest_fillet_ends_smaller_cells_go_on_made_equal_where_both_are_known(monkeypatch):
    own = Resolution().cells
    reach = {own: 2, own + CLOSER[0]: 3, own + CLOSER[1]: 4}

    def paths(rim, cells, depths):
        count = reach[cells] if rim > 0.06 else len(depths)
        stop = None if count == len(depths) else "folds"
        return made(depths[:count], (1.0 + 0.1 * (cells - own)) * depths[:count], stop)

    asked, depths = rims(monkeypatch, paths), np.array([0.3, 0.35, 0.4, 0.45])
    samples, (large, small) = solve_rims(Case(1.0, 9.0), depths, (0.1, 0.05), Resolution())
    tried = [(round(rim, 9), cells - own) for rim, cells, _ in asked]
    assert tried == [(0.1, 0), (0.1, CLOSER[0]), (0.1, CLOSER[1]), (0.05, 0)]
    assert large.force == pytest.approx(depths) and large.stop is None
    assert (large.load_steps, small.load_steps) == (6, 2)
    assert len(samples.depth) == 8
    reach.update({own: 4})
    asked.clear()
    solve_rims(Case(1.0, 9.0), depths, (0.1,), Resolution())
    assert len(asked) == 1


@pytest.mark.parametrize(("radius", "rim"), [(0.5, 0.025), (2.0, 0.1)])
def test_a_path_under_a_fillet_begins_with_a_step_of_it_and_may_halve_it_ten_times(monkeypatch, radius, rim):
    steps = []
    monkeypatch.setattr(sharp_edge, "follow", lambda problem, depths, *words, **more: steps.append((words, more)))
    solve_path(Case(radius, 9.0), np.array([0.1]), rim, Resolution())
    (first, largest, smallest), more = steps[0]
    assert first == rim and largest == pytest.approx(0.05 * min(radius, 1.0)) and more == {"most_wasted": MOST_WASTED}
    assert smallest == pytest.approx(min(0.005 * min(radius, 1.0), 0.1 * rim))


def curve(monkeypatch, depths, table=True, reached=9.0):
    """``solve_curve`` of a slab of 10 mm with made-up values of its rims; what they were asked for."""
    asked = []

    def solve(case, grid, ladder, resolution):
        asked.append((grid, ladder))
        depth, rim = (one.ravel() for one in np.meshgrid(grid[grid <= reached], ladder))
        value = np.exp(load_table().log(depth, case.radius))
        samples = Samples(depth, np.full(len(depth), case.radius), rim, value)
        return samples, [made(grid, grid, "it folds")]

    monkeypatch.setattr(sharp_edge, "solve_rims", solve)
    found = solve_curve(Pad(10.0, 0.03, 7.9), depths, independent=not table)
    return found, asked


@pytest.mark.parametrize("table", [True, False])
def test_a_curve_is_solved_on_an_even_grid_besides_the_wanted_depths_and_has_its_units(monkeypatch, table):
    found, ((grid, ladder),) = curve(monkeypatch, [1.0, 2.3, 4.0], table)
    assert ladder == (RIMS_BY_TABLE if table else RIMS) and {0.1, 0.23, 0.4} <= set(np.round(grid, 9))
    assert grid[-1] == pytest.approx(0.4) and np.diff([0.0, *grid]).max() < 1.7 * 0.4 / 12.0
    assert np.diff(grid).min() > 0.02 * 0.4 - 1e-12 and len(grid) >= 12
    assert found.depth_mm == pytest.approx([1.0, 2.3, 4.0]) and found.notes == ()
    # What the correction adds to values that need none is doubted no more than that.
    assert found.force_N == pytest.approx(load_table().force(found.depth_mm, 10.0, 0.03, 7.9), rel=0.06)
    doubt = sharp_edge_doubt(found.depth_mm / 10.0, 0.79)
    own = found.solved_error_N / found.force_N
    assert found.error_N / found.force_N == pytest.approx(np.maximum(own, doubt)) and own.min() > 0.0


def test_a_curve_to_a_small_depth_is_solved_further_and_one_that_ends_says_where(monkeypatch):
    found, asked = curve(monkeypatch, [0.2])
    assert asked[0][0][-1] == pytest.approx(0.25 * 0.79) and found.depth_mm == pytest.approx([0.2])
    short, _ = curve(monkeypatch, [1.0, 2.0, 4.0], reached=0.31)
    assert short.depth_mm == pytest.approx([1.0, 2.0]) and "it folds" in short.notes[0] and "0.400" in short.notes[0]


def test_a_curve_with_too_few_values_by_the_table_is_solved_without_it_and_without_any_has_no_answer(monkeypatch):
    asked = []

    def solve(case, grid, ladder, resolution):
        asked.append(ladder)
        count = 3 if ladder == RIMS_BY_TABLE else 0
        depth = np.repeat(grid[:count], 2)
        samples = Samples(depth, np.full(len(depth), 0.79), np.full(len(depth), 0.1), np.ones(len(depth)))
        return samples, [made([], [], "why")]

    monkeypatch.setattr(sharp_edge, "solve_rims", solve)
    with pytest.raises(NoAnswerError, match="why"):
        solve_curve(Pad(10.0, 0.03, 7.9), [1.0])
    assert asked == [RIMS_BY_TABLE, RIMS]


@pytest.mark.parametrize("poisson", [0.5, 0.4])
def test_the_modulus_of_a_curve_is_three_shear_moduli_of_the_law(monkeypatch, poisson):
    solved = {"stiffness": np.array([2.0]), "error": np.array([0.1]), "own": np.array([0.05])}
    solved |= {"solver": dict(NO_COST), "notes": ()}
    monkeypatch.setattr(sharp_edge, "_relative_curve", lambda *words: solved)
    found = solve_curve(Pad(10.0, 0.03, 7.9, poisson=poisson), [1.5])
    shear = 0.03 / (2.0 * (1.0 + poisson))
    assert found.force_N == pytest.approx([3.0 * shear * 7.9 * 1.5 * 2.0])
    assert found.error_N == pytest.approx(0.1 * found.force_N)
    assert found.solved_error_N == pytest.approx(0.05 * found.force_N)

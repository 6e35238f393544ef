"""The square's factor: shipped values, solves of its own, limits, derivatives that stay small, validity."""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.core.user_library import data_folder
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import predict_static
from dummydesign.pad.spatial.square_punch import (
    CORRECTION_ERROR,
    MESH_ERROR,
    CornerCells,
    FactorCurve,
    SquareProblem,
    block_problem,
    solve_factor,
    solve_ratios,
    twin_problem,
)
from dummydesign.pad.tables.slab import load_table
from dummydesign.pad.tables.square import HELD_ERROR, SIDE_OVER_RADIUS, crown_factor, load_square, square_factor
from tests.support.refusal import raises_code

RADIUS = 7.0 / SIDE_OVER_RADIUS


def block(thickness: float, base: str = "bonded") -> SquareProblem:
    """The 14 mm square on the 150 x 120 mm slab."""
    return SquareProblem((7.0 / thickness,) * 2, (75.0 / thickness, 60.0 / thickness), base)


@pytest.mark.parametrize(("thickness", "expected"), [(5.0, 1.002), (10.0, 1.028), (15.0, 1.032), (20.0, 1.032)])
def test_the_factor_at_small_depth_is_that_of_another_code(thickness, expected):
    factor, error = square_factor(0.05 * thickness, thickness, RADIUS)
    assert factor == pytest.approx(expected, abs=0.003)
    assert 0.0 < error < 0.004


@pytest.mark.slow
@pytest.mark.parametrize("base", ["bonded", "sliding"])
@pytest.mark.parametrize("thickness", [6.3, 13.0])
def test_the_factor_agrees_with_a_solve_between_its_ratios(base, thickness):
    """At ratios a / h that were not solved for the table, on other cells, where one corner cell is good to 0.1 %."""
    found = solve_ratios(block(thickness, base), np.array([0.04, 0.08]), CornerCells(0.25, 1.8))
    factor, _ = square_factor(np.array([0.0, 0.04, 0.08]) * thickness, thickness, RADIUS, base)
    assert len(found.depth) == 2
    assert factor == pytest.approx(np.array([found.first, *found.ratio]), abs=2e-3)


@pytest.mark.parametrize("base", ["bonded", pytest.param("sliding", marks=pytest.mark.slow)])
def test_first_touch_agrees_with_fine_cells(base):
    cells = CornerCells(0.1)
    pad = block(10.0, base)
    found = 4.0 * block_problem(pad, cells).stiffness() / twin_problem(pad, cells).stiffness()
    assert square_factor(0.0, 10.0, RADIUS, base)[0] == pytest.approx(found, abs=1e-3)


def test_the_error_grows_where_the_factor_is_held():
    depth = np.array([0.1, 0.3, 0.5, 0.6]) * 20.0
    factor, error = square_factor(depth, 20.0, RADIUS)
    assert np.all(np.diff(error) > 0.0)
    assert error[-1] > error[-2] + 1e-3
    assert factor[-1] == pytest.approx(float(square_factor(11.0, 20.0, RADIUS)[0]), abs=2e-4)


def test_factors_are_found_for_whole_arrays_and_change_gently():
    thickness = np.linspace(3.2, 30.0, 240)[:, None]
    factor, error = square_factor(thickness * np.linspace(-0.1, 0.6, 71), thickness, RADIUS)
    assert factor.shape == error.shape == (240, 71)
    assert np.all((factor > 0.95) & (factor < 1.05))
    assert np.abs(np.diff(factor, axis=1)).max() < 2e-3
    assert np.abs(np.diff(factor, axis=0)).max() < 3e-3


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_the_shipped_values_are_those_the_series_was_fitted_to(base):
    data = json.loads((data_folder() / "materials" / "tables" / f"square-{base}.json").read_text())
    depth, ratio, corner, value = (np.array(data["values"][n]) for n in ("depth", "ratio", "corner", "factor"))
    rim = np.array(data["values"].get("rim", 0.0 * depth))
    factor, error = load_square(base).factor(depth / np.sqrt(1.0 + 1.0 / ratio**2), ratio)
    off, fine = np.abs(factor / value - 1.0), (corner < 0.25) & (rim == 0.0)
    assert np.all(off[fine] < np.maximum(3.0 * error[fine], 2e-3))
    assert np.all(off[rim > 0.0] < 0.025)
    off_by_rim = [off[rim == size].mean() for size in np.unique(rim[rim > 0.0])]
    assert np.all(np.diff(off_by_rim) > 0.0)


@pytest.mark.slow
def test_a_solved_factor_is_that_of_the_table():
    solved = solve_factor(block(10.0), 0.2)
    depth = np.array([0.0, 0.1, 0.2])
    factor, error = solved.factor(depth)
    table, stated = square_factor(depth * 10.0, 10.0, RADIUS)
    assert np.all(np.abs(factor / table - 1.0) < error + stated)
    assert error.max() < 0.005


def test_a_square_punch_carries_the_table_times_its_factor_and_their_errors_add_up():
    pad = Pad(10.0, 0.03, RADIUS, sides_mm=(14.0, 14.0))
    found = predict_static(pad, [1.0, 2.0])
    factor, error = square_factor(np.array([1.0, 2.0]), 10.0, RADIUS)
    table = load_table()
    assert found.force_N == pytest.approx(factor * table.force([1.0, 2.0], 10.0, 0.03, RADIUS), rel=1e-12)
    width = found.force_high_N / found.force_N - 1.0
    assert width == pytest.approx(error + table.relative_error([1.0, 2.0], 10.0, RADIUS), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [6.3, 13.0])
def test_the_factor_at_depth_agrees_with_a_beaded_solve_between_its_ratios(thickness):
    """At ratios a / h and with a bead that were not solved for the table: within its stated error and 0.5 %."""
    depth = np.array([0.3, 0.4, 0.5])
    found = solve_ratios(block(thickness), depth, CornerCells(0.16), 0.16)
    factor, error = square_factor(depth * thickness, thickness, RADIUS)
    assert np.all(np.abs(factor / found.ratio - 1.0) < error + 5e-3)
    assert error.max() < 0.015


@pytest.mark.slow
def test_a_curve_solved_in_space_is_the_round_one_times_the_tabulated_factor_and_rectangles_are_stiffer():
    depth = np.array([0.5, 1.0, 2.0, 3.0])
    square = Pad(10.0, 0.03, RADIUS, sides_mm=(14.0, 14.0))
    solved, circle = predict_static(square, depth, "3d"), predict_static(Pad(10.0, 0.03, RADIUS), depth, "axisymmetric")
    factor, error = square_factor(depth, 10.0, RADIUS)
    assert np.all(np.abs(solved.force_N / circle.force_N / factor - 1.0) < error + 1e-3)
    long = predict_static(Pad(10.0, 0.03, RADIUS, sides_mm=(28.0, 7.0)), depth, "3d")
    assert np.all(long.force_N > 1.03 * solved.force_N)


def test_what_cannot_be_known_is_refused(monkeypatch, tmp_path):
    with raises_code("not_tabulated", "base"):
        square_factor(1.0, 10.0, 7.9, "glue")
    with raises_code("out_of_range", "punch_radius_over_pad_thickness"):
        square_factor(0.1, 1.0, 7.9)
    with raises_code("unsupported", "fidelity"):
        predict_static(Pad(10.0, 0.03, RADIUS), [1.0], "3d")
    monkeypatch.setattr("dummydesign.core.user_library.data_folder", lambda: tmp_path)
    load_square.cache_clear()
    with raises_code("table_unavailable", "table"):
        load_square()
    load_square.cache_clear()


def test_the_stated_error_of_a_factor_adds_cells_scatter_and_what_is_extrapolated():
    curve = FactorCurve(
        np.array([0.1, 0.5]), np.array([1.0]), np.array([2.0]), 0.5, {0.45: 0.1, 0.2: 0.05}, {0.28: 0.5}, 1e-3, 2e-3, {}
    )
    value, error = curve.factor(np.array([0.04, 0.08, 0.3, 0.6]))
    half_of = np.array([0.2 * 1.0, 0.45 * 1.0, 0.28 * 2.0, 0.28 * 2.0]) * CORRECTION_ERROR
    scatter = 2.0 * np.array([1e-3, 1e-3, 2e-3, 2e-3])
    held = np.array([0.0, 0.0, 0.0, HELD_ERROR * 0.1 / 0.5])
    assert error == pytest.approx(MESH_ERROR + half_of + scatter + held)
    assert value == pytest.approx(np.exp(0.1 + 0.5 * np.array([0.04, 0.08, 0.3, 0.5])))


CROWN = {"radius": 21.2, "height": 2.0, "foot": 9.4}


def test_a_crown_knows_nothing_of_a_square_until_its_side_is_reached():
    factor, error = crown_factor(np.array([0.05, 0.2]), 4.5, RADIUS, CROWN)
    assert factor == pytest.approx(1.0, abs=1e-12)
    assert error == pytest.approx(0.0, abs=1e-12)


def test_the_factor_of_a_crown_is_that_of_finer_cells_than_most_of_its_fit():
    # `python -m studies.tables.square_crown`, nine cells over half a side; seven with half the fillet and short steps
    depth, solved = np.array([0.26, 0.34, 0.42]), np.array([0.92075, 0.93641, 0.94758])
    factor, error = crown_factor(4.5 * depth, 4.5, RADIUS, CROWN)
    assert np.all(np.abs(factor / solved - 1.0) <= error)
    depth, solved = np.array([0.26265, 0.29699, 0.33133, 0.36566, 0.4]), [0.92827, 0.92455, 0.93399, 0.94212, 0.94329]
    assert crown_factor(4.5 * depth, 4.5, RADIUS, CROWN)[0] == pytest.approx(np.array(solved), rel=0.006)
    assert np.all(factor < 0.97)


def test_on_a_crown_that_is_almost_flat_the_factor_is_that_of_a_slab():
    flat = {"radius": 1e6, "height": 5e-5, "foot": 10.0}
    factor, _ = crown_factor(2.0, 10.0, RADIUS, flat)
    assert factor == pytest.approx(float(square_factor(2.0, 10.0, RADIUS)[0]), abs=1e-4)


@pytest.mark.parametrize(("part", "least"), [("fresh", 30), ("blind", 60)])
def test_the_shipped_error_covers_crowns_that_were_not_fitted(part, least):
    """Blind ones are of another seed, with half the fillet and a third of the load step."""
    data = json.loads((data_folder() / "materials" / "tables" / "square-crowned.json").read_text(encoding="utf-8"))
    inside = []
    for row in data["values"]:
        if row["part"] == part and "factor" in row:
            h, *crown = row["pad"]
            depth = np.array(row["depth"])
            kept = (depth > 0.9 * row["edge"]) & (np.abs(row["correction"]) < 0.08)
            value, error = crown_factor(depth * h, h, RADIUS, dict(zip(CROWN, crown)))
            inside += (np.abs(np.log(value / np.array(row["factor"]))) <= error)[kept].tolist()
    assert len(inside) > least
    assert np.mean(inside) >= 0.95

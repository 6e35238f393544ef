"""Tables of made-up values that are known in closed form: what is read between nodes, beyond them and as error."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from dummydesign.core.user_library import data_folder
from dummydesign.pad.tables import puck, slab
from dummydesign.pad.tables.crowned import Response, crown_inputs, fade, matern, quadratic
from dummydesign.pad.tables.puck import PuckTable, friction_of, grip, interpolate, uniaxial
from dummydesign.pad.tables.slab import (
    CompressibilityTable,
    ResponseTable,
    check_ratio,
    load_table,
    sharp_edge_doubt,
    square_doubt,
)
from dummydesign.pad.tables.square import HELD_ERROR, SquareTable, combined_depth
from tests.support.refusal import raises_code

RNG = np.random.default_rng(12)
CHEBYSHEV = np.polynomial.chebyshev


def test_grip_runs_from_no_friction_to_glue_and_back():
    friction = np.array([0.0, 0.05, 0.2, 1.0, np.inf])
    assert grip(friction) == pytest.approx([0.0, 0.2, 0.5, 1.0 / 1.2, 1.0])
    assert [friction_of(float(one)) for one in grip(friction)] == pytest.approx(friction.tolist())


@pytest.mark.parametrize("alpha", [1.3, 2.0, 4.0])
def test_a_free_cylinder_follows_the_one_term_law_and_begins_with_its_modulus(alpha):
    """From the energy 2 E / (3 alpha^2) (l^alpha + 2 l^(-alpha / 2) - 3) per volume, by differences."""
    compression, step = np.array([0.1, 0.4]), 1e-6

    def energy(at):
        stretch = 1.0 - at
        return 2.0 / (3.0 * alpha**2) * (stretch**alpha + 2.0 * stretch ** (-0.5 * alpha) - 3.0)

    slope = (energy(compression + step) - energy(compression - step)) / (2.0 * step)
    assert uniaxial(alpha, compression) == pytest.approx(slope, rel=1e-6)
    assert uniaxial(alpha, np.array([1e-6]))[0] == pytest.approx(1e-6, rel=1e-4)


def bilinear(shape, a, g, c):
    return a + 2.0 * g + a * g + 3.0 * c


def made_puck(shape: float = 1.0, count: int = 5, log=bilinear) -> PuckTable:
    alpha, grips, compression = np.array([1.0, 2.0, 5.0]), np.array([0.0, 0.4, 1.0]), 0.1 * np.arange(count)
    values = log(shape, alpha[:, None, None], grips[:, None], compression)
    return PuckTable(shape, alpha, grips, compression, 0.1 * values)


def test_between_nodes_of_a_puck_s_table_a_bilinear_factor_is_exact_and_outside_it_is_held():
    table, compression = made_puck(), np.array([0.0, 0.13, 0.35])
    for alpha, held in ((1.0, 0.0), (1.7, 0.2), (4.0, 0.9), (5.0, 1.0), (0.2, 0.5), (9.0, 3.0)):
        a, g = np.clip(alpha, 1.0, 5.0), np.clip(held, 0.0, 1.0)
        found = np.log(table.factor(alpha, held, compression))
        assert found == pytest.approx(0.1 * bilinear(1.0, a, g, compression))
    table.check_shape(2.0 * 1.004 * 30.0, 30.0)
    for wrong in (0.99, 1.01):
        with raises_code("out_of_range"):
            table.check_shape(2.0 * wrong * 30.0, 30.0)


@pytest.mark.parametrize("shape", [0.55, 0.9, 1.3, 2.5])
def test_between_proportions_a_cubic_in_their_logarithm_is_exact_as_far_as_both_neighbours_reach(shape):
    def log(of, a, g, c):
        x = np.log(of)
        return a * (1.0 + x - 0.5 * x**2 + 0.3 * x**3) + g + c

    known = [made_puck(one, count, log) for one, count in ((0.5, 6), (0.7, 6), (1.0, 7), (1.6, 5), (3.0, 6))]
    found = interpolate(tuple(known), shape)
    left = max(k for k, one in enumerate(known) if one.radius_over_height < shape)
    reach = min(len(known[left].compression), len(known[left + 1].compression))
    assert found.log_factor.shape[-1] == len(found.compression) == reach and found.radius_over_height == shape
    assert found.log_factor == pytest.approx(made_puck(shape, reach, log).log_factor, abs=1e-12)
    assert interpolate(tuple(known), 0.7) is known[1]


def test_the_range_of_proportions_is_that_of_the_tables_and_its_ends_belong_to_it():
    low, high = puck.shape_range()
    shapes = [one.radius_over_height for one in puck.load_shapes()]
    assert (low, high) == pytest.approx((2.0 * shapes[0], 2.0 * shapes[-1])) and np.all(np.diff(shapes) > 0.0)
    for end in (low, high):
        assert puck.table_for(end * 10.0, 10.0).radius_over_height == pytest.approx(0.5 * end)
    for one in puck.load_shapes():
        assert one.log_factor.shape == (len(one.alpha), len(one.grip), len(one.compression))
        assert np.isfinite(one.log_factor).all()


def test_columns_of_a_quadratic_are_all_its_products_once():
    q = RNG.standard_normal((5, 3))
    columns = quadratic(q)
    assert columns.shape == (5, 10) and columns[:, 0] == pytest.approx(1.0) and columns[:, 1:4] == pytest.approx(q)
    products = {round(float(q[0, i] * q[0, j]), 9) for i in range(3) for j in range(i, 3)}
    assert {round(float(one), 9) for one in columns[0, 4:]} == products


def test_the_kernel_is_materns_of_five_halves():
    one, other, lengths = RNG.standard_normal((4, 2)), RNG.standard_normal((3, 2)), np.array([0.7, 2.0])
    distance = np.linalg.norm((one[:, None] - other) / lengths, axis=-1) * np.sqrt(5.0)
    exact = (1.0 + distance + distance**2 / 3.0) * np.exp(-distance)
    assert matern(one, other, lengths) == pytest.approx(exact, rel=1e-10)
    assert matern(one, one, lengths).diagonal() == pytest.approx(1.0)


def test_a_share_fades_smoothly_with_the_derivative_it_states():
    x, step = np.linspace(-0.2, 1.7, 20), 1e-6
    share, slope = fade(x, 0.5, 1.5)
    assert fade(np.array([0.5, 1.0, 1.5]), 0.5, 1.5)[0] == pytest.approx([0.0, 0.5, 1.0])
    assert np.all(np.diff(share) >= 0.0)
    ends = [fade(x + sign * step, 0.5, 1.5)[0] for sign in (1.0, -1.0)]
    assert slope == pytest.approx((ends[0] - ends[1]) / (2.0 * step), abs=1e-5)


def made_surface(anchored: bool) -> Response:
    levels = np.array([0.04, 0.16, 0.36, 0.64])
    trend = RNG.standard_normal((4, 6))
    return Response(
        np.array([0.0, -1.0]),
        np.array([2.0, 3.0]),
        np.array([0.8, 0.5]),
        RNG.uniform([0, -1], [2, 3], (7, 2)),
        levels,
        trend,
        RNG.standard_normal((4, 7)),
        RNG.uniform(0.4, 0.6, 7),
        anchored,
    )


@pytest.mark.parametrize("anchored", [True, False])
def test_a_surface_is_a_quadratic_with_kernels_at_its_levels_and_a_natural_spline_in_the_root_of_depth(anchored):
    made, inputs = made_surface(anchored), RNG.uniform([0, -1], [2, 3], (600, 2))
    q = inputs - np.array([1.0, 1.0])
    q[:, 1] /= 2.0
    assert made.scaled(inputs) == pytest.approx(q)
    rows = made.at_levels(inputs)
    exact = quadratic(q) @ made.trend.T + matern(q, made.scaled(made.centres), made.lengths) @ made.weights.T
    assert rows == pytest.approx(exact, abs=1e-10)
    knots = np.sqrt(np.concatenate([[0.0], made.levels]) if anchored else made.levels)
    values = np.concatenate([[0.0], rows[3]]) if anchored else rows[3]
    spline = CubicSpline(knots, values, bc_type="natural")
    depth = np.array([0.05, 0.1, 0.3, 0.5, 0.63])
    value, slope = made.along(rows, np.full(5, 3), depth)
    assert value == pytest.approx(spline(np.sqrt(depth))) and slope == pytest.approx(spline(np.sqrt(depth), 1))
    ends = np.array([0.0, 0.01, 0.7, 2.0])
    held, flat = made.along(rows, np.full(4, 3), ends)
    assert held == pytest.approx(spline(np.clip(np.sqrt(ends), knots[0], knots[-1])))
    assert flat[2:] == pytest.approx([0.0, 0.0]) and (anchored or not flat[:2].any())


def test_the_reach_of_a_surface_is_a_mean_of_what_was_solved_near_by():
    made = made_surface(True)
    assert made.limit(made.centres) == pytest.approx(made.reach, rel=1e-4)
    inputs = RNG.uniform([0, -1], [2, 3], (5, 2))
    square = ((made.scaled(inputs)[:, None] - made.scaled(made.centres)) / made.lengths) ** 2
    weight = 1.0 / square.sum(axis=-1) ** 2
    assert made.limit(inputs) == pytest.approx((weight * made.reach).sum(axis=1) / weight.sum(axis=1), rel=1e-3)


def test_the_coefficient_of_compressibility_is_read_on_straight_lines_of_its_logarithm():
    ratio, depth = np.array([0.5, 1.0, 4.0]), np.array([0.0, 0.2, 0.6])
    table = CompressibilityTable(ratio, depth, np.exp(1.0 + 0.3 * np.log(ratio)[:, None] - 0.5 * depth))
    share, at = np.array([[-0.1, 0.1, 0.3, 0.9], [0.0, 0.2, 0.5, 0.6]]), np.array([[0.7], [9.0]])
    exact = np.exp(1.0 + 0.3 * np.log(np.clip(at, 0.5, 4.0)) - 0.5 * np.clip(share, 0.0, 0.6))
    assert table.coefficient(share, at) == pytest.approx(exact)


def test_what_codes_differ_by_under_a_sharp_edge_is_read_between_pads_and_carried_on_below():
    """On the pads of 20, 15, 10 and 5 mm under the punch of 7.9 mm, at d/h 0.1, 0.2, 0.3 and 0.425."""
    known = slab._DIFFERENCE
    for row, ratio in zip(known, slab._RATIO):
        assert sharp_edge_doubt(slab._DEPTH, ratio) == pytest.approx(row)
        slope = (row[3] - row[2]) / 0.125
        assert sharp_edge_doubt(np.array([0.0, 0.15, 0.5]), ratio) == pytest.approx(
            [row[0], 0.5 * (row[0] + row[1]), row[3] + 0.075 * slope]
        )
    between = np.sqrt(slab._RATIO[0] * slab._RATIO[1])
    assert sharp_edge_doubt(0.3, between) == pytest.approx(0.5 * (known[0, 2] + known[1, 2]))
    assert sharp_edge_doubt(0.3, [0.01, 9.0]) == pytest.approx(known[[0, -1], 2])


def test_a_square_is_doubted_on_thin_pads_pressed_deep_alone():
    assert square_doubt(0.45, 1.58) == pytest.approx(0.014) and square_doubt(0.6, 9.0) == pytest.approx(0.028)
    assert square_doubt(0.375, 1.58) == pytest.approx(0.007)
    assert square_doubt(0.45, np.sqrt(0.79 * 1.58)) == pytest.approx(0.007)
    assert not np.any(square_doubt([0.1, 0.3, 0.45, 0.6], [1.58, 2.0, 0.79, 0.2]))


def test_a_radius_outside_a_table_is_refused_and_the_ends_belong_to_it():
    check_ratio([0.2, 1.0, 3.0], (0.2, 3.0))
    for wrong in (0.199, 3.01, np.nan):
        with raises_code("out_of_range"):
            check_ratio([1.0, wrong], (0.2, 3.0))


def made_slab() -> ResponseTable:
    """ln s = 1 + 2 u + 0.5 v + 0.25 u v over d/h 0 to 0.5 and a/h 0.5 to 2."""
    ratio = np.array([0.5, 1.0, 2.0])
    return ResponseTable(
        "bonded", np.array([[1.0, 0.5], [2.0, 0.25]]), (0.5, 2.0), (0.0, 0.5), ratio, np.array([0.5, 0.4, 0.3]), ratio,
        np.array([0.0, 0.5]), np.array([[0.01, 0.03], [0.02, 0.04], [0.03, 0.05]]), {},
    )  # fmt: skip


def test_a_series_of_a_slab_is_its_force_and_its_end():
    table, depth, h = made_slab(), np.array([0.5, 1.5, 3.0]), 10.0
    for a in (5.0, 8.0, 14.0):
        u, v = 4.0 * depth / h - 1.0, np.log(a / h) / np.log(2.0)
        s = np.exp(1.0 + 2.0 * u + 0.5 * v + 0.25 * u * v)
        assert table.force(depth, h, 0.03, a) == pytest.approx(0.03 * a * depth * s)
        slope = 4.0 * (2.0 + 0.25 * v)
        stiffness = table.stiffness(depth, h, 0.03, a)
        assert stiffness == pytest.approx(0.03 * a * s * (1.0 + depth / h * slope))
    end = table.depth_limit(np.sqrt(0.5))
    assert end == pytest.approx(0.45) and table.depth_limit_mm(h, 14.142135623730951) == pytest.approx(3.5)
    assert np.isnan(table.force(4.01, h, 0.03, 10.0))
    assert np.isfinite(table.force(4.0, h, 0.03, 10.0)) and table.force(-1.0, h, 0.03, 10.0) == 0.0
    assert table.stiffness(-1.0, h, 0.03, 10.0) == 0.0


def test_the_error_of_a_slab_is_the_larger_of_its_own_and_of_what_codes_differ_by():
    table, h = made_slab(), 10.0
    found = table.solved_error([2.5, 0.0, 9.0], h, [10.0, 7.0710678, 20.0])
    assert found == pytest.approx([0.03, 0.015, 0.05])
    assert table.relative_error(2.5, h, 10.0) == pytest.approx(0.03)
    exact = replace(table, error=0.0 * table.error)
    assert exact.relative_error(4.0, h, 10.0) == pytest.approx(sharp_edge_doubt(0.4, 1.0))


def test_a_square_s_factor_is_held_beyond_its_solves_and_its_error_grows_from_there():
    ends = np.array([0.5, 2.0])
    table = SquareTable(
        "bonded", np.array([[0.02, 0.01], [0.03, 0.0]]), (0.5, 2.0), (0.0, 1.0), ends, np.array([0.8, 0.4]), ends,
        np.array([0.0, 1.0]), np.array([[0.001, 0.003], [0.002, 0.004]]), {},
    )  # fmt: skip
    assert combined_depth(0.3, 0.75) == pytest.approx(0.3 * np.sqrt(1.0 + 1.0 / 0.5625))
    ratio, reach = 1.0, 0.6
    y = np.array([-0.2, 0.0, 0.3, 0.6, 0.9])
    value, error = table.factor(y / np.sqrt(2.0), ratio)
    inside = np.clip(y, 0.0, reach)
    assert np.log(value) == pytest.approx(0.02 + 0.03 * (2.0 * inside - 1.0))
    assert error == pytest.approx(0.0015 + 0.002 * inside + HELD_ERROR * np.array([0, 0, 0, 0, 0.5]))
    assert np.log(table.factor(0.0, 2.0)[0]) == pytest.approx(0.02 + 0.01 - 0.03)


def test_values_at_a_fillet_lie_between_its_neighbours_where_both_are_known():
    at = np.array([0.0, 0.1, 0.3, 0.7])
    rows = 1.0 + 2.0 * at[:, None] + np.zeros((4, 3))
    rows[2, 1], rows[0, 2] = np.nan, np.nan
    found = slab._joined(at, rows, 0.2)
    assert found[0] == pytest.approx(1.4) and np.isnan(found[1]) and found[2] == pytest.approx(1.4)
    assert slab._joined(at, rows, 0.7)[0] == pytest.approx(2.4)
    assert slab._joined(at, rows, 0.05)[0] == pytest.approx(1.1)
    depth = np.array([0.1, 0.2, 0.4])
    lasts = [slab._last_known(depth, row) for row in ([1.0, 2.0, 3.0], [1.0, np.nan, 3.0], [np.nan, 1.0, 1.0])]
    assert lasts == [0.4, 0.1, 0.0]


@pytest.fixture(scope="module")
def fillets():
    """The solves of every fourth pad."""
    data = json.loads((data_folder() / "materials" / "tables" / "filleted-bonded.json").read_text(encoding="utf-8"))
    return data | {name: data[name][::4] for name in ("ratio", "value", "error")}


def test_at_a_solved_fillet_the_table_is_its_solves_within_the_stated_error(fillets):
    depth, ratios = np.array(fillets["depth"]), np.array(fillets["ratio"])
    k = 2
    table = slab.between_fillets(fillets, float(fillets["fillet"][k]))
    value, error = (np.array(fillets[name], dtype=float)[:, k] for name in ("value", "error"))
    known = np.isfinite(value)
    found = table.log(depth, ratios[:, None])
    stated = table.relative_error(depth, 1.0, ratios[:, None])
    assert known.mean() > 0.7 and np.abs(found - value)[known].max() < stated[known].max()
    assert np.mean(np.abs(found - value)[known] <= stated[known]) > 0.99
    assert np.median(np.abs(found - value)[known]) < 1e-3
    assert np.all(stated[known] >= error[known] - 1e-9) and np.all(np.diff(stated, axis=1) >= -1e-12)
    ends = np.array([depth[np.nonzero(row)[0].max()] for row in known])
    assert table.limit_depth == pytest.approx(ends, abs=0.1)
    assert (table.ratio_range, table.depth_range) == ((ratios[0], ratios[-1]), (0.0, depth[-1]))


def test_a_fillet_below_the_first_node_is_doubted_more_where_few_sharp_solves_are_left(fillets):
    tables = [slab.between_fillets(fillets, float(one)) for one in (0.0249, 0.0251)]
    shallow, deep = (
        [float(table.relative_error(depth, 1.0, 1.0)) for table in tables] for depth in (0.3, tables[0].depth_range[1])
    )
    assert shallow[0] == pytest.approx(shallow[1], abs=2e-3) and deep[0] - deep[1] > 0.8 * slab.FEW
    sharp = load_table("bonded")
    assert tables[0].depth_limit(1.0) <= float(sharp.depth_limit(1.0)) + 0.051


def test_the_numbers_of_a_crown_alone_leave_the_punch_out():
    """c/h, b/h and s from ln h/a, c/h, ln b/a and ln s: the same whatever the punch."""
    one = np.array([[np.log(2.0), 0.3, np.log(0.8), -1.0]])
    other = one - np.array([[np.log(3.0), 0.0, np.log(3.0), 0.0]])
    assert crown_inputs(one) == pytest.approx(crown_inputs(other))
    assert crown_inputs(one)[0] == pytest.approx([0.3, np.log(0.4), -1.0])

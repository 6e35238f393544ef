"""Profile intervals: equal to the textbook in a linear problem, one-sided or missing where data are silent."""

import numpy as np
import pytest

from dummydesign.inference.least_squares import Solution, profile_interval, solve, solve_by_differences, solve_marquardt

WIDE = np.full(2, 50.0)


def line(y, x):
    """Unit-variance straight line."""
    design = np.column_stack([np.ones_like(x), x])
    return lambda b: (design @ b - y, design)


def test_in_a_linear_problem_the_interval_is_1_96_standard_deviations():
    rng = np.random.default_rng(0)
    x = np.linspace(0, 1, 40)
    y = 2.0 + 3.0 * x + rng.normal(size=40)
    model = line(y, x)
    best = solve(model, [np.zeros(2)], -WIDE, WIDE)
    assert best.parameters == pytest.approx(np.polynomial.polynomial.polyfit(x, y, 1), rel=1e-6)
    design = model(best.parameters)[1]
    deviation = np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
    for index in range(2):
        interval = profile_interval(model, best, index, -WIDE, WIDE)
        assert interval.high - best.parameters[index] == pytest.approx(1.96 * deviation[index], rel=0.02)
        assert best.parameters[index] - interval.low == pytest.approx(1.96 * deviation[index], rel=0.02)
        assert not interval.at_bound and interval.reason == ""


def test_a_parameter_the_data_do_not_see_has_no_interval():
    x = np.linspace(0, 1, 20)

    def model(b):
        jacobian = np.column_stack([np.ones(20), np.zeros(20)])
        return b[0] - x, jacobian

    best = solve(model, [np.zeros(2)], -WIDE, WIDE)
    interval = profile_interval(model, best, 1, -WIDE, WIDE)
    assert interval.low is None and interval.high is None
    assert interval.reason == "not identifiable: the data set no bound below or above"


def test_a_logarithm_that_may_go_to_minus_infinity_is_bounded_on_one_side_only():
    def model(b):
        return np.array([10.0 * np.exp(b[0]) - 0.5]), np.array([[10.0 * np.exp(b[0]), 0.0]])

    best = Solution(np.array([np.log(0.05), 0.0]), 0.0, 1, 1)
    interval = profile_interval(model, best, 0, -WIDE, WIDE)
    # |10 exp(b) - 0.5| = 1.96 at exp(b) = 0.246 above, never below
    assert interval.low is None and "below" in interval.reason
    assert np.exp(interval.high) == pytest.approx(0.246, rel=0.02)


def test_an_optimum_on_the_box_is_called_at_bound():
    x = np.linspace(0, 1, 20)
    low, high = np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    best = solve(line(5.0 + 0 * x, x), [np.zeros(2)], low, high)
    assert best.parameters[0] == pytest.approx(1.0)
    assert profile_interval(line(5.0 + 0 * x, x), best, 0, low, high).at_bound


def test_the_best_of_several_starts_is_kept_and_the_agreeing_ones_counted():
    def model(b):
        # minima at b0 = -1 (cost 0.25) and b0 = 2 (cost 0)
        value = np.array([(b[0] + 1) * (b[0] - 2), 0.5 * (b[0] < 0.5), b[1]])
        return value, np.array([[2 * b[0] - 1, 0.0], [0.0, 0.0], [0.0, 1.0]])

    starts = [np.array([-2.0, 1.0]), np.array([3.0, 1.0]), np.array([4.0, 0.0])]
    best = solve(model, starts, -WIDE, WIDE)
    assert best.parameters == pytest.approx([2.0, 0.0], abs=1e-6)
    assert (best.starts, best.agreeing) == (3, 2)


@pytest.mark.parametrize("by", ["trust region", "differences", "marquardt"])
@pytest.mark.parametrize("top", [50.0, 2.5])
def test_the_three_searches_find_the_same_minimum_inside_and_on_the_box(by, top):
    """y = a exp(-b t): with b bounded below its least-squares value the best a is the linear one at the bound."""
    t = np.linspace(0.0, 1.0, 30)
    y = 4.0 * np.exp(-3.0 * t) + 0.01 * np.cos(40.0 * t)
    low, high, start = np.array([-9.0, -9.0]), np.array([9.0, np.log(top)]), np.array([0.0, 0.0])

    def residual(b):
        return np.exp(b[0] - np.exp(b[1]) * t) - y

    def jacobian(b):
        value = residual(b) + y
        return np.column_stack([value, -np.exp(b[1]) * t * value])

    if by == "trust region":
        found = solve(lambda b: (residual(b), jacobian(b)), [start], low, high).parameters
    elif by == "differences":
        found = solve_by_differences(residual, [start], low, high, 1e-10).parameters
    else:
        found = solve_marquardt(residual, jacobian, start, low, high, iterations=60, enough=1e-12)
    if top > 3.0:
        assert np.exp(found) == pytest.approx([4.0, 3.0], rel=0.01)
        assert np.max(np.abs(jacobian(found).T @ residual(found))) < 1e-4
    else:
        column = np.exp(-top * t)
        assert np.exp(found) == pytest.approx([column @ y / (column @ column), top], rel=1e-4)
        assert by != "marquardt" or found[1] == high[1]


def test_parameters_that_are_fixed_stay_and_the_others_are_best_for_them():
    x = np.linspace(0.0, 1.0, 20)
    design = np.column_stack([np.ones(20), x])
    y = 2.0 + 3.0 * x
    found = solve_marquardt(
        lambda b: design @ b - y, lambda b: design, np.array([1.0, 0.0]), -WIDE, WIDE, [0], 60, 1e-12
    )
    assert found == pytest.approx([1.0, x @ (y - 1.0) / (x @ x)])


def test_the_jacobian_is_made_once_a_step_that_is_taken():
    made, tried = [], []

    def residual(b):
        tried.append(b)
        return np.array([10.0 * (b[1] - b[0] ** 2), 1.0 - b[0]])

    def jacobian(b):
        made.append(tuple(b))
        return np.array([[-20.0 * b[0], 10.0], [-1.0, 0.0]])

    found = solve_marquardt(residual, jacobian, np.array([-1.2, 1.0]), -WIDE, WIDE, iterations=200, enough=1e-14)
    assert found == pytest.approx([1.0, 1.0], abs=1e-5)
    assert len(set(made)) == len(made) < len(tried)

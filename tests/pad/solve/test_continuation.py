"""Load steps of a path that fail: halved, tried again, and given up when they lead nowhere."""

import numpy as np
import pytest

from dummydesign.core.progress import reporting_depths
from dummydesign.pad.solve import continuation
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.equilibrium import MAX_ITERATIONS, Equilibrium, Failure

MOST_WASTED = 45


class Spring:
    """One unknown that follows the punch; its force is the depth."""

    surface = punch = None
    grows = False

    class pattern:
        n = 1

    class State:
        J = np.ones(1)

    def start(self):
        return np.zeros(1), np.zeros(1)

    def direction(self):
        return -np.ones(1), np.zeros(1)

    def force(self, state):
        return state.force


@pytest.fixture
def fails(monkeypatch):
    """Make steps fail by a rule (reached, tried); gives the depths at which one failed."""
    failed = []

    def by(rule):
        reached = [0.0]

        def find(problem, u, p, depth, tolerance=1e-6, without_ties=False):
            if rule(reached[-1], depth):
                failed.append(depth)
                return Failure("no equilibrium", MAX_ITERATIONS)
            reached.append(depth)
            state = Spring.State()
            state.force = depth
            return Equilibrium(np.array([-depth]), p, state, (1e-8,), 0, 2)

        monkeypatch.setattr(continuation, "find_equilibrium", find)
        monkeypatch.setattr(continuation, "explain", lambda problem, u, p, depth, reason: f"{depth:.3f}: {reason}")
        return failed

    return by


def test_a_wall_ends_a_path_long_before_the_smallest_step(fails):
    failed = fails(lambda reached, depth: depth > 0.31)
    path = follow(Spring(), [0.1, 0.2, 0.3, 0.4, 0.5], 0.05, 0.05, 1e-9, most_wasted=MOST_WASTED)
    assert path.depth.tolist() == pytest.approx([0.1, 0.2, 0.3])
    assert len(failed) * MAX_ITERATIONS > MOST_WASTED >= (len(failed) - 1) * MAX_ITERATIONS
    assert "no equilibrium" in path.stop and path.newton_iterations >= len(failed) * MAX_ITERATIONS


def test_single_steps_that_fail_here_and_there_end_no_path(fails):
    failed = fails(lambda reached, depth: depth - reached > 0.03)
    path = follow(Spring(), [0.5], 0.05, 0.05, 1e-9, most_wasted=MOST_WASTED)
    assert path.stop is None and path.depth.tolist() == pytest.approx([0.5])
    assert len(failed) * MAX_ITERATIONS > 2 * MOST_WASTED


@pytest.mark.parametrize("lattice", [False, True])
def test_a_path_ends_before_the_first_depth_that_is_refused_and_takes_the_reason_for_its_own(fails, lattice):
    fails(lambda reached, depth: False)
    asked, told = [], []

    def visit(depth, solution):
        asked.append(depth)
        return "met itself" if depth > 0.25 else None

    with reporting_depths(told.append):
        path = follow(Spring(), [0.1, 0.2, 0.3, 0.4], 0.05, 0.05, 1e-9, lattice=lattice, visit=visit)
    follow(Spring(), [0.1], 0.05, 0.05, 1e-9)
    assert path.stop == "met itself" and path.depth.tolist() == pytest.approx([0.1, 0.2]) == told
    assert path.force.tolist() == pytest.approx([0.1, 0.2]) and asked == pytest.approx([0.1, 0.2, 0.3])

"""Load steps of a path: how they grow, end and halve, what is kept of them, and fronts of a dissection."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.solve import continuation
from dummydesign.pad.solve.continuation import EASY, WITHOUT_TIES, follow
from dummydesign.pad.solve.equilibrium import TIED, Equilibrium, Failure
from dummydesign.pad.solve.multifrontal import LEAF_CELLS, Dissection, halve
from dummydesign.pad.solve.sparse import Pattern, _inverse, _sweeps
from dummydesign.pad.spatial.shaped_pad import pierced


class Spring:
    """One unknown that follows the punch; its force is the square of the depth."""

    punch, grows = None, False

    class pattern:
        n = 1

    class State:
        def __init__(self, depth: float, J: float) -> None:
            self.force, self.J = depth**2, np.array([J, 1.0])

    class Surface:
        changes = 0

        def __init__(self) -> None:
            self.settled, self.state = [], 0

        def memory(self):
            return self.state

        def restore(self, memory):
            self.state = memory

        def settle(self, u, punch, depth):
            self.settled.append(depth)
            self.state += 1

    def __init__(self, touches: bool = False) -> None:
        self.surface = self.Surface() if touches else None

    def start(self):
        return np.zeros(1), np.zeros(1)

    def direction(self):
        return -np.ones(1), 3.0 * np.ones(1)

    def force(self, state):
        return state.force


@pytest.fixture
def walk(monkeypatch):
    """Follow a spring; iterations and ties of a step by its end, failures by a rule; all that was tried."""
    monkeypatch.setattr(continuation, "explain", lambda problem, u, p, depth, reason: f"{depth:.4f}: {reason}")

    def go(
        depths,
        first=0.01,
        largest=0.04,
        smallest=1e-4,
        hard=lambda depth: EASY,
        ties=lambda depth: 0,
        fails=lambda depth: None,
        J=lambda depth: 1.0,
        touches=False,
        **more,
    ):
        tried = []

        def find(problem, u, p, depth, tolerance=1e-6, without_ties=False):
            tried.append((depth, float(u[0]), float(p[0]), without_ties))
            why = fails(depth)
            if why is None and without_ties and ties(depth):
                why = TIED
            if why:
                return Failure(why, 9)
            return Equilibrium(
                np.array([-depth]),
                np.array([3.0 * depth]),
                Spring.State(depth, J(depth)),
                (1e-8,),
                ties(depth),
                hard(depth),
            )

        monkeypatch.setattr(continuation, "find_equilibrium", find)
        problem = Spring(touches)
        return follow(problem, depths, first, largest, smallest, **more), tried, problem

    return go


def test_easy_steps_grow_to_the_largest_and_hard_ones_stay(walk):
    path, tried, _ = walk([1.0])
    ends = np.diff([0.0, *(row[0] for row in tried)])
    assert ends[0] == pytest.approx(0.01) and ends[:-1].max() == pytest.approx(0.04) and ends[-1] <= 0.05 + 1e-12
    growing = ends[:4]
    assert growing[1:] / growing[:-1] == pytest.approx(np.full(3, 1.4))
    assert path.depth == pytest.approx([1.0]) and path.force == pytest.approx([1.0]) and path.load_steps == len(tried)
    assert path.newton_iterations == EASY * len(tried)
    _, slow, _ = walk([0.1], hard=lambda depth: EASY + 1)
    assert np.diff([0.0, *(row[0] for row in slow)]) == pytest.approx(np.full(10, 0.01))
    # Points that came to touch may cost some iterations more.
    _, tied, _ = walk([0.1], hard=lambda depth: EASY + 2, ties=lambda depth: 1)
    assert len(tied) < 8


def test_every_depth_is_met_and_no_sliver_is_left_before_it(walk):
    depths = [0.013, 0.05, 0.051, 0.2]
    path, tried, _ = walk(depths)
    assert path.depth == pytest.approx(depths) and path.stop is None
    steps = np.diff([0.0, *(row[0] for row in tried)])
    assert steps.min() == pytest.approx(0.001) and np.sort(steps)[1] > 0.004


def test_a_step_starts_from_the_last_two_carried_on_straight_but_not_far_after_a_small_one(walk):
    """States are straight in depth: every guess is then the answer itself, but after a step of a hundredth."""
    _, tried, _ = walk([0.3])
    assert [row[1:3] for row in tried] == [pytest.approx((-row[0], 3.0 * row[0])) for row in tried]
    _, tried, _ = walk([0.02, 0.0201, 0.3], first=0.02)
    before, small, after = tried[:3]
    assert after[1] == pytest.approx(-(small[0] + 5.0 * (small[0] - before[0])))


def test_a_step_that_fails_is_halved_and_a_path_ends_below_the_smallest(walk):
    path, tried, _ = walk([0.1, 0.5], fails=lambda depth: "a wall" if depth > 0.1234 else None)
    wall = [row[0] for row in tried if row[0] > 0.1234]
    assert path.depth == pytest.approx([0.1]) and path.stop.endswith("a wall") and path.stop.startswith("0.123")
    assert wall[-1] - 0.1234 < 2e-4 and len(wall) < 25
    assert path.newton_iterations == 9 * len(wall) + EASY * path.load_steps
    once = [False]

    def fails(depth):
        once[0], before = once[0] or depth > 0.15, once[0]
        return "once" if depth > 0.15 and not before else None

    path, tried, _ = walk([0.5], fails=fails)
    failed = next(k for k in range(1, len(tried)) if tried[k][0] < tried[k - 1][0])
    base = tried[failed - 2][0]
    assert tried[failed][0] - base == pytest.approx(0.5 * (tried[failed - 1][0] - base)) and path.stop is None


def test_on_a_lattice_steps_end_at_multiples_of_the_largest_and_halves_of_it_whatever_depths_are_wanted(walk):
    ends = []
    for depths in ([0.3], [0.0123, 0.1, 0.117, 0.3]):
        kept = []
        path, _, problem = walk(depths, lattice=True, touches=True, keep=kept.append)
        assert path.depth == pytest.approx(depths) and path.force == pytest.approx(np.array(depths) ** 2)
        ends.append([one.depth for one in kept])
        assert problem.surface.settled == pytest.approx(ends[-1])
        assert [one.memory for one in kept] == list(range(len(kept)))
    assert ends[0] == pytest.approx(ends[1])
    steps, whole = np.diff([0.0, *ends[0]]), np.array(ends[0]) / 0.04
    assert np.all(np.abs(whole * 4.0 - np.round(whole * 4.0)) < 1e-9)
    large = steps[whole[:-1].searchsorted(1.0) + 1 :]
    assert steps.max() <= WITHOUT_TIES * 0.04 * (1.0 + 1e-9) and large.max() > 0.04 * (1.0 + 1e-9)


def test_on_a_lattice_a_long_step_in_which_something_came_to_touch_is_taken_in_ordinary_ones(walk):
    path, tried, _ = walk([0.6], lattice=True, ties=lambda depth: int(depth > 0.3))
    long = [row for row in tried if row[3]]
    assert path.stop is None and long and all(row[0] > 0.04 for row in long)
    failed = [k for k, row in enumerate(tried) if row[3] and row[0] > 0.3]
    assert failed and all(tried[k + 1][0] <= tried[k][0] and not tried[k + 1][3] for k in failed)


def test_a_wanted_depth_that_cannot_be_met_beside_the_lattice_is_met_from_nearer_by(walk):
    seen = []

    def fails(depth):
        seen.append(depth)
        return "from afar" if abs(depth - 0.09) < 1e-9 and seen[-2] - depth > 0.006 else None

    path, _, _ = walk([0.09, 0.2], lattice=True, fails=fails)
    assert path.depth == pytest.approx([0.09, 0.2]) and seen.count(0.09) > 1
    path, _, _ = walk([0.09, 0.2], lattice=True, fails=lambda depth: "never" if abs(depth - 0.09) < 1e-9 else None)
    assert path.stop.endswith("never") and not len(path.depth)


def test_a_path_ends_after_the_first_depth_at_which_a_cell_is_crumpled(walk):
    path, _, _ = walk([0.1, 0.2, 0.3], J=lambda depth: 1.0 - 3.0 * depth, sound_J=0.5)
    assert path.depth == pytest.approx([0.1, 0.2]) and path.smallest_J == pytest.approx([0.7, 0.4])
    assert "volume ratio" in path.stop


def test_cells_are_halved_across_their_longest_way_between_two_layers():
    position = np.array([[0, 1, 2, 3, 4, 5, 0, 1], [7, 7, 7, 7, 7, 7, 8, 8], [90] * 8])
    one, other = halve(position, np.arange(8))
    assert position[0, one].max() < position[0, other].min() and len(one) in (4, 5)
    one, other = halve(np.zeros((3, 5), dtype=int), np.arange(5))
    assert sorted([*one, *other]) == list(range(5)) and {len(one), len(other)} == {2, 3}


def test_the_fronts_of_a_long_beam_are_small():
    """A chain of cells far along its second axis: cut across it, a front has the unknowns of two ends."""
    count = 64
    dofs = np.arange(count)[:, None] * 2 + np.arange(4)
    position = np.stack([100 + np.arange(count) % 2, np.arange(count), np.zeros(count, dtype=int)])
    fronts = Dissection([dofs], np.arange(2 * count + 2), 2 * count + 2, position).fronts
    assert max(len(front.unknowns) for front in fronts) <= 2 * (LEAF_CELLS + 1)
    assert sum(front.eliminated for front in fronts) == 2 * count + 2


@pytest.mark.parametrize("size", [1, 2, 3])
def test_small_blocks_are_inverted(size):
    blocks = np.random.default_rng(size).standard_normal((5, size, size)) + 2.0 * np.eye(size)
    assert _inverse(blocks) @ blocks == pytest.approx(np.broadcast_to(np.eye(size), blocks.shape), abs=1e-12)


def test_places_are_swept_along_each_direction_and_along_the_next_where_they_are_alike():
    x, y = (grid.ravel() for grid in np.meshgrid([0.0, 1.0, 2.0], [0.0, -1.0]))
    first, second = _sweeps(np.stack([x, y]))
    assert np.all(np.diff(x[first]) >= 0.0) and np.all(np.diff(y[second]) >= 0.0)
    assert y[first].tolist() == [-1.0, 0.0] * 3 and x[second].tolist() == [0.0, 1.0, 2.0] * 2


def test_inner_unknowns_of_elements_are_eliminated_before_the_factorisation():
    """The last two of every element are its own: they are not in the band, and their answers are exact."""
    count, rng = 12, np.random.default_rng(9)
    element = np.arange(count)
    dofs = np.column_stack([element, 1 + element, 20 + 2 * element, 21 + 2 * element])
    root = rng.standard_normal((count, 4, 4))
    matrix, size = root @ root.transpose(0, 2, 1) + np.eye(4), 20 + 2 * count
    free = np.setdiff1d(np.unique(dofs), [0])
    pattern = Pattern([dofs], free, size)
    whole, load = np.zeros((size, size)), rng.standard_normal(size)
    np.add.at(whole, (dofs[:, :, None], dofs[:, None, :]), matrix)
    answer = pattern.solve([matrix], load)
    assert answer[free] == pytest.approx(np.linalg.solve(whole[np.ix_(free, free)], load[free]), rel=1e-9)
    assert pattern._band.width == 1 and len(pattern._kept) == count
    other = rng.standard_normal(size)
    exact = np.linalg.solve(whole[np.ix_(free, free)], other[free])
    assert pattern.again(other)[free] == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("upwards", [False, True])
def test_an_edge_that_runs_through_a_triangle_pierces_it_whichever_way_both_are_counted(turned, upwards):
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    other = np.array([[0.25, 0.25, -1.0], [0.25, 0.25, 1.0], [0.3, -2.0, 0.0]])
    points = np.concatenate([flat[::-1] if turned else flat, other[[1, 0, 2]] if upwards else other])
    edges, faces = pierced(points, np.array([[0, 1, 2], [3, 4, 5]]))
    through = [set(edge) for edge, face in zip(edges.tolist(), faces.tolist()) if set(face) == {0, 1, 2}]
    assert through == [{3, 4}]
    beside = points + np.where(np.arange(6)[:, None] > 2, np.array([0.6, 0.6, 0.0]), 0.0)
    assert not any({3, 4} == set(edge) for edge in pierced(beside, np.array([[0, 1, 2], [3, 4, 5]]))[0].tolist())

"""Forces by table do not jump where pieces, nodes and neighbouring tables join: paths through every coordinate.

Crowned pads have a module of their own (test_crown_continuity).
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.core.user_library import table_path
from dummydesign.pad.tables import puck
from dummydesign.pad.tables.shape import load_shape_table
from dummydesign.pad.tables.slab import FILLETS, load_filleted, load_table
from dummydesign.pad.tables.square import combined_depth, load_square, square_law
from studies.tables.puck import filled
from tests.support.steps import largest_steps

WIDTH, ALLOWED, PATHS = 1e-6, 1e-4, 400
"""Share of a path of 4 % over which ln F may change by ``ALLOWED``."""


def steps_along(function, points, coordinate):
    end = points.copy()
    end[:, coordinate] *= 1.04
    return largest_steps(function, points, end, WIDTH)


def shaped(kind, seed):
    """Function and random points (pad's numbers and d/h) of a kind's table, inside its depth limit."""
    table = load_shape_table(kind)
    low, high = (table.coordinates(end[None])[0] for end in (table.low, table.high))
    rng = np.random.default_rng(seed)
    pads = rng.uniform(low, high, (PATHS, len(low)))
    pads = np.where(table.similarity.logarithms, np.exp(pads), pads)
    points = np.hstack([pads, rng.uniform(0.02, 0.58, (PATHS, 1))])
    points = points[points[:, -1] < 0.95 * table.depth_limit(pads)]
    return lambda at: table.log_factor(at[:, :-1], np.arange(len(at)), at[:, -1]), points


@pytest.mark.parametrize("kind", ["layered", "boned"])
@pytest.mark.parametrize("coordinate", range(4))
def test_a_shaped_pad_meets_no_step(kind, coordinate):
    function, points = shaped(kind, 61 + coordinate)
    assert len(points) > PATHS / 2
    assert steps_along(function, points, coordinate).max() < ALLOWED


@pytest.mark.parametrize("base", ["bonded", "sliding"])
@pytest.mark.parametrize("coordinate", range(2))
def test_slabs_and_squares_meet_no_step(base, coordinate):
    table, square = load_table(base), load_square(base)
    rng = np.random.default_rng(35)
    low, high = (np.log(end) for end in table.ratio_range)
    points = np.column_stack([rng.uniform(0.0, 0.45, PATHS), np.exp(rng.uniform(low, high - 0.05, PATHS))])
    assert steps_along(lambda at: table.log(at[:, 0], at[:, 1]), points, coordinate).max() < ALLOWED
    assert steps_along(lambda at: square.factor(at[:, 0], at[:, 1])[0], points, coordinate).max() < ALLOWED


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_a_square_meets_no_step_where_its_solves_end(base):
    """The factor is held and its error grows from there; both over every a / h, its nodes among them."""
    square = load_square(base)
    ratio = np.concatenate([np.geomspace(*square.ratio_range, 61), square.limit_ratio])
    end = np.interp(np.log(ratio), np.log(square.limit_ratio), square.limit_depth) / combined_depth(1.0, ratio)
    below, above = (square.factor(end * (1.0 + share), ratio) for share in (-WIDTH, WIDTH))
    for before, after in zip(below, above):
        assert np.max(np.abs(after - before)) < 1e-5
    deeper = square.factor(1.2 * end, ratio)
    assert deeper[0] == pytest.approx(above[0], rel=1e-5) and np.all(deeper[1] > above[1] + 1e-3)


@pytest.mark.parametrize("base", ["bonded", "sliding"])
@pytest.mark.parametrize("coordinate", range(2))
def test_force_and_stated_error_of_a_square_punch_meet_no_step(base, coordinate):
    """The slab's table times the square's factor, with the errors of both and the doubt in either."""
    law, table = square_law(load_table(base), base), load_table(base)
    rng = np.random.default_rng(36)
    low, high = (np.log(end) for end in table.ratio_range)
    ratio = np.exp(rng.uniform(low, high - 0.05, PATHS))
    ends = np.minimum(table.depth_limit(ratio), table.depth_limit(1.04 * ratio))
    points = np.column_stack([rng.uniform(0.01, 0.96, PATHS) * ends, ratio])

    def log_force(at):
        return np.log(law.force(at[:, 0], 1.0, 1.0, at[:, 1]))

    def error(at):
        return law.relative_error(at[:, 0], 1.0, at[:, 1])

    assert steps_along(log_force, points, coordinate).max() < ALLOWED
    assert steps_along(error, points, coordinate).max() < ALLOWED


@pytest.mark.parametrize("base", ["bonded", "sliding"])
@pytest.mark.parametrize("fillet", FILLETS[:-1])
def test_a_fillet_that_grows_past_a_node_moves_the_force_by_less_than_the_stated_error(base, fillet):
    """The solves that are known change at a node, and the series with them."""
    depth, ratio = np.meshgrid(np.linspace(0.02, 0.58, 57), np.geomspace(0.26, 2.6, 37))
    below, above = (load_filleted(base, float(fillet) * (1.0 + share)) for share in (-1e-6, 1e-6))
    step = np.abs(above.log(depth, ratio) - below.log(depth, ratio))
    known = depth <= np.minimum(below.depth_limit(ratio), above.depth_limit(ratio))
    assert known.mean() > 0.6
    assert np.max((step / below.relative_error(depth, 1.0, ratio))[known]) < 1.0
    assert np.max(step[known & (depth < 0.3)]) < 2e-3


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_a_small_fillet_leads_to_the_sharp_edge(base):
    """The series of the smallest fillet against the table of the sharp edge, within what the series leaves."""
    depth, ratio = np.meshgrid([0.05, 0.15, 0.3], np.geomspace(0.3, 1.6, 9))
    sharp = load_table(base)
    table = load_filleted(base, 1e-6)
    apart = np.abs(table.log(depth, ratio) - sharp.log(depth, ratio))
    assert np.max(apart - table.relative_error(depth, 1.0, ratio)) <= 0.0


def test_a_puck_meets_no_step_where_its_neighbours_change():
    tables = puck.load_shapes()
    known = np.array([table.radius_over_height for table in tables])
    # of four neighbours, where the nearest change: at the nodes and half way between any two of them
    middles = np.sqrt([a * b for n, a in enumerate(known) for b in known[n + 1 :]])
    joins = [place for place in (*known[1:-1], *middles) if known[0] * 1.001 < place < known[-1] * 0.999]
    steps = []
    for place in joins:
        below, above = (puck.interpolate(tables, place * (1.0 + share)) for share in (-2e-4, 2e-4))
        reach = min(len(below.compression), len(above.compression))
        steps.append(np.abs(above.log_factor[..., :reach] - below.log_factor[..., :reach]).max())
    assert len(steps) > 10 and max(steps) < 2e-3


def stored_pucks():
    """Compressions, grips, ln B and the number of solved compressions of each stored proportion."""
    files = [json.loads(table_path(name).read_text(encoding="utf-8")) for name in (puck.USUAL, puck.OTHERS)]
    names = ("compression", "grip", "log_factor", "solved")
    return [tuple(np.array(table[name]) for name in names) for table in (files[0], *files[1]["shapes"])]


def test_a_puck_meets_no_step_where_its_curve_ends():
    """What follows the last solved compression, against the line through the two before it: no more than a bend.

    Where curves went on at the place of their friction instead, steps were 22 % of the force at the most and half of
    them above 1.2 %.
    """
    steps = []
    for place, _, rows, solved in stored_pucks():
        for i, j in zip(*np.nonzero(solved < len(place))):
            row, count = rows[i, j], solved[i, j]
            slope = (row[count - 1] - row[count - 2]) / (place[count - 1] - place[count - 2])
            steps.append(row[count] - row[count - 1] - slope * (place[count] - place[count - 1]))
    assert len(steps) > 30 and np.max(np.abs(steps)) < 0.04 and np.median(np.abs(steps)) < 0.006


def test_a_continued_curve_of_a_puck_lies_where_the_solved_one_does():
    """Solved rows, hidden from 20 % on and continued to 30 %: half of them come back to 0.5 %, nine tenths to 3 %."""
    missed = []
    for place, grips, rows, solved in stored_pucks():
        shallow = (place > 0.2 + 1e-9) & (place < 0.3 + 1e-9)
        known = solved >= np.searchsorted(place, 0.3 + 1e-9)
        for i, j in zip(*np.nonzero(known[:, 2:-1])):
            hidden = rows[i].copy()
            hidden[j + 2, place > 0.2 + 1e-9] = np.nan
            missed.append(np.abs(filled(hidden, grips)[j + 2] - rows[i, j + 2])[shallow].max())
    assert len(missed) > 100
    assert np.median(missed) < 0.005 and np.percentile(missed, 90.0) < 0.03


@pytest.mark.slow
def test_force_on_a_puck_meets_no_step():
    """Paths through proportion, alpha, friction and compression, over the nodes of each."""
    rng = np.random.default_rng(37)
    low, high = puck.shape_range()
    for shape in rng.uniform(low, high, 2):
        table = puck.table_for(shape, 1.0)
        count = 20
        points = np.column_stack([rng.uniform(1.0, 5.7, count), rng.uniform(0.02, 0.95, count)])
        points = np.column_stack([points, rng.uniform(0.01, 0.95 * table.compression[-1], count)])

        def log_factor(at, table=table):
            return np.array([np.log(table.factor(alpha, held, np.array([c]))[0]) for alpha, held, c in at])

        for coordinate in range(3):
            assert steps_along(log_factor, points, coordinate).max() < ALLOWED

"""The force of a crowned pad is continuous in foot, tip radius, height, thickness, punch radius and depth."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.tables.crowned import BEND, JOIN, LEAST_FADE, SETTLED, SHARED
from dummydesign.pad.tables.shape import load_shape_table
from tests.support.steps import largest_steps

# Relative step of a parameter, and what the force may change by over it.
STEP, ALLOWED = 1e-6, 1e-4
DEPTHS = np.array([0.02, 0.06, 0.12, 0.2, 0.28, 0.36, 0.45, 0.55])


@pytest.fixture(scope="module")
def table():
    return load_shape_table("crowned")


def random_pads(table, seed, count):
    """h/a, c/h, b/a and s, even in the table's own coordinates."""
    low, high = (table.coordinates(end[None])[0] for end in (table.low, table.high))
    pads = np.random.default_rng(seed).uniform(low, high, (count, 4))
    return np.where(table.similarity.logarithms, np.exp(pads), pads)


def log_force(table, points):
    """ln of the force over the tip's, of points (n, 5): the pad's four numbers and d/h."""
    return table.log_factor(points[:, :4], np.arange(len(points)), points[:, 4])


@pytest.mark.parametrize("foot", [*JOIN, 0.7])
def test_a_foot_that_grows_past_a_join_does_not_move_the_force(table, foot):
    pads = np.repeat(random_pads(table, 5120, 400), len(DEPTHS), axis=0)
    x = np.tile(DEPTHS, 400)[:, None]
    below, above = pads.copy(), pads.copy()
    # The tip radius stays as the foot grows, so that s falls.
    for moved, share in ((below, 1.0 - STEP / 2), (above, 1.0 + STEP / 2)):
        moved[:, 2] = foot * share
        moved[:, 3] /= share**2
    step = log_force(table, np.hstack([above, x])) - log_force(table, np.hstack([below, x]))
    assert np.max(np.abs(step)) < ALLOWED


@pytest.mark.slow
def test_a_path_through_all_parameters_meets_no_step(table):
    pads = random_pads(table, 77031, 3000)
    rng = np.random.default_rng(8113)
    start = np.hstack([pads, rng.uniform(0.02, 0.58, (len(pads), 1))])
    end = start * (1.0 + rng.uniform(-0.04, 0.04, start.shape))
    assert np.max(largest_steps(lambda points: log_force(table, points), start, end, STEP)) < ALLOWED


@pytest.mark.slow
def test_a_path_across_the_feet_of_all_joins_meets_no_step(table):
    pads = random_pads(table, 40962, 1000)
    start = np.hstack([pads, np.random.default_rng(41).uniform(0.02, 0.58, (len(pads), 1))])
    start[:, 2], end = 0.6, start.copy()
    end[:, 2] = 0.85
    assert np.max(largest_steps(lambda points: log_force(table, points), start, end, STEP)) < ALLOWED


def test_depths_where_pieces_begin_and_end_meet_no_step(table):
    pads = random_pads(table, 2718, 600)
    coordinates = table.coordinates(pads)
    response = table.response
    for surface in (response.narrow_edge, response.wide_edge):
        edge = np.exp(surface.at_levels(coordinates)[:, 0]) * pads[:, 1]
        start = np.maximum(SHARED[0] * edge, response.after.levels[0])
        joins = [edge, BEND[0] * edge, BEND[1] * edge, start, start + np.maximum(SHARED[1] * edge, LEAST_FADE)]
        joins += [edge + eta for eta in (response.jump.levels[0], *SETTLED)]
        for depth in joins:
            x = np.minimum(depth, 0.6)[:, None]
            step = log_force(table, np.hstack([pads, x * (1.0 + STEP / 2)]))
            step -= log_force(table, np.hstack([pads, x * (1.0 - STEP / 2)]))
            assert np.max(np.abs(step)) < ALLOWED

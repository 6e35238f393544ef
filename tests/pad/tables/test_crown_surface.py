"""The surface of crowned pads in pieces: what it must know of the edge, continuity, slopes."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.tables.crowned import FIRST, JOIN, CrownResponse
from dummydesign.pad.tables.shape import TabulatedShapeLaw, load_shape_table

# h/a, c/h, b/a, s: feet that are narrow, a little narrower than the punch, and wide.
PADS = np.array(
    [[0.7, 0.4, 0.45, 0.3], [1.2, 0.35, 0.6, 0.5], [1.0, 0.4, 0.9, 0.3], [0.8, 0.5, 1.4, 0.3], [2.0, 0.3, 1.6, 0.2]]
)


@pytest.fixture(scope="module")
def table():
    found = load_shape_table("crowned")
    assert isinstance(found.response, CrownResponse)
    return found


def edges(table):
    return table.response.edge(table.coordinates(PADS))


def every(x):
    return np.broadcast_to(np.arange(len(x))[:, None], x.shape)


def test_the_edge_is_reached_about_where_the_crown_has_come_down_by_its_fall_at_the_edge(table):
    _, height, foot, s = PADS.T
    reached = np.minimum(1.0, 1.0 / foot) ** 2
    fall = reached / (s + np.sqrt(s**2 - (2.0 * s - 1.0) * reached))
    assert np.all(np.abs(edges(table) / (height * fall) - 1.0) < 0.35)


def test_until_the_edge_is_reached_the_force_does_not_know_how_large_the_punch_is(table):
    crown, h = Crowned(8.0, 3.0, 7.0), 8.0
    law, depth = TabulatedShapeLaw(crown), np.linspace(0.2, 1.8, 9)
    one, other = (law.force(depth, h, 0.03, radius) for radius in (0.9 * PUNCH_RADIUS_MM, 1.2 * PUNCH_RADIUS_MM))
    assert one == pytest.approx(other, rel=1e-9)
    deep = [float(law.force(4.0, h, 0.03, radius)) for radius in (0.9 * PUNCH_RADIUS_MM, 1.2 * PUNCH_RADIUS_MM)]
    assert deep[1] > 1.05 * deep[0]


def test_force_is_continuous_and_its_slope_the_derivative_across_every_join(table):
    x = np.linspace(0.02, 0.6, 20001) + np.zeros((len(PADS), 1))
    value = table.log_factor(PADS, every(x), x)
    steps = np.diff(value, axis=1)
    # Where the flat is met ln F rises by up to some hundred a thickness; a step would be of any size.
    assert np.all(np.abs(steps) < 400.0 * (x[0, 1] - x[0, 0]))
    _, slope = table.response._pressed(table.coordinates(PADS), every(x), x)
    middle = 0.5 * (slope[:, 1:] + slope[:, :-1]) * np.diff(x, axis=1)
    clear = (np.abs(x[:, :-1] - edges(table)[:, None]) > 1e-3) & (x[:, :-1] > FIRST)
    assert np.max(np.abs(steps - middle)[clear]) < 1e-7


def test_a_narrow_crown_jumps_where_the_flat_is_met_and_a_wide_one_does_not(table):
    edge = edges(table)
    x = edge[:, None] + np.array([-0.03, 0.03])
    value = table.log_factor(PADS, every(x), x)
    rise = np.diff(value, axis=1)[:, 0]
    assert PADS[0, 2] < JOIN[0] < JOIN[1] < PADS[2, 2]
    assert rise[0] > 1.0 and np.all(rise[2:] < 0.5)


def test_pads_of_one_call_are_those_of_single_calls(table):
    x = np.linspace(0.05, 0.5, 7) + np.zeros((len(PADS), 1))
    value = table.log_factor(PADS, every(x), x)
    for i in range(len(PADS)):
        one = table.log_factor(PADS[i : i + 1], np.zeros(7, dtype=int), x[i])
        assert one == pytest.approx(value[i], rel=1e-9)

"""How the surface of crowned pads is fitted: the edge's depth from gaps, levels of unlike scatter, the pieces."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.shaped_problem import solve_path
from studies.tables.crowns.edge import GROWN, MET, PLACES, EdgeWatch, edge_depth
from studies.tables.crowns.fit import Curves, fit_crowns
from studies.tables.crowns.levels import fit_by_level
from studies.tables.designs import designs

DEPTH = np.linspace(0.02, 0.4, 39)


def states(edge, foot):
    """A flat that comes down at an even rate to a punch while the contact grows over the crown."""
    touched = np.where(DEPTH < edge, (0.64 + 0.4 * DEPTH) * foot, 0.97)
    gaps = np.where(PLACES > foot, edge - DEPTH[:, None], 0.0) + 0.02 * (PLACES - 0.7) ** 2
    return touched, gaps


@pytest.mark.parametrize("edge", [0.1637, 0.3021])
def test_a_flat_that_is_met_at_once_is_met_where_its_gap_closes(edge):
    touched, gaps = states(edge, 0.5)
    found, doubt = edge_depth(DEPTH, touched, gaps, 0.5, 0.05)
    assert doubt == MET and found == pytest.approx(edge, abs=1e-3)


def test_a_contact_that_grows_to_the_edge_reaches_it_on_its_line():
    touched = np.minimum(3.0 * DEPTH, 0.96)
    found, doubt = edge_depth(DEPTH, touched, np.full((len(DEPTH), 7), 0.1), 1.4, 0.05)
    assert doubt == GROWN and found == pytest.approx(1.0 / 3.0, abs=0.02)


def test_an_edge_that_is_far_off_is_not_known():
    touched, gaps = states(0.7, 0.5)
    assert edge_depth(DEPTH, touched, gaps, 0.5, 0.05) is None
    assert edge_depth(DEPTH[:3], touched[:3], gaps[:3], 0.5, 0.05) is None


def test_the_edge_of_a_solved_crown_is_where_its_force_begins_to_rise():
    design = designs()["crowned"]
    press = design.press(np.array([-0.1, 0.25, -0.7, 0.4]))
    watch, depth = EdgeWatch(press), np.round(np.arange(0.02, 0.301, 0.01), 4)
    force = solve_path(press, depth, 8, 0.05, visit=watch).force
    found = watch.reached(float(np.exp(-0.7)), 0.05 * press.scale / press.radius)
    assert found is not None and found[1] == MET
    steep = np.diff(np.log(force)) / np.diff(np.log(depth))
    first = depth[1:][steep > 1.5 * steep[10]][0]
    assert first - 0.011 <= found[0] <= first


def test_a_level_that_scatters_does_not_blur_one_that_does_not():
    rng = np.random.default_rng(5)
    points, new = rng.uniform(-1.0, 1.0, (120, 2)), rng.uniform(-0.9, 0.9, (50, 2))
    levels = np.array([0.1, 0.3, 0.6])

    def truth(q):
        return np.sin(2.0 * q[:, :1] + q[:, 1:]) * levels

    scatter = np.array([0.05, 0.0, 0.0])
    values = truth(points) + scatter * rng.standard_normal((120, 3))
    surface = fit_by_level(points, values, np.full((120, 3), 1e-4), levels, False, np.full(120, 0.6))
    miss = np.abs(surface.at_levels(new) - truth(new))
    assert np.median(miss[:, 0]) < 0.025
    assert np.percentile(miss[:, 1:], 95.0) < 2e-3


@pytest.mark.slow
def test_a_crown_that_is_known_in_closed_form_is_found_again_in_its_pieces():
    rng = np.random.default_rng(7)
    n, x = 400, np.round(np.arange(0.02, 0.601, 0.01), 4)
    low, high = np.array([-0.7, 0.17, -1.0, -2.4]), np.array([1.1, 0.6, 0.5, -0.4])

    def truth(inputs, x):
        """An edge at c, a smooth crown before it, and a force that rises on from it by a slab's share."""
        edge = inputs[:, 1:2]
        alone = 0.5 * np.sqrt(x / edge) * (1.0 + 0.2 * (inputs[:, 2:3] - inputs[:, :1])) + 0.3 * inputs[:, 3:] * x
        at_edge = 0.5 * (1.0 + 0.2 * (inputs[:, 2:3] - inputs[:, :1])) + 0.3 * inputs[:, 3:] * edge
        eta = np.maximum(x - edge, 0.0)
        share = np.where(inputs[:, 2:3] < np.log(0.8), 20.0, 4.0)
        risen = at_edge + np.log1p(share * eta) - 1.5 * np.log(np.maximum(x / edge, 1.0))
        return np.where(x < edge, alone, risen)

    inputs, new = rng.uniform(low, high, (n, 4)), rng.uniform(low + 0.05, high - 0.05, (60, 4))
    y = truth(inputs, x[None, :])
    doubt = np.where(inputs[:, 2] < np.log(0.8), MET, GROWN)
    added = np.where(x[None, :] > inputs[:, 1:2] + 0.01, 0.03, 0.0)
    surface = fit_crowns(Curves(inputs, x, y, added, inputs[:, 1], doubt, np.full(n, 0.7)))
    assert surface.edge(new) == pytest.approx(new[:, 1], rel=0.01)
    depth = np.linspace(0.05, 0.58, 30) + np.zeros((60, 1))
    value = surface.along(new, np.broadcast_to(np.arange(60)[:, None], depth.shape), depth)
    # The step in the truth from one kind of foot to the other is no smooth function.
    clear = np.abs(new[:, 2] - np.log(0.8)) > 0.3
    miss = np.abs(value - truth(new, depth))[clear]
    assert np.median(miss) < 0.01 and np.percentile(miss, 95.0) < 0.05

"""Crowns among others: solved bounds of what neighbours and rim change."""

import numpy as np
import pytest

from dummydesign.design.crown_array import CrownWithRing, IsolatedCrown
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.geometry.shape_registry import read_shape

CROWN = read_shape("crowned:radius=21.2,height=2,foot=9.4")


@pytest.fixture(scope="module")
def alone():
    return IsolatedCrown(CROWN, 4.5, PUNCH_RADIUS_MM, 1.7)


def test_a_ring_has_the_crown_inside_and_the_full_thickness_outside():
    ringed, r = CrownWithRing(CROWN, 15.0, True), np.array([0.0, 4.0, 9.4, 13.9, 15.0, 40.0])
    np.testing.assert_allclose(ringed.drop_mm(r, 0 * r)[:4], CROWN.drop_mm(r[:4], 0 * r[:4]))
    np.testing.assert_array_equal(ringed.drop_mm(r, 0 * r)[4:], 0.0)


def test_the_ring_begins_at_the_foot_of_the_neighbour(alone, monkeypatch):
    lines = []
    monkeypatch.setattr(IsolatedCrown, "_change", lambda _, one, reach, other, end: lines.append((other, end)) or 0.0)
    alone.stiffer(21.5)
    alone.softer(13.0)
    (among, _), (ending, end_mm) = lines
    assert among.ring and among.line_mm == pytest.approx(21.5 - 9.4)
    assert not ending.ring and 9.4 < ending.line_mm < end_mm == 13.0


@pytest.mark.slow
def test_a_neighbour_stiffens_and_a_rim_softens_and_both_die_out_with_distance(alone):
    near, far = alone.stiffer(21.5), alone.stiffer(26.0)
    assert near > 0.005 > far > -1e-5
    close, away = alone.softer(13.0), alone.softer(20.0)
    assert close < -0.01 < away < 1e-5


@pytest.mark.slow
def test_bounds_fall_steadily_with_distance_so_that_they_are_no_noise_of_the_mesh(alone):
    rise = [alone.stiffer(pitch) for pitch in (21.5, 22.0, 22.5, 24.0, 26.0, 30.0)]
    fall = [-alone.softer(rim) for rim in (13.0, 15.0, 17.5, 20.0)]
    assert (np.diff(rise) < 0.0).all() and (np.diff(fall) < 0.0).all() and rise[-1] > 0.0 and fall[-1] > 0.0


@pytest.mark.slow
def test_a_ring_far_away_changes_nothing_on_a_pad_of_other_size():
    small = IsolatedCrown(CROWN, 4.5, PUNCH_RADIUS_MM, 1.7, extent_mm=40.0)
    assert abs(small.stiffer(34.0)) < 1e-3

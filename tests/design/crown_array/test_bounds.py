"""What is solved for the bounds of a crown among others, and layouts at the limits they follow from."""

from __future__ import annotations

from math import hypot
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design import crown_array as module
from dummydesign.design.crown_array import (
    DEPTH_SHARES,
    INDEPENDENT,
    RAMP_MM,
    CrownWithRing,
    IsolatedCrown,
    _needed,
    lay_out,
    lay_out_sites,
)
from dummydesign.design.search.slabs import DesignCandidate
from dummydesign.geometry.dimensions import PAD_EXTENT_MM, RIM_FREE_MM
from dummydesign.geometry.shape_registry import read_shape

CROWN = read_shape("crowned:radius=21.2,height=2,foot=9.4")
FOOT = 9.4


@pytest.fixture
def compared(monkeypatch):
    """The pads that each bound compares, with their extents."""
    pairs = []
    monkeypatch.setattr(
        IsolatedCrown, "_change", lambda _, one, reach, other, end: pairs.append((one, reach, other, end)) or 0.0
    )
    return pairs


@pytest.mark.parametrize("pitch", [20.0, 60.0, 90.0])
@pytest.mark.parametrize("extent", [30.0, PAD_EXTENT_MM, 120.0])
def test_neighbours_are_a_ring_on_a_pad_that_reaches_beyond_them(compared, pitch, extent):
    IsolatedCrown(CROWN, 4.5, 7.9, 1.7, extent_mm=extent).stiffer(pitch)
    ((one, reach, other, end),) = compared
    assert one.line_mm == other.line_mm == pytest.approx(pitch - FOOT) and not one.ring and other.ring
    assert reach == pytest.approx(max(extent, 1.1 * (pitch - FOOT)))
    assert end == pytest.approx(max(extent, 2.0 * pitch, PAD_EXTENT_MM))


@pytest.mark.parametrize("rim", [13.0, 20.0])
def test_a_rim_is_compared_on_the_same_lines_half_way_to_it(compared, rim):
    IsolatedCrown(CROWN, 4.5, 7.9, 1.7, extent_mm=70.0).softer(rim)
    ((one, reach, other, end),) = compared
    assert one is other and one.line_mm == pytest.approx(0.5 * (FOOT + rim)) and (reach, end) == (70.0, rim)


def test_the_wall_of_the_ring_leans_inwards_and_has_its_lines_in_the_mesh():
    ring = CrownWithRing(CROWN, 15.0, True)
    r = np.array([13.9, 14.0, 14.25, 14.5, 15.0, 16.0])
    np.testing.assert_allclose(ring.drop_mm(r, 0.0 * r), 2.0 * np.array([1.0, 1.0, 0.75, 0.5, 0.0, 0.0]))
    np.testing.assert_allclose(CrownWithRing(CROWN, 15.0).drop_mm(r, 0.0 * r), 2.0)
    assert ring.lines_mm() == (*CROWN.lines_mm(), 15.0 - RAMP_MM, 15.0)
    # round: only the distance from the axis counts
    assert ring.drop_mm(np.array([3.0]), np.array([4.0])) == pytest.approx(CROWN.drop_mm(np.array([5.0]), np.zeros(1)))


def forces(monkeypatch, alone, among):
    queue = iter((alone, among))
    monkeypatch.setattr(IsolatedCrown, "_force", lambda self, shape, extent: np.asarray(next(queue), float))
    line = CrownWithRing(CROWN, 15.0)
    return IsolatedCrown(CROWN, 4.5, 7.9, 1.7)._change(line, 60.0, line, 20.0)


def test_the_largest_relative_change_over_the_depths_that_both_reached_is_the_bound(monkeypatch):
    alone = np.arange(1.0, 8.0)
    assert forces(monkeypatch, alone, alone * [1.0, 1.01, 1.0, 0.97, 1.02, 1.0, 1.0]) == pytest.approx(-0.03)
    assert forces(monkeypatch, alone, alone * [1.0, 1.01, 1.0, 0.97, 1.05, 1.0, 1.0]) == pytest.approx(0.05)
    assert forces(monkeypatch, alone, 1.02 * alone[:6]) == pytest.approx(0.02)
    assert forces(monkeypatch, alone[:6], 1.02 * alone) == pytest.approx(0.02)
    with pytest.raises(NoAnswerError):
        forces(monkeypatch, alone, alone[:5])


def test_a_crown_is_solved_in_units_of_the_thickness_at_shares_of_its_depth(monkeypatch):
    from dummydesign.pad.axisymmetric import shaped_problem

    asked = {}

    def path(case, depths, cells, rim):
        asked.update(case=case, depths=depths)
        return SimpleNamespace(force=depths)

    monkeypatch.setattr(shaped_problem, "solve_path", path)
    found = IsolatedCrown(CROWN, 4.5, 7.9, 1.8)._solve(CrownWithRing(CROWN, 15.0), 1.8 * DEPTH_SHARES, 60.0)
    np.testing.assert_allclose(found["force"], 0.4 * DEPTH_SHARES)
    case = asked["case"]
    assert (case.radius, case.extent) == (pytest.approx(7.9 / 4.5), pytest.approx(60.0 / 4.5))
    assert case.thickness_mm == 4.5 and 0.0 < case.first < asked["depths"][0]


@pytest.mark.parametrize("least", [5.0, 7.3, 12.0])
@pytest.mark.parametrize("enough", [5.0, 8.2, 11.9, 12.0, 31.4, 58.0])
def test_the_smallest_length_is_found_to_half_a_millimetre(least, enough):
    def change(length):
        return (1.01 if length < enough else 0.99) * INDEPENDENT * (-1.0) ** round(length)

    found = _needed(change, least)
    steps = (found - least) / 0.5
    assert steps == pytest.approx(round(steps)) and found >= enough - 1e-9
    assert found == least or found - 0.5 < enough


def test_a_length_beyond_sixty_millimetres_is_not_looked_for():
    with pytest.raises(NoAnswerError):
        _needed(lambda length: 1.0 if length < 66.0 else 0.0, 10.0)


class Stepped:
    """Crowns that are independent from a pitch and a rim on."""

    crown, radius_mm = CROWN, 7.9

    def __init__(self, pitch=0.0, rim=0.0):
        self.pitch, self.rim = pitch, rim

    def stiffer(self, pitch):
        return 0.005 if pitch >= self.pitch else 0.02

    def softer(self, rim):
        return -0.005 if rim >= self.rim else -0.02


REACH = 9.9
LEAST_PITCH = FOOT + REACH + 1.0 + RAMP_MM
LEAST_RIM = max(FOOT + RIM_FREE_MM, 1.5 * 7.9)


def test_even_shares_stand_where_they_keep_pitch_and_rim_and_crowns_move_where_they_do_not():
    least = 2.0 * LEAST_RIM
    wide = lay_out(Stepped(), (2, 1), (2.0 * max(LEAST_PITCH, least) + 0.2, 60.0), REACH)
    assert wide.pitch_mm[0] == pytest.approx(max(LEAST_PITCH, least), abs=0.11)
    # a share that is a little narrower than twice the rim: crowns move in until the rim is kept
    narrow = lay_out(Stepped(), (2, 1), (2.0 * least - 2.0, 60.0), REACH)
    assert narrow.rim_mm >= LEAST_RIM - 0.1 and narrow.pitch_mm[0] < 0.5 * (2.0 * least - 2.0)
    assert narrow.pitch_mm[0] >= LEAST_PITCH
    assert narrow.softer == -0.005 and narrow.stiffer == 0.005
    # the sides of both directions count for the rim
    assert lay_out(Stepped(), (2, 1), (150.0, 40.0), REACH).rim_mm == pytest.approx(20.0)


def test_a_grid_needs_its_pitches_and_two_rims():
    """Four crowns of a pitch of 30 and a rim of 20 need 130 mm."""
    known = Stepped(30.0 - 1e-9, 20.0 - 1e-9)
    pitch, rim = _needed(known.stiffer, LEAST_PITCH), _needed(known.softer, LEAST_RIM)
    need = 3.0 * pitch + 2.0 * rim
    sites = lay_out(known, (4, 1), (need, 60.0), REACH)
    assert sites.pitch_mm[0] == pytest.approx(pitch, abs=0.11) and sites.rim_mm == pytest.approx(rim, abs=0.11)
    with pytest.raises(InputError) as caught:
        lay_out(known, (4, 1), (need - 0.1, 60.0), REACH)
    assert "3x1 fit it" in str(caught.value)
    with pytest.raises(InputError) as caught:
        lay_out(known, (4, 1), (need, 2.0 * rim - 0.1), REACH)
    assert "fit it" not in str(caught.value)


@pytest.mark.parametrize(
    ("known", "reach", "size", "least"), [(Stepped(40.0), REACH, 76.0, 40.0), (Stepped(), 30.0, 80.0, FOOT + 32.0)]
)
def test_crowns_that_need_more_than_an_even_share_move_out_to_the_rim(known, reach, size, least):
    """Neighbours that are felt farther than twice the rim, and a punch that would touch them."""
    sites = lay_out(known, (2, 1), (size, 60.0), reach)
    assert 0.5 * size < least <= sites.pitch_mm[0] and sites.rim_mm >= LEAST_RIM - 0.1
    assert max(-sites.softer, sites.stiffer) <= INDEPENDENT
    with pytest.raises(InputError):
        lay_out(known, (2, 1), (least + 2.0 * LEAST_RIM - 0.6, 60.0), reach)


def test_one_crown_alone_has_no_neighbour():
    one = lay_out(Stepped(99.0), (1, 1), (60.0, 50.0), REACH)
    assert one.pitch_mm == (0.0, 0.0) and one.rim_mm == pytest.approx(25.0) and one.stiffer == 0.0


@pytest.mark.parametrize(
    ("sides", "reach"), [(None, 7.9), ((14.0, 14.0), hypot(14.0, 14.0) / 2.0), ((20.0, 10.0), hypot(20.0, 10.0) / 2.0)]
)
def test_a_punch_reaches_to_its_corners_and_crowns_are_solved_at_the_deepest_press(monkeypatch, sides, reach):
    asked = []
    monkeypatch.setattr(module, "lay_out", lambda *given: asked.append(given))
    depth = np.array([[1.0, 9.0], [1.5, np.nan]])
    best = DesignCandidate(4.5, 15.0, 1, SimpleNamespace(depth_mm=depth))
    space = SimpleNamespace(radius_mm=7.9, extent_mm=60.0, base="sliding", pad_mm=(150.0, 120.0))
    lay_out_sites(CROWN, best, space, SimpleNamespace(sides_mm=sides, radius_mm=7.9), (2, 3))
    (alone, wanted, pad, reached) = asked[0]
    assert (alone.depth_mm, alone.thickness_mm, alone.extent_mm, alone.base) == (1.5, 4.5, 60.0, "sliding")
    assert wanted == (2, 3) and pad == (150.0, 120.0) and reached == pytest.approx(reach)


def test_bounds_and_lengths_are_told_as_they_are():
    sites = lay_out(Stepped(), (2, 3), (150.0, 120.0), REACH)
    told = sites.to_dict(sites.on(CROWN))
    assert told["force_change"] == {"low": -0.005, "high": 0.005}
    assert "-0.50 to +0.50 %" in sites.text and "2 x 3 crowns, 75 x 40 mm apart" in sites.text
    assert told["pitch_mm"] == [75.0, 40.0] and told["rim_mm"] == 20.0

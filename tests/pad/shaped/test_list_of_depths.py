"""A solved crown's force and stated error at a depth are the same whatever other depths are asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_pad import last_known, solve_shaped_pad
from dummydesign.pad.axisymmetric.shaped_problem import LEAST_DEPTH, Climb, PathCache, climb, grids, meshed
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import predict_static
from dummydesign.pad.solve.continuation import ForcePath, VisitedState, force_between

pytestmark = pytest.mark.slow

CELLS = 6


@pytest.mark.parametrize(
    ("shape", "more"),
    [
        ("crowned:2.4,3.5,7.8", {}),
        ("crowned:21.2,2,9.4", {"edge_radius_mm": 0.5}),
        ("boned:12,2", {}),
        ("crowned:15,2", {"condition": "frictionless"}),
    ],
)
def test_force_and_stated_error_do_not_know_the_other_depths(shape, more):
    pad = Pad(9.0, 0.03, 7.899, geometry=read_shape(shape), **more)
    wanted = 9.0 * np.array([0.05, 0.13])
    lists = [wanted, wanted[1:], 9.0 * np.union1d(np.arange(1, 18) * 0.0093, wanted / 9.0)]
    curves = [solve_shaped_pad(pad, depths, cells=CELLS) for depths in lists]
    for curve in curves[1:]:
        at = [int(np.argmin(np.abs(curve.depth_mm - depth))) for depth in wanted[-len(curve.depth_mm) :]]
        own = curves[0].force_N[-len(at) :], curves[0].error_N[-len(at) :]
        assert curve.force_N[at] == pytest.approx(own[0], rel=1e-9)
        assert curve.error_N[at] == pytest.approx(own[1], rel=1e-9)


@pytest.mark.parametrize(("shape", "thickness"), [("crowned:2.6,3.2,7.8", 10.0), ("crowned:2.4,3.5,7.8", 11.0)])
def test_depths_above_the_first_that_is_solved_have_a_force_of_their_own(shape, thickness):
    pad = Pad(thickness, 0.03, 7.899, geometry=read_shape(shape))
    wanted = [0.001, 0.2, 0.44]
    among = predict_static(pad, [*wanted, 2.0], "axisymmetric")
    assert np.all(np.diff(among.force_N) > 0.0)
    for depth, force, high in zip(wanted, among.force_N, among.force_high_N):
        alone = predict_static(pad, [depth], "axisymmetric")
        assert np.abs(np.log(alone.force_N / force)) < np.log(alone.force_high_N / alone.force_N) + np.log(high / force)


def test_forces_between_the_ends_of_steps_are_those_solved_there():
    """Ends of every second step give the forces of the ends between."""
    case = meshed(Case(0.72, 6.9, shape=read_shape("crowned:2.4,3.5,7.8"), thickness_mm=11.0))
    ends = climb(case, 0.3, 8).ends
    first = next(k for k, end in enumerate(ends) if end.depth > 0.05)
    between, known = ends[first + 1 : -1 : 2], ends[first::2]
    force, doubt = force_between(known, np.array([end.depth for end in between]))
    exact = np.array([end.force for end in between])
    assert np.all(np.abs(np.log(force / exact)) < doubt + 5e-3) and np.all(doubt < 0.03)


def test_a_power_of_the_depth_is_met_exactly_above_and_between_ends():
    ends = [VisitedState(d, None, None, None, 3.0 * d**1.7, 1.0) for d in (0.1, 0.17, 0.3)]
    at = np.array([0.01, 0.1, 0.15, 0.29, 0.3])
    force, doubt = force_between(ends, at)
    assert force == pytest.approx(3.0 * at**1.7, rel=1e-12) and doubt == pytest.approx(0.0, abs=1e-12)
    assert force_between(ends[:1], at[1:2])[0] == pytest.approx(3.0 * at[1:2] ** 1.7, rel=1e-12)


def test_a_path_gives_the_depths_it_reached_and_says_why_others_are_missing():
    ends = tuple(VisitedState(d, None, None, None, d, 1.0 - d) for d in (0.1, 0.2))
    path = ForcePath(np.array([]), np.array([]), np.array([]), 9, 2, 5, 0.1, "a fold")
    made = Climb(ends, path)
    found = made.at(np.array([0.05, 0.15, 0.25]))
    assert made.reached == 0.2 and found.stop == "a fold" and found.load_steps == 2
    assert found.depth == pytest.approx([0.05, 0.15]) and found.force == pytest.approx([0.05, 0.15])
    assert found.smallest_J == pytest.approx([0.9, 0.85])
    assert made.at(np.array([0.2])).stop is None
    nothing = Climb((), path).at(np.array([0.1]))
    assert not len(nothing.force) and nothing.stop == "a fold"


def test_a_tip_is_meshed_by_its_radius_and_a_flat_face_as_it_was():
    case = Case(0.8, 7.0, shape=read_shape("crowned:20,2"), thickness_mm=10.0)
    assert case.tip == pytest.approx(2.0, rel=1e-3) and meshed(case).first == pytest.approx(0.0025 / 2.0, rel=1e-3)
    blunt = replace(case, shape=read_shape("crowned:2000,0.2,25"), radius=1.5)
    assert meshed(blunt).first == LEAST_DEPTH
    flat = replace(case, shape=read_shape("boned:12,2"))
    assert flat.tip is None and meshed(flat) == flat


def test_the_path_under_the_larger_fillet_is_the_smaller_ones_until_the_contact_comes_to_it():
    case = meshed(Case(0.79, 7.57, shape=read_shape("crowned:20,3,11"), thickness_mm=10.0))
    solved = PathCache()
    small, _, large = (solved.climb(case, 0.24, grid, False) for grid in grids(8, case))
    shared = sum(one is other for one, other in zip(small.ends, large.ends))
    assert 0 < shared < len(large.ends) and large.path.load_steps == len(large.ends) - shared
    own = climb(case, 0.24, *grids(8, case)[2])
    at = np.array([0.05, 0.1, 0.15, 0.2, 0.24])
    assert large.at(at).force == pytest.approx(own.at(at).force, rel=1e-3)


def test_what_is_last_known_is_carried_on():
    assert last_known(np.array([0.1, 0.05, np.nan, np.nan]), 0.3).tolist() == [0.1, 0.05, 0.05, 0.05]
    assert last_known(np.full(2, np.nan), 0.3).tolist() == [0.3, 0.3]

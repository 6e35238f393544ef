"""The law of first touch: closed forms over six decades of depth, the joint, the stated error, what is solved."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.punch import ball_profile
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad import force_source
from dummydesign.pad.axisymmetric.case import Case, first_stiffness
from dummydesign.pad.axisymmetric.profile_punch import profile
from dummydesign.pad.first_touch import least_depth_mm, low_end, solvable_depths, stuck_factor, touch_of
from dummydesign.pad.force_law import PadCurve
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.predict import predict_static

DEPTH = np.geomspace(1e-6, 0.3, 60)
HAYES = {0.2: 1.281, 0.4: 1.684, 1.0: 3.619}  # kappa of a flat punch on a bonded layer, nu 0.5, by a / h
LAYER = (1.133, 1.283, 0.769, 0.0975)  # of a ball on a bonded layer, by powers of sqrt(R d) / h, nu 0.5


def ball(radius, h, **change):
    punch = ball_profile(2.0 * radius)
    return Pad(h, 1.0, punch[0][-1], **({"condition": "frictionless", "profile_mm": punch} | change))


def cone(angle_deg, reach=12.0, count=201, h=10.0):
    r = np.linspace(0.0, reach, count)
    heights = r * np.tan(np.radians(angle_deg))
    return Pad(h, 1.0, reach, condition="frictionless", profile_mm=(tuple(r), tuple(heights)))


def hertz(depth, radius):
    return 16.0 / 9.0 * np.sqrt(radius) * depth**1.5


def dimitriadis(depth, radius, h):
    c = np.sqrt(radius * depth) / h
    return hertz(depth, radius) * (1.0 + sum(one * c ** (k + 1) for k, one in enumerate(LAYER)))


def test_the_half_space_has_the_closed_form_of_every_punch_and_shape():
    flat, crown = Pad(10.0, 1.0, 8.0), Pad(10.0, 1.0, 8.0, geometry=Crowned(21.2, 2.0, 9.4))
    half = np.tan(np.radians(8.0))
    forms = {
        1.0: (flat, 8.0 / 3.0 * 8.0 * DEPTH),
        1.5: (ball(10.0, 10.0), hertz(DEPTH, 10.0)),
        1.5001: (crown, hertz(DEPTH, 21.2)),
        2.0: (cone(8.0), 8.0 / 3.0 / np.pi / half * DEPTH**2),
    }
    for power, (pad, exact) in forms.items():
        touch = touch_of(pad)
        assert touch.area(DEPTH) == pytest.approx(exact, rel=0.005)
        assert touch.power(1e-4) == pytest.approx(power, abs=2e-3)
    assert touch_of(flat).area(np.array([-1.0, 0.0])) == pytest.approx([0.0, 0.0])


def test_a_fillet_touches_with_its_flat_face_and_ends_as_the_whole_punch():
    touch = touch_of(Pad(10.0, 1.0, 8.0, edge_radius_mm=1.0))
    assert touch.area(1e-6) == pytest.approx(8.0 / 3.0 * 7.0 * 1e-6, rel=1e-3)
    assert touch.contact(50.0) == pytest.approx(8.0) and np.all(np.diff(touch.contact(DEPTH)) >= 0.0)
    # dF / dd is 2 E / (1 - nu^2) times the contact's radius, whatever the punch [Sneddon]
    slope = (touch.area(0.1001) - touch.area(0.0999)) / 2e-4
    assert slope == pytest.approx(8.0 / 3.0 * touch.contact(0.1), rel=5e-3)


def test_a_stump_of_a_profile_is_flat_first_and_a_cone_later():
    r = np.linspace(0.0, 8.0, 161)
    pad = Pad(10.0, 1.0, 8.0, condition="frictionless", profile_mm=(tuple(r), tuple(0.5 * np.maximum(r - 2.0, 0.0))))
    touch = touch_of(pad)
    assert touch.face_mm == pytest.approx(2.0) and touch.power(1e-5) == pytest.approx(1.0, abs=0.01)
    assert 1.5 < touch.power(3.0) < 2.0


def test_a_profile_through_a_ball_s_points_is_the_ball_down_to_its_tip_and_a_cone_keeps_its_point():
    radius = 10.0
    r, z = ball_profile(2.0 * radius)
    at = np.linspace(0.01, 5.0, 400)
    height, slope, *_ = profile(r, z).height(at)
    assert height == pytest.approx(radius - np.sqrt(radius**2 - at**2), rel=2e-3)
    assert slope == pytest.approx(at / np.sqrt(radius**2 - at**2), rel=5e-3)
    coarse = profile([0.0, 4.0, 8.0], [0.0, 2.0, 4.0])
    assert coarse.height(at)[0] == pytest.approx(0.5 * at) and coarse.height(at)[1] == pytest.approx(0.5)
    # between the points' heights, whatever they are
    rng = np.random.default_rng()
    for _ in range(20):
        steps = rng.exponential(1.0, (2, 9)) * rng.integers(0, 2, (2, 9))
        r, z = np.cumsum(np.r_[0.0, steps[0] + 0.05]), np.cumsum(np.r_[0.0, steps[1]])
        assert np.all(np.diff(profile(r, z).height(np.linspace(0.0, r[-1], 999))[0]) > -1e-9)


def test_a_ball_on_a_layer_runs_down_within_two_per_cent_and_within_its_error():
    rng = np.random.default_rng()
    for _ in range(12):
        h, radius = rng.uniform(3.0, 20.0), float(np.exp(rng.uniform(np.log(4.0), np.log(100.0))))
        pad = ball(radius, h)
        solved = solvable_depths(pad, 0.6 * h * np.arange(1, 17) / 16.0)
        solved = solved[np.sqrt(radius * solved) < h]
        end = low_end(pad, solved, dimitriadis(solved, radius, h), np.full(len(solved), 0.002))
        depth = end.first_mm * np.geomspace(1e-6, 1.0, 50)
        off = np.log(end.force(depth) / dimitriadis(depth, radius, h))
        assert np.abs(off).max() < 0.02 and np.all(np.abs(off) <= end.relative_error(depth) + 3e-3)
        assert end.force(depth[-1]) == pytest.approx(dimitriadis(depth[-1], radius, h))
    assert end.force(np.array([-1.0, 0.0])) == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize("ratio", HAYES)
def test_a_flat_face_without_friction_begins_as_hayes_layer(ratio):
    value = 8.0 / 3.0 * HAYES[ratio]
    assert first_stiffness(Case(ratio, 10.0, condition="frictionless")) == pytest.approx(value, rel=0.002)
    pad, depth = Pad(10.0, 0.03, 10.0 * ratio, condition="frictionless"), np.array([0.1, 0.2])
    end = low_end(pad, depth, 0.03 * 10.0 * ratio * value * depth, np.full(2, 0.01))
    assert end.force(DEPTH[:30]) == pytest.approx(0.03 * 10.0 * ratio * value * DEPTH[:30])
    assert end.relative_error(DEPTH[:30]) == pytest.approx(0.01)


def test_a_flat_face_whose_stiffness_changes_with_depth_states_it():
    depth = np.array([0.5, 1.0])
    force = depth * np.exp(0.2 * depth)
    end = low_end(Pad(10.0, 1.0, 8.0, condition="friction:0.3"), depth, force, np.full(2, 0.01))
    off = np.log(end.force(DEPTH) / DEPTH) - 0.2 * DEPTH
    assert np.all(np.abs(off) <= end.relative_error(DEPTH))
    assert end.relative_error(1e-6) == pytest.approx(0.11, abs=1e-3)


def test_a_puck_is_linear_and_a_rectangle_on_a_crown_begins_with_its_power():
    depth = np.array([0.2, 0.4])
    puck = low_end(Puck(10.0, 1.0, 20.0), depth, 3.0 * depth, np.full(2, 0.005))
    assert puck.force(DEPTH[:30]) == pytest.approx(3.0 * DEPTH[:30]) and puck.power == 1.0
    shape = read_shape("crowned:10,2,6,1")
    field = Pad(10.0, 1.0, 7.9, sides_mm=(14.0, 14.0), geometry=shape)
    force = 3.0 * depth**1.5 * np.exp(0.3 * np.sqrt(depth))
    end = low_end(field, depth, force, np.full(2, 0.01))
    assert end.force(DEPTH[:30]) == pytest.approx(3.0 * DEPTH[:30] ** 1.5 * np.exp(0.3 * np.sqrt(DEPTH[:30])))
    assert end.relative_error(1e-6) > 0.01


def test_what_sticks_to_a_compressible_pad_is_doubted_by_what_sticking_adds():
    assert stuck_factor(0.5) == 1.0 and stuck_factor(0.0) == pytest.approx(np.log(3.0))
    depth = np.array([0.01, 0.02])
    errors = []
    for condition in ("frictionless", "bonded"):
        pad = ball(10.0, 10.0, condition=condition, poisson=0.3)
        errors.append(low_end(pad, depth, hertz(depth, 10.0), np.full(2, 0.01)).relative_error(1e-9))
    assert errors[1] - errors[0] == pytest.approx(np.log(stuck_factor(0.3)), rel=1e-6)


def test_a_pad_that_rests_is_solved_from_a_hundredth_on_and_doubted_by_what_its_weight_holds():
    resting = Pad(10.0, 0.025, 8.0, base="friction:0.3")
    assert least_depth_mm(resting) == pytest.approx(0.1)
    depth = np.array([0.1, 0.2])
    end = low_end(resting, depth, 0.5 * depth, np.full(2, 0.01))
    assert end.force(1e-4) == pytest.approx(5e-5) and end.relative_error(1e-4) > np.log(1.0 / 0.61)


def test_depths_asked_for_are_solved_but_those_whose_contact_is_too_small(monkeypatch):
    asked = []

    def solve(own, depth_mm):
        asked.append(depth_mm)
        return PadCurve(depth_mm, dimitriadis(depth_mm, 10.0, 10.0), 1e-4 * depth_mm, {"unknowns": 1})

    monkeypatch.setattr(force_source, "solve_points", solve)
    wanted = np.array([1e-5, 0.01, 0.1, 2.0])
    curve = elastic_curve(ball(10.0, 10.0), "axisymmetric", 2.0, wanted)
    assert set(wanted[1:]) <= set(asked[-1]) and asked[-1].min() == pytest.approx(0.01) and curve.first_mm == 0.01
    at = np.geomspace(1e-6, 2.0, 80)
    assert curve.force(at) == pytest.approx(dimitriadis(at, 10.0, 10.0), rel=0.01)
    assert np.all(curve.relative_error(at) < 0.02)


def test_shallow_depths_alone_have_the_force_that_they_have_among_deeper_ones(monkeypatch):
    """Of a tip that is touched at a point; the solver is the closed form of a ball on a layer."""
    rng, solved = np.random.default_rng(), []

    def solve(own, depth_mm):
        solved.append(depth_mm)
        force = own.young_MPa * dimitriadis(depth_mm, own.geometry.radius_mm, own.thickness_mm)
        return PadCurve(depth_mm, force, 0.002 * force, {"unknowns": 1})

    monkeypatch.setattr(force_source, "solve_points", solve)
    for _ in range(8):
        h = rng.uniform(7.0, 25.0)
        radius = h * np.exp(rng.uniform(np.log(0.2), np.log(0.8)))
        pad = Pad(h, 0.03, 8.0, geometry=Crowned(radius, rng.uniform(0.05, 0.1) * h))
        least = least_depth_mm(pad)
        shallow = np.sort(least * np.exp(rng.uniform(np.log(1e-3), np.log(2.0), 3)))
        among = predict_static(pad, [*shallow, 0.3 * h], "axisymmetric")
        for depths in (shallow, shallow[:2], *shallow[:, None]):
            alone = predict_static(pad, depths, "axisymmetric")
            own = np.searchsorted(shallow, depths)
            known = np.log(alone.force_high_N / alone.force_N) + np.log(among.force_high_N / among.force_N)[own]
            assert np.all(np.abs(np.log(alone.force_N / among.force_N[own])) <= known)
            assert len(solved[-1]) > 1 and least * (1.0 - 1e-9) <= solved[-1].min() and solved[-1].max() <= 0.6 * h


def test_a_ball_solved_shallow_and_run_down_is_the_layer_s():
    pad = ball(20.0, 5.0)
    depth = solvable_depths(pad, np.array([0.1, 0.1875]))
    solved = force_source.solve_points(pad, depth)
    end = low_end(pad, solved.depth_mm, solved.force_N, solved.error_N / solved.force_N)
    at = np.geomspace(1e-7, depth[0], 30)
    assert end.force(at) == pytest.approx(dimitriadis(at, 20.0, 5.0), rel=0.02)


@pytest.mark.parametrize(("foot", "solved"), [(5.0, True), (9.0, False)])
def test_depths_about_a_foot_under_the_punch_are_solved(foot, solved):
    pad = Pad(11.1, 1.0, 8.0, geometry=read_shape(f"crowned:radius=1.3,height=2.4,foot={foot:g}"))
    depth = solvable_depths(pad, 0.6 * 11.1 * np.arange(1, 17) / 16.0)
    assert (2.4 in depth) == solved


@pytest.mark.slow
def test_between_solved_depths_a_crown_follows_where_its_foot_is_met():
    """A curve through the depths of a design beside solves at other ones: 7 % off without depths about the foot."""
    pad = Pad(11.1, 1.0, 8.0, geometry=read_shape("crowned:radius=1.3,height=2.4,foot=5"))
    about = 2.4 * np.array([0.985, 1.01, 1.03, 1.05, 1.075, 1.11])
    curve, solved = (elastic_curve(pad, "axisymmetric", 5.0, depths) for depths in (None, about))
    np.testing.assert_allclose(curve.force(about), solved.force(about), rtol=1e-2)

"""The closed form of the paper for an ideal ramp, made continuous at the stop and as printed."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.laws import CONSISTENT, PUBLISHED, ramps_of

V, DEPTH = 20.0, 2.0
STOP = DEPTH / V
TIME = np.r_[np.linspace(0.0, STOP, 81), STOP + np.linspace(0.0, 1.0, 201)[1:]]
RAMP = Motion(TIME, np.minimum(V * TIME, DEPTH))
GAMMA1, GAMMA, C = 0.05, 0.3, 0.8
LAWS = (CONSISTENT, PUBLISHED)


def force(law, gamma=GAMMA, c=C, motion=RAMP):
    return law.force(motion, np.array([GAMMA1]), np.array([[gamma]]), np.array([[c]]))[0]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_the_rise_is_equation_five(law):
    rise = TIME <= STOP
    wanted = GAMMA1 * (V * TIME) ** 3 + C * V * -np.expm1(-GAMMA * V**2 * TIME**3 / C)
    np.testing.assert_allclose(force(law)[rise], wanted[rise], rtol=1e-9)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_the_hold_decays_by_the_stop_time_or_by_the_running_time(law):
    hold = TIME > STOP
    t = TIME[hold]
    clock = t if law is PUBLISHED else STOP
    peak = C * V * -np.expm1(-GAMMA * V**2 * STOP**3 / C)
    wanted = GAMMA1 * DEPTH**3 + peak * np.exp(-GAMMA / C * (V * clock) ** 2 * (t - STOP))
    np.testing.assert_allclose(force(law)[hold], wanted, rtol=1e-9)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_a_stiff_damper_leaves_the_springs_and_a_thin_one_the_steady_force(law):
    stiff = force(law, c=1e9)
    np.testing.assert_allclose(stiff, (GAMMA1 + GAMMA) * RAMP.displacement_mm**3, rtol=1e-6, atol=1e-12)
    thin = force(law, c=1e-9)
    np.testing.assert_allclose(thin, GAMMA1 * RAMP.displacement_mm**3, rtol=1e-5, atol=1e-7)


def test_the_force_has_no_step_at_the_stop():
    fine = STOP + np.array([-1e-7, 1e-7])
    time = np.sort(np.r_[TIME, fine])
    found = force(CONSISTENT, motion=Motion(time, np.minimum(V * time, DEPTH)))
    low, high = np.interp(fine, time, found)
    assert high == pytest.approx(low, rel=1e-5)


def test_a_press_that_begins_later_has_the_same_force_later():
    later = Motion(np.r_[0.0, TIME + 0.5], np.r_[-0.5 * V, RAMP.displacement_mm])
    for law in LAWS:
        np.testing.assert_allclose(force(law, motion=later)[1:], force(law), rtol=1e-5, atol=1e-6)


def test_contact_stop_and_depth_of_several_motions_keep_their_shape():
    scale = np.array([[1.0], [2.0]])
    many = Motion(np.broadcast_to(TIME, (2, len(TIME))), scale * RAMP.displacement_mm)
    contact, stop, depth = ramps_of(many)
    assert contact.shape == stop.shape == depth.shape == (2,)
    np.testing.assert_allclose(contact, 0.0, atol=1e-6)
    np.testing.assert_allclose(stop, STOP, rtol=1e-3)
    np.testing.assert_allclose(depth, [DEPTH, 2.0 * DEPTH])
    one = ramps_of(RAMP)
    assert one[0].shape == () and float(one[2]) == DEPTH

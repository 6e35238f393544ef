"""Scaling laws of the force of a pad, over drawn pads: linear in the modulus, square in the lengths, no unit in it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import predict_motion, predict_static

BASES = st.sampled_from(["bonded", "sliding"])
RATIO = st.floats(0.35, 1.6)
"""Punch radius over thickness, where the tables of both bases reach half of the thickness."""
SHARE = st.floats(0.01, 0.5)
"""Depth over thickness."""
THICKNESS = st.floats(3.0, 30.0)
EXAMPLES = settings(max_examples=25, deadline=None)


def force_N(base: str, ratio: float, thickness_mm: float, share: float, young_MPa: float) -> float:
    extent = 12.0 * ratio * thickness_mm
    slab = Pad(thickness_mm, young_MPa, ratio * thickness_mm, base=base, slab_mm=(2.0 * extent, 2.0 * extent))
    return float(predict_static(slab, [share * thickness_mm]).force_N[0])


@EXAMPLES
@given(BASES, RATIO, THICKNESS, SHARE, st.floats(0.2, 50.0))
def test_force_is_linear_in_the_modulus(base, ratio, thickness_mm, share, factor):
    one = force_N(base, ratio, thickness_mm, share, 0.02)
    assert force_N(base, ratio, thickness_mm, share, 0.02 * factor) == pytest.approx(factor * one, rel=1e-12)


@EXAMPLES
@given(BASES, RATIO, THICKNESS, SHARE, st.floats(0.4, 2.5))
def test_lengths_that_scale_together_scale_the_force_by_their_square(base, ratio, thickness_mm, share, factor):
    one = force_N(base, ratio, thickness_mm, share, 0.02)
    other = force_N(base, ratio, factor * thickness_mm, share, 0.02)
    assert other == pytest.approx(factor**2 * one, rel=1e-9)


@EXAMPLES
@given(BASES, RATIO, THICKNESS, st.floats(0.01, 0.33), st.floats(1.01, 1.5))
def test_force_rises_with_depth(base, ratio, thickness_mm, share, further):
    deeper = share * further
    assert force_N(base, ratio, thickness_mm, deeper, 0.02) > force_N(base, ratio, thickness_mm, share, 0.02)


@EXAMPLES
@given(RATIO, THICKNESS, SHARE)
def test_a_base_that_slides_carries_less_than_a_glued_one(ratio, thickness_mm, share):
    free, glued = (force_N(base, ratio, thickness_mm, share, 0.02) for base in ("sliding", "bonded"))
    assert free < glued


@settings(max_examples=15, deadline=None)
@given(st.floats(0.01, 10.0), st.floats(0.05, 2.0), st.floats(0.3, 3.0))
def test_time_has_no_scale_of_its_own(tau_s, beta, factor):
    """Times of arm and motion stretched together give the same forces."""
    time = np.linspace(0.0, 1.0, 60)
    elastic = np.minimum(time / 0.3, 1.0) ** 1.5
    one = relaxed_force(time, elastic, (PronyTerm(tau_s, beta),))
    other = relaxed_force(factor * time, elastic, (PronyTerm(factor * tau_s, beta),))
    assert other == pytest.approx(one, rel=1e-9, abs=1e-12)


@settings(max_examples=8, deadline=None)
@given(st.floats(5.0, 60.0), st.floats(0.2, 5.0))
def test_a_press_is_linear_in_the_modulus_too(young_kPa, factor):
    motion = ramp_and_hold(10.0, 2.0, hold_s=1.0)
    arms = (PronyTerm(0.03, 1.0), PronyTerm(1.0, 0.3))
    one, other = (
        predict_motion(Pad(10.0, 1e-3 * young_kPa * k, 7.9, arms), motion).peak_force_N for k in (1.0, factor)
    )
    assert other == pytest.approx(factor * one, rel=1e-9)

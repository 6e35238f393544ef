"""The low-pass: transfer function, independence of sampling, agreement with other implementations."""

import numpy as np
import pytest
from scipy.signal import butter, lfilter, lsim

from dummydesign.core.errors import InputError
from dummydesign.measurement.sensor import Lowpass, parse_lowpass


def lowpass(time, force, cutoff_hz=35.0, order=2, passes=1):
    return Lowpass(cutoff_hz, order, passes).apply(time, force)


def _uneven(seconds, seed):
    # 20,000 samples: the gaps are short against the fastest sine, so that linear pieces follow it to 0.1 %
    return np.sort(np.random.default_rng(seed).uniform(0, seconds, 20_000))


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_a_sine_passes_with_the_gain_and_phase_of_a_butterworth_filter(order):
    time = _uneven(2.0, order)
    for frequency in (7.0, 35.0, 70.0):
        out = lowpass(time, np.sin(2 * np.pi * frequency * time), 35.0, order)
        late = time > 1.0
        basis = np.exp(2j * np.pi * frequency * time[late])
        fit = np.linalg.lstsq(np.c_[basis.real, basis.imag], out[late], rcond=None)[0]
        b, a = butter(order, 2 * np.pi * 35.0, analog=True)
        exact = np.polyval(b, 2j * np.pi * frequency) / np.polyval(a, 2j * np.pi * frequency)
        assert fit[1] == pytest.approx(exact.real, abs=2e-3)
        assert fit[0] == pytest.approx(exact.imag, abs=2e-3)


def test_it_agrees_with_the_state_space_solver_of_scipy():
    time = np.arange(0, 0.5, 1e-3)
    force = np.where(time < 0.1, 0.0, np.minimum((time - 0.1) * 100, 8.0))
    b, a = butter(2, 2 * np.pi * 35.0, analog=True)
    assert np.allclose(lowpass(time, force), lsim((b, a), force, time)[1], atol=1e-9)


def test_it_is_near_the_digital_filter_that_laboratories_run_at_1_kHz():
    time = np.arange(0, 0.5, 1e-3)
    force = 5 * np.clip((time - 0.1) / 0.03, 0, 1)
    b, a = butter(2, 35.0, fs=1000.0)
    assert np.max(np.abs(lowpass(time, force) - lfilter(b, a, force))) < 0.03


def test_dropping_samples_of_a_polyline_does_not_change_the_result():
    knots = np.array([0.0, 0.1, 0.12, 0.4])
    fine = np.union1d(knots, _uneven(0.4, 5))
    coarse = lowpass(knots, [0.0, 0.0, 6.0, 5.0])
    dense = lowpass(fine, np.interp(fine, knots, [0.0, 0.0, 6.0, 5.0]))
    assert np.allclose(dense[np.searchsorted(fine, knots)], coarse, atol=1e-9)


def test_a_constant_passes_unchanged_and_two_passes_do_not_delay():
    time = _uneven(1.0, 6)
    assert np.allclose(lowpass(time, np.full(20_000, 3.0)), 3.0)
    pulse = np.exp(-(((time - 0.5) / 0.02) ** 2))
    there_and_back = lowpass(time, pulse, passes=2)
    centre = np.trapezoid(time * there_and_back, time) / np.trapezoid(there_and_back, time)
    assert centre == pytest.approx(0.5, abs=1e-4)
    once = lowpass(time, pulse)
    delay = np.trapezoid(time * once, time) / np.trapezoid(once, time) - 0.5
    assert delay == pytest.approx(np.sqrt(2) / (2 * np.pi * 35.0), rel=1e-2)


def test_rows_are_filtered_one_by_one():
    time = np.linspace(0, 1, 200)
    force = np.random.default_rng(0).normal(size=(3, 200)).cumsum(axis=1)
    assert np.allclose(lowpass(time, force)[1], lowpass(time, force[1]))
    assert np.allclose(lowpass(np.stack([time] * 3), force), lowpass(time, force))


def test_the_option_text_is_read_or_refused():
    assert parse_lowpass("35") == Lowpass(35.0, 2, 1)
    assert parse_lowpass("20:4:2") == Lowpass(20.0, 4, 2)
    assert parse_lowpass(None) is None
    for bad in ("", "a", "35:2:3", "-1", "35:0", "35:2:1:1", "nan"):
        with pytest.raises(InputError):
            parse_lowpass(bad)

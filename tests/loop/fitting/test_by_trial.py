"""What each press reads by itself: a gain and a zero that were put in, and nothing where nothing was."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.fitting.by_trial import gains, of_pads, zeros
from tests.support import puck_presses as pucks


def test_a_press_with_a_gain_of_its_own_has_its_logarithm_and_the_others_have_none():
    def change(presses, forces):
        factor = np.ones_like(forces)
        factor[3] = 1.2
        return factor

    found = gains(pucks.pressed(change), pucks.clean_fit())
    others = np.delete(np.arange(len(found.value)), 3)
    assert found.value[3] == pytest.approx(np.log(1.2), abs=4.0 * found.error[3])
    assert np.all(np.abs(found.value[others]) < 4.0 * found.error[others] + 0.01)
    assert found.value[3] > 4.0 * np.abs(found.value[others]).max()


def test_a_zero_is_the_mean_reading_before_contact_and_is_not_known_without_one():
    time = np.arange(-0.1, 0.1, 1e-3)
    force = np.where(time < 0.0, 0.3, 5.0)
    trials = [SimpleNamespace(trace=SimpleNamespace(time_s=time, force_N=force))] * 2
    presses = SimpleNamespace(trials=trials, contact_s=np.array([0.0, -0.2]))
    noise = SimpleNamespace(white_N=0.2, slow_N=0.05)
    found = zeros(presses, SimpleNamespace(sizes=SimpleNamespace(noise=noise)))
    assert found.value == pytest.approx([0.3, 0.0])
    count = int(np.sum(time < -0.005))
    assert found.error[0] == pytest.approx(np.sqrt(0.04 / count + 0.0025)) and np.isinf(found.error[1])


def test_presses_as_if_all_were_of_one_pad():
    presses = pucks.planned()
    pad = replace(presses.trials[0], young_factor=1.3)
    found = of_pads(presses, [pad] * len(presses.trials))
    assert set(found.thickness_mm) == {pad.thickness_mm} and {one.young_factor for one in found.trials} == {1.3}
    assert [one.trace for one in found.trials] == [one.trace for one in presses.trials]

"""The speed on the way back is the path over the time of that part alone, wherever the clock began."""

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.data.trials import Presses
from dummydesign.measurement.trace import Trace


@pytest.mark.parametrize("began_s", [-0.1, 30.0])
def test_the_way_back_has_its_own_speed_and_a_press_without_one_that_of_its_ramp(began_s):
    time = np.arange(0.0, 6.0, 1e-2)
    x = np.where(time < 0.2, 10.0 * time, np.where(time < 5.0, 2.0, 2.0 - 4.0 * (time - 5.0)))
    whole = Trace("a.csv", began_s + time, x, np.maximum(x, 0.0))
    held = Trace("b.csv", *(column[time < 5.0] for column in (whole.time_s, x, whole.force_N)))
    trials = [SimpleNamespace(trace=whole), SimpleNamespace(trace=held)]
    presses = SimpleNamespace(trials=trials, hold_end_s=[began_s + 5.0] * 2, velocity_mm_s=[10.0, 10.0])
    assert Presses.back_mm_s.func(presses) == pytest.approx([4.0, 10.0])

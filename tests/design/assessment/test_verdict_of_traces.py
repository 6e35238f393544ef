"""What the verdict reads from the traces of a cast pad."""

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.measured_pad import energy_of
from dummydesign.measurement.motion import ramp_and_hold

DEPTH_MM, HOLD_S = 3.6, 10.0


@pytest.mark.parametrize("speed", [10.0, 250.0])
def test_the_energy_of_a_trace_goes_to_where_the_punch_stands_still(speed):
    motion = ramp_and_hold(speed, np.array([DEPTH_MM]), HOLD_S, 30_000.0, 60, 24, 60)
    stop = motion.time_s[0, 84]
    time = np.r_[np.linspace(0.0, stop, 150)[:-1], stop + np.geomspace(0.4 * stop / 150, HOLD_S, 120)]
    x = np.interp(time, motion.time_s[0], motion.displacement_mm[0])
    ideal_stop = DEPTH_MM / speed  # a ramp without braking stops here
    trace = SimpleNamespace(
        trace=SimpleNamespace(time_s=time, displacement_mm=x, force_N=0.4 * x**2),
        ramp=SimpleNamespace(contact_time_s=0.0, stop_time_s=ideal_stop, hold_end_s=time[-1], overshoot_mm=0.0),
    )
    assert energy_of(trace) == pytest.approx(0.4 * DEPTH_MM**3 / 3.0, rel=2e-3)

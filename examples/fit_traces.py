"""Fit the three-element law to traces; here traces made by the law itself, with the noise of a sensor."""

import numpy as np

import dummydesign
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.model.maxwell_law import law_named

rng = np.random.default_rng(4)
traces = []
for velocity in (10.0, 250.0):
    motion = ramp_and_hold(velocity, 2.0, hold_s=5.0)
    time = np.arange(0.0, motion.time_s[-1], 0.0005)
    depth = np.interp(time, motion.time_s, motion.displacement_mm)
    exact = np.interp(time, motion.time_s, law_named("ode").force(motion, 0.8, [0.5], [0.3]))
    traces.append(Trace(f"{velocity:g} mm/s", time, depth, exact + 0.02 * rng.standard_normal(len(time))))

# springs are shared; dampers belong to a speed, unless mode="joint" is asked for
found = dummydesign.fit(traces, elements=3)
for name, entry in found.to_dict()["parameters"].items():
    for speed, one in {"": entry}.items() if "value" in entry else entry.items():
        label = f"{name} at {speed} mm/s" if speed else name
        print(f"{label} = {one['value']:.3f} (95 %: {one['low']:.3f} to {one['high']:.3f})")

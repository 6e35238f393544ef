"""Fit the three-element law to traces; here traces made by the law itself, with the noise of a sensor."""

import numpy as np

import dummydesign
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.model.laws import law_named

rng = np.random.default_rng(4)
traces = []
for velocity in (10.0, 250.0):
    motion = ramp_and_hold(velocity, 2.0, hold_s=5.0)
    time = np.arange(0.0, motion.time_s[-1], 0.0005)
    depth = np.interp(time, motion.time_s, motion.displacement_mm)
    exact = np.interp(time, motion.time_s, law_named("ode").force(motion, 0.8, [0.5], [0.3]))
    traces.append(Trace(f"{velocity:g} mm/s", time, depth, exact + 0.02 * rng.standard_normal(len(time))))

found = dummydesign.fit(traces, elements=3)
for name, entry in found.to_dict()["parameters"].items():
    print(f"{name} = {entry['value']:.3f} (95 %: {entry['low']:.3f} to {entry['high']:.3f})")

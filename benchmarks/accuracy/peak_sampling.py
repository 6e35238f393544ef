"""Error of the peak that ``compare`` reads, by sampling and braking: ``python -m benchmarks.accuracy.peak_sampling``.

A subject of the palm is pressed to 5 and 15 N by its printed law, with 0.02 N of noise, the samples anywhere about the
stop. Printed are the mean errors of the largest sample, of parabolas alone and of what is read, with its scatter.
"""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from dummydesign.design import measured_pad
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.measurement.trace import Trace
from dummydesign.tissue import load_tissue
from dummydesign.tissue.fitting.reduction import ReducedTrace, reduce_trace
from dummydesign.tissue.model.maxwell_law import law_named

NOISE_N, DRAWS, SEED = 0.02, 40, 3
BRAKING_MM_S2 = (30_000.0, 3000.0, 1000.0, 300.0)
RATES_HZ = {10.0: (50, 100, 200, 1000), 250.0: (1000, 2000, 5000)}


def presses(speed_mm_s: float, rate_Hz: float, motion: Motion, force_N: np.ndarray, rng: np.random.Generator):
    """Presses of one motion, sampled at random moments."""
    for _ in range(DRAWS):
        time = np.arange(-0.5, motion.time_s[-1] - 0.1, 1.0 / rate_Hz) + rng.uniform(0.0, 1.0 / rate_Hz)
        before = time < 0.0
        x = np.where(before, speed_mm_s * time, np.interp(time, motion.time_s, motion.displacement_mm))
        force = np.where(before, 0.0, np.interp(time, motion.time_s, force_N))
        yield reduce_trace(Trace("drawn", time, x, force + NOISE_N * rng.standard_normal(len(time))))


def parabolas_alone(trace: ReducedTrace) -> float:
    """The peak as it is read where braking is seen."""
    with patch.object(measured_pad, "_force_at_abrupt_stop", return_value=None):
        return measured_pad.peak_of(trace, NOISE_N)


def main() -> None:
    """Print the table."""
    tissue, rng = load_tissue("palm"), np.random.default_rng(SEED)
    law, subject = law_named(tissue.law), tissue.parameter_sets[2]
    dampers = dict(subject.c_N_s_per_mm)
    print("m/s2  mm/s   N    Hz | error %: largest sample, parabolas, read (scatter)")
    for braking in BRAKING_MM_S2:
        for speed, rates in RATES_HZ.items():
            for steady_N in (5.0, 15.0):
                depth = (steady_N / subject.gamma1_N_per_mm3) ** (1 / 3)
                motion = ramp_and_hold(speed, depth, deceleration_mm_s2=braking, ramp_points=2000, brake_points=500)
                force = law.force(motion, subject.gamma1_N_per_mm3, subject.gamma_N_per_mm3, dampers[speed])
                for rate in rates:
                    found = [
                        (one.trace.force_N.max(), parabolas_alone(one), measured_pad.peak_of(one, NOISE_N))
                        for one in presses(speed, rate, motion, force, rng)
                    ]
                    error = 100.0 * (np.array(found) / force.max() - 1.0)
                    largest, alone, read = error.mean(axis=0)
                    words = f"{braking / 1000:4g} {speed:5g} {steady_N:4g} {rate:5d} | {largest:+.2f} {alone:+.2f} "
                    print(f"{words}{read:+.2f} ({error[:, 2].std():.2f})", flush=True)


if __name__ == "__main__":
    main()

"""Quick predictions of drawn crowns against presses solved at finite strain: share inside the interval, bias.

    python -m benchmarks.accuracy.finite_strain_blind --count 50 --seed 5150

Crowns, depths, speeds and arms are drawn as those to which the interval is fitted (``studies.tables.separability``),
by another seed. Three seconds of processor time a press; presses that fold are left out.
"""

from __future__ import annotations

import argparse
from itertools import islice

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.axisymmetric.finite_strain import nodes_of_motion, solve_ratio
from dummydesign.pad.predict import departure
from studies.tables.separability_shapes import drawn_crowns

Array = np.ndarray
# Where less than this share of the depth is reached forces are small and mostly mesh.
SMALLEST_DEPTH = 0.2


def compared(count: int, seed: int) -> Array:
    """Middle minus solution and half width at the peak and of the energy over the quick ones, and the share of times.

    One row a press: peak, its half width, energy, its half width, share of times inside, speed [mm/s].
    """
    rows = []
    for _, _, press, share, speed, prony in islice(drawn_crowns(seed), count):
        h = press.thickness_mm
        motion = ramp_and_hold(speed, share * h)
        try:
            path = solve_ratio(press, prony, *nodes_of_motion(motion.time_s, motion.displacement_mm / h, prony))
        except NoAnswerError:
            continue
        quick, off = path.separable, path.force - path.separable
        low, high = departure("bonded", press.radius, path.depth, path.time_s, path.elastic, prony, press.shape, h)
        peak, row = int(np.argmax(quick)), []
        rise = slice(0, peak + 1)
        for part in (lambda values: values[peak], lambda values: np.trapezoid(values[rise], path.depth[rise])):  # noqa: B023
            row += [part(0.5 * (low + high) - off) / part(quick), part(0.5 * (high - low)) / part(quick)]
        deep = path.depth > SMALLEST_DEPTH * path.depth.max()
        inside = (off >= np.minimum(low, 0.0)) & (off <= np.maximum(high, 0.0))
        rows.append([*row, np.mean(inside[deep]), speed])
    return np.array(rows)


def main() -> None:
    """Solve and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=5150)
    options = parser.parse_args()
    rows = compared(options.count, options.seed)
    for name, (away, half) in (("peak", rows.T[:2]), ("energy", rows.T[2:4])):
        print(
            f"{name}: {np.mean(np.abs(away) <= half):.1%} of {len(rows)} inside; middle minus solution: median "
            f"{np.median(away):+.2%}, rms {np.sqrt(np.mean(away**2)):.2%}; half width {np.median(half):.2%}"
        )
    print(f"inside at all times: {np.mean(rows[:, 4] >= 1.0):.1%}")


if __name__ == "__main__":
    main()

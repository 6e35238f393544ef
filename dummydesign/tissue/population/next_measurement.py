"""Which measurement would narrow an inferred tissue most: variance of its ranges explained, over the draws."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.population.protocol import LAW, SPEEDS_MM_S, STEADY_N

MEASUREMENTS = {
    "steady_depth": "the depth at which one more person carries a steady 10 N",
    "fast_peak": "one press of one person at 250 mm/s to 10 N: its peak over the steady force",
    "slow_peak": "one press of one person at 10 mm/s to 10 N: its peak over the steady force",
    "slow_decay": "the force of one person 1 s after the stop of a press at 10 mm/s to 10 N",
    "fast_decay": "the force of one person 50 ms after the stop of a press at 250 mm/s to 10 N",
}
"""What could be measured on one person, in words."""


def next_measurement(draws: NDArray, weight: NDArray, persons_measured: int = 0) -> dict[str, Any]:
    """Rank single measurements on one person by how much of the ranges' variance they would remove.

    The ranges are described at 10 N by the logarithms of the smallest and largest depth, peaks at both
    speeds, and forces 1 s (10 mm/s) and 50 ms (250 mm/s) after the stop. Over the draws, the variance
    of each that a linear regression on the measured quantity explains is what would be saved.

    Parameters
    ----------
    draws : ndarray, shape (m, 5, 7)
        Posterior draws, columns as ``posterior.COLUMNS``.
    weight : ndarray, shape (m,)
        Of each draw; they need not add up to 1.
    persons_measured : int
        Persons whose steady depth is known already; with five of them the steady depth is not asked for.

    Returns
    -------
    dict
        ``measurement``, ``text``, ``variance_removed`` and ``ranking`` [{measurement, variance_removed}].
    """
    seen = _observed(draws)
    outcomes = np.column_stack([end(seen[name], axis=1) for name in MEASUREMENTS for end in (np.min, np.max)])
    share = weight / weight.sum()
    middle = draws.shape[1] // 2
    ranking: list[dict[str, Any]] = []
    for name in MEASUREMENTS:
        if name == "steady_depth" and persons_measured >= draws.shape[1]:
            continue
        at = seen[name][:, middle]
        centred, spread = at - share @ at, outcomes - share @ outcomes
        variance = share @ centred**2
        explained = (share @ (centred[:, None] * spread)) ** 2 / max(variance, 1e-30)
        ranking.append({"measurement": name, "variance_removed": float(explained.sum() / (share @ spread**2).sum())})
    ranking.sort(key=lambda row: -row["variance_removed"])
    best = ranking[0]
    text = f"{MEASUREMENTS[best['measurement']]} (would remove {100 * best['variance_removed']:.0f} % of the variance)"
    return {**best, "text": text, "ranking": ranking}


def _observed(draws: NDArray) -> dict[str, NDArray]:
    """Logarithms of what a press of each person (m, 5) to 10 N would show."""
    gamma1, gamma = draws[..., 0], draws[..., 1:3]
    depth = np.cbrt(STEADY_N / gamma1)
    seen = {"steady_depth": np.log(depth)}
    for at, speed in enumerate(SPEEDS_MM_S):
        motion = ramp_and_hold(speed, depth, 10.0, ramp_points=24, brake_points=8, hold_points=24)
        curve = law_named(LAW).force(motion, gamma1, gamma, draws[..., [3 + at, 5 + at]])
        label, after = (("slow", 1.0), ("fast", 0.05))[at]
        seen[f"{label}_peak"] = np.log(curve.max(axis=-1) / curve[..., -1])
        # the hold is sampled alike for all persons
        since = motion.time_s[..., -24:] - (motion.time_s[..., -1:] - 10.0)
        place = int(np.argmin(np.abs(since.reshape(-1, 24)[0] - after)))
        seen[f"{label}_decay"] = np.log(curve[..., place - 24] / curve[..., -1])
    return seen

"""In vivo anchors of the relaxing arms: proposals, and which of them agree with measurements on hands."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue.model.maxwell_law import law_named
from dummydesign.tissue.model.posterior import LAW, SPEEDS_MM_S, STEADY_N
from studies.tissues.statements import Statement

PEAK_RATIO = {"palm": (2.0, 2.75, 1.15), "thenar": (2.0, 2.75, 1.3), "forefinger": (2.0, 2.75, 1.5)}
"""Peak over steady force in a fast press: measured low and high, and the factor a site may differ by."""

_RATIO_SOURCE = {
    "palm": "Spartacus et al. 2021, PLOS ONE 16:e0261008, palm over trapezium, 15 adults",
    "thenar": "as for the palm (Spartacus et al. 2021), assumed to hold within a factor of 1.3",
    "forefinger": "as for the palm (Spartacus et al. 2021), assumed to hold within a factor of 1.5",
}


def propose(gamma1: NDArray, rng: np.random.Generator) -> dict[str, NDArray]:
    """Draw arms for a typical subject of each sample.

    Parameters
    ----------
    gamma1 : ndarray, shape (n,)
        Steady coefficient of that subject. [N/mm3]

    Returns
    -------
    dict
        ``strength`` (n, 2): gamma2 / gamma1 and gamma3 / gamma1; ``time_s`` (n, 2 speeds, 2 arms):
        c / (gamma x^2) at the depth of 10 N; ``depth_mm`` (n,) that depth.
    """
    count = len(gamma1)

    def log_uniform(low: float, high: float) -> NDArray:
        return np.exp(rng.uniform(np.log(low), np.log(high), count))

    strength = np.column_stack([log_uniform(0.05, 3.0), log_uniform(0.1, 20.0)])
    fast_press = np.column_stack([log_uniform(0.3, 6.0), log_uniform(0.005, 0.5)])
    fall = np.column_stack([log_uniform(1.0, 10.0), log_uniform(1.0, 10.0)])
    time = np.stack([fast_press * fall, fast_press], axis=1)
    return {"strength": strength, "time_s": time, "depth_mm": np.cbrt(STEADY_N / gamma1)}


def judge(site: str, gamma1: NDArray, arms: dict[str, NDArray], rng: np.random.Generator) -> list[Statement]:
    """Judge proposals of arms for one site by the law itself (``ode``) at 10 N and both speeds.

    Parameters
    ----------
    site : str
        ``palm``, ``thenar`` or ``forefinger``.
    gamma1 : ndarray, shape (n,)
        Steady coefficient of a typical subject. [N/mm3]
    arms : dict of ndarray, shapes (n, ...)
        As :func:`propose` gives them.
    rng : numpy.random.Generator
        For what a statement leaves open (how near is near).

    Returns
    -------
    list of Statement
        One for each anchor, with whether it holds for each proposal.
    """
    count = len(gamma1)
    gamma = arms["strength"] * gamma1[:, None]
    dampers = arms["time_s"] * (gamma * arms["depth_mm"][:, None] ** 2)[:, None, :]
    peaks, middle = [], []
    for at, speed in enumerate(SPEEDS_MM_S):
        # the ideal ramp of the paper's law; sample 12 of 24 is half of the rise
        motion = ramp_and_hold(speed, arms["depth_mm"], 10.0, np.inf, 24, 1, 12)
        curve = law_named(LAW).force(motion, gamma1, gamma, dampers[:, at])
        peaks.append(curve.max(axis=-1) / curve[:, -1])
        middle.append(curve[:, 12] / curve[:, 24])
    low, high, factor = PEAK_RATIO[site]
    slow, fast = arms["time_s"][:, :, 0], arms["time_s"][:, :, 1]
    # what the slow arm still loses per second after 10 s of hold at 5 N, where its time is 2^(2/3) longer
    late = slow[:, 0] * 2.0 ** (2 / 3)
    drift = arms["strength"][:, 0] * np.exp(-10.0 / late) / late
    near = np.exp(rng.uniform(np.log(1.5), np.log(2.5), count))
    pulp = "Pawluk and Howe 1999, J Biomech Eng 121:178: fingerpad 4 ms, 70 ms, 1.4 s"
    rows = [
        (
            "peak ratio at 250 mm/s",
            "peak 2 to 2.75 times the slow force",
            _RATIO_SOURCE[site],
            (peaks[1] > low / factor) & (peaks[1] < high * factor),
        ),
        ("smaller peak at 10 than at 250 mm/s", "forces rise with speed", "Sensors 2017, 17:1190", peaks[0] < peaks[1]),
        (
            "slow time near 1.4 s at 10 mm/s",
            "slowest mode 1.4 s",
            pulp,
            (slow[:, 0] > 1.4 / near) & (slow[:, 0] < 1.4 * near),
        ),
        (
            "fast time between 4 and 70 ms at 250 mm/s",
            "fast modes 4 and 70 ms",
            pulp,
            (fast[:, 1] > 0.004 * near) & (fast[:, 1] < 0.07 * near),
        ),
        (
            "gamma2 below gamma3",
            "gamma2 is always smaller than gamma3",
            "paper, section V-A",
            arms["strength"][:, 0] < arms["strength"][:, 1],
        ),
        (
            "c2 above c3",
            "c2 is always larger than c3",
            "paper, section V-A",
            (dampers[..., 0] > dampers[..., 1]).all(axis=1),
        ),
        ("steady after 10 s", "decreased to a constant value", "paper, section II-C", drift < 0.01),
        (
            "rise curved upward",
            "concavity of the rising phase",
            "paper, section V-A",
            (np.array(middle) < 0.5).all(axis=0),
        ),
    ]
    return [Statement(f"{site}: {name}", text, source, holds) for name, text, source, holds in rows]

"""What each press reads by itself beside the model: its gain, its zero, and the cut-off of its sensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.reduction import FAST_RISE_S, HOLD, RISE, UNLOADING
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.fit import CampaignFit
from dummydesign.loop.fitting.noise import make_whitener
from dummydesign.loop.model.forward_model import simulate
from dummydesign.measurement.campaign import Trial
from dummydesign.measurement.sensor import Lowpass

SHIFT_MM, ZERO_N, WIDTH = 0.02, 1.0, 1.0
"""Standard deviations of what a press may have of its own: contact [mm], zero [N], ln of the cut-off."""
UNDECLARED_HZ = 50.0
"""Cut-off about which a sensor without a declared filter is judged: below the sampling of usual robots."""
STEP = 1.25
"""Factor of the cut-off by whose change of the force the cut-off of one press is fitted."""
RUNG_S, LATE_S = 0.06, 0.3
"""Time after the stop from which a filter no longer shows, and until which it is looked for. [s]"""


@dataclass(frozen=True)
class Own:
    """A quantity of each press and its standard error, both (T,); ``left`` is chi-square over bins."""

    value: NDArray
    error: NDArray
    left: NDArray


def of_pads(presses: Presses, pads: Sequence[Trial]) -> Presses:
    """The same presses as if each were of the pad of one of these trials (T,)."""
    keys = ("thickness_mm", "geometry", "young_factor", "young_factor_sd")
    trials = tuple(replace(t, **{key: getattr(pad, key) for key in keys}) for t, pad in zip(presses.trials, pads))
    return replace(presses, trials=trials, thickness_mm=np.array([trial.thickness_mm for trial in trials]))


def gains(presses: Presses, fit: CampaignFit) -> Own:
    """ln of the measured over the modelled force of each press, contact and zero free, the law's own error left out.

    By the slow part of a press: what a filter does to a fast rise, and the way back, are left out.
    """
    force, slope, _ = _modelled(presses, fit)
    phase, fast = presses.label // 100, presses.stop_s - presses.contact_s < FAST_RISE_S
    early = (phase == RISE) & fast[:, None] | (phase == HOLD) & (presses.since_stop_s < RUNG_S)
    use = presses.used & (phase != UNLOADING) & ~early
    columns = [force, slope, np.ones_like(force)]
    return _own(presses, fit, use, columns, (np.inf, SHIFT_MM, ZERO_N), 0)


def cutoffs(presses: Presses, fit: CampaignFit, lowpass: Lowpass | None) -> Own:
    """ln of the cut-off of each press's sensor over the declared one; by its rise and the first part of its hold."""
    force, slope, nodes = _modelled(presses, fit)
    middle = 0.5 * (presses.bins.start + presses.bins.end)
    change = np.zeros_like(middle)
    for row, trial in enumerate(presses.trials):
        usual, time = trial.lowpass or lowpass or Lowpass(UNDECLARED_HZ), presses.time_s[row]
        ends = [replace(usual, cutoff_hz=usual.cutoff_hz * factor) for factor in (STEP, 1.0 / STEP)]
        above, below = (np.interp(middle[row], time, one.apply(time, nodes[row])) for one in ends)
        change[row] = (above - below) / (2.0 * np.log(STEP))
    use = presses.used & (presses.label // 100 != UNLOADING) & (presses.since_stop_s < LATE_S)
    return _own(presses, fit, use, [force, slope, np.ones_like(force), change], (np.inf, SHIFT_MM, ZERO_N, WIDTH), 3)


def zeros(presses: Presses, fit: CampaignFit) -> Own:
    """Mean reading of each press before its contact; an infinite error where none was recorded. [N]"""
    noise = fit.sizes.noise
    before = [t.trace.force_N[t.trace.time_s < at - 0.005] for t, at in zip(presses.trials, presses.contact_s)]
    count = np.array([len(values) for values in before])
    mean = np.array([float(values.mean()) if len(values) else 0.0 for values in before])
    error = np.sqrt(noise.white_N**2 / np.maximum(count, 1) + noise.slow_N**2)
    return Own(mean, np.where(count > 0, error, np.inf), np.ones(len(mean)))


def _modelled(presses: Presses, fit: CampaignFit) -> tuple[NDArray, NDArray, NDArray]:
    """Bins (T, B), their change with the contact, and the force at the nodes. [N, N/mm, N]"""
    step = 2e-3
    moved = replace(presses, displacement_mm=presses.displacement_mm - step)
    nodes, less = (simulate(one, fit.problem.law, fit.base) for one in (presses, moved))
    force = presses.measure(nodes)
    return force, (force - presses.measure(less)) / step, nodes


def _own(
    presses: Presses, fit: CampaignFit, use: NDArray, columns: list[NDArray], spreads: Sequence[float], wanted: int
) -> Own:
    """Least squares of each press on columns with normal priors; the first is the force, that all are relative to."""
    whiten = make_whitener(replace(presses, bins=presses.bins.without(~use)), fit.sizes.noise)
    turned = whiten(np.where(use[..., None], np.stack(columns, axis=-1), 0.0))
    read = whiten(np.where(use, presses.force_N, 0.0))
    prior = np.diag(np.array(spreads) ** -2.0 + 1e-9)
    inverse = np.linalg.inv(np.einsum("tbi,tbj->tij", turned, turned) + prior)
    own = np.einsum("tij,tj->ti", inverse, np.einsum("tbi,tb->ti", turned, read))
    left = ((read - np.einsum("tbi,ti->tb", turned, own)) ** 2).sum(axis=1) / np.maximum(use.sum(axis=1), 1)
    gain = np.maximum(own[:, 0], 1e-3)
    error = np.sqrt(inverse[:, wanted, wanted]) / gain
    return Own(np.log(gain) if wanted == 0 else own[:, wanted] / gain, error, left)

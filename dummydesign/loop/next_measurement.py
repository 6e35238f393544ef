"""The next measurement: which feasible press would separate two explanations best."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.geometry.pad_shape import PadShape
from dummydesign.loop.data.reduction import UNLOADING
from dummydesign.loop.data.trials import SAME_DEPTH, Presses, planned_trace, stack
from dummydesign.loop.fitting.candidates import USUAL_POSITION_MM
from dummydesign.loop.fitting.fit import CampaignFit
from dummydesign.loop.model.effect import SetupLaw
from dummydesign.loop.model.forward_model import LAW_TERMS, SMOOTH_TERMS
from dummydesign.measurement.campaign import Trial
from dummydesign.measurement.sensor import Lowpass
from dummydesign.pad.tables.puck import shape_range
from dummydesign.pad.tables.slab import load_table

HOLD_S = 10.0  # of every planned press
LUBRICATED = "between plates lubricated with silicone oil"
MADE, SCATTER, SAME_SPEED = 2, 3.0, 0.05
"""How often a press must have been made to be known; how many standard deviations of the contact two presses of one
condition lie apart at most, and by which share their speeds differ, which robots keep no better."""


@dataclass(frozen=True)
class PossiblePress:
    """A press that could be made: pad, speed, depth, whether it unloads, and its circumstances.

    ``known`` says whether the pad is one of the campaign.
    """

    thickness_mm: float
    velocity_mm_s: float
    depth_share: float
    unloading: bool
    circumstance: str
    rest_s: float
    temperature_C: float | None
    age_days: float | None
    geometry: PadShape
    known: bool

    @property
    def pad(self) -> tuple[str, float]:
        """Shape as typed, empty for a slab, and thickness."""
        return "" if self.geometry.plain else str(self.geometry), self.thickness_mm

    @property
    def text(self) -> str:
        """The press in words."""
        away = " and unloading" if self.unloading else ""
        when = f", {self.circumstance}" if self.circumstance else ""
        shape = "" if self.geometry.plain else f"{self.geometry} "
        what = f"{'the' if self.known else 'a new'} {self.thickness_mm:g} mm {shape}pad"
        return (
            f"press {what} to {self.depth_share * self.thickness_mm:.2g} mm at "
            f"{self.velocity_mm_s:g} mm/s; record the hold{away}{when}"
        )


@dataclass(frozen=True)
class NextMeasurement:
    """The recommended press, what it separates, and the expected gap in chi2 between the two explanations.

    ``options`` are the press and its alternatives, the best first.
    """

    text: str
    separates: tuple[str, ...]
    expected_gain: float
    alternatives: tuple[tuple[str, float], ...]
    options: tuple[PossiblePress, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return all in words and numbers."""
        return {
            "text": self.text,
            "separates": list(self.separates),
            "expected_gain": self.expected_gain,
            "alternatives": [list(row) for row in self.alternatives],
        }


def options(presses: Presses, law: SetupLaw) -> list[PossiblePress]:
    """A short list of feasible presses: known and new pads, speeds, depths, unloading, and circumstances."""
    geometry = {trial.pad: trial.geometry for trial in presses.trials}
    pads = [(geometry[pad], pad[1], True) for pad in presses.pads]
    known = sorted({thickness for _, thickness, _ in pads})
    new: list[float] = []
    if law.shape == "slab":
        new, ratios = [0.7 * known[0], 0.5 * (known[0] + known[-1]), 1.3 * known[-1]], load_table().ratio_range
    elif law.shape == "cylinder":
        new, ratios = [0.6 * known[0], 1.5 * known[-1]], (0.5 * shape_range()[0], 0.5 * shape_range()[1])
    for h in (round(thickness, 1) for thickness in new):
        if ratios[0] <= law.radius_mm / h <= ratios[1] and h not in known:
            pads.append((pads[0][0], h, False))
    speeds = sorted({2.0, *(t.velocity_mm_s for t in presses.trials)})
    history = presses.history
    warm = float(np.nanmean(history.temperature_C)) if np.any(np.isfinite(history.temperature_C)) else None
    age = float(np.nanmax(history.age_days)) if np.any(np.isfinite(history.age_days)) else None
    plain = ("", 3600.0, warm, age)
    out = [
        PossiblePress(float(h), float(v), share, True, *plain, shape, known)
        for shape, h, known in pads
        for v in speeds
        for share in (0.1, 0.3, 0.45)
    ]
    if law.shape == "cylinder":
        shape, h, pressed_before = pads[0]
        press = (float(h), float(speeds[0]), 0.45, True)
        out.append(PossiblePress(*press, LUBRICATED, *plain[1:], shape, pressed_before))
    pressed = len(presses.pads)
    for number in dict.fromkeys((0, pressed // 2)):
        shape, h, _ = pads[number]
        press = (float(h), float(speeds[-1]), 0.3, True)
        out.append(PossiblePress(*press, "10 s after a press to the same depth", 10.0, warm, age, shape, True))
        if warm is not None:
            out.append(PossiblePress(*press, "at 10 K more", 3600.0, warm + 10.0, age, shape, True))
        if age is not None:
            out.append(PossiblePress(*press, f"at {3 * age:.0f} days", 3600.0, warm, 3 * age, shape, True))
    return out


def planned_presses(presses: Presses, lowpass: Lowpass | None, chosen: list[PossiblePress]) -> Presses:
    """Presses of the options, each as if it were the next after the campaign."""
    trials = []
    for number, option in enumerate(chosen):
        depth = option.depth_share * option.thickness_mm
        trace = planned_trace(f"planned-{number}", option.velocity_mm_s, depth, HOLD_S, option.unloading)
        trials.append(
            Trial(
                trace.name,
                option.thickness_mm,
                option.velocity_mm_s,
                HOLD_S,
                None,
                1,
                number + 1,
                option.rest_s,
                option.temperature_C,
                option.age_days,
                trace,
                option.geometry,
            )
        )
    made = stack(tuple(trials), lowpass)
    count = len(presses.trials)
    earlier, elapsed = np.zeros((len(chosen), count)), np.full((len(chosen), count), np.inf)
    for row, option in enumerate(chosen):
        same = np.array([trial.pad == option.pad for trial in presses.trials])
        earlier[row, same] = presses.depth_mm[same]
        elapsed[row, same] = option.rest_s
    sequence = presses.history.sequence.max() + made.history.sequence
    history = replace(made.history, earlier_depth_mm=earlier, elapsed_s=elapsed, sequence=sequence)
    return replace(made, history=history)


def still_new(presses: Presses, chosen: list[PossiblePress], planned: Presses, position_mm: float) -> NDArray:
    """Bins (T, B) of planned presses that the campaign does not hold already.

    A press under usual circumstances that was made :data:`MADE` times or more, at a depth within :data:`SAME_DEPTH` or
    :data:`SCATTER` of the contact's ``position_mm``, shows nothing new; its way back does where none was recorded.
    """
    new = planned.used.copy()
    away = planned.label // 100 == UNLOADING
    for row, option in enumerate(chosen):
        if option.circumstance:
            continue
        depth = option.depth_share * option.thickness_mm
        slack = max(SAME_DEPTH * depth, SCATTER * np.sqrt(2.0) * position_mm)
        same = np.array([trial.pad == option.pad for trial in presses.trials])
        speeds = np.array([trial.velocity_mm_s for trial in presses.trials])
        same &= np.abs(speeds - option.velocity_mm_s) <= SAME_SPEED * option.velocity_mm_s
        same &= np.abs(presses.depth_mm - depth) <= slack
        if same.sum() >= MADE:
            new[row] &= away[row]
        if (same & presses.unloads).sum() >= MADE:
            new[row] = False
    return new


def _prediction(fit: CampaignFit, planned: Presses) -> tuple[NDArray, NDArray]:
    """Bins (T, B) of the planned presses and a square root (T, B, n) of their parameter covariance."""
    problem = replace(fit.problem, presses=planned)
    fixed, old, new = problem.fixed, fit.problem.presses.pads, planned.pads
    vector = np.r_[fit.vector[:fixed], np.zeros(LAW_TERMS * len(new))]
    spread = np.zeros((len(vector),) * 2)
    source = np.r_[np.arange(fixed), np.full(LAW_TERMS * len(new), -1)]
    for term in range(LAW_TERMS):
        for at, pad in enumerate(new, problem.law_entries(term).start):
            if pad in old:
                source[at] = fit.problem.law_entries(term).start + old.index(pad)
                vector[at] = fit.vector[source[at]]
            else:
                spread[at, at] = fit.sizes.law[min(term, SMOOTH_TERMS)] ** 2
    known = source >= 0
    spread[np.ix_(known, known)] = fit.covariance[np.ix_(source[known], source[known])]
    forces = problem.predict(vector)
    values, turn = np.linalg.eigh(0.5 * (spread + spread.T))
    return forces, problem.spread(problem.jacobian(vector, forces)) @ (turn * np.sqrt(np.maximum(values, 0.0)))


def _without_friction(fit: CampaignFit) -> CampaignFit:
    """A model as it is between lubricated plates."""
    vector = fit.vector.copy()
    for effect in fit.problem.effects:
        if effect.lubricated:
            vector[fit.problem.entries[effect.name]] = 0.0
    return replace(fit, vector=vector)


def next_measurement(
    first: CampaignFit, others: tuple[CampaignFit, ...], names: tuple[str, ...], lowpass: Lowpass | None
) -> NextMeasurement:
    """Find the press with the largest expected gap in chi2 between a fitted explanation and the nearest of others.

    gap = d' (C + S1 + S2)^-1 d with d the difference of two predictions, C the noise, S their parameter
    uncertainty (law error of new pads included). Only what is new counts, see :func:`still_new`.
    """
    presses = first.problem.presses
    chosen = [o for o in options(presses, first.problem.law) if o.depth_share * o.thickness_mm > 0.2]
    planned = planned_presses(presses, lowpass, chosen)
    oiled = np.array([option.circumstance == LUBRICATED for option in chosen])[:, None]

    def predicted(fit: CampaignFit) -> tuple[NDArray, NDArray]:
        forces, root = _prediction(fit, planned)
        if not oiled.any():
            return forces, root
        smooth, smooth_root = _prediction(_without_friction(fit), planned)
        return np.where(oiled, smooth, forces), np.where(oiled[..., None], smooth_root, root)

    forces, root = predicted(first)
    rivals = [predicted(one) for one in others]
    noise = first.sizes.noise
    gaps = np.zeros(len(chosen))
    plain = replace(first.problem, presses=planned, effects=())
    slope = plain.slope(np.r_[first.vector[: plain.base_count], np.zeros(LAW_TERMS * len(planned.pads))], forces)
    cover = planned.bins.covariance(noise, np.where(planned.used, slope, 0.0))
    cover += first.sizes.gain**2 * forces[:, :, None] * forces[:, None, :]
    new = still_new(presses, chosen, planned, min(noise.position_mm, USUAL_POSITION_MM))
    for row in np.nonzero(new.any(axis=1))[0]:
        use = new[row]
        own = cover[row][np.ix_(use, use)] + root[row][use] @ root[row][use].T
        each = []
        for other, other_root in rivals:
            total = own + other_root[row][use] @ other_root[row][use].T
            difference = (forces - other)[row][use]
            each.append(float(difference @ np.linalg.solve(total, difference)))
        gaps[row] = min(each)
    best = np.argsort(-gaps)
    listed = tuple((chosen[i].text, float(gaps[i])) for i in best[1:4])
    presses_to_make = tuple(chosen[i] for i in best[:4])
    return NextMeasurement(presses_to_make[0].text, names, float(gaps[best[0]]), listed, presses_to_make)

"""Doubts about the labels of a campaign: presses on another pad, exchanged, mistyped, of another sensor or zero.

A wrong label acts on single presses or days, an effect on all presses that are alike. So every press is compared with
what the others let expect of a press like it: its gain by pad, depth, speed and circumstances, its zero and the cut-off
of its sensor. How far presses that are rightly labelled scatter about that, by whatever effect, is the floor.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses, stack
from dummydesign.loop.fitting.by_trial import UNDECLARED_HZ, Own, cutoffs, gains, of_pads, zeros
from dummydesign.loop.fitting.fit import CampaignFit, fit_base
from dummydesign.loop.model.campaign_law import BEYOND, within_reach
from dummydesign.loop.selection.doubt_words import (
    Doubt,
    OddGroup,
    PadReading,
    exchanged,
    mistyped,
    other_pad,
    other_sensor,
    other_speed,
    other_zero,
    pads_exchanged,
    whole_pad,
)
from dummydesign.measurement.campaign import Campaign, Trial, held_force
from dummydesign.measurement.ramp_detection import planned_velocity

ODD_Z, FITS_Z = 6.0, 4.0
"""Standard deviations from which a press is odd, and up to which another label fits it."""
LEAST_GAIN, GAIN_FLOOR = 0.05, 0.007
"""Least ln of the force by which a press must be odd, and the least scatter of it that is believed."""
ODD_SPEED = 0.18
"""ln of the speed by which a press differs from the sheet; robots keep theirs within 5 %."""
ODD_TARGET = 0.1
"""ln of the held over the planned force by which a press must be odd to be taken for another's."""
LEAST_ZERO_N, ZERO_FLOOR_N = 0.04, 0.01
LEAST_CUTOFF, CUTOFF_FLOOR, CUTOFF_KNOWN, SHOWN_TIMES = 0.3, 0.04, 0.25, 5.0
"""Least ln of the cut-off by which a sensor is another, least scatter, the standard error up to which it counts, and
how many times that of presses that show it well: where a filter hardly shows, what the model misses looks like one."""
MOST_CUTOFF = 1.6
"""Largest ln of the cut-off by which a sensor may be another: what asks for more is no filter."""
SAME_REPEAT = 0.5
"""Share of the change by which repeats must differ where one of them is of another sensor."""
LEAST_OF_IT = 0.35
"""Share of a press's oddness up to which another label must bring it."""
MISFIT = 4.0
"""Chi-square a bin over the largest of rightly labelled presses, up to which another label is held to fit."""
STUDENT, ROUNDS = 3.0, 40
"""Degrees of freedom of what scatters, so that odd presses do not draw the others, and rounds of its regression."""
GROUP_Z, SINGLE_Z = 4.7, 6.0
"""Difference of two groups of presses over the scatter within, from which they are two; where one is a single press."""
OWN_LEVEL, DAY_FIRST, GAPS = 1.0, 1.5, 3
"""How far a group's level may be off (N, or ln of a cut-off), how much clearer than a day other groups must be, and how
many of the widest gaps are looked at."""


@dataclass(frozen=True)
class TrialRegression:
    """What presses let expect of each other: coefficients with their covariance, and the scatter about them."""

    scale: float
    middle: NDArray
    covariance: NDArray

    def z(self, values: NDArray, columns: NDArray, error: NDArray | float = 0.0) -> NDArray:
        """Standard deviations by which values with errors differ from what is expected of presses of these columns."""
        spread = np.einsum("ti,ij,tj->t", columns, self.covariance, columns)
        return (values - columns @ self.middle) / np.sqrt(self.scale**2 + error**2 + spread)


def expect(
    values: NDArray, errors: NDArray, columns: NDArray, spreads: NDArray, floor: float, use: NDArray
) -> tuple[TrialRegression, NDArray]:
    """Regression on columns with normal priors and Student's t about it, of those values that are used; the scale is
    from the values themselves. Also the weights (T,)."""
    prior = np.diag(spreads**-2.0)
    scale = max(floor, 1.4826 * float(np.median(np.abs(values[use] - np.median(values[use])))))
    weight = 1.0 * use
    for _ in range(ROUNDS):
        strength = weight / (scale**2 + errors**2)
        covariance = np.linalg.inv((columns.T * strength) @ columns + prior)
        middle = covariance @ ((columns.T * strength) @ values)
        left = values - columns @ middle
        taken = float(np.einsum("ti,ij,tj,t->", columns, covariance, columns, strength))
        free = max(use.sum() - taken, 1.0) / use.sum()
        seen = np.median((np.abs(left) / np.sqrt(1.0 + (errors / scale) ** 2))[use])
        scale = max(floor, 0.7 * scale, 1.4826 * float(seen) / np.sqrt(free))
        weight = use * (STUDENT + 1.0) / (STUDENT + left**2 / (scale**2 + errors**2))
    return TrialRegression(scale, middle, covariance), strength


def odd(
    values: NDArray, errors: NDArray, columns: NDArray, spreads: NDArray, floor: float, use: NDArray
) -> tuple[NDArray, NDArray]:
    """Differences of each value from what the others let expect of it, and how many standard deviations they are."""
    differences, z = np.zeros(len(values)), np.zeros(len(values))
    near, strength = expect(values, errors, columns, spreads, floor, use)
    normal, inner = (columns.T * strength) @ columns + np.diag(spreads**-2.0), (columns.T * strength) @ values
    for row, own in enumerate(columns):
        covariance = np.linalg.inv(normal - strength[row] * np.outer(own, own))
        differences[row] = values[row] - own @ (covariance @ (inner - strength[row] * values[row] * own))
        z[row] = differences[row] / np.sqrt(near.scale**2 + errors[row] ** 2 + own @ covariance @ own)
    return differences, z


@dataclass(frozen=True)
class Labels:
    """What the sheet says of the presses and what they read.

    ``columns`` (T, n) are those by which gains may follow pad, depth, speed and circumstances, and ``spreads`` (n,) how
    far; pads ``between`` (T,) are expected to lie between others. ``ln_speed`` is ln of the measured over the declared
    speed, ``ln_target`` that of the held over the planned force (nan without one).
    """

    presses: Presses
    fit: CampaignFit
    gain: Own
    columns: NDArray
    spreads: NDArray
    between: NDArray
    ln_speed: NDArray
    ln_target: NDArray

    @property
    def gain_errors(self) -> NDArray:
        """Standard errors of the gains, of pads between others with what these leave open (T,)."""
        return np.hypot(self.gain.error, self.between * BETWEEN)


WIDE = np.array([10.0, 0.2, 0.2, 1.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.03])
"""How far ln of the force may follow, in the order of :func:`gain_columns`: level, depth over thickness and its square,
contact over depth, speed, temperature, age, rest, presses before, order."""
PAD_LEVEL, PAD_SLOPE = 0.3, 0.1
"""The same of a pad's own level and slope in depth."""
FEW, FEW_SHARE = 2, 0.34
"""A thickness that at most so many presses name, and that share of what is usual, is expected to lie between others."""
BETWEEN = 0.04
"""How well, in ln of the force."""
USUAL_SHARE, CONTACT_MM, SEEN_TO = 0.2, 0.05, 3
"""Depth over thickness and contact of usual size; of the deepest presses so many count as equally deep, so that none
is expected from others far away."""


def gain_columns(presses: Presses) -> tuple[NDArray, NDArray, NDArray]:
    """Columns (T, n) by which gains may follow what is declared of the presses, how far (n,), and which pads, in place
    of an own level, lie between others (T,)."""

    def centred(values: NDArray) -> NDArray:
        known = np.all(np.isfinite(values))
        return (values - values.mean()) / max(float(values.std()), 1e-9) if known else np.zeros(len(values))

    history = presses.history
    share = presses.depth_mm / presses.thickness_mm
    share = np.minimum(share, np.sort(share)[-min(SEEN_TO, len(share))]) / USUAL_SHARE - 1.0
    shared = [
        np.ones(len(share)),
        share,
        share**2,
        CONTACT_MM / presses.depth_mm,
        np.log(presses.velocity_mm_s / presses.velocity_mm_s.mean()),
        centred(history.temperature_C),
        centred(np.log(np.maximum(history.age_days, 1e-2))),
        centred(np.log(np.maximum(history.rest_s, 1.0))),
        np.log1p((history.earlier_depth_mm > 0).sum(axis=1)),
        centred(history.sequence),
    ]
    counts = np.bincount(presses.pad)
    few = (counts <= FEW) & (counts <= FEW_SHARE * np.median(counts))
    known = np.flatnonzero(~few)
    thick = np.log(np.array([thickness for _, thickness in presses.pads]))
    order = known[np.argsort(thick[known], kind="stable")]
    own = []
    for pad in known:
        level = 1.0 * (np.arange(len(counts)) == pad)
        level[few] = np.interp(thick[few], thick[order], 1.0 * (order == pad))
        own.append(level[presses.pad])
    spreads = np.r_[WIDE, np.full(len(own), PAD_LEVEL), np.full(len(own), PAD_SLOPE)]
    return np.stack([*shared, *own, *(one * share for one in own)], axis=1), spreads, few[presses.pad]


def labels_of(presses: Presses, fit: CampaignFit) -> Labels:
    """Read every press beside a base fit."""
    columns, spreads, between = gain_columns(presses)
    ramps = [press.ramp for press in presses.presses]
    declared = np.array([trial.velocity_mm_s for trial in presses.trials])
    speeds = [planned_velocity(ramp, planned) for ramp, planned in zip(ramps, declared)]
    held = [held_force(trial.trace, ramp) for trial, ramp in zip(presses.trials, ramps)]
    planned = np.array([trial.target_force_N or np.nan for trial in presses.trials])
    ln_target = np.log(np.maximum(held, 1e-6) / planned)
    speed = np.log(np.array(speeds) / declared)
    return Labels(presses, fit, gains(presses, fit), columns, spreads, between, speed, ln_target)


GROSS, GROSS_SHARE, REFITS = 0.2, 0.4, 3
"""ln of the force from which an odd press may have drawn the base fit, the share of the oddest one's that others must
have to be left out with it, and how often the base is fitted again."""
MOST = 0.4
"""Share of the presses up to which some may be in doubt: beyond, nobody knows which are right."""


def undrawn(presses: Presses, fit: CampaignFit, campaign: Campaign) -> tuple[Labels, NDArray]:
    """All presses beside a base fit without those that would draw it away from the others, and which it has (T,)."""
    labels, use = labels_of(presses, fit), np.ones(len(presses.trials), bool)
    for _ in range(REFITS):
        differences, z = odd_gains(labels, use)
        least = max(GROSS, GROSS_SHARE * float(np.abs(differences * use).max()))
        gross = (np.abs(differences) > least) & (np.abs(z) > FITS_Z) & use
        if not gross.any() or (gross | ~use).sum() > MOST * len(use):
            break
        use = use & ~gross
        labels = labels_of(presses, refitted(campaign, presses, use, fit)[2])
    return labels, use


def refitted(
    campaign: Campaign, presses: Presses, use: NDArray, fit: CampaignFit
) -> tuple[Campaign, Presses, CampaignFit]:
    """Some of the presses (T,), as a campaign and stacked, and their base fit."""
    kept = tuple(trial for trial, own in zip(presses.trials, use) if own)
    own, rest, _ = within_reach(replace(campaign, trials=kept), stack(kept, campaign.lowpass), fit.problem.law)
    return own, rest, fit_base(rest, fit.problem.law, fit.base.young_MPa, prior=fit.problem.prior)


def odd_gains(labels: Labels, use: NDArray) -> tuple[NDArray, NDArray]:
    """How odd the gain of each press is: ln of the force, and standard deviations."""
    own = use & ~labels.between
    return odd(labels.gain.value, labels.gain_errors, labels.columns, labels.spreads, GAIN_FLOOR, own)


def expected_gains(labels: Labels, use: NDArray) -> tuple[TrialRegression, NDArray]:
    """What the gains let expect of each other, and by which presses (T,)."""
    own = use & ~labels.between
    return expect(labels.gain.value, labels.gain_errors, labels.columns, labels.spreads, GAIN_FLOOR, own)[0], own


def as_pads(labels: Labels, use: NDArray) -> list[PadReading]:
    """All presses read as of each pad that more than a few presses name."""
    presses, shared = labels.presses, len(WIDE)
    near, own = expected_gains(labels, use)
    count = (len(labels.spreads) - shared) // 2
    out = []
    for number in np.unique(presses.pad[own]):
        first = int(np.flatnonzero(presses.pad == number)[0])
        pad = presses.trials[first]
        gain = gains(of_pads(presses, [pad] * len(presses.trials)), labels.fit)
        end = float(labels.columns[:, 1].max())
        share = np.minimum(presses.depth_mm / pad.thickness_mm / USUAL_SHARE - 1.0, end)
        level = labels.columns[first, shared : shared + count]
        columns = labels.columns.copy()
        columns[:, 1], columns[:, 2] = share, share**2
        columns[:, shared:] = np.concatenate([np.tile(level, (len(share), 1)), share[:, None] * level], axis=1)
        difference, z = gain.value - columns @ near.middle, near.z(gain.value, columns, gain.error)
        limit = labels.fit.problem.law.limit_of((pad,))
        out.append(PadReading(pad, difference, z, gain.left, presses.depth_mm <= BEYOND * float(np.min(limit))))
    return out


def doubts_of(campaign: Campaign, presses: Presses, fit: CampaignFit) -> tuple[Doubt, ...]:
    """Doubts about the labels of all presses of a campaign, from the base fit of those that its force law reaches."""
    labels, use = undrawn(presses, fit, campaign)
    looked = np.array([trial.confirmed for trial in presses.trials])
    found = pads_of_a_day(labels, use, looked)
    if found:
        use = ~np.isin(np.arange(len(use)), found[0].rows)
        labels = labels_of(presses, refitted(campaign, presses, use, fit)[2])
        looked = looked | ~use
    found += [*of_gains(labels, use, looked), *of_whole_pads(labels, use, looked, campaign)]
    rest = ~looked & ~np.isin(np.arange(len(looked)), [row for one in found for row in one.rows])
    return (*found, *of_sensors(labels, rest & use, campaign), *of_zeros(labels, ~looked))


TORN, SEVERAL = 0.05, 3
"""Scatter of the gains, or presses that would draw the base fit, from which two pads may have been taken for each other
for a whole day: single presses do not tell then, as no label is that of most presses of a pad."""


def pads_of_a_day(labels: Labels, use: NDArray, looked: NDArray) -> list[Doubt]:
    """Two pads taken for each other for a day: the likeliest pair, if it is by as much as if all scattered so much less
    (:data:`LEAST_OF_IT`)."""
    presses, every = labels.presses, np.ones(len(looked), bool)
    days = presses.history.age_days

    def unlikely(own: Labels) -> tuple[float, float]:
        """Minus the log likelihood of a press, and the scatter."""
        near, _ = expected_gains(own, every)
        z = near.z(own.gain.value, own.columns, own.gain_errors)
        return float(np.log(near.scale) + 0.5 * (STUDENT + 1.0) * np.mean(np.log1p(z**2 / STUDENT))), near.scale

    usual, torn = unlikely(labels)
    if torn < TORN and (~use).sum() < SEVERAL:
        return []
    tried: list[tuple[float, NDArray, Trial, Trial]] = []
    for day in np.unique(days[np.isfinite(days)]):
        for pair in combinations(np.unique(presses.pad[days != day]), 2):
            rows = (days == day) & np.isin(presses.pad, pair) & ~looked
            if rows.any() and rows.sum() <= MOST * len(rows):
                one, two = (presses.trials[int(np.argmax((presses.pad == pad) & (days != day)))] for pad in pair)
                other = {one.pad: two, two.pad: one}
                pads = [other[trial.pad] if own else trial for trial, own in zip(presses.trials, rows)]
                tried.append((unlikely(labels_of(of_pads(presses, pads), labels.fit))[0], rows, one, two))
    if not tried:
        return []
    left, rows, one, two = min(tried, key=lambda own: own[0])
    share = float(np.exp(left - usual))
    return [pads_exchanged(presses, rows, one, two, 1.0 / share)] if share < LEAST_OF_IT else []


LEAST_LEFT = 4
"""Presses that must remain where those in doubt are left out."""


def without_doubted(
    campaign: Campaign, presses: Presses, fit: CampaignFit, doubts: tuple[Doubt, ...]
) -> tuple[Campaign, Presses, CampaignFit]:
    """Campaign, presses and base fit without the presses in doubt; with them where too few would remain."""
    use = ~np.isin([trial.file for trial in presses.trials], [file for one in doubts for file in one.files])
    if use.all() or use.sum() < max(LEAST_LEFT, (1.0 - MOST) * len(use)):
        return campaign, presses, fit
    return refitted(campaign, presses, use, fit)


def of_gains(labels: Labels, use: NDArray, looked: NDArray) -> list[Doubt]:
    """Presses on another pad, exchanged, mistyped or at another speed."""
    presses = labels.presses
    differences, z = odd_gains(labels, use)
    gain_odd = (np.abs(z) > np.where(labels.between, FITS_Z, ODD_Z)) & (np.abs(differences) > LEAST_GAIN) & ~looked
    gain_odd &= ~_like_its_repeats(presses, differences, gain_odd)
    speed_odd = (np.abs(labels.ln_speed) > ODD_SPEED) & ~looked
    target_odd = _odd_target(labels) & ~looked
    pads = as_pads(labels, use) if gain_odd.any() else []
    usual = float(labels.gain.left[use & ~gain_odd].max(initial=1.0))
    taken = np.zeros(len(use), bool)
    out = []

    def fits(row: int, pad: PadReading) -> bool:
        near = abs(pad.z[row]) < FITS_Z or abs(pad.difference[row]) < LEAST_OF_IT * abs(differences[row]) * 0.5
        better = abs(pad.difference[row]) < LEAST_OF_IT * abs(differences[row])
        return bool(near and better and pad.reached[row] and pad.left[row] < MISFIT * usual)

    def has_label_of(row: int, other: int) -> bool:
        one, two = presses.trials[row], presses.trials[other]
        same = one.pad == two.pad
        if gain_odd[row] == same or not (same or any(p.pad.pad == two.pad and fits(row, p) for p in pads)):
            return False
        if abs(labels.ln_speed[row] + np.log(one.velocity_mm_s / two.velocity_mm_s)) > ODD_SPEED:
            return False
        if one.target_force_N and two.target_force_N and (target_odd[row] or target_odd[other]):
            usual_target = float(np.nanmedian(labels.ln_target[presses.pad == presses.pad[other]]))
            own = labels.ln_target[row] + np.log(one.target_force_N / two.target_force_N) - usual_target
            return abs(own) < max(3.0 * ODD_TARGET, 0.3 * abs(labels.ln_target[row] - usual_target))
        return True

    suspects = np.flatnonzero(gain_odd | speed_odd | target_odd)
    for one, two in combinations(suspects.tolist(), 2):
        if not (taken[one] or taken[two]) and has_label_of(one, two) and has_label_of(two, one):
            taken[[one, two]] = True
            worst = max(abs(float(z[one])), abs(float(z[two])))
            out.append(exchanged(presses, one, two, worst))
    for row in np.flatnonzero(gain_odd & ~taken).tolist():
        trial = presses.trials[row]
        options = [pad for pad in pads if pad.pad.pad != trial.pad and fits(row, pad)]
        best = min(options, key=lambda pad: abs(float(pad.z[row])), default=None)
        if best is not None:
            out.append(other_pad(presses, row, best, float(z[row])))
        elif (mm := _thickness_mm(pads, row)) is not None:
            out.append(mistyped(presses, row, mm, float(z[row])))
    for row in np.flatnonzero(speed_odd & ~taken).tolist():
        ln_speed = float(labels.ln_speed[row])
        out.append(other_speed(presses, row, ln_speed, ln_speed / ODD_SPEED * ODD_Z))
    return out


WHOLE_PAD, WHOLE_SPAN, THINNEST = 0.12, 3.0, 4.0
"""ln of the force by which all presses of a pad must differ from those of the others: at least, and over the
differences among these; and how many times that of the thinnest pad."""


def of_whole_pads(labels: Labels, use: NDArray, looked: NDArray, campaign: Campaign) -> list[Doubt]:
    """A pad whose thickness looks mistyped in all its rows.

    The thinnest must differ by more: what changes its force most (slip of its base, compressibility, an error of all
    thicknesses) is an effect, and looks the same.
    """
    presses = labels.presses
    near, own = expected_gains(labels, use)
    count = (len(labels.spreads) - len(WIDE)) // 2
    numbers = np.unique(presses.pad[own])
    if count < 3 or len(numbers) != count:
        return []
    levels, thick = near.middle[len(WIDE) : len(WIDE) + count], [presses.pads[number][1] for number in numbers]
    apart = []
    for place in range(count):
        others = np.delete(levels, place)
        differs = abs(float(levels[place] - np.median(others)))
        limit = max(WHOLE_PAD, WHOLE_SPAN * float(np.ptp(others)))
        apart.append(differs / limit / (1.0 if thick[place] > min(thick) else THINNEST))
    place = int(np.argmax(apart))
    rows = np.flatnonzero((presses.pad == numbers[place]) & ~looked)
    if apart[place] < 1.0 or len(rows) == 0:
        return []
    rest = use & (presses.pad != numbers[place])
    pads = as_pads(labels_of(presses, refitted(campaign, presses, rest, labels.fit)[2]), rest)
    seen = [mm for row in rows.tolist() if (mm := _thickness_mm(pads, row)) is not None]
    z = float(levels[place] - np.median(np.delete(levels, place))) / near.scale
    return [whole_pad(presses, rows, float(np.median(seen)) if seen else None, z)]


def _like_its_repeats(presses: Presses, differences: NDArray, odd_ones: NDArray) -> NDArray:
    """Whether all repeats of an odd press differ as it does (T,): then it is no label, but what they have in common."""
    out = np.zeros(len(differences), bool)
    for row in np.flatnonzero(odd_ones):
        same = np.flatnonzero((presses.cell == presses.cell[row]) & (np.arange(len(out)) != row))
        own = differences[row]
        out[row] = len(same) > 0 and bool(np.all(np.abs(differences[same] - own) < 0.5 * abs(own)))
    return out


def _odd_target(labels: Labels) -> NDArray:
    """Whether the force held is another than planned, by what is usual on the pad (T,)."""
    out = np.zeros(len(labels.ln_target), bool)
    for pad in np.unique(labels.presses.pad):
        own = (labels.presses.pad == pad) & np.isfinite(labels.ln_target)
        if own.sum() > FEW:
            left = labels.ln_target[own] - np.median(labels.ln_target[own])
            scale = max(1.4826 * float(np.median(np.abs(left))), 0.3 * ODD_TARGET)
            out[own] = (np.abs(left) > ODD_Z * scale) & (np.abs(left) > ODD_TARGET)
    return out


def _thickness_mm(pads: list[PadReading], row: int) -> float | None:
    """Thickness of which the force of a press is expected, by those of the pads; None where it is none. [mm]"""
    reached = [pad for pad in pads if pad.reached[row] and pad.pad.pad[0] == ""]
    if len(reached) < 2:
        return None
    thick = np.log([pad.pad.thickness_mm for pad in reached])
    ends = np.argsort([abs(float(pad.difference[row])) for pad in reached])[:2]
    (a, b), (left, right) = thick[ends], (float(reached[end].difference[row]) for end in ends)
    if left == right:
        return None
    at = a - left * (b - a) / (right - left)
    inside = thick.min() - BEYOND_PADS < at < thick.max() + BEYOND_PADS
    return float(np.exp(at)) if inside else None


BEYOND_PADS = 1.2
"""ln of the thickness by which a press may be of a pad beyond all others."""


def groups(
    values: NDArray, errors: NDArray, days: NDArray, floor: float, least: float, columns: NDArray, spreads: NDArray
) -> OddGroup | None:
    """The presses that are another group than the rest, if any are.

    Those of a day, or those beyond one of the widest gaps, have a level of their own beside what values follow
    (``columns``, see :func:`expect`). None where it differs by less than ``least`` or :data:`GROUP_Z` times the scatter
    within.
    """
    known = np.isfinite(errors)
    if known.sum() < 5:
        return None
    errors = np.where(known, errors, 1.0)
    sure = 1.0 / (floor**2 + errors[known] ** 2)
    left = values - columns @ expect(values, errors, columns, spreads, floor, known)[0].middle
    tried = [(days == day, True) for day in np.unique(days[np.isfinite(days)])]
    for order, one in ((np.flatnonzero(known)[np.argsort(one[known], kind="stable")], one) for one in (values, left)):
        widest = np.argsort(-np.diff(one[order]), kind="stable")[:GAPS]
        tried += [(np.isin(np.arange(len(known)), order[: place + 1]), False) for place in widest]
    found = []
    for rows, of_day in tried:
        counts = (rows & known).sum(), (~rows & known).sum()
        if min(counts) < 1 + of_day:
            continue
        both = np.c_[columns, rows]
        near, _ = expect(values, errors, both, np.r_[spreads, OWN_LEVEL], floor, known)
        within, apart = (values - both @ near.middle)[known], float(near.middle[-1])
        wide = (float(np.average(squares, weights=sure)) for squares in (within**2, errors[known] ** 2))
        scatter = max(floor, 1.4826 * float(np.median(np.abs(within))), *(float(np.sqrt(one)) for one in wide))
        error = float(np.sqrt(near.covariance[-1, -1]))
        # a day is chosen before it is seen: its mean counts, where a split by value must leave two heaps
        scatter = 1.25 * scatter * error / near.scale if of_day else max(scatter, error)
        if abs(apart) > max(least, (SINGLE_Z if min(counts) == 1 else GROUP_Z) * scatter):
            other = ~rows if of_day else ~rows & known
            few = (rows, apart) if counts[0] <= counts[1] else (other, -apart)
            found.append(OddGroup(*few, abs(apart) / scatter, of_day))
    return max(found, key=lambda one: one.z * (DAY_FIRST if one.of_day else 1.0), default=None)


def of_sensors(labels: Labels, use: NDArray, campaign: Campaign) -> list[Doubt]:
    """Presses by a sensor of another filter."""
    presses = labels.presses
    own = cutoffs(presses, labels.fit, campaign.lowpass)
    # what the model misses may look like a filter
    error = own.error * np.sqrt(np.maximum(own.left, 1.0))
    shows = use & (error < CUTOFF_KNOWN) & (own.error < SHOWN_TIMES * np.quantile(own.error[use], 0.25))
    if shows.sum() < 5:
        return []
    # by pad and depth the model may be off in what looks like a filter
    columns = labels.columns[:, [0, 1, *range(len(WIDE), len(WIDE) + (len(labels.spreads) - len(WIDE)) // 2)]]
    spreads = np.r_[10.0, 0.3, np.full(columns.shape[1] - 2, 0.3)]
    days, errors = presses.history.age_days, np.where(shows, error, np.inf)
    found = groups(own.value, errors, days, CUTOFF_FLOOR, LEAST_CUTOFF, columns, spreads)
    if found is None or abs(found.apart) > MOST_CUTOFF:
        return []
    if not found.of_day:
        # a filter tells repeats apart; what all repeats have in common does not
        repeats = [shows & (presses.cell == presses.cell[row]) for row in np.flatnonzero(found.rows & shows)]
        apart = [
            np.median(own.value[one & found.rows]) - np.median(own.value[one & ~found.rows])
            for one in repeats
            if np.any(one & ~found.rows)
        ]
        alone = not any(one.sum() > 1 for one in repeats)
        if not alone and (not apart or min(gap / found.apart for gap in apart) < SAME_REPEAT):
            return []
    usual = campaign.lowpass.cutoff_hz if campaign.lowpass else UNDECLARED_HZ
    return [other_sensor(presses, found, usual * float(np.exp(found.apart)), usual)]


def of_zeros(labels: Labels, use: NDArray) -> list[Doubt]:
    """Presses of a day whose zero is another."""
    presses = labels.presses
    own = zeros(presses, labels.fit)
    # how far zeros scatter is seen; the noise of a hold, by which they would, is drawn by a zero that moved
    errors = np.where(use & np.isfinite(own.error), 0.0, np.inf)
    level = np.ones((len(errors), 1)), np.array([10.0])
    found = groups(own.value, errors, presses.history.age_days, ZERO_FLOOR_N, LEAST_ZERO_N, *level)
    return [] if found is None else [other_zero(presses, found)]

"""What a design is compared with: the tissue's ranges at each condition, the aim inside them, and people's peaks."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.core.serialise import Serialised
from dummydesign.design.request import NAGOYA_PROTOCOL, Protocol
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.settings import VerdictLimits, Weights, verdict_limits, weights_of
from dummydesign.measurement.motion import work_mJ
from dummydesign.tissue.model.maxwell_law import SETTLED_S, Parameters, law_named
from dummydesign.tissue.model.people_share import (
    CONFIDENCE,
    LARGE_FACTOR,
    Population,
    is_share,
    is_strict,
    share_of_aim,
    tolerance_factor,
)
from dummydesign.tissue.model.posterior import DRAWN, FARTHEST
from dummydesign.tissue.model.ranges import ForceRange, force_ranges
from dummydesign.tissue.model.subject import Subject, flatten, nest
from dummydesign.tissue.model.tissue import Tissue

# Half-widths of bands are never taken below 15 %: a single subject has no band, but distances from it need
# a scale on which a slab's unavoidable misfit still distinguishes better from worse.
NARROWEST = 0.15
HELD_FORCES = 60


@dataclass(frozen=True)
class Condition:
    """One press of the protocol: the range of the subjects, and the aim's own curve on the same times."""

    steady_force_N: float
    velocity_mm_s: float
    range: ForceRange
    aim: ForceRange
    # Energy of the rise, lowest and highest subject; NaN where a subject still moves when the range ends.
    energy_mJ: tuple[float, float] = (np.nan, np.nan)

    @property
    def aim_peak_N(self) -> float:
        """Peak of the aim. [N]"""
        return self.aim.peak_high_N

    @property
    def peak_half_width(self) -> float:
        """Half-width of the subjects' peaks in ln F."""
        return max(0.5 * float(np.log(self.range.peak_high_N / self.range.peak_low_N)), NARROWEST)


@dataclass(frozen=True)
class Targets:
    """A tissue, an aim, the conditions of the protocol, the score's weights for the aim and the verdict's limits."""

    tissue: Tissue
    aim: str
    parameters: Parameters
    conditions: tuple[Condition, ...]
    weights: Weights
    limits: VerdictLimits
    protocol: Protocol = NAGOYA_PROTOCOL
    sampling: Sampling = field(default_factory=Sampling)

    def depth_range_mm(self, force_N: NDArray) -> tuple[NDArray, NDArray]:
        """Depth of the stiffest and the softest subject at steady forces. [mm]"""
        if self.settled:
            return self.tissue.steady_depth_range(force_N)
        depth = self.subject_depths_mm(force_N)
        return depth.min(axis=0), depth.max(axis=0)

    def subject_depths_mm(self, force_N: NDArray) -> NDArray:
        """Depth of each subject at steady forces, shape (subjects, n). [mm]"""
        if self.settled:
            return law_named(self.tissue.law).steady_depths(self.tissue.parameter_sets, force_N)
        return self._held_mm(force_N)[:-1]

    def aim_depth_mm(self, force_N: NDArray) -> NDArray:
        """Depth of the aim at steady forces. [mm]"""
        if self.settled:
            return law_named(self.tissue.law).steady_depths([self.parameters], force_N)[0]
        return self._held_mm(force_N)[-1]

    @cached_property
    def drawn(self) -> tuple[Targets, ...]:
        """Targets of tissues that the data of this one allow, of the same test; empty where nothing can be drawn.

        One who is named is followed as he was measured: nothing is drawn. The bound of a share of people has it all.
        """
        if self.aim.lower().startswith("subject:") or is_share(self.aim):
            return ()
        return self.of_tissues(self.tissue.drawn(DRAWN), self.aim)

    def of_tissues(self, tissues: Sequence[Tissue], aim: str) -> tuple[Targets, ...]:
        """Targets of other tissues of the same law in the same test."""
        return make_each(tissues, aim, self.sampling, self.protocol, self.weights, self.limits)

    def subject_energies_mJ(self) -> NDArray:
        """Energy of the rise of each subject in each press, shape (subjects, presses); NaN as in a condition. [mJ]"""
        each = [energies_of([one.range], self.tissue.law, self.sampling)[0] for one in self.conditions]
        return np.stack(each, axis=-1)

    @cached_property
    def people(self) -> PeopleReadings | None:
        """People as the subjects of the tissue show them in the presses of the test; None where they do not.

        An inferred tissue has groups of subjects that its data allow. Of others the spread between the subjects is
        never taken as smaller than the errors of their own numbers; errors of inferred numbers, the same for all, are
        added.
        """
        if reason_of(self.tissue) is not None:
            return None
        grid = self.protocol.steady_grid_N
        views: tuple[Callable[[Targets], NDArray], ...] = (
            _peaks,
            lambda one: one.subject_energies_mJ(),
            lambda one: 1.0 / one.subject_depths_mm(grid),
        )
        if self.tissue.posterior(1):
            groups = self.drawn or self.of_tissues(self.tissue.posterior(DRAWN), "average")
            each = [Population.of_groups([view(one) for one in groups]) for view in views]
        else:
            moved = moved_tissues(self.tissue)
            others = self.of_tissues([one for _, one in moved], "average")
            kinds = [kind for kind, _ in moved]
            each = [with_errors(view(self), [view(one) for one in others], kinds) for view in views]
        return PeopleReadings(*[*each, Population.of(_peaks(self))])

    @cached_property
    def bounds(self) -> tuple[NDArray, NDArray, NDArray, str] | None:
        """The bound of an aim at a share of people; None for another aim.

        Peaks [N] and energies [mJ] above the share of people with 95 % confidence, in each press (c,); depths [mm]
        below which that share is not, at the steady forces of the test (g,); what the bound is, in words.
        """
        share = share_of_aim(self.aim)
        if share is None:
            return None
        people = self.people
        if people is None:
            raise InputError(
                f"aim = '{self.aim}': {reason_of(self.tissue)}; use average, safe-side or a tissue of several people",
                "not_enough_data",
                "subjects",
                len(self.tissue.subjects),
            )
        peak, energy, stiff = (each.bound(share) for each in (people.peak_N, people.energy_mJ, people.stiffness_per_mm))
        return peak, energy, 1.0 / stiff, f"the bound of {100 * share:g} % of people"

    @property
    def strict(self) -> bool:
        """Whether a pad may read no lower than any subject, or than the bound of a share of people."""
        return is_strict(self.aim)

    @property
    def settled(self) -> bool:
        """Whether the hold is so long that a steady force is the relaxed one; measured curves are at a hold's end."""
        if self.tissue.measured:
            return False
        return self.sampling.hold_s >= SETTLED_S or not self.parameters.gamma_N_per_mm3

    @cached_property
    def power(self) -> float:
        """Exponent of the subjects' steady force over depth, from the lowest to the highest force of the test."""
        ends = self.protocol.forces_N[0], self.protocol.forces_N[-1]
        return law_named(self.tissue.law).exponent_of(self.tissue.parameter_sets, *ends, self.sampling.hold_s)

    @property
    def parametric(self) -> bool:
        """Whether the tissue has parameters that a pad's can be compared with."""
        return not self.tissue.measured

    @property
    def depth_half_width(self) -> float:
        """Half-width of the steady-state range in ln depth, at the force a design has to reach."""
        stiff, soft = self.depth_range_mm(np.array([self.protocol.needed_N]))
        return max(0.5 * float(np.log(soft[0] / stiff[0])), NARROWEST)

    @cached_property
    def steady_gamma1_N_per_mm3(self) -> float:
        """What :func:`~dummydesign.design.scoring.score.steady_gamma1` gives for the aim itself."""
        if self.settled:
            return self.parameters.gamma1_N_per_mm3
        forces = np.array(self.protocol.forces_N)
        cube = self.aim_depth_mm(forces) ** self.power
        return float((cube * forces).sum() / (cube**2).sum())

    def steady_inside(self, force_N: NDArray, depth_mm: NDArray) -> NDArray:
        """Fraction of steady curves (..., n) that lies between the subjects, even over the forces (n,)."""
        stiff, soft = self.depth_range_mm(force_N)
        with np.errstate(invalid="ignore"):
            return ((depth_mm >= stiff - 1e-9) & (depth_mm <= soft + 1e-9)).mean(axis=-1)

    def _held_mm(self, force_N: NDArray) -> NDArray:
        """Depths (subjects and aim, ...) at which each still carries a force at the end of the hold. [mm]"""
        if self.tissue.measured:
            law, everyone = law_named(self.tissue.law), (*self.tissue.parameter_sets, self.parameters)
            motion = self.protocol.slow_mm_s, self.sampling.hold_s, self.sampling.deceleration_mm_s2
            return law.held_depths(everyone, np.asarray(force_N, float), *motion)
        known, depth = self._held_curves
        wanted = np.log(np.maximum(np.asarray(force_N, float), 1e-12))
        below = np.minimum(wanted - known[0], 0.0)
        slope = np.diff(depth[:, :2], axis=-1)[:, 0] / (known[1] - known[0])
        return np.array([np.exp(np.interp(wanted, known, row) + s * below) for row, s in zip(depth, slope)])

    @cached_property
    def _held_curves(self) -> tuple[NDArray, NDArray]:
        """ln force (k,) and ln depth (subjects and aim, k) at the end of the hold of the slowest ramp."""
        forces = np.geomspace(0.02 * self.protocol.forces_N[0], 12.0 * self.protocol.forces_N[-1], HELD_FORCES)
        everyone = (*self.tissue.parameter_sets, self.parameters)
        motion = self.sampling.hold_s, self.sampling.deceleration_mm_s2
        depth = law_named(self.tissue.law).held_depths(everyone, forces, self.protocol.slow_mm_s, *motion)
        return np.log(forces), np.log(depth)


def make_targets(tissue: Tissue, aim: str, sampling: Sampling, protocol: Protocol = NAGOYA_PROTOCOL) -> Targets:
    """Compute the ranges of a tissue at every condition of the protocol."""
    return make_each((tissue,), aim, sampling, protocol)[0]


def make_each(
    tissues: Sequence[Tissue],
    aim: str,
    sampling: Sampling,
    protocol: Protocol,
    weights: Weights | None = None,
    limits: VerdictLimits | None = None,
) -> tuple[Targets, ...]:
    """The :func:`make_targets` of several tissues of one law, all subjects pressed at once."""
    if not tissues:
        return ()
    aims = [tissue.target(aim) for tissue in tissues]
    if weights is None:
        whole = weights_of(aim)
        weights = whole.without("parametric") if tissues[0].measured else whole
    limits = limits or verdict_limits()
    groups = [(*tissue.parameter_sets, parameters) for tissue, parameters in zip(tissues, aims)]
    conditions: list[list[Condition]] = [[] for _ in tissues]
    for velocity, force in product(protocol.velocities_mm_s, protocol.forces_N):
        bands = force_ranges(groups, force, velocity, sampling.hold_s, sampling.deceleration_mm_s2)
        subjects = [_part(band, slice(-1)) for band in bands]
        energies = energies_of(subjects, tissues[0].law, sampling)
        for band, own, part, energy in zip(bands, conditions, subjects, energies):
            ends = float(energy.min()), float(energy.max())
            own.append(Condition(force, velocity, part, _part(band, slice(-1, None)), ends))
    return tuple(
        Targets(tissue, aim, parameters, tuple(own), weights, limits, protocol, sampling)
        for tissue, parameters, own in zip(tissues, aims, conditions)
    )


def energies_of(bands: Sequence[ForceRange], law: str, sampling: Sampling) -> list[NDArray]:
    """Return the energy of the rise of each subject of several ranges of one speed, in ramp and hold. [mJ]"""
    from dummydesign.tissue.model.laws import ramps_of

    motion = sampling.motion(bands[0].velocity_mm_s, np.concatenate([band.depth_mm for band in bands]))
    curves = [(band.time_s, curve) for band in bands for curve in band.curves_N]
    forces = np.array([np.interp(at, *curve) for at, curve in zip(motion.time_s, curves)])
    displacement = motion.displacement_mm
    if law_named(law).ideal_ramp:
        contact, stop, depth = (values[:, None] for values in ramps_of(motion))
        displacement = depth * np.clip((motion.time_s - contact) / (stop - contact), 0.0, 1.0)
    parts = np.split(work_mJ(displacement, forces), np.cumsum([len(band.stop_s) for band in bands])[:-1])
    return [np.where(band.stop_s <= band.time_s[-1], part, np.nan) for band, part in zip(bands, parts)]


def _part(band: ForceRange, chosen: slice) -> ForceRange:
    """Some curves of a range with their own envelope: the aim's is no part of the subjects'."""
    curves = band.curves_N[chosen]
    ends = {"low_N": curves.min(axis=0), "high_N": curves.max(axis=0)}
    return replace(band, curves_N=curves, depth_mm=band.depth_mm[chosen], stop_s=band.stop_s[chosen], **ends)


SHARED = ("inferred", "assumed")
"""Kinds of numbers whose error is common to all subjects; the others err on their own."""
ENOUGH = (15, 40)
"""Numbers of subjects whose factor is named beside a large one."""
ONE, SPRING = "one subject does not show how people differ", "a spring constant says nothing of the peaks of people"


@dataclass(frozen=True)
class PeopleReadings:
    """People's peaks and energies in the c presses of a test, and their stiffness 1 / depth at its g steady forces.

    ``stated`` are the peaks as if the subjects were known exactly. Shapes (c,), (c,), (g,) and (c,).
    """

    peak_N: Population
    energy_mJ: Population
    stiffness_per_mm: Population
    stated: Population


@dataclass(frozen=True)
class ShareBelow(Serialised):
    """Expected share of people whose peak is at most the pad's, and the 90 % interval of the true share.

    ``below_expected_if_exact`` is the expected share if the subjects were known exactly. None where out of reach.
    """

    steady_force_N: float
    velocity_mm_s: float
    below_expected: float | None
    below_90: tuple[float, float] | None
    below_expected_if_exact: float | None


@dataclass(frozen=True)
class PeopleShares(Serialised):
    """The share of people below the pad's peak in each press; none, with the reason, where subjects do not say it."""

    subjects: int
    conditions: tuple[ShareBelow, ...]
    inferred: bool = False
    reason: str | None = None


def reason_of(tissue: Tissue) -> str | None:
    """Why the subjects of a tissue say nothing of people; None where they do."""
    law = law_named(tissue.law)
    if not (law.fitted or law.measured):
        return SPRING
    return ONE if len(tissue.subjects) < 2 else None


def with_errors(readings: NDArray, moved: Sequence[NDArray], kinds: Sequence[str]) -> Population:
    """Population of subjects (n, ...) with the errors of their numbers, from the readings with one number moved."""
    own, shared = np.zeros(readings.shape[1:]), np.zeros(readings.shape[1:])
    for kind, other in zip(kinds, moved):
        square = np.mean(np.log(other / readings) ** 2, axis=0)
        own, shared = (own, shared + square) if kind in SHARED else (own + square, shared)
    return Population.of(readings, np.sqrt(own), np.sqrt(shared))


def moved_tissues(tissue: Tissue) -> list[tuple[str, Tissue]]:
    """The tissue with one number of every subject moved by its standard deviation, and the kind of that number."""
    if tissue.measured:
        return []
    rows = [flatten(subject.numbers) for subject in tissue.subjects]
    tissues = []
    # subjects may have been pressed at speeds of their own
    for key in dict.fromkeys(key for row in rows for key in row):
        known = [row[key] for row in rows if key in row]
        if all(number.low == number.high for number in known):
            continue
        subjects = tuple(
            Subject.of(subject.name, subject.parameters.law, nest({**row, key: _one_deviation_up(row[key])}))
            if key in row
            else subject
            for subject, row in zip(tissue.subjects, rows)
        )
        kinds = {number.kind for number in known}
        tissues.append((SHARED[0] if kinds & set(SHARED) else "fitted", replace(tissue, subjects=subjects)))
    return tissues


def _one_deviation_up(number: Quantity) -> Quantity:
    width = math.log(number.high / max(number.low, 1e-9 * number.high)) / (2.0 * HALF_WIDTH)
    return replace(number, value=number.value * math.exp(min(width, FARTHEST)))


def _peaks(targets: Targets) -> NDArray:
    """Peak of each subject in each press, shape (subjects, c). [N]"""
    return np.stack([one.range.curves_N.max(axis=-1) for one in targets.conditions], axis=-1)


def shares_below(targets: Targets, peak_N: NDArray) -> PeopleShares:
    """Return the share of people below the peaks (c,) of a pad in the presses of a test; NaN is out of reach."""
    people, tissue = targets.people, targets.tissue
    if people is None:
        return PeopleShares(len(tissue.subjects), (), is_inferred(tissue), reason_of(tissue))
    peak = np.asarray(peak_N, float)
    expected, exact = people.peak_N.expected_below(peak), people.stated.expected_below(peak)
    low, high = people.peak_N.interval_below(peak)
    rows = []
    for at, one in enumerate(targets.conditions):
        test, span = (one.steady_force_N, one.velocity_mm_s), (float(low[at]), float(high[at]))
        rows.append(
            ShareBelow(*test, float(expected[at]), span, float(exact[at]))
            if np.isfinite(peak[at])
            else ShareBelow(*test, None, None, None)
        )
    return PeopleShares(len(tissue.subjects), tuple(rows), is_inferred(tissue))


def is_inferred(tissue: Tissue) -> bool:
    """Whether a number of a subject is inferred."""
    return "inferred" in tissue.kinds


def people_warnings(targets: Targets) -> list[tuple[str, str]]:
    """Say how large the bound of a share of people is, and why; nothing for another aim."""
    if not is_share(targets.aim):
        return []
    bounds, people, share = targets.bounds, targets.people, share_of_aim(targets.aim)
    assert bounds is not None and people is not None and share is not None
    count = len(targets.tissue.subjects)
    highest = np.array([one.range.peak_high_N for one in targets.conditions])
    exact = float(np.max(people.stated.bound(share) / highest))
    factor = tolerance_factor(count, share)
    others = ", ".join(f"{tolerance_factor(n, share):.2f} with {n}" for n in ENOUGH if n > count)
    ratio = float(np.max(bounds[0] / highest))
    text = (
        f"peaks above {100 * share:g} % of people ({100 * CONFIDENCE:g} % confidence) are up to {ratio:.2f} times the "
        f"highest subject's: {factor:.2f} standard deviations above the mean of {count} subjects"
    )
    if factor > LARGE_FACTOR and others:
        text += f", a large number ({others})"
    if ratio > 1.02 * exact:
        text += f"; {exact:.2f} times if these subjects were measured ('dummydesign tissues add')"
    return [("people_bound", text)]

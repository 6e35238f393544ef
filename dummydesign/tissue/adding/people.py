"""A tissue of people's presses: by a law where it follows them, else as they were measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.serialise import Serialised
from dummydesign.measurement.importing.press_checks import copies_among
from dummydesign.measurement.motion import work_mJ
from dummydesign.measurement.ramp_detection import find_ramp
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.adding.observations import HELD_S
from dummydesign.tissue.fitting.fit import TissueFit, fit_traces, subject_from_fit
from dummydesign.tissue.fitting.problem import fitted_force
from dummydesign.tissue.fitting.reduction import ReducedTrace, condition_groups, reduce_trace, speed_groups
from dummydesign.tissue.model.laws import CURVES
from dummydesign.tissue.model.maxwell_law import DEFAULT
from dummydesign.tissue.model.measured_curves import DEPTH_MM, FIRST_HOLD_S, SHARES, HeldPress, MeasuredPerson
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE
from dummydesign.tissue.model.tissue import Subject, Tissue, same_shape, share_a_speed
from dummydesign.tissue.model.tissue_file import subjects_of

AUTO, NONE = "auto", "none"
"""Laws of a tissue: the default one where it follows the people, and their curves."""
LEAST_RISE = 20
"""Samples of a rise from which on it is smoothed."""
WINDOW, ORDER = 5, 2
"""Samples and degree of the parabolas that smooth a rise; at its ends the outer parabola goes on."""
HOLD_BINS, LATE = 40, 0.05
"""Bins of the hold, even in the logarithm of time, and the last share of it that its end is the mean of."""


def held_press(trace: ReducedTrace, velocity_mm_s: float) -> HeldPress:
    """Rise at shares of the depth, and means of the hold in bins of time."""
    time, force, x = trace.trace.time_s, trace.trace.force_N, trace.trace.displacement_mm
    ramp = trace.ramp
    rise = (time >= ramp.contact_time_s) & (time <= ramp.stop_time_s)
    rising = _smooth(time[rise], force[rise])
    share, first = np.unique(np.maximum.accumulate(np.clip(x[rise] / ramp.depth_mm, 0.0, 1.0)), return_index=True)
    stop, inner = _at_stop(x[rise], rising, ramp.depth_mm), share < 1.0
    curve = np.interp(SHARES, np.r_[share[inner], 1.0], np.r_[rising[first][inner], stop])
    held = trace.inside[time[trace.inside] > ramp.stop_time_s]
    when, mean = _bins(time[held] - ramp.stop_time_s, force[held], trace.hold_s)
    if not trace.steady_force_N > 0.0:
        message = f"{trace.trace.name}: the force at the end of the hold is {trace.steady_force_N:.3g} N"
        raise InputError(message, "out_of_range", "steady_force_N", float(trace.steady_force_N))
    carried = np.r_[stop, mean, trace.steady_force_N]
    return HeldPress(float(velocity_mm_s), float(ramp.depth_mm), curve, np.r_[0.0, when, trace.hold_s], carried)


def _smooth(time: NDArray, force: NDArray) -> NDArray:
    """Parabolas through five even samples; where there are few or uneven ones, the samples."""
    step = np.diff(time)
    if len(time) < LEAST_RISE or step.max() > 1.2 * step.min():
        return force
    from scipy.signal import savgol_filter

    return savgol_filter(force, WINDOW, ORDER, mode="interp")


def _at_stop(x: NDArray, force: NDArray, depth_mm: float) -> float:
    """Force at the stop, extrapolated over depth from the last two samples by less than their step. [N]"""
    step = np.diff(x[-2:])
    if len(step) == 0 or step[0] <= 0.0:
        return float(force[-1])
    # over time it would miss that the robot brakes
    return float(force[-1] + (force[-1] - force[-2]) * np.clip((depth_mm - x[-1]) / step[0], 0.0, 1.0))


def _bins(since_s: NDArray, force_N: NDArray, hold_s: float) -> tuple[NDArray, NDArray]:
    """Mean time and force of the bins that hold a sample, before the last twentieth. [s, N]"""
    edges = np.r_[0.0, np.geomspace(FIRST_HOLD_S, (1.0 - LATE) * hold_s, HOLD_BINS)]
    bin_number = np.digitize(since_s, edges)
    kept = [row for number in range(1, len(edges)) if len(row := np.flatnonzero(bin_number == number))]
    return np.array([since_s[row].mean() for row in kept]), np.array([force_N[row].mean() for row in kept])


PEAK, STEADY, ENERGY = range(3)
ENERGY_TOLERANCE = 0.02
"""Share of an energy within which the verdict does not tell two apart."""
FOLLOWS = 2.0
"""Misfit over the scatter of repeats up to which a law follows the curves."""


@dataclass(frozen=True)
class Misfit(Serialised):
    """What a law misses of one person's peaks, steady forces and energies, and what repeats differ by; rms in percent.

    ``repeats`` is whether presses were repeated; else the scatter is that of depth and noise.
    """

    subject: str
    misfit_percent: float
    scatter_percent: float
    repeats: bool
    ratio: float
    also: ClassVar[tuple[str, ...]] = ("follows",)

    @property
    def follows(self) -> bool:
        """Whether the law is taken."""
        return self.ratio <= FOLLOWS

    @property
    def words(self) -> str:
        """Both numbers."""
        by = "repeats scatter by" if self.repeats else "depth and noise make"
        return f"{self.subject} by {self.misfit_percent:.1f} % ({by} {self.scatter_percent:.1f} %)"


def misfit_of(subject: str, fit: TissueFit, person: MeasuredPerson) -> Misfit:
    """Hold a fitted law against peaks, steady forces and energies of the presses it was fitted to."""
    traces, forces = [], []
    for problem, optimum in fit.problems:
        traces += problem.traces
        forces += [_of_model(trace, fitted_force(problem, optimum, k)) for k, trace in enumerate(problem.traces)]
    measured = np.array([_measured(trace) for trace in traces])
    off = np.log(np.array(forces) / measured)
    noise = float(fit.result["noise_floor_N"] or 0.0) / measured
    noise[:, ENERGY] = 0.0
    depth = np.array([trace.ramp.depth_mm for trace in traces])
    around = [person.steady_N(one * np.array([0.9, 1.1]), np.inf) for one in depth]
    steady = np.array([np.log(high / low) / np.log(1.1 / 0.9) for low, high in around])
    exponent = np.column_stack([steady, steady, steady + 1.0])
    expected = np.hypot(exponent * (0.5 * DEPTH_MM / depth)[:, None], noise)
    scatter = _of_repeats(traces)
    if scatter is not None:
        expected = np.full_like(expected, scatter)
    least = np.tile((STEADY_TOLERANCE, STEADY_TOLERANCE, ENERGY_TOLERANCE), (len(traces), 1))
    least[:, PEAK] *= measured[:, STEADY] / measured[:, PEAK]
    expected = np.maximum(expected, least)
    return Misfit(subject, 100.0 * _rms(off), 100.0 * _rms(expected), scatter is not None, _rms(off / expected))


def _measured(trace: ReducedTrace) -> NDArray:
    """Peak, steady force and energy of a press, smoothed as curves are. [N, N, mJ]"""
    press = held_press(trace, trace.velocity_mm_s)
    return np.array(
        [
            max(press.rise_N.max(), press.hold_N.max()),
            trace.steady_force_N,
            work_mJ(SHARES * press.depth_mm, press.rise_N),
        ]
    )


def _of_model(trace: ReducedTrace, force_N: NDArray) -> NDArray:
    """The same of a model's force at the nodes of the press."""
    time, x = trace.motion.time_s, trace.motion.displacement_mm
    late_s, rise = trace.ramp.hold_end_s - trace.hold_s * np.linspace(0.0, LATE, 9), time <= trace.ramp.stop_time_s
    return np.array([force_N.max(), np.interp(late_s, time, force_N).mean(), work_mJ(x[rise], force_N[rise])])


def _of_repeats(traces: Sequence[ReducedTrace]) -> float | None:
    """Standard deviation of repeats' peaks, steady forces and energies over their mean, pooled; None without."""
    repeats = [np.log([_measured(one) for one in group]) for _, _, group in condition_groups(traces) if len(group) > 1]
    squares = sum(float(((values - values.mean(axis=0)) ** 2).sum()) for values in repeats)
    return float(np.sqrt(squares / sum(3 * (len(values) - 1) for values in repeats))) if repeats else None


def _rms(values: NDArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


FASTER, SLOWER = 1.3, 3.0
"""Factors beyond which a press did not move as commanded; a shallow one that brakes all the way is at half."""


def people_tissue(
    name: str,
    read: dict[str, list[Trace]],
    sources: dict[str, str],
    law: str,
    elements: str,
    lowpass: Lowpass | None = None,
    others: Sequence[Subject] = (),
) -> tuple[Tissue, dict[str, Any]]:
    """Make a tissue of people's traces and of subjects fitted before; also return what the answer says of it."""
    if others and law == NONE:
        raise InputError(
            f"--law none keeps curves, and {others[0].name} is a fit; give the traces", "inconsistent", "law", law
        )
    warnings = copies_of(read)
    held, short, unlike = _check_presses(read)
    groups = {who: speed_groups([reduce_trace(trace) for trace in own]) for who, own in held.items()}
    people = {
        who: MeasuredPerson([held_press(trace, speed) for speed, group in own for trace in group])
        for who, own in groups.items()
    }
    if law != NONE and people:
        share_a_speed({who: one.velocities_mm_s for who, one in people.items()})
    form = DEFAULT if law == AUTO else law
    fits = {} if law == NONE else fit_people(held, form, elements, lowpass, intervals=law != AUTO)
    misfits = [misfit_of(who, fit, people[who]) for who, fit in fits.items()]
    missed = [one for one in misfits if not one.follows]
    by_law = bool(others) or (law != NONE and not (law == AUTO and missed))
    if by_law and law == AUTO:
        fits = fit_people(held, form, elements, lowpass)
    rows = [fit_row(who, sources[who], fit) for who, fit in fits.items()]
    if not by_law:
        kept = {who: f"curves of {sources[who]}, {len(one.presses)} presses of {who}" for who, one in people.items()}
        named = [(who, one, "measured", kept[who]) for who, one in people.items()]
        subjects, notice = subjects_of(named), CURVES.notice_of("This tissue")[1]
        title = f"{len(subjects)} subject{'s' if len(subjects) > 1 else ''}, measured curves"
        tissue = Tissue(name, title, CURVES.name, subjects, (), (f"{notice}.",), "user")
    else:
        tissue = tissue_of_fits(name, fits, others)
        warnings += [warning for who, fit in fits.items() for warning in fit_warnings(who, fit)]
    speeds = ", ".join(f"{v:g}" for v in tissue.velocities_mm_s)
    notes = (
        (
            unlike,
            "speed_unlike_told",
            f"velocity_mm_s is not how these moved: {'; '.join(unlike)}; they count at the speed in the table",
        ),
        (
            missed,
            "law_does_not_follow",
            "the law does not follow the curves: it misses peaks, steady forces and energies (rms) of "
            f"{', '.join(one.words for one in missed)}{'; --law none keeps the curves' if by_law else ''}",
        ),
        (short, "hold_too_short", f"left out, held for less than {HELD_S:g} s: {', '.join(short)}"),
        (
            len(tissue.subjects) < 2,
            "one_subject",
            f"{name} has one subject, who makes no range: nothing can be inside it",
        ),
        (
            len(tissue.velocities_mm_s) == 1,
            "one_speed",
            f"{name} is known at {speeds} mm/s only: give --velocity {speeds} where a pad is made for it",
        ),
    )
    warnings += [] if missed and by_law else tissue.warnings
    warnings += [{"code": code, "message": text} for seen, code, text in notes if seen]
    return tissue, {"fits": rows, "law_misfit": [one.to_dict() for one in misfits], "warnings": warnings}


def _check_presses(read: dict[str, list[Trace]]) -> tuple[dict[str, list[Trace]], list[str], list[str]]:
    """Return presses that were held to a steady force, the others, and those that moved unlike their speed."""
    held: dict[str, list[Trace]] = {who: [] for who in read}
    short, unlike = [], []
    for who, own in read.items():
        for trace in own:
            ramp = find_ramp(trace.time_s, trace.displacement_mm)
            name = trace.name.removesuffix(".csv").replace("_", " ")
            if ramp.hold_end_s - ramp.stop_time_s < HELD_S:
                short.append(f"{who}: {name}")
                continue
            held[who].append(trace)
            seen = ramp.speed
            declared = trace.commanded_speed_mm_s or seen.value_mm_s
            if not (declared / SLOWER < seen.high_mm_s and seen.low_mm_s < FASTER * declared):
                unlike.append(f"{who}, {name}: {seen.value_mm_s:.2g} for {declared:g} mm/s")
    none = [who for who, own in held.items() if not own]
    if none:
        raise InputError(
            f"no press of {', '.join(none)} is held for {HELD_S:g} s, so the steady force is not known; give the hold "
            "with its times, or depths at steady forces by 'dummydesign tissues add-points'",
            "not_enough_data",
            "hold_s",
        )
    return held, short, unlike


def fit_people(
    read: dict[str, list[Trace]], law: str, elements: str, lowpass: Lowpass | None = None, intervals: bool = True
) -> dict[str, TissueFit]:
    """Fit the law to each person's traces, per speed."""
    options = law, "per-speed", lowpass, intervals
    return {person: fit_traces(traces, int(elements), *options) for person, traces in read.items()}


def fit_row(person: str, source: str, fit: TissueFit) -> dict[str, Any]:
    """Return the row of an answer on a fit."""
    return {"subject": person, "from": source, **{key: fit.result[key] for key in ("rmse_N", "max_residual_N")}}


def fit_warnings(person: str, fit: TissueFit) -> list[dict[str, str]]:
    """Return the warnings of a fit with the person's name; copies are found by :func:`copies_of`."""
    own = [warning for warning in fit.result["warnings"] if warning["code"] != "same_press"]
    return [{"code": w["code"], "message": f"{person}: {w['message']}"} for w in own]


def copies_of(read: dict[str, list[Trace]]) -> list[dict[str, str]]:
    """Warn of presses that are listed twice, over all subjects: one under two names counts twice."""
    return copies_among([replace(trace, name=f"{who}: {trace.name}") for who, own in read.items() for trace in own])


def tissue_of_fits(name: str, fits: dict[str, TissueFit], others: Sequence[Subject] = ()) -> Tissue:
    """Make the tissue of fitted subjects and others, by rising gamma1."""
    subjects = [*others, *(subject_from_fit(who, fit) for who, fit in fits.items())]
    names = [subject.name.lower() for subject in subjects]
    double = next((n for n in names if names.count(n) > 1), None)
    if double:
        raise InputError(f"subject '{double}' is listed twice; rename one file", "duplicate", "subject", double)
    same_shape(tuple(subjects))
    ordered = tuple(sorted(subjects, key=lambda s: s.parameters.gamma1_N_per_mm3))
    notes = ("Below the smallest steady force that was measured the band is the law extrapolated.",)
    title = f"{len(ordered)} subject{'s' if len(ordered) > 1 else ''}"
    return Tissue(name, title, ordered[0].parameters.law, ordered, (), notes, "user")

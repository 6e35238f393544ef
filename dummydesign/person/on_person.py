"""What presses on a pad would have been on people: each press, each subject, one more person, against limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.core.serialise import to_plain
from dummydesign.design.assessment.budget import Budget, Reading, UncertaintyComponent, decide
from dummydesign.measurement.importing.press_checks import copies_among, doubts_of
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.person.drives.drive import RobotDrive, TraceSigns, signs_of
from dummydesign.person.integrate import FOUR, PersonResponse, held_after
from dummydesign.person.limits import N_PER_CM2, ContactLoad, LimitRow, UserLimits, against_guarded_limits
from dummydesign.person.people import People, draw_another, draw_subject
from dummydesign.person.press import Press, read_press
from dummydesign.person.validity_range import Beyond, beyond_range
from dummydesign.tissue.model.tissue import Tissue

SEED, OTHERS, OWN = 61, 512, 120
"""Draws of one more person, and of each subject."""
ENDS = (0.025, 0.975)
SEEN_SAMPLES = 6.0
"""Samples a period from which on the ringing of an arm is followed."""
Interval = tuple[float | None, float | None]


@dataclass(frozen=True)
class PersonPress:
    """One press: on the pad, on every subject, on one more person.

    ``pad``, ``subjects`` and the intervals are by the names of :data:`~.integrate.FOUR`; ``factor`` is the lowest
    and highest subject's peak over the pad's, ``factor_95`` that of one more person.
    """

    press: Press
    response: PersonResponse
    pad: dict[str, float | None]
    subjects: tuple[dict[str, Any], ...]
    band: dict[str, Interval]
    interval: dict[str, Interval]
    factor: Interval
    factor_95: Interval
    signs: TraceSigns
    contradicted: str
    beyond: tuple[Beyond, ...]
    limits: tuple[LimitRow, ...]

    def to_dict(self, area_mm2: float) -> dict[str, Any]:
        """Return the press in the form of the contract."""

        def pressure(force: float | None) -> float | None:
            return None if force is None else force * N_PER_CM2 / area_mm2

        name = "mean_pressure_N_per_cm2"
        return to_plain(
            {
                "file": self.press.trace.name,
                "velocity_mm_s": self.press.velocity_mm_s,
                "contact_mm_s": float(self.press.contact_mm_s),
                "hold_s": self.press.hold_s,
                "pad": {**self.pad, name: pressure(self.pad["peak_N"])},
                "subjects": [{**one, name: pressure(one["peak_N"])} for one in self.subjects],
                "band": {**self.band, name: [pressure(end) for end in self.band["peak_N"]]},
                "interval_95": {**self.interval, name: [pressure(end) for end in self.interval["peak_N"]]},
                "factor_peak": list(self.factor),
                "factor_peak_95": list(self.factor_95),
                "limits": self.limits,
                "signs": self.signs,
                "drive_contradicted": self.contradicted or None,
                "beyond_range": self.beyond,
            }
        )


@dataclass(frozen=True)
class OnPerson:
    """All presses with the drive, the tissue and what was asked."""

    presses: tuple[PersonPress, ...]
    drive: RobotDrive
    tissue: Tissue
    area_mm2: float
    warnings: tuple[dict[str, str], ...]


def on_person(
    traces: Sequence[Trace],
    tissue: Tissue,
    drive: RobotDrive,
    *,
    limits: UserLimits | None = None,
    lowpass: Lowpass | None = None,
    area_mm2: float = 196.0,
    progress: Callable[[str], None] | None = None,
) -> OnPerson:
    """Work out what each press would have been on the subjects of a tissue and on one more person.

    Parameters
    ----------
    traces : sequence of Trace
        One press each.
    tissue : Tissue
    drive : Drive
        What moves the robot.
    limits : Limits, optional
        Own limits of force and pressure.
    lowpass : Lowpass, optional
        Filter that the forces went through; it is undone.
    area_mm2 : float
        Of the punch. [mm2]
    progress : callable, optional
        Called with a word at each step.

    Raises
    ------
    InputError
        For a press, or a tissue, that the drive cannot carry over.
    """
    if not traces:
        raise InputError("no trace was given; give one or more TRACE.csv", "missing", "trace")
    pressed = []
    for number, trace in enumerate(traces):
        if progress is not None:
            progress(f"press {number + 1} of {len(traces)}")
        press = read_press(trace, lowpass, drive.arm)
        drive.check(press)
        doubt = drive.speed_doubt(press)
        press = drive.with_own_speed(press)
        pressed.append(_press_people(press, tissue, drive, limits, area_mm2, doubt))
    of_traces = [*(warning for trace in traces for warning in doubts_of(trace)), *copies_among(traces)]
    return OnPerson(tuple(pressed), drive, tissue, area_mm2, (*of_traces, *_of_presses(pressed, drive, tissue)))


def _press_people(
    press: Press, tissue: Tissue, drive: RobotDrive, limits: UserLimits | None, area_mm2: float, doubt: str
) -> PersonPress:
    """Press subjects and draws, and judge."""
    names, rng = [one.name for one in tissue.subjects], np.random.default_rng(SEED)
    pad = {name: None if value is None else float(np.mean(value)) for name, value in drive.on_pad(press).items()}
    if tissue.measured:
        response = drive.on_curves(press, tissue.parameter_sets)
        another, own, pads = _of_few(response), {}, np.full(1, pad["peak_N"])
    else:
        speed, count = press.velocity_mm_s, len(names)
        people = People.of(tissue.parameter_sets, speed)
        response = drive.respond(press, people)
        drawn = [draw_another(tissue, speed, OTHERS, rng)]
        drawn += [draw_subject(tissue, row, speed, OWN, rng) for row in range(count)]
        everyone = People(
            people.law, *(np.concatenate([getattr(one, part) for one in drawn]) for part in ("gamma1", "gamma", "c"))
        )
        pressed = press.drawn(len(everyone), rng)
        answer = drive.respond(pressed, everyone, keep=False)
        values = {**answer.four(), "held_N": answer.held_N}
        another = {name: value[:OTHERS] for name, value in values.items()}
        own = {name: value[OTHERS:].reshape(count, OWN) for name, value in values.items()}
        pads = pressed.peak_N[:OTHERS]
    beyond = tuple(beyond_range(tissue, response, press.velocity_mm_s))
    interval = {name: _ends(another[name]) for name in FOUR}
    band = {name: _outer(response.four()[name]) for name in FOUR}
    subjects = tuple(
        {
            "name": name,
            **{key: _number(value[row]) for key, value in response.four().items()},
            "interval_95": {key: _ends(own[key][row]) for key in FOUR} if own else None,
        }
        for row, name in enumerate(names)
    )
    signs = signs_of(press)
    rows: tuple[LimitRow, ...] = ()
    if limits is not None:
        rows = against_guarded_limits(_loads(press, response, another, own), limits, area_mm2, bool(beyond))
    low, high = (None if end is None else end / (pad["peak_N"] or np.nan) for end in band["peak_N"])
    return PersonPress(
        press,
        response,
        pad,
        subjects,
        band,
        interval,
        (low, high),
        _ends(another["peak_N"] / pads),
        signs,
        drive.contradicted(signs) or doubt,
        beyond,
        rows,
    )


def _loads(
    press: Press, response: PersonResponse, another: dict[str, NDArray], own: dict[str, NDArray]
) -> list[ContactLoad]:
    """Transient and quasi-static forces."""
    loads = []
    pads = {"transient": float(press.peak_N), "quasi-static": float(held_after(press.time_s, press.force_N[None])[0])}
    for kind, name, values in (("transient", "peak_N", response.peak_N), ("quasi-static", "held_N", response.held_N)):
        low, high = _ends(another[name])
        ends = [_ends(row)[0] for row in own[name]] if own else [_number(value) for value in values]
        known = tuple(end for end in ends if end is not None)
        loads.append(ContactLoad(kind, _number(pads[kind]) if known or high is not None else None, low, high, known))
    return loads


def _of_few(response: PersonResponse) -> dict[str, NDArray]:
    """Quantiles of one more person where people are curves: Student's prediction in logarithms, as two values."""
    from scipy.special import stdtrit

    rows = {}
    for name, values in {**response.four(), "held_N": response.held_N}.items():
        count = len(values)
        if count < 2 or not np.all(np.isfinite(values)):
            rows[name] = np.full(2, np.nan)
            continue
        logs = np.log(values)
        half = stdtrit(count - 1, ENDS[1]) * logs.std(ddof=1) * np.sqrt(1.0 + 1.0 / count)
        # quantiles of 0.025 and 0.975 of these many equal halves are their ends
        rows[name] = np.exp(logs.mean() + half * np.repeat([-1.0, 1.0], 20))
    return rows


def _ends(values: NDArray) -> Interval:
    """Ends of the 95 % interval of draws; None where they are not known."""
    known = values[np.isfinite(values)]
    if len(known) < 0.9 * len(values) or not len(known):
        return None, None
    # between these ranks of n draws lies one more draw in (n + 1) x 0.95 of n + 1 cases
    low, high = np.quantile(known, ENDS, method="weibull")
    return float(low), float(high)


def _outer(values: NDArray) -> Interval:
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if len(known) else (None, None)


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _of_presses(pressed: Sequence[PersonPress], drive: RobotDrive, tissue: Tissue) -> list[dict[str, str]]:
    """What the reader must know: a drive that does not fit, a range that is left, people who were not measured."""
    rows: list[tuple[str, str]] = []
    rows += [
        ("drive_mismatch", f"{one.press.trace.name}: the trace does not fit --drive {drive.text}: {one.contradicted}")
        for one in pressed
        if one.contradicted
    ]
    arm = drive.arm
    for one in pressed:
        file, step = one.press.trace.name, float(np.median(np.diff(one.press.trace.time_s)))
        if arm is not None and arm.period_s < SEEN_SAMPLES * step:
            own, least = 1.0 / arm.period_s, SEEN_SAMPLES / arm.period_s
            words = f"peaks are missing: the arm rings at {own:.3g} Hz; record at least {least:.0f} samples/s"
            rows.append(("arm_unseen", f"{file}: {words}"))
        elif arm is not None and one.press.rings and arm.damping_ratio == 0.0:
            words = "the arm still rings in the hold and is assumed undamped; give its damping ratio: "
            rows.append(("arm_rings", f"{file}: {words}--drive {drive.text},RATIO"))
    for one in pressed:
        if one.beyond:
            words = "; ".join(entry.text for entry in one.beyond)
            rows.append(("beyond_range", f"{one.press.trace.name}: extrapolated: {words}"))
    if "inferred" in tissue.kinds:
        rows.append(("inferred_tissue", f"the subjects of {tissue.name} are inferred, not measured"))
    if len(tissue.subjects) < 2:
        rows.append(("one_subject", "the interval is that of one subject; measure more people to see how they differ"))
    rows += [] if tissue.notice is None else [tissue.notice]
    return [{"code": code, "message": text} for code, text in rows]


OF_SUBJECTS, DIFFER = "subjects and trace", "differences among people"
NO_LIMIT = "no limit was given"
BEYOND = "the press goes beyond those on people by an unknown error"
# Quantity of the subjects' own intervals by the kind of a limit.
OF_KIND = {"transient": "peak_N", "quasi-static": "steady_N"}


def middle_and_spread(ends: Sequence[float | None] | None) -> tuple[float, float] | None:
    """Geometric middle of a 95 % interval, and the standard deviation of the logarithm; None where it is not known."""
    if ends is None or ends[0] is None or ends[1] is None or not 0.0 < ends[0] <= ends[1]:
        return None
    return math.sqrt(ends[0] * ends[1]), math.log(ends[1] / ends[0]) / (2.0 * HALF_WIDTH)


def budget_of_people(answer: OnPerson) -> Budget | None:
    """Make the budget of the reading that decides; None where no interval of people is known.

    With limits it is the check that is most probably not met, else the largest peak. The spread of one more person is
    that of the 95 % interval; the part of the subjects' own intervals in it, which holds the trace as well, is the root
    mean square over the subjects, the rest are differences among people.
    """
    limited = [(press, row) for press in answer.presses for row in press.limits]
    checks = [
        (press, row, known)
        for press, row in limited
        if (known := middle_and_spread((row.person_low_95, row.person_high_95)))
    ]
    if checks:
        press, row, known = max(checks, key=lambda one: math.log(one[2][0] / one[1].limit) / max(one[2][1], 1e-9))
        return _of_check(press, row, *known)
    peaks = [(press, known) for press in answer.presses if (known := middle_and_spread(press.interval["peak_N"]))]
    if not peaks or limited:
        return None
    press, (value, spread) = max(peaks, key=lambda one: one[1][0])
    reading = Reading(
        "peak force on one more person", value, "N", None, press.press.velocity_mm_s, press.press.trace.name
    )
    return Budget(reading, _components(press, "peak_N", spread), NO_LIMIT, None, doubt=BEYOND if press.beyond else "")


def _of_check(press: PersonPress, row: LimitRow, value: float, spread: float) -> Budget:
    quantity, _, kind = row.name.rpartition(" ")
    reading = Reading(
        f"{kind} {quantity} on one more person",
        value,
        row.unit,
        None,
        press.press.velocity_mm_s,
        press.press.trace.name,
    )
    decision = decide(value, (None, row.limit), (0.0, spread))
    requirement = f"{kind} {quantity} at most {row.limit:.4g} {row.unit}"
    doubt = BEYOND if press.beyond else ""
    return Budget(reading, _components(press, OF_KIND[kind], spread), requirement, decision, doubt=doubt)


def _components(press: PersonPress, quantity: str, spread: float) -> tuple[UncertaintyComponent, ...]:
    """Parts whose root sum of squares is the spread of one more person."""
    own = [middle_and_spread((one["interval_95"] or {}).get(quantity)) for one in press.subjects]
    known = [one[1] for one in own if one is not None]
    if not known:
        return UncertaintyComponent(OF_SUBJECTS, None), UncertaintyComponent(DIFFER, 100.0 * spread)
    mean = min(float(np.sqrt(np.mean(np.square(known)))), spread)
    return UncertaintyComponent(OF_SUBJECTS, 100.0 * mean), UncertaintyComponent(
        DIFFER, 100.0 * math.sqrt(spread**2 - mean**2)
    )

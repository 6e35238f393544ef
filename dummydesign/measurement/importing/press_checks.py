"""What looks wrong in a press, and in traces that are used together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.interpolation import true_runs
from dummydesign.measurement.importing.baseline import LEAST_LEAD_IN
from dummydesign.measurement.importing.contact import ContactEstimate, contact_off, find_contact
from dummydesign.measurement.importing.decisions import ImportLog, Settings
from dummydesign.measurement.importing.judge import DELAYED, Judgement, contact_of, judge_press
from dummydesign.measurement.importing.sign_convention import find_presses, find_signs
from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.ramp_detection import Summary, summarise
from dummydesign.measurement.sensor import find_clip, longest_run, middle_of_three
from dummydesign.measurement.trace import Trace, import_first, ranges, units_that_fit

Warn = Callable[[str, str], None]
Doubts = Iterator[tuple[str, str]]
"""Codes and messages, without the name of the press."""

FALLING = 0.01
"""Share of the force by which it may still fall over the last fifth of a hold and be called steady."""
COARSE = 0.01
"""Share of the steady force by which half a step of the digits may be off."""
SHORT_HOLD_S = 10.0
"""Hold of the published protocol; no shorter one is called too short unless the force still falls."""
NO_HOLD = "no_hold"
"""Code of a warning of imports alone: some uses of a trace need no hold."""
NO_TRAVEL = "no_free_travel"
FREE = 0.02
"""Share of the depth that the punch must travel before it touches, for the contact to be seen."""
COMPUTED = 1e-3
"""Share of the force by which it may be off a line over displacement to be called computed; the least of any pad or
tissue here is 0.08."""
HELD, RELAXED = 0.02, 0.05
"""Shares of its range within which a value is held, and by which the other one must fall meanwhile to be doubted."""


@dataclass(frozen=True, eq=False)
class _Press:
    """One press with what was found in it."""

    time: NDArray
    x: NDArray
    force: NDArray
    noise_N: float
    step_N: float
    summary: Summary


def check_press(
    time: NDArray, x: NDArray, force: NDArray, contact: ContactEstimate, summary: Summary, warn: Warn
) -> Judgement:
    """Warn of what looks wrong in one press; and whether it is explained as a whole."""
    before = contact.baseline
    judged = judge_press(time, x, force, summary, before.step_N, contact.delay_s)
    press = _Press(time, x, force, max(before.noise_N, noise_of(force)), before.step_N, summary)
    checks = _computed, _approach, _coarse, _hold, _several_holds, _clipped, _gaps, _frozen, _spikes, _units
    found = [*_swapped(press)] or [doubt for check in checks for doubt in check(press)]
    if not judged.explains and not {code for code, _ in found} & (CUT if judged.delay_s else FAULTS):
        found.append((judged.code, judged.message))
    for code, message in found:
        warn(code, message)
    return judged


def _swapped(press: _Press) -> Doubts:
    """Force held while the position relaxes, which no pad does: the columns are the wrong way round.

    In a press at held depth the force falls, at held force the depth grows, at a clipped force it stands or grows.
    """
    force, x = press.force, press.x
    top, reach = float(force.max()), float(np.ptp(x))
    first, last = longest_run(force > top - HELD * float(np.ptp(force)))
    tenth = (last - first) // 10
    if tenth < 3:
        return
    begin, middle = x[first : first + tenth], x[(first + last) // 2 :][:tenth]
    fall = float(begin.mean() - middle.mean())
    if fall > RELAXED * reach and fall > 4.0 * float(np.hypot(begin.std(), middle.std())) / np.sqrt(tenth):
        yield (
            "columns_swapped",
            f"the position falls back by {100 * fall / reach:.0f} % while the force stands: "
            "give --columns displacement and force the other way round",
        )


def _computed(press: _Press) -> Doubts:
    """One column a multiple of the other: only a spring that does not relax, or a computation, gives that."""
    steep, begin = np.polyfit(press.x, press.force, 1)
    if np.abs(press.force - steep * press.x - begin).max() < COMPUTED * np.ptp(press.force):
        yield (
            "proportional",
            f"force and displacement are proportional ({steep:.4g} N/mm): was one computed from the other, or a spring "
            "pressed? a pad and skin relax; record the position by itself",
        )


def _approach(press: _Press) -> Doubts:
    """Motion before the force rises: without any the zero may have been set at a touch."""
    free, depth = -float(press.x[: int(press.x.argmax()) + 1].min()), press.summary.depth_mm
    if free < FREE * depth:
        yield (
            NO_TRAVEL,
            f"no travel without force is recorded: if the zero was set at a touch, contact lies before it and the "
            f"depth of {depth:.3g} mm is too little; record from before contact",
        )


def _coarse(press: _Press) -> Doubts:
    """Digits that the noise does not spread, so coarse that the steady force is not known to 1 %."""
    step, steady = press.step_N, press.summary.steady_force_N
    if steady and 0.5 * step > COARSE * steady and press.noise_N < 0.3 * step:
        yield (
            "coarse_digits",
            f"the digits of the force are {step:.2g} N, {100 * step / steady:.1f} % of the "
            "steady force: export it with more digits, or use a smaller range",
        )


def _hold(press: _Press) -> Doubts:
    steady, hold_s, end_s = press.summary.steady_force_N, press.summary.hold_s, press.summary.hold_end_s
    if steady is None:
        yield (
            NO_HOLD,
            "the punch does not stand still: no steady force; 'fit', 'compare' and 'loop' need a hold of 10 s",
        )
    if steady is None or hold_s >= 0.95 * SHORT_HOLD_S:
        return
    begin = end_s - 0.2 * hold_s
    late = (press.time >= begin) & (press.time <= end_s)
    if late.sum() < 6:
        return
    fall = -float(np.polyfit(press.time[late] - begin, press.force[late], 1)[0]) * 0.2 * hold_s
    if fall > FALLING * steady and fall > 4.0 * press.noise_N / np.sqrt(late.sum()):
        yield (
            "hold_too_short",
            f"after {hold_s:.3g} s the force still falls, by {100 * fall / steady:.1f} % in "
            f"the last {0.2 * hold_s:.2g} s: {steady:.3g} N is no steady force; hold for 10 s",
        )


def _several_holds(press: _Press) -> Doubts:
    """Staircases: other plateaus than the deepest, where the punch presses and stands.

    A position that creeps during one hold is no staircase: more than half of a step is made at speed.
    """
    summary, grid = press.summary, np.linspace(press.time[0], press.time[-1], 2000)
    x, step = np.interp(grid, press.time, press.x), grid[1] - grid[0]
    slow = np.abs(np.gradient(x, step)) < 0.05 * max(summary.velocity_mm_s, 1e-9)
    deepest = np.abs(x - summary.depth_mm) <= 0.05 * summary.depth_mm
    pressed = slow & (x > 0.1 * summary.depth_mm) & ~deepest
    # a hold found on a staircase reaches over its last steps: only standing at the deepest is compared with
    first, last = longest_run(slow & deepest)
    least_s = max(0.3, 5.0 * step, 0.3 * min(summary.hold_s, (last - first) * step))
    standing = np.flatnonzero(slow & deepest)

    def stepped(a: int, b: int) -> bool:
        """Whether the way between a plateau and the nearest moment at the deepest is mostly made between them."""
        ends = [(a, standing[standing < a][-1:]), (b - 1, standing[standing >= b][:1])]
        jumps = [abs(float(x[at] - x[other[0]])) for at, other in ends if len(other)]
        return not jumps or min(jumps) > 0.5 * abs(float(np.median(x[a:b])) - summary.depth_mm)

    runs = ((a, b) for a, b in true_runs(pressed) if (b - a) * step > least_s)
    if plateaus := [float(np.median(x[a:b])) for a, b in runs if stepped(a, b)]:
        depths = ", ".join(f"{depth:.2f}" for depth in sorted({*plateaus, summary.depth_mm}))
        yield (
            "several_holds",
            f"the punch stands at several depths ({depths} mm) without coming back to zero "
            "between; fits read one ramp and one hold: press each depth by itself, or cut the file",
        )


def _clipped(press: _Press) -> Doubts:
    """The load cell's end: the force stands within its noise while the punch still moves, or before it relaxes."""
    if clip := find_clip(press.time, press.x, press.force, press.step_N):
        yield (
            "clipped",
            f"the force stands at {clip.level_N:.6g} N for {clip.stop - clip.first} samples from "
            f"{clip.start_s:.4g} s: the load cell or its amplifier is at its end; use a larger range; fits "
            "leave these samples out, the peak is not known",
        )


def _gaps(press: _Press) -> Doubts:
    """Time without samples while the punch moves on or the press goes on."""
    time, x, summary = press.time, press.x, press.summary
    step = np.diff(time)
    usual = np.maximum(np.r_[step[1:], step[-1]], np.r_[step[0], step[:-1]])
    hole = (step > 8.0 * usual) & (step > 5.0 * float(np.median(step))) & (x[1:] > 0.02 * summary.depth_mm)
    moved = np.abs(np.diff(x)) > 0.1 * summary.depth_mm
    rising = time[1:] <= summary.stop_time_s
    gaps = np.flatnonzero(hole & (moved | rising | (step > 0.2 * max(summary.hold_s, 1e-9))))
    if gaps.size:
        at = int(gaps[0])
        yield (
            "drop_out",
            f"no samples from {time[at]:.4g} to {time[at + 1]:.4g} s ({gaps.size} such gaps) within "
            "the press; the force between is not known: record again",
        )


def _frozen(press: _Press) -> Doubts:
    """Both columns repeat while the punch should move."""
    time, x, depth = press.time, press.x, press.summary.depth_mm
    rise = (x[1:] > 0.02 * depth) & (x[1:] < 0.95 * depth) & (time[1:] < press.summary.stop_time_s)
    first, last = longest_run((np.diff(x) == 0) & (np.diff(press.force) == 0) & rise)
    if last - first < 5 or last >= len(x) - 1:
        return
    if abs(x[last + 1] - x[last]) > 3.0 * float(np.median(np.abs(np.diff(x)[rise]))):
        yield (
            "drop_out",
            f"force and position repeat for {last - first} samples from {time[first]:.4g} s in the "
            "rise and then jump: the recording stood still; record again",
        )


def _spikes(press: _Press) -> Doubts:
    """Single samples far off their neighbours, which agree with each other."""
    force = press.force
    if len(force) < 20:
        return
    off = np.abs(force - middle_of_three(force))[1:-1]
    across = np.abs(force[2:] - force[:-2])
    limit = max(15.0 * press.noise_N, 0.03 * float(force.max()))
    spikes = np.flatnonzero((off > limit) & (across < 0.3 * off)) + 1
    if 0 < spikes.size <= max(0.01 * len(force), 3):
        worst = int(spikes[np.argmax(off[spikes - 1])])
        yield (
            "spike",
            f"{spikes.size} single samples stand out, by {off[worst - 1]:.3g} N at {press.time[worst]:.4g} s; they are "
            "kept: mend the shielding, or take them out before fitting",
        )


def _units(press: _Press) -> Doubts:
    """Stiffer than any hand or pad: the force or the position may be in another unit."""
    largest, depth = press.summary.peak_force_N, press.summary.depth_mm
    if largest > ranges()["stiffness_N_mm"].usual_high * depth:
        columns = press.time, press.x, press.force
        fitting = [f"{role}={one}" for role in ("force", "displacement") for one in units_that_fit(role, *columns)]
        doubt = f"{largest:.4g} N at {depth:.3g} mm is stiffer than any hand or pad: are both in these units?"
        yield ("far_from_known", doubt + f" say --units {' or '.join(fitting)} if not" * bool(fitting))


CODES = (
    *("force_before_contact", "contact_off", "hold_too_short", "several_holds", "clipped", "drop_out", "spike"),
    *("coarse_digits", "far_from_known", "columns_swapped", "same_press", "several_subjects"),
    *("not_explained", "proportional"),
)
"""Codes of the warnings of this module."""
MENDED = ("force_before_contact", "contact_off", "far_from_known")
"""Those that an import mends."""
CUT = {"clipped", "drop_out", "proportional", "columns_swapped"}
FAULTS = {"several_holds", "spike", *CUT}
"""Those that say why a force is not explained, and of these those that pass for a delay."""
OFFSET_SHARE = 0.01
"""Share of the largest force up to which a force before contact does not matter."""
READING = 4.0
"""A sensor zeroed on a single reading is off by up to so many standard deviations of its noise (1 in 16,000)."""
ALIKE_DEPTH, ALIKE_SPEED, DIFFERENT = 1.4, 1.2, 1.4
"""Ratios: of depths and speeds that are comparable, and of forces there that one subject does not show."""


def doubts_of(trace: Trace, resolution_N: float = 0.0) -> list[dict[str, str]]:
    """Return warnings about one trace."""
    log = ImportLog(trace.name, Settings(flip=frozenset()))

    def warn(code: str, message: str) -> None:
        # its user says whether a hold is needed, and declares a filter; its zero is the contact
        if code not in (NO_HOLD, DELAYED, NO_TRAVEL):
            log.warn(code, message + (import_first(trace.name) if code in MENDED else ""))

    time, x, force = trace.time_s, trace.displacement_mm, trace.force_N
    try:
        rest = find_signs(x, force, None, log).rest_force_N
        span = find_presses(trace.name, x, force - rest, False)[0]
        contact = contact_of(time, x, force - rest, span)
        summary = summarise(trace.name, time, x, force)
    except InputError:
        return []  # whoever uses the trace names what it lacks
    before = contact.baseline
    tare, noise = rest + before.mean_N, max(before.noise_N, noise_of(force))
    allowed = allowed_offset(summary.peak_force_N, noise, before.error_N, resolution_N)
    if before.samples >= LEAST_LEAD_IN and abs(tare) > allowed:
        warn(
            "force_before_contact",
            f"the force is {tare:.3g} N before contact and counts as pressing; up to "
            f"{allowed:.2g} N is allowed (noise {noise:.2g} N)",
        )
    elif abs(before.before_N) > max(OFFSET_SHARE * summary.peak_force_N, READING * noise):
        warn(
            "force_before_contact",
            f"the force changes by {before.before_N:+.3g} N before contact, which makes "
            f"{before.effect_N:.2g} N by the end of the hold",
        )
    elif before.samples >= LEAST_LEAD_IN and contact_off(contact, summary.depth_mm):
        tares = (before.mean_N + side * READING * noise for side in (-1.0, -0.5, 0.5, 1.0))
        others = (find_contact(time, x, force - rest, span, other) for other in tares)
        if all(contact_off(other, summary.depth_mm) for other in others):
            warn("contact_off", contact_off(contact, summary.depth_mm))
    check_press(time, x, force, contact, summary, warn)
    return log.warnings


def allowed_offset(peak_force_N: float, noise_N: float, tare_error_N: float, resolution_N: float = 0.0) -> float:
    """Return the largest force before contact that is no fault. [N]

    That is what a sensor zeroed on one noisy reading shows, with the error of the mean before contact; at least one
    step of the sensor, and 1 % of the largest force.
    """
    return max(READING * noise_N + tare_error_N, OFFSET_SHARE * peak_force_N, resolution_N)


def copies_among(traces: Sequence[Trace]) -> list[dict[str, str]]:
    """Return warnings about traces that hold the same recording: one subject under two names, or a copy."""
    names: dict[bytes, str] = {}
    copies = []
    for trace in traces:
        # to a tenth of a micrometre and of a millinewton
        key = (np.round([trace.displacement_mm, trace.force_N], 4) + 0.0).tobytes()
        if key in names:
            message = f"{trace.name} is the same recording as {names[key]}: one subject twice, or a copy? use it once"
            copies.append({"code": "same_press", "message": message})
        names.setdefault(key, trace.name)
    return copies


def subjects_among(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, str]]:
    """Warn where presses of like depth and speed differ in force as two subjects (or two pads) do.

    A deeper press of the same subject needs more force, as the depth to a power between 1 (a flat pad) and 3 (tissue).
    Two presses are doubted when both their steady and their largest force are 1.4 times beyond that.
    """
    for a, b in combinations(rows, 2):
        shallow, deep = sorted((a, b), key=lambda row: row["depth_mm"])
        depth = deep["depth_mm"] / shallow["depth_mm"]
        speed = max(a["velocity_mm_s"] / b["velocity_mm_s"], b["velocity_mm_s"] / a["velocity_mm_s"])
        if depth > ALIKE_DEPTH or speed > ALIKE_SPEED:
            continue
        ratios = [deep[key] / max(shallow[key], 1e-12) for key in ("steady_force_N", "peak_force_N")]
        if max(ratios) < depth / DIFFERENT or min(ratios) > depth**3 * DIFFERENT:
            message = (
                f"{a['file']} and {b['file']} press {a['depth_mm']:.3g} and {b['depth_mm']:.3g} mm deep with "
                f"{a['steady_force_N']:.3g} and {b['steady_force_N']:.3g} N: two subjects or pads in one fit? "
                "fit each by itself; for a tissue give each subject a folder"
            )
            return [{"code": "several_subjects", "message": message}]
    return []

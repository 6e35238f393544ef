"""All trials of a campaign as stacks for one vectorised simulation, with each pad's history."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.noise import Bins, interpolation
from dummydesign.loop.data.reduction import UNLOADING, ReducedPress, has_hold, reduce_press
from dummydesign.measurement.campaign import Campaign, Trial
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.measurement.sensor import Lowpass, find_clip
from dummydesign.measurement.trace import Trace

DAY_S = 86400.0


@dataclass(frozen=True)
class History:
    """Earlier presses on the same pad. A pad is known by its shape and thickness."""

    earlier_depth_mm: NDArray
    elapsed_s: NDArray
    sequence: NDArray
    repeat: NDArray
    rest_s: NDArray
    temperature_C: NDArray
    age_days: NDArray


def make_history(trials: tuple[Trial, ...], depth_mm: NDArray) -> History:
    """Collect the history of every trial from sequence, rest and age."""

    def column(name: str) -> NDArray:
        return np.array([np.nan if getattr(t, name) is None else getattr(t, name) for t in trials], dtype=float)

    count = len(trials)
    sequence, rest, age = column("sequence"), column("rest_s"), column("age_days")
    depth, elapsed = np.zeros((count, count)), np.full((count, count), np.inf)
    pads: dict[tuple[str, float], list[int]] = {}
    for index in np.argsort(sequence, kind="stable"):
        before = pads.setdefault(trials[index].pad, [])
        since, later = 0.0, index
        for earlier in reversed(before):
            since += float(rest[later]) if np.isfinite(rest[later]) else 60.0
            days = age[index] - age[earlier]
            gap = max(since, days * DAY_S) if np.isfinite(days) else since
            depth[index, earlier], elapsed[index, earlier] = depth_mm[earlier], gap
            trace = trials[earlier].trace
            since += float(trace.time_s[-1] - trace.time_s[0])
            later = earlier
        before.append(int(index))
    return History(depth, elapsed, sequence, column("repeat"), rest, column("temperature_C"), age)


KEPT = 6  # depths of which the values are kept: a fit asks for those of the trials, and for the same a little less deep


def memoised_law(law: Callable[[NDArray, NDArray], NDArray]) -> Callable[[NDArray, NDArray], NDArray]:
    """A law that gives the same values, from memory for the depths of its last calls."""
    kept: dict[tuple[bytes, bytes], NDArray] = {}

    def remembered(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        key = depth_mm.tobytes(), thickness_mm.tobytes()
        values = kept.pop(key, None)
        if values is None:
            values = law(depth_mm, thickness_mm)
            values.flags.writeable = False
        kept[key] = values
        if len(kept) > KEPT:
            del kept[next(iter(kept))]
        return values

    remembered.__wrapped__ = law  # type: ignore[attr-defined]
    return remembered


@dataclass(frozen=True)
class Presses:
    """T trials with up to N nodes and B bins; padding repeats the last node and has no bins."""

    trials: tuple[Trial, ...]
    presses: tuple[ReducedPress, ...]
    time_s: NDArray
    displacement_mm: NDArray
    acceleration_mm_s2: NDArray
    thickness_mm: NDArray
    contact_s: NDArray
    stop_s: NDArray
    hold_end_s: NDArray
    depth_mm: NDArray
    velocity_mm_s: NDArray
    force_N: NDArray
    samples: NDArray
    label: NDArray
    operator: NDArray  # bin means (T, B, N) of the sensor's output for forces at the nodes
    bins: Bins
    cell: NDArray
    history: History

    @cached_property
    def pads(self) -> tuple[tuple[str, float], ...]:
        """The different pads: shape as typed (empty for a slab) and thickness, slabs first, thin ones first."""
        return tuple(sorted({trial.pad for trial in self.trials}))

    @cached_property
    def pad(self) -> NDArray:
        """Which of :attr:`pads` each trial presses, shape (T,)."""
        return np.array([self.pads.index(trial.pad) for trial in self.trials])

    @cached_property
    def young_factor(self) -> NDArray | None:
        """What is known of each trial's pad: its modulus over that of the usual pad (T,); None where nothing is."""
        factors = np.array([trial.young_factor for trial in self.trials])
        return None if np.all(factors == 1.0) else factors

    @cached_property
    def flat_top_N(self) -> float | None:
        """The largest reading when presses stay at it, see :func:`flat_top`. [N]"""
        return flat_top([trial.trace for trial in self.trials])

    @cached_property
    def pulls(self) -> int:
        """In how many presses the readings show tension on the way back, see :func:`shows_tension`."""
        rows = zip(self.trials, self.contact_s, self.hold_end_s)
        return sum(shows_tension(trial.trace.time_s, trial.trace.force_N, a, b) for trial, a, b in rows)

    @cached_property
    def _laws(self) -> dict[int, tuple[Any, Any]]:
        return {}

    def remembered(self, law: Any) -> Any:
        """The law of these trials, with its values at the depths that were asked last.

        A fit asks for the same depths again and again: only effects of the motion change them.
        """
        if id(law) not in self._laws:
            self._laws[id(law)] = law, memoised_law(law.on(self.trials))
        return self._laws[id(law)][1]

    @property
    def used(self) -> NDArray:
        """Mask of the bins, shape (T, B)."""
        return self.bins.used

    @property
    def since_stop_s(self) -> NDArray:
        """Time from the stop to the middle of each bin, shape (T, B). [s]"""
        return 0.5 * (self.bins.start + self.bins.end) - self.stop_s[:, None]

    @property
    def unloads(self) -> NDArray:
        """Whether each trial goes on after the hold, shape (T,)."""
        return ((self.label // 100 == UNLOADING) & self.used).any(axis=1)

    @property
    def going_back(self) -> NDArray:
        """Whether the punch is on its way back at each node, shape (T, N)."""
        return self.time_s > self.hold_end_s[:, None]

    @cached_property
    def back_mm_s(self) -> NDArray:
        """Mean speed on the way back (T,), that of the ramp where there is none. [mm/s]"""
        speeds = []
        for trial, end, ramp in zip(self.trials, self.hold_end_s, self.velocity_mm_s):
            away = trial.trace.time_s > end
            time, x = trial.trace.time_s[away], trial.trace.displacement_mm[away]
            moved = len(x) > 1 and x[0] > x[-1]
            speeds.append((x[0] - x[-1]) / (time[-1] - time[0]) if moved else ramp)
        return np.array(speeds)

    @property
    def elastic_only(self) -> bool:
        """Whether nothing shows relaxation: no trial holds and all have about one speed."""
        speed = self.velocity_mm_s
        return not any(has_hold(press.ramp) for press in self.presses) and speed.max() < 1.5 * speed.min()

    def measure(self, node_force_N: NDArray) -> NDArray:
        """Bin means (T, B) of the sensor's output for a force at the nodes (T, N). [N]"""
        return (self.operator @ node_force_N[..., None])[..., 0]

    def at_samples(self, node_force_N: NDArray) -> list[NDArray]:
        """The sensor's output at the raw samples of each trial. [N]"""
        out = []
        for row, press in enumerate(self.presses):
            values = press.filtered @ node_force_N[row, : len(press.time_s)]
            index, weight = interpolation(self.trials[row].trace.time_s, press.time_s, press.smooth_s)
            out.append((values[index] * weight).sum(axis=1))
        return out


TENSION_RUN, TENSION_Z = 5, 5.0
"""Readings in a row that make a tension, and how many standard deviations of their mean they lie below zero."""


def shows_tension(time_s: NDArray, force_N: NDArray, contact_s: float, hold_end_s: float) -> bool:
    """Whether readings on the way back lie below those before contact, beyond noise and drift of the zero."""
    before, back = force_N[time_s < contact_s - 0.005], force_N[time_s > hold_end_s]
    if len(before) < TENSION_RUN or len(back) < TENSION_RUN:
        return False
    means = np.convolve(back - np.median(before), np.full(TENSION_RUN, 1.0 / TENSION_RUN), "valid")
    noise = max(float(np.std(before)), float(np.median(np.abs(np.diff(back)))))
    # the zero may have drifted: off the pad the readings end at it
    return bool(means.min() - min(means[-1], 0.0) < -TENSION_Z * noise / np.sqrt(TENSION_RUN))


FLAT_PRESSES, ALIKE = 2, 0.01
"""Presses that must stand at one force, and the share of it by which they may differ."""


def flat_top(traces: list[Trace]) -> float | None:
    """The force at which presses stand although the punch goes on or the pad relaxes later; None otherwise. [N]"""
    clips = [find_clip(one.time_s, one.displacement_mm, one.force_N) for one in traces]
    levels = [clip.level_N for clip in clips if clip is not None]
    if len(levels) < FLAT_PRESSES:
        return None
    level = float(np.median(levels))
    return level if sum(abs(one - level) <= ALIKE * level for one in levels) >= FLAT_PRESSES else None


def make_presses(campaign: Campaign) -> Presses:
    """Reduce all trials of a campaign."""
    return stack(campaign.trials, campaign.lowpass)


def stack(trials: tuple[Trial, ...], lowpass: Lowpass | None) -> Presses:
    """Reduce trials and stack them."""
    reduced = tuple(reduce_press(trial.trace, trial.lowpass or lowpass) for trial in trials)
    count = max(len(press.time_s) for press in reduced)
    bins = Bins(reduced)
    longest = bins.used.shape[1]
    time, x, acceleration = (np.zeros((len(reduced), count)) for _ in range(3))
    operator = np.zeros((len(reduced), longest, count))
    for row, press in enumerate(reduced):
        nodes = len(press.time_s)
        time[row] = np.r_[press.time_s, press.time_s[-1] + 1.0 + np.arange(count - nodes)]
        x[row] = np.r_[press.displacement_mm, np.full(count - nodes, press.displacement_mm[-1])]
        acceleration[row, :nodes] = press.acceleration_mm_s2
        operator[row, : len(press.samples), :nodes] = press.operator

    def joined(name: str) -> NDArray:
        return bins.stacked(np.concatenate([np.asarray(getattr(press, name), float) for press in reduced]))

    ramps = [press.ramp for press in reduced]
    thickness = np.array([trial.thickness_mm for trial in trials])
    depth = np.array([ramp.depth_mm for ramp in ramps])
    return Presses(
        trials,
        reduced,
        time,
        x,
        acceleration,
        thickness,
        np.array([r.contact_time_s for r in ramps]),
        np.array([r.stop_time_s for r in ramps]),
        np.array([r.hold_end_s for r in ramps]),
        depth,
        np.array([r.velocity_mm_s for r in ramps]),
        joined("force_N"),
        joined("samples"),
        joined("label").astype(int),
        operator,
        bins,
        _cells(trials, depth),
        make_history(trials, depth),
    )


SAME_DEPTH = 0.04  # relative change of depth up to which presses are of one condition


def _cells(trials: tuple[Trial, ...], depth: NDArray) -> NDArray:
    """Number the conditions: same pad, declared speed and target force (or depth, see :data:`SAME_DEPTH`)."""
    keys: list[tuple[tuple[str, float], float, float]] = []
    numbers = []
    for trial, reached in zip(trials, depth):
        target = trial.target_force_N
        level, slack = (float(reached), SAME_DEPTH * float(reached)) if target is None else (target, 1e-9)
        pad, speed = trial.pad, trial.velocity_mm_s
        match = [i for i, key in enumerate(keys) if key[:2] == (pad, speed) and abs(key[2] - level) <= slack]
        if not match:
            keys.append((pad, speed, level))
        numbers.append(match[0] if match else len(keys) - 1)
    return np.array(numbers)


BACK_MM_S = 10.0  # of the way back of a planned press


def planned_trace(name: str, velocity_mm_s: float, depth_mm: float, hold_s: float, unloading: bool) -> Trace:
    """Make the motion of a press without its force: from before contact, through the hold, and back where wanted."""
    press = ramp_and_hold(velocity_mm_s, depth_mm, hold_s)
    stop = float(press.time_s[-1]) - hold_s
    fine = np.arange(-min(0.1, 20.0 / velocity_mm_s), stop + 0.4, max(1e-3, stop / 500.0))
    hold = np.arange(fine[-1] + 0.02, stop + hold_s, 0.02)
    end = float(hold[-1]) if len(hold) else float(fine[-1])
    away = np.arange(end + 4e-3, end + (depth_mm + 2.0) / BACK_MM_S, 4e-3) if unloading else np.zeros(0)
    time = np.r_[fine, hold, away]
    x = np.interp(time, press.time_s, press.displacement_mm)
    x = np.where(time < 0, velocity_mm_s * time, x)
    x = np.where(time > end, depth_mm - BACK_MM_S * (time - end), x)
    return Trace(name, time, x, np.zeros_like(time))

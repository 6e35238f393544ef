"""Force over time against people: share of the time inside their range, the largest miss, the objective rating."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.serialise import Serialised
from dummydesign.design.scoring.score import Evaluation
from dummydesign.design.scoring.targets import Targets
from dummydesign.measurement.rating import Rating, rate
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE, ForceRange

# Even samples of a curve that is rated, and the end of the rated time over the aim's time from contact to stop.
RATED, RATED_RISES = 400, 2.0


@dataclass(frozen=True, eq=False)
class PressCurve:
    """Force of one press over time since contact, arrays (n,), with the subjects' range and the aim's curve.

    ``inside_fraction`` is the share of the time inside the range, ``near_N`` how far beside it still counts.
    """

    steady_force_N: float
    velocity_mm_s: float
    time_s: NDArray
    force_N: NDArray
    stop_s: float
    range: ForceRange
    aim: ForceRange
    inside_fraction: float
    near_N: float


@dataclass(frozen=True)
class Miss(Serialised):
    """How far a force lies outside the subjects' range: below 0 below all of them, else above all.

    ``miss_percent`` is that of the nearest subject's force at the same time. ``time_after_stop_s`` is below 0 before
    the pad's own stop.
    """

    steady_force_N: float
    velocity_mm_s: float
    time_after_stop_s: float
    miss_N: float
    miss_percent: float | None

    @property
    def size(self) -> float:
        """Over the steady force, so that presses to different forces compare."""
        return abs(self.miss_N) / self.steady_force_N


@dataclass(frozen=True)
class CurveRow(Serialised):
    """One press: share of the time inside, and its rating; None where it is out of reach."""

    steady_force_N: float
    velocity_mm_s: float
    inside_fraction: float
    rating: Rating | None


@dataclass(frozen=True)
class CurveMatch(Serialised):
    """All presses: the least share, and the miss that is largest over its press's steady force; None for no miss."""

    inside_fraction_least: float
    worst: Miss | None
    conditions: tuple[CurveRow, ...]


def largest_miss(press: PressCurve) -> Miss | None:
    """The largest miss of one press; None where all of it is inside, or beside the range by less than counts."""
    shown = (press.time_s >= 0.0) & (press.time_s <= press.range.time_s[-1])
    time, force = press.time_s[shown], press.force_N[shown]
    low, high = (np.interp(time, press.range.time_s, edge) for edge in (press.range.low_N, press.range.high_N))
    miss = np.maximum(force - high, 0.0) - np.maximum(low - force, 0.0)
    if not len(miss) or not np.abs(miss).max() > press.near_N:
        return None
    at = int(np.argmax(np.abs(miss)))
    nearest = float(high[at] if miss[at] > 0.0 else low[at])
    percent = 100.0 * float(miss[at]) / nearest if nearest > 0.0 else None
    test = press.steady_force_N, press.velocity_mm_s
    return Miss(*test, float(time[at]) - press.stop_s, float(miss[at]), percent)


def rate_press(press: PressCurve) -> Rating:
    """Rate a press against the aim by ISO/TS 18571, from contact on until twice the time that the aim takes to stop.

    Rise and fast relaxation then count alike at every speed; at the end of a hold of 10 s the forces are equal.
    """
    aim = press.aim
    end = min(RATED_RISES * float(aim.stop_s[0]), float(aim.time_s[-1]), float(press.time_s[-1]))
    at = np.linspace(0.0, end, RATED)
    return rate(np.interp(at, aim.time_s, aim.curves_N[0]), np.interp(at, press.time_s, press.force_N))


def match_of_design(evaluation: Evaluation, index: int, targets: Targets) -> CurveMatch:
    """Compare the presses of one design with the subjects and the aim."""
    rows, misses = [], []
    for column, (condition, press) in enumerate(zip(targets.conditions, evaluation.presses)):
        test = condition.steady_force_N, condition.velocity_mm_s
        share = float(evaluation.inside[index, column])
        if not np.isfinite(press.depth_mm[index]):
            rows.append(CurveRow(*test, share, None))
            continue
        time, force, stop = press.time_s[index], press.force_N[index], float(press.stop_s[index])
        near = STEADY_TOLERANCE * condition.steady_force_N
        curve = PressCurve(*test, time, force, stop, condition.range, condition.aim, share, near)
        rows.append(CurveRow(*test, share, rate_press(curve)))
        misses.append(largest_miss(curve))
    return _match(rows, misses)


def match_of_presses(conditions: Sequence[Sequence[PressCurve]]) -> CurveMatch:
    """Compare measured presses; those of one condition are repeats, whose shares and ratings are averaged."""
    rows = []
    for repeats in conditions:
        ratings = [rate_press(one) for one in repeats]
        rating = Rating(*(float(np.mean([getattr(one, name) for one in ratings])) for name in vars(ratings[0])))
        force, speed, share = np.mean(
            [(one.steady_force_N, one.velocity_mm_s, one.inside_fraction) for one in repeats], axis=0
        ).tolist()
        rows.append(CurveRow(force, speed, share, rating))
    return _match(rows, [largest_miss(one) for repeats in conditions for one in repeats])


def _match(rows: Sequence[CurveRow], misses: Sequence[Miss | None]) -> CurveMatch:
    known = [one for one in misses if one is not None]
    worst = max(known, key=lambda one: one.size, default=None)
    return CurveMatch(min(row.inside_fraction for row in rows), worst, tuple(rows))

"""What the paper says of its three dummies, in our words, each as a test of simulated dummies.

A test gives true, false or None (a force it needs is out of reach) and the numbers behind it. How far the
paper's words reach is fixed here: "centre" is the middle half of a range, "edge" its outer quarter (or up to
a twentieth beyond), "about 5 N" is 4 to 6 N.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studies.paper_dummies.dummies import STEADY_GRID_N, Dummy
from studies.paper_dummies.in_time import (
    CENTRE,
    SOFT_EDGE,
    SPEEDS,
    STIFF_EDGE,
    Dummies,
    Judged,
    concave,
    falls,
    more_viscous,
    peaks_placed,
    rise_is_high,
    rises_inside,
    within,
)

ABOUT_5N = (4.0, 6.0)


@dataclass(frozen=True)
class Statement:
    """One thing the paper says: dummy, words, section, what our judgement rests on, and the test.

    ``basis`` is ``input`` when the shipped tissue bands or the resin's relaxation were inferred with the
    help of this very statement, ``band`` when it is judged against them, ``free`` when it needs neither band.
    ``steady_curve`` marks the three that say where the steady curve runs through the range.
    """

    dummy: str
    words: str
    section: str
    basis: str
    judge: Callable[[Dummies], Judged]
    steady_curve: bool = False


def statements() -> tuple[Statement, ...]:
    """All statements, dummy by dummy."""
    every = []
    for name in ("I", "II", "III"):
        every += [*_steady(name), *_in_time(name)]
    return tuple(every)


def _steady(name: str) -> list[Statement]:
    """Statements on parameters and the steady-state curve."""

    def say(words: str, section: str, basis: str, judge: Callable[[Dummy], Judged], curve: bool = False) -> Statement:
        return Statement(name, words, section, basis, lambda dummies: judge(dummies[name]), curve)

    where = {"I": ("at the centre", CENTRE), "II": ("near the soft edge", SOFT_EDGE)}
    edge, span = where.get(name, ("near the stiffest edge", STIFF_EDGE))
    section = "IV-B" if name == "III" else "V-B"
    rows = [
        say("was pressed to 5, 10 and 15 N", "II-B, IV-C", "input", _reached),
        say("stiffer than the stiffest subject at first touch", "IV-B", "band", _first_touch),
        say("enters the steady range near 5 N", "IV-B, V-B", "input", _crossing, True),
        say("inside the steady range above about 5 N", "V-B", "input", _inside_above, True),
        say("soft at large depth: moves towards the soft edge", "IV-B", "band", _softens),
        say(f"{edge} of the steady range at 10 N", section, "input", lambda d: _placed(d, span), True),
    ]
    if name == "III":
        rows += [
            say("gamma1 above all subjects", "IV-A", "input", lambda d: _parameter(d, "gamma1", "above")),
            say("gamma1 misleads: high due to small forces, curve inside the range", "V-B", "band", _misleading),
            say("gamma2 and c2 below all subjects", "IV-A", "band", lambda d: _both(d, "gamma2", "c2", "below")),
        ]
    else:
        rows += [
            say("gamma1 inside the band", "IV-A", "input", lambda d: _parameter(d, "gamma1", "inside")),
            say("gamma1 near the average of the subjects", "IV-A", "band", _average),
        ]
    if name == "II":
        rows += [
            say("gamma3 and c3 above all subjects", "IV-A", "band", lambda d: _both(d, "gamma3", "c3", "above")),
            Statement("II", "the most curved of the three", "V-B", "free", _most_curved),
        ]
    else:
        rows.append(Statement(name, "worse at first touch than dummy II", "V-B", "band", lambda ds: _worse(ds, name)))
    return rows


def _in_time(name: str) -> list[Statement]:
    """Statements on F(t)."""

    def say(words: str, section: str, basis: str, judge: Callable[[Dummy], Judged]) -> Statement:
        return Statement(name, words, section, basis, lambda dummies: judge(dummies[name]))

    rows = [say("F(t) at 10 N, 10 mm/s: begins above the range, ends the rise in it", "IV-C", "band", rises_inside)]
    if name == "II":
        rows += [
            say("large peak near the upper edge at 10 N", "IV-C", "input", lambda d: peaks_placed(d, STIFF_EDGE)),
            say("rise near the upper edge at 10 N, 250 mm/s", "V-B", "band", rise_is_high),
            say("falls off faster than the subjects", "IV-A", "band", lambda d: falls(d, faster=True)),
            Statement("II", "more viscous than I and III: larger peak at 10 N", "IV-C", "free", more_viscous),
        ]
    else:
        rows.append(say("peak inside the range at 10 N", "IV-C", "input", lambda d: peaks_placed(d, (0.0, 1.0))))
    if name == "I":
        rows.append(say("F(t) at the centre of the range at 10 N", "V-B", "band", lambda d: peaks_placed(d, CENTRE)))
    if name == "III":
        rows.append(say("falls off slower than the subjects", "IV-A", "band", lambda d: falls(d, faster=False)))
    rows.append(say("rise concave-down at 250 mm/s", "V-B", "free", concave))
    return rows


def _reached(d: Dummy) -> Judged:
    return bool(d.reach_N >= 15.0), f"{d.reach_N:.1f} N at d/h 0.6"


def _first_touch(d: Dummy) -> Judged:
    ratio = float((d.edges_mm[0][0] / d.depth_mm[0]) ** 3)
    return ratio > 1.0, f"gamma1 of its own {ratio:.3g} times the stiffest at 0.5 N"


def _crossing(d: Dummy) -> Judged:
    crossing = d.crossing_N
    if math.isnan(crossing):
        return False, f"stiffer up to {min(d.reach_N, 15.0):.1f} N"
    return within(crossing, ABOUT_5N), f"at {crossing:.1f} N"


def _inside_above(d: Dummy) -> Judged:
    above = (STEADY_GRID_N >= ABOUT_5N[1] - 1e-9) & np.isfinite(d.depth_mm)
    if d.reach_N < 10.0:
        return None, f"{d.reach_N:.1f} N reached"
    stiff, soft = (edge[above] for edge in d.edges_mm)
    inside = (d.depth_mm[above] >= stiff - 1e-9) & (d.depth_mm[above] <= soft + 1e-9)
    return bool(inside.all()), f"{100 * inside.mean():.0f} % of 6 to {min(d.reach_N, 15.0):.1f} N"


def _softens(d: Dummy) -> Judged:
    top = 15.0 if d.reach_N >= 15.0 else 10.0
    early, late = d.position_at(5.0), d.position_at(top)
    return (None if math.isnan(late) else late < early), f"place {early:.2f} at 5 N, {late:.2f} at {top:g} N"


def _placed(d: Dummy, span: tuple[float, float]) -> Judged:
    position = d.position_at(10.0)
    return within(position, span), f"place {position:.2f} (0 softest, 1 stiffest)"


def _value(d: Dummy, name: str) -> tuple[list[float], list[tuple[float, float]]]:
    """A parameter (one number, or one a speed) and the band beside each."""
    band = d.tissue.bands
    if name.startswith("gamma"):
        key = f"{name}_N_per_mm3"
        own = d.parameters.to_dict()[key]
        return [own], [(band[key].low, band[key].high)]
    key = f"{name}_N_s_per_mm"
    own = d.parameters.to_dict()[key]
    return [own[f"{v:g}"] for v in SPEEDS], [(band[key][f"{v:g}"].low, band[key][f"{v:g}"].high) for v in SPEEDS]


def _parameter(d: Dummy, name: str, where: str) -> Judged:
    if d.parameters is None:
        return None, "no press at one of the speeds"
    values, bands = _value(d, name)
    tests = {
        "above": lambda v, low, high: v > high,
        "below": lambda v, low, high: v < low,
        "inside": lambda v, low, high: low <= v <= high,
    }
    shown = ", ".join(f"{v:.3g} ({low:.3g} to {high:.3g})" for v, (low, high) in zip(values, bands))
    return all(tests[where](v, *b) for v, b in zip(values, bands)), f"{name} {shown}"


def _both(d: Dummy, one: str, other: str, where: str) -> Judged:
    first, second = _parameter(d, one, where), _parameter(d, other, where)
    if first[0] is None:
        return first
    return first[0] and second[0], f"{first[1]}; {second[1]}"


def _average(d: Dummy) -> Judged:
    if d.parameters is None:
        return None, "no press at one of the speeds"
    (value,), ((low, high),) = _value(d, "gamma1")
    position = math.log(value / low) / math.log(high / low)
    return within(position, CENTRE), f"place {position:.2f} in ln gamma1"


def _misleading(d: Dummy) -> Judged:
    at = {force: force / d.depth_at(force) ** 3 for force in (5.0, 10.0)}
    position, highest = d.position_at(10.0), d.tissue.bands["gamma1_N_per_mm3"].high
    holds = None if math.isnan(position) else bool(at[5.0] > highest and 0.0 <= position <= 1.0)
    return holds, f"F/x3 {at[5.0]:.3g} at 5 N, {at[10.0]:.3g} at 10 N, stiffest {highest:.3g}"


def _most_curved(dummies: Dummies) -> Judged:
    own = {name: dummy.exponent() for name, dummy in dummies.items()}
    shown = "exponent 5 to 10 N: " + ", ".join(f"{name} {value:.2f}" for name, value in own.items())
    if any(math.isnan(value) for value in own.values()):
        return None, shown
    return own["II"] > max(own["I"], own["III"]), shown


def _worse(dummies: Dummies, name: str) -> Judged:
    ratio = {key: (d.edges_mm[0][5] / d.depth_mm[5]) ** 3 for key, d in dummies.items()}
    return bool(ratio[name] > ratio["II"]), f"force over the stiffest's at 1 N: {ratio[name]:.2g}, II {ratio['II']:.2g}"

"""Judgements of the force over time at 10 N: rise, peak, fall, and what makes a dummy the more viscous one."""

from __future__ import annotations

import math

import numpy as np

from dummydesign.measurement.motion import contact_velocity
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE
from studies.paper_dummies.dummies import SAMPLING, Dummy, PressFigures

Dummies = dict[str, Dummy]
Judged = tuple[bool | None, str]
CENTRE = (0.25, 0.75)
STIFF_EDGE, SOFT_EDGE = (0.75, 1.05), (-0.05, 0.25)
"""What the words mean as a place between the smallest (0) and the largest (1) of the subjects."""
SPEEDS = (10.0, 250.0)
VISIBLE = 0.1
"""Difference of peak over steady force that a figure shows."""


def within(value: float, span: tuple[float, float]) -> bool | None:
    return None if math.isnan(value) else bool(span[0] <= value <= span[1])


def presses_at_10N(d: Dummy) -> list[PressFigures] | None:
    presses = [d.presses.get((10.0, speed)) for speed in SPEEDS]
    return None if None in presses else presses


def out_of_reach(d: Dummy) -> Judged:
    return None, f"10 N out of reach ({d.reach_N:.1f} N)"


def rises_inside(d: Dummy) -> Judged:
    press = d.presses.get((10.0, 10.0))
    if press is None:
        return out_of_reach(d)
    (early, _, top), (late, low, high) = press.at(0.1 * press.stop_s), press.at(press.stop_s)
    near = STEADY_TOLERANCE * 10.0
    holds = early > top and low - near <= late <= high + near
    return holds, f"{early:.2f} N against {top:.2g} N at a tenth, {late:.1f} N against {low:.1f} to {high:.1f} at stop"


def peaks_placed(d: Dummy, span: tuple[float, float]) -> Judged:
    presses = presses_at_10N(d)
    if presses is None:
        return out_of_reach(d)
    shown = ", ".join(f"{p.peak_N:.1f} N in {p.band.peak_low_N:.1f} to {p.band.peak_high_N:.1f}" for p in presses)
    near = [STEADY_TOLERANCE * 10.0 / (p.band.peak_high_N - p.band.peak_low_N) for p in presses]
    return all(within(p.peak_position, (span[0] - n, span[1] + n)) for p, n in zip(presses, near)), shown


def rise_is_high(d: Dummy) -> Judged:
    press = d.presses.get((10.0, 250.0))
    if press is None:
        return out_of_reach(d)
    places = []
    for share in np.linspace(0.5, 1.0, 26):
        force, low, high = press.at(share * press.stop_s)
        places.append((force - low) / (high - low))
    return within(float(np.mean(places)), STIFF_EDGE), f"mean place {np.mean(places):.2f} over the later half"


def half_time_s(time: np.ndarray, force: np.ndarray) -> float:
    """Time from the peak until half of the fall from peak to the end is done. [s]"""
    top = int(np.argmax(force))
    left = (force[top:] - force[-1]) / (force[top] - force[-1])
    return float(np.interp(-0.5, -np.minimum.accumulate(left), time[top:] - time[top]))


def falls(d: Dummy, faster: bool) -> Judged:
    presses = presses_at_10N(d)
    if presses is None:
        return out_of_reach(d)
    holds, shown = [], []
    for press in presses:
        own = half_time_s(press.time_s, press.force_N)
        others = [half_time_s(press.band.time_s, curve) for curve in press.band.curves_N]
        holds.append(own < min(others) if faster else own > max(others))
        shown.append(f"{1e3 * own:.0f} ms ({1e3 * min(others):.0f} to {1e3 * max(others):.0f})")
    return all(holds), f"half-time {', '.join(shown)}"


def more_viscous(dummies: Dummies) -> Judged:
    presses_of = {name: presses_at_10N(dummy) for name, dummy in dummies.items()}
    if None in presses_of.values():
        return None, "10 N out of reach of one"
    ratio = {name: [press.peak_N / 10.0 for press in presses] for name, presses in presses_of.items()}
    shown = "; ".join(f"{name} {values[0]:.2f}, {values[1]:.2f}" for name, values in ratio.items())
    others = np.maximum(ratio["I"], ratio["III"])
    return bool(np.all(np.array(ratio["II"]) > others + VISIBLE)), f"peak over steady at 10, 250 mm/s: {shown}"


def bow(time: np.ndarray, force: np.ndarray, stop_s: float) -> float:
    """Mean force over (0, stop) above half the force at its end, over that force: positive is concave-down.

    Parameters
    ----------
    time, force : ndarray, shape (n,)
        A press from its first contact on. [s, N]
    stop_s : float
        When the punch stops. [s]

    Returns
    -------
    float
        0 of a straight rise; no unit.
    """
    grid = np.linspace(0.0, stop_s, 401)
    curve = np.interp(grid, time, force)
    return float(np.mean(0.5 * (curve[1:] + curve[:-1])) / curve[-1] - 0.5)


def concave(d: Dummy) -> Judged:
    press = d.presses.get((10.0, 250.0))
    if press is None:
        return out_of_reach(d)
    peak_s = float(press.time_s[np.argmax(press.force_N)])
    touch = float(contact_velocity(250.0, press.depth_mm, SAMPLING.deceleration_mm_s2))
    brake_s = press.stop_s - touch / SAMPLING.deceleration_mm_s2
    whole = bow(press.time_s, press.force_N, peak_s)
    even = f"{bow(press.time_s, press.force_N, brake_s):+.2f} before braking" if brake_s > 1e-5 else "brakes throughout"
    return whole > 0.0, f"bow {whole:+.2f} from contact to peak, {even}"

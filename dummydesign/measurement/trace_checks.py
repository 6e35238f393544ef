"""What looks wrong in traces that are to be used together: tare, contact, damage, copies, several subjects."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes, Settings
from dummydesign.measurement.importing.press.contact import LEAST_LEAD_IN, find_contact
from dummydesign.measurement.importing.press.sanity import check_press
from dummydesign.measurement.importing.press.signs import find_signs, noise_of
from dummydesign.measurement.importing.press.split import find_presses
from dummydesign.measurement.importing.press.summary import summarise
from dummydesign.measurement.importing.press.zero import contact_off
from dummydesign.measurement.trace import Trace, import_first

CODES = (
    *("force_before_contact", "contact_off", "hold_too_short", "several_holds", "clipped", "drop_out", "spike"),
    *("far_from_known", "same_press", "several_subjects"),
)
"""Codes of the warnings of this module."""
MENDED = ("force_before_contact", "contact_off", "far_from_known")
"""Those that an import mends."""
OFFSET_SHARE = 0.01
"""Share of the largest force up to which a force before contact does not matter."""
READING = 4.0
"""A sensor zeroed on a single reading is off by up to so many standard deviations of its noise (1 in 16,000)."""
ALIKE_DEPTH, ALIKE_SPEED, DIFFERENT = 1.4, 1.2, 1.4
"""Ratios: of depths and speeds that are comparable, and of forces there that one subject does not show."""


def doubts_of(trace: Trace, resolution_N: float = 0.0) -> list[dict[str, str]]:
    """Return warnings about one trace.

    A force before contact beyond :func:`allowed_offset`; a contact that is not where the displacement is zero for any
    zero of the force within its noise; clipping, drop-outs, spikes.

    Parameters
    ----------
    trace : Trace
    resolution_N : float
        Smallest step of the force that was saved, 0 where it is unknown. [N]

    Returns
    -------
    list of {code, message}
    """
    found: list[dict[str, str]] = []

    def warn(code: str, message: str) -> None:
        found.append({"code": code, "message": message + (import_first(trace.name) if code in MENDED else "")})

    time, x, force = trace.time_s, trace.displacement_mm, trace.force_N
    try:
        rest = find_signs(trace.name, x, force, Settings(flip=frozenset()), None, Notes()).rest_force_N
        span = find_presses(trace.name, x, force - rest, False)[0]
        contact = find_contact(time, x, force - rest, span)
        summary = summarise(trace.name, time, x, force)
    except InputError:
        return found  # whoever uses the trace says what it lacks
    tare = rest + contact.tare_N
    noise = max(contact.noise_N, noise_of(force))
    allowed = allowed_offset(summary.peak_force_N, noise, contact.tare_error_N, resolution_N)
    if contact.lead_in >= LEAST_LEAD_IN and abs(tare) > allowed:
        warn(
            "force_before_contact",
            f"{trace.name}: the force is {tare:.3g} N before contact and counts as pressing; up to {allowed:.2g} N is "
            f"allowed (noise {noise:.2g} N)",
        )
    elif contact.lead_in >= LEAST_LEAD_IN and contact_off(contact, summary.depth_mm):
        tares = (contact.tare_N + side * READING * noise for side in (-1.0, -0.5, 0.5, 1.0))
        others = (find_contact(time, x, force - rest, span, other) for other in tares)
        if all(contact_off(other, summary.depth_mm) for other in others):
            warn("contact_off", f"{trace.name}: {contact_off(contact, summary.depth_mm)}")
    check_press(trace.name, time, x, force, contact, summary, warn)
    return found


def allowed_offset(peak_force_N: float, noise_N: float, tare_error_N: float, resolution_N: float = 0.0) -> float:
    """Return the largest force before contact that is no fault. [N]

    That is what a sensor zeroed on one noisy reading shows, with the error of the mean before contact; at least one
    step of the sensor, and 1 % of the largest force.

    Parameters
    ----------
    peak_force_N, noise_N, tare_error_N, resolution_N : float
        Largest force, standard deviation of the noise, 95 % error of the mean before contact, step of the sensor. [N]
    """
    return max(READING * noise_N + tare_error_N, OFFSET_SHARE * peak_force_N, resolution_N)


def copies_among(traces: Sequence[Trace]) -> list[dict[str, str]]:
    """Warnings about traces that hold the same recording: one subject under two names, or a copy."""
    seen: dict[str, str] = {}
    found = []
    for trace in traces:
        rounded = np.round(np.stack([trace.displacement_mm, trace.force_N]), 4) + 0.0
        key = hashlib.sha256(rounded.tobytes()).hexdigest()
        if key in seen:
            message = f"{trace.name} is the same recording as {seen[key]}: one subject twice, or a copy? use it once"
            found.append({"code": "same_press", "message": message})
        seen.setdefault(key, trace.name)
    return found


def subjects_among(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, str]]:
    """Warn where presses of like depth and speed differ in force as two subjects (or two pads) do.

    Parameters
    ----------
    rows : sequence of mapping
        ``file``, ``velocity_mm_s``, ``depth_mm``, ``steady_force_N`` and ``peak_force_N`` of each press.

    Notes
    -----
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
                f"{a['steady_force_N']:.3g} and {b['steady_force_N']:.3g} N: two subjects or pads in one fit? fit "
                "each by itself"
            )
            return [{"code": "several_subjects", "message": message}]
    return []

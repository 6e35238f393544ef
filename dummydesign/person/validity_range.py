"""The range in which people were pressed, and how far a press goes beyond it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import DECELERATION_MM_S2, HOLD_S
from dummydesign.tissue.comparison import PAPER_N
from dummydesign.tissue.model.maxwell_law import law_named
from dummydesign.tissue.model.measured_curves import FORCE_FACTOR, SPEED_FACTOR, common_span
from dummydesign.tissue.model.subject import PRESSED
from dummydesign.tissue.model.tissue import Tissue

if TYPE_CHECKING:
    from dummydesign.person.integrate import PersonResponse

STEADY, DEPTH, PEAK = PRESSED
NEAR = 1.05
"""Factor up to which a press still counts as inside."""
FAR = 2.0
"""Times beyond the presses on people from which on numbers must not be used, as in the verdict on a pad."""
QUANTITIES = {
    "velocity_mm_s": ("speed", "mm/s"),
    "steady_force_N": ("steady force", "N"),
    "depth_mm": ("depth", "mm"),
    "peak_force_N": ("peak force", "N"),
}
RANKED = re.compile(r"rank-(\d+)-of-(\d+)")


@dataclass(frozen=True)
class Beyond:
    """One way in which a press leaves the range: what, its value, the end of the range, and words."""

    quantity: str
    value: float
    pressed_to: float
    text: str


def beyond_range(tissue: Tissue, response: PersonResponse, velocity_mm_s: float) -> list[Beyond]:
    """Return how a press leaves the range of steady forces, depths, peaks and speeds in which people were pressed.

    Subjects that were fitted, and measured curves, have the range of their own presses; a steady force is inside if
    all of them were pressed so. Of others it is that of the published protocol: steady forces of 5 to 15 N at the
    speeds of the tissue, 10 s held; a subject was pressed as deep as 15 N at rest takes it, and bore the peak on
    the way.

    Parameters
    ----------
    tissue : Tissue
    response : Response
        Of the subjects.
    velocity_mm_s : float
        Of the press.
    """
    low, high = _forces(tissue)
    speeds, rows, names = tissue.velocities_mm_s, list[Beyond](), [one.name for one in tissue.subjects]
    ranges = (
        [("velocity_mm_s", np.array([velocity_mm_s]), (min(speeds), max(speeds)), SPEED_FACTOR, ("slowest", "fastest"))]
        if speeds
        else []
    )
    if np.isfinite(response.steady_N).any():
        ranges.append(("steady_force_N", response.steady_N, (low, high), FORCE_FACTOR, ("smallest", "largest")))
    for quantity, values, ends, factor, words in ranges:
        least, most = int(np.nanargmin(values)), int(np.nanargmax(values))
        differ = values[most] > NEAR * values[least]
        ways = ((least, values[least] < ends[0] / factor), (most, values[most] > ends[1] * factor))
        rows += [
            _beyond(quantity, float(values[at]), end, f"the {word} press on people", names[at] if differ else "")
            for (at, outside), end, word in zip(ways, ends, words)
            if outside
        ]
    deepest, strongest = limits_of_subjects(tissue)
    for quantity, values, limits in (
        ("depth_mm", response.depth_mm, deepest),
        ("peak_force_N", response.peak_N, strongest),
    ):
        over = values / limits
        worst = int(np.argmax(over))
        if over[worst] > NEAR:
            rows.append(
                _beyond(
                    quantity, float(values[worst]), float(limits[worst]), f"the most for {subject_words(names[worst])}"
                )
            )
    return rows


def _beyond(quantity: str, value: float, end: float, what: str, whom: str = "") -> Beyond:
    """One way, with its size: as a multiple from twice on, else in percent."""
    name, unit = QUANTITIES[quantity]
    times, on = value / end, f" on {subject_words(whom)}" if whom else ""
    if times >= 2.0:
        size = f"{short_number(times, 2)} times"
    else:
        size = f"{100.0 * (times - 1.0):.0f} % above" if times > 1.0 else f"{100.0 * times:.2g} % of"
    text = f"a {name} of {short_number(value)} {unit}{on} is {size} {what} ({short_number(end)} {unit})"
    return Beyond(quantity, value, end, text)


def short_number(value: float, digits: int = 3) -> str:
    """A number of three digits; none as a power of ten below a million."""
    return f"{float(f'{value:.{digits}g}'):.10g}" if abs(value) < 1e6 else f"{value:.{digits}g}"


def subject_words(name: str) -> str:
    """Name of a subject as it is read; inferred subjects are numbered from the softest on."""
    match = RANKED.fullmatch(name)
    return name if match is None else f"subject {match[1]} of {match[2]}"


def _forces(tissue: Tissue) -> tuple[float, float]:
    """Lowest and highest steady force. [N]"""
    if not tissue.measured:
        steady = [one.pressed.get(STEADY) for one in tissue.subjects]
        own = [PAPER_N if one is None else (one.low, one.high) for one in steady]
        return max(low for low, _ in own), min(high for _, high in own)
    spans = [common_span(tissue.parameter_sets, speed, HOLD_S) for speed in tissue.velocities_mm_s]  # type: ignore[arg-type]
    known = [span for span in spans if span is not None]
    return (min(low for low, _ in known), max(high for _, high in known)) if known else PAPER_N


def limits_of_subjects(tissue: Tissue) -> tuple[NDArray, NDArray]:
    """Deepest press and strongest peak of each subject, shapes (subjects,). [mm, N]"""
    law, subjects = law_named(tissue.law), tissue.parameter_sets
    speeds = tissue.velocities_mm_s or (10.0,)
    if tissue.measured:
        depth = np.array([max(press.depth_mm for press in one.presses) for one in subjects])  # type: ignore[attr-defined]
        peak = np.array([max(max(p.rise_N.max(), p.hold_N.max()) for p in one.presses) for one in subjects])  # type: ignore[attr-defined]
        return depth, peak
    if not law.fitted:
        return (np.full(len(subjects), np.inf),) * 2
    _, force, assumed_mm = law.press(subjects, PAPER_N[1], max(speeds), HOLD_S, DECELERATION_MM_S2)
    own = [one.pressed for one in tissue.subjects]
    depth = np.array([one[DEPTH].high if one else deep for one, deep in zip(own, assumed_mm)])
    peak = np.array([one[PEAK].high if one else strong for one, strong in zip(own, force.max(axis=-1))])
    return depth, peak

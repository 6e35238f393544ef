"""The range in which people were pressed, and how far a press goes beyond it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import DECELERATION_MM_S2, HOLD_S
from dummydesign.tissue.comparison import PAPER_N
from dummydesign.tissue.model.measured_curves import FORCE_FACTOR, SPEED_FACTOR, common_span
from dummydesign.tissue.model.tissue import PRESSED

if TYPE_CHECKING:
    from dummydesign.person.drives.drive import Response
    from dummydesign.tissue.model.tissue import Tissue

STEADY, DEPTH, PEAK = PRESSED
NEAR = 1.05
"""Factor up to which a press still counts as inside."""


@dataclass(frozen=True)
class Beyond:
    """One way in which a press leaves the range: what, its value, the end of the range, and words."""

    quantity: str
    value: float
    end: float
    text: str


def beyond_range(tissue: Tissue, response: Response, velocity_mm_s: float) -> list[Beyond]:
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
    speeds, rows = tissue.velocities_mm_s, list[Beyond]()
    if speeds:
        slow, fast = min(speeds), max(speeds)
        if not slow / SPEED_FACTOR <= velocity_mm_s <= fast * SPEED_FACTOR:
            end = fast if velocity_mm_s > fast else slow
            words = f"{velocity_mm_s:g} mm/s, people were pressed at {slow:g} to {fast:g} mm/s"
            rows.append(Beyond("velocity_mm_s", velocity_mm_s, end, words))
    held = response.steady_N[np.isfinite(response.steady_N)]
    if held.size and float(held.min()) < low / FORCE_FACTOR:
        rows.append(Beyond("steady_force_N", float(held.min()), low,
                           f"{float(held.min()):.3g} N steady, people were pressed from {low:g} N on"))  # fmt: skip
    if held.size and float(held.max()) > high * FORCE_FACTOR:
        rows.append(Beyond("steady_force_N", float(held.max()), high,
                           f"{float(held.max()):.3g} N steady, people were pressed up to {high:g} N"))  # fmt: skip
    deepest, strongest = _limits(tissue)
    for quantity, values, ends, unit in (
        ("depth_mm", response.depth_mm, deepest, "mm deep"),
        ("peak_force_N", response.peak_N, strongest, "N at the peak"),
    ):
        over = values / ends
        worst = int(np.argmax(over))
        if over[worst] > NEAR:
            share, own = 100.0 * (over[worst] - 1.0), unit.partition(" ")[0]
            words = (f"{values[worst]:.3g} {unit} on {tissue.subjects[worst].name}, who was pressed to "
                     f"{ends[worst]:.3g} {own} ({share:.0f} % beyond)")  # fmt: skip
            rows.append(Beyond(quantity, float(values[worst]), float(ends[worst]), words))
    return rows


def _forces(tissue: Tissue) -> tuple[float, float]:
    """Lowest and highest steady force. [N]"""
    if not tissue.measured:
        steady = [one.pressed.get(STEADY) for one in tissue.subjects]
        own = [PAPER_N if one is None else (one.low, one.high) for one in steady]
        return max(low for low, _ in own), min(high for _, high in own)
    spans = [common_span(tissue.parameter_sets, speed, HOLD_S) for speed in tissue.velocities_mm_s]  # type: ignore[arg-type]
    known = [span for span in spans if span is not None]
    return (min(low for low, _ in known), max(high for _, high in known)) if known else PAPER_N


def _limits(tissue: Tissue) -> tuple[NDArray, NDArray]:
    """Deepest press and strongest peak of each subject, shapes (subjects,). [mm, N]"""
    from dummydesign.tissue.model.laws import law_named

    law, subjects = law_named(tissue.law), tissue.parameter_sets
    speeds = tissue.velocities_mm_s or (10.0,)
    if tissue.measured:
        depth = np.array([max(press.depth_mm for press in one.presses) for one in subjects])  # type: ignore[attr-defined]
        peak = np.array([max(max(p.rise_N.max(), p.hold_N.max()) for p in one.presses) for one in subjects])  # type: ignore[attr-defined]
        return depth, peak
    if not law.fitted:
        return np.full(len(subjects), np.inf), np.full(len(subjects), np.inf)
    _, force, assumed_mm = law.press(subjects, PAPER_N[1], max(speeds), HOLD_S, DECELERATION_MM_S2)
    own = [one.pressed for one in tissue.subjects]
    depth = np.array([one[DEPTH].high if one else deep for one, deep in zip(own, assumed_mm)])
    peak = np.array([one[PEAK].high if one else strong for one, strong in zip(own, force.max(axis=-1))])
    return depth, peak

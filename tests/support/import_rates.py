"""How many machine files are read right, wrong, wrong without a word, and refused."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.read import Imported, import_files
from tests.support.machine_files import MachineFile

CONTACT_MM, CONTACT_SHARE = 0.15, 0.04
"""What a contact may be off where it has to be found by the force: 0.15 mm or 4 % of the depth."""

ABOUT_CONTACT = {"contact_uncertain", "contact_may_be_late", "contact_not_checked", "another_place", "surface_not_back"}


@dataclass(frozen=True)
class Outcome:
    """``right``, ``wrong`` or ``refused``; whether a warning speaks of what is wrong; and what was wrong or said."""

    verdict: str
    warned: bool
    text: str


def judge(
    made: MachineFile, folder: Path, contact_mm: float = CONTACT_MM, contact_share: float = CONTACT_SHARE
) -> Outcome:
    """Import one file and hold what comes out against the truth; a contact may be off by the larger of the two."""
    path = folder / made.name
    path.write_bytes(made.data)
    try:
        found = import_files([path])[0][0]
    except InputError as refusal:
        return Outcome("refused", True, str(refusal))
    finally:
        path.unlink()
    fault = _fault(made, found, contact_mm, contact_share)
    told = {warning["code"] for warning in found.warnings}
    warned = bool(told & ABOUT_CONTACT) if fault.startswith("contact") else bool(told)
    codes = ", ".join(sorted({warning["code"] for warning in found.warnings}))
    return Outcome("wrong" if fault else "right", warned, fault or codes)


def _fault(made: MachineFile, found: Imported, contact_mm: float, contact_share: float) -> str:
    """What is wrong with the presses; empty where all is right."""
    truth = made.recording
    if len(found.presses) != len(truth.depth_mm):
        return f"{len(found.presses)} presses instead of {len(truth.depth_mm)}"
    first = 0
    for press, depth in zip(found.presses, truth.depth_mm):
        count = len(press.time_s)
        part = slice(first, first + count)
        first += count
        x, force = truth.displacement_mm[part], truth.true_force_N[part]
        time = truth.time_s[part] - truth.time_s[part][0]
        if len(x) != count:
            return "samples are missing"
        if np.max(np.abs(time - press.time_s)) > 2e-4 * max(1.0, time[-1]):
            return f"time differs by {np.max(np.abs(time - press.time_s)):.3g} s"
        off = float(np.median(press.displacement_mm - x))
        if np.max(np.abs(press.displacement_mm - x - off)) > 0.01:
            return "position is another quantity, sign or unit"
        if abs(off) > max(contact_mm, contact_share * depth):
            return f"contact is off by {off:.3f} mm of {depth:.2f} mm"
        apart = press.force_N - force
        if np.max(np.abs(apart - np.median(apart))) > 0.02 * force.max() + 8.0 * truth.noise_N:
            return "force is another quantity, sign or unit"
        if abs(float(np.mean(apart))) > 0.01 * truth.true_force_N.max() + truth.noise_N:
            return f"tare is off by {np.mean(apart):.4f} N"
        speed = press.summary.velocity_mm_s
        # below its top speed where it brakes all the way from far above is no matter of reading
        if not 0.7 * truth.velocity_mm_s < speed < 1.05 * truth.velocity_mm_s:
            return f"speed {speed:.4g} instead of {truth.velocity_mm_s:g} mm/s"
    if first != len(truth.time_s):
        return "samples are missing"
    return ""

"""Checks of a mould, each with what was measured, its limit and the verdict: of solids, files, release and process."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any

from dummydesign.mold.model.spec import MouldSpec


@dataclass(frozen=True)
class Check:
    """One check: what was measured, the limit and the verdict."""

    id: str
    value: Any
    limit: Any
    status: str
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return the fields; a note only when there is one."""
        plain = {"id": self.id, "value": self.value, "limit": self.limit, "status": self.status}
        return {**plain, "note": self.note} if self.note else plain


def below(name: str, value: float, limit: float, note: str = "") -> Check:
    """Check that a finite value is at most a limit."""
    good = math.isfinite(value) and value <= limit
    return Check(name, value, limit, "pass" if good else "fail", note)


def above(name: str, value: float, limit: float, note: str = "") -> Check:
    """Check that a value is at least a limit."""
    return Check(name, value, limit, "pass" if value >= limit else "fail", note)


def equal(name: str, value: Any, limit: Any, note: str = "") -> Check:
    """Check that a value is exactly the limit."""
    return Check(name, value, limit, "pass" if value == limit else "fail", note)


def skipped(name: str, why: str) -> Check:
    """A check that could not be made, and why."""
    return Check(name, None, None, "skipped", why)


def genera(spec: MouldSpec) -> Counter[str]:
    """How many holes go through each part: 8 bolts, 3 level screws, sprue and vents, the frame's opening."""
    # Vents and screws of a bone's carrier; that of several crowns only has marks.
    carrier = 8 if spec.pad.shape.bone_height_mm else 0
    if spec.is_printed:
        # Eight bolts, two pins, three levelling screws; the ring's openings.
        return Counter(mould=13, frame=13 + spec.count, collar=1, carrier=carrier)
    lid = 0 if spec.closure is None else 6
    return Counter(master=8, frame=9, tray=3, collar=1, lid=lid, backer=lid, lid_master=8, lid_frame=9, carrier=carrier)

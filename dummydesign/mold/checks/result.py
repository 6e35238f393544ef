"""One check of a mould: what was measured, its limit and the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Check:
    """One check: what was measured, the limit it was held against and the verdict."""

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

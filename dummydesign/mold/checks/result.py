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
    """Check that a finite value is at most a limit.

    Parameters
    ----------
    name : str
        What was checked, a key in the result.
    value : float
        What was measured.
    limit : float
        What it is compared with, in the same unit.
    note : str
        Unit or circumstances, for the reader.

    Returns
    -------
    Check
    """
    good = math.isfinite(value) and value <= limit
    return Check(name, value, limit, "pass" if good else "fail", note)


def above(name: str, value: float, limit: float, note: str = "") -> Check:
    """Check that a value is at least a limit.

    Parameters
    ----------
    name : str
        What was checked, a key in the result.
    value : float
        What was measured.
    limit : float
        What it is compared with, in the same unit.
    note : str
        Unit or circumstances, for the reader.

    Returns
    -------
    Check
    """
    return Check(name, value, limit, "pass" if value >= limit else "fail", note)


def equal(name: str, value: Any, limit: Any, note: str = "") -> Check:
    """Check that a value is exactly the limit.

    Parameters
    ----------
    name : str
        What was checked, a key in the result.
    value, limit : object
        What was found and what it must be.
    note : str
        Circumstances, for the reader.

    Returns
    -------
    Check
    """
    return Check(name, value, limit, "pass" if value == limit else "fail", note)


def skipped(name: str, why: str) -> Check:
    """A check that could not be made, and why."""
    return Check(name, None, None, "skipped", why)

"""What is kept of the puck behind a measured point: which recording it was, and the arms its holds showed."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity, read_quantity

if TYPE_CHECKING:
    from dummydesign.measurement.trace import Trace

_KEYS = ("sha256", "file", "diameter_mm", "height_mm", "seen_s", "arm")


@dataclass(frozen=True)
class PuckPoint:
    """A puck's recording.

    Attributes
    ----------
    sha256 : str
        Of the numbers of the recording: the same puck under another file name is known again.
    file : str
    diameter_mm, height_mm : float
    seen_s : (float, float) or None
        Shortest and longest time its holds show; None without holds. [s]
    arms : tuple of (tau_s, beta)
        What the holds showed, strengths relative to the long-term modulus at the point's ratio.
    """

    sha256: str
    file: str
    diameter_mm: float
    height_mm: float
    seen_s: tuple[float, float] | None = None
    arms: tuple[tuple[Quantity, Quantity], ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return plain values as they stand in a resin file."""
        plain: dict[str, Any] = {
            "sha256": self.sha256, "file": self.file, "diameter_mm": self.diameter_mm, "height_mm": self.height_mm,
        }  # fmt: skip
        if self.seen_s is not None:
            plain["seen_s"] = list(self.seen_s)
        if self.arms:
            plain["arm"] = [{"tau_s": tau.to_dict(), "beta": beta.to_dict()} for tau, beta in self.arms]
        return plain


def recording_sha256(trace: Trace) -> str:
    """SHA-256 of a trace's numbers."""
    digest = hashlib.sha256()
    for column in (trace.time_s, trace.displacement_mm, trace.force_N):
        digest.update(column.astype("<f8").tobytes())
    return digest.hexdigest()


def read_puck_point(table: Mapping[str, Any], path: Path) -> PuckPoint:
    """Read the table ``[point.puck]`` of a resin file.

    Raises
    ------
    InputError
        When a key is missing, unknown or of another kind.
    """
    if not isinstance(table, dict) or not set(table) <= set(_KEYS) or not set(_KEYS[:4]) <= set(table):
        raise InputError(f"{path.name}: [point.puck] needs {', '.join(_KEYS[:4])} and may have seen_s and arm")
    try:
        seen = table.get("seen_s")
        arms = tuple((read_quantity(arm, "tau_s", path), read_quantity(arm, "beta", path)) for arm in _arms(table))
        return PuckPoint(
            str(table["sha256"]), str(table["file"]), float(table["diameter_mm"]), float(table["height_mm"]),
            None if seen is None else (float(seen[0]), float(seen[1])), arms,
        )  # fmt: skip
    except (TypeError, ValueError, IndexError, KeyError):
        raise InputError(f"{path.name}: a number of [point.puck] is not one") from None


def _arms(table: Mapping[str, Any]) -> list[dict[str, Any]]:
    arms = table.get("arm", [])
    if not isinstance(arms, list) or not all(isinstance(arm, dict) for arm in arms):
        raise TypeError
    return arms

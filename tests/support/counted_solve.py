"""A stand-in for a long solve, and the entries that a cache folder holds."""

from pathlib import Path
from typing import Any


class CountedSolve:
    """Counts how often it was asked."""

    def __init__(self, value: dict[str, Any] | None = None) -> None:
        self.calls, self.value = 0, {"force": 2.5} if value is None else value

    def __call__(self) -> dict[str, Any]:
        self.calls += 1
        return self.value


def entries(place: Path) -> list[Path]:
    """Files of all kept results."""
    return sorted(place.glob("*.json"))

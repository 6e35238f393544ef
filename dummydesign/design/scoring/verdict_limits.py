"""The limits of the verdict, read from ``materials/verdict.toml``."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import find, read_toml
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import KINDS, line_of, read_quantity

KIND, NAME = "materials", "verdict"
NUMBERS = {
    "stands_for": {"shortfall": "stands_shortfall", "over": "stands_over", "inside": "stands_inside"},
    "usable": {"shortfall": "shortfall", "shortfall_castings": "shortfall_castings", "over": "over",
               "beyond_people": "beyond_people"},
    "castings": {"share": "share"},
    "bottoming_out": {"gel_compression": "gel_compression"},
    "choice": {"tie": "tie"},
}
BOUNDS = {
    "beyond_people": (1.0, 10.0), "stands_inside": (0.0, 1.0), "share": (0.5, 0.999),
    "gel_compression": (0.05, 0.6), "tie": (0.0, 0.1),
}  # fmt: skip
FACTORS = (1.0, 3.0)
"""Allowed range of shortfalls and over-readings."""


@dataclass(frozen=True)
class VerdictLimits:
    """Limits of shortfall and over-reading, of the share of castings, of the gel's compression, and of a tie.

    ``stands_*`` are those of green; ``shortfall`` and ``over`` those of amber at central estimates, and
    ``shortfall_castings`` that for ``share`` of the castings. ``beyond_people`` limits the largest steady force of the
    test over the hardest press of people.
    """

    stands_shortfall: float
    stands_over: float
    stands_inside: float
    shortfall: float
    shortfall_castings: float
    over: float
    beyond_people: float
    share: float
    gel_compression: float
    tie: float
    origin: str = "built-in"

    def to_dict(self) -> dict[str, Any]:
        """Return all limits and where they come from."""
        return asdict(self)

    def moved(self, name: str, factor: float) -> VerdictLimits:
        """The limits with one of them multiplied by a factor.

        Parameters
        ----------
        name : str
            A field.
        factor : float
        """
        return replace(self, **{name: factor * getattr(self, name)})


def verdict_limits() -> VerdictLimits:
    """Read the limits: the user's own file where there is one, else the built-in one.

    Raises
    ------
    InputError
        With file and line when the file breaks its form, or limits contradict each other.
    """
    entry = find(KIND, NAME, NAME)
    return replace(_read(entry.path, entry.path.stat().st_mtime_ns), origin=entry.origin)


@lru_cache(maxsize=4)
def _read(path: Path, changed_ns: int) -> VerdictLimits:
    """Read again when the file has changed."""
    content, text = read_toml(path)
    if content.get("schema") != 1:
        raise InputError(f"{path.name}: schema = {content.get('schema')!r} is not 1")
    for key in content:
        if key not in ("schema", *NUMBERS):
            raise unknown_name(f"table of {path.name}:{line_of(text, f'[{key}')}", key, list(NUMBERS))
    values: dict[str, float] = {}
    for name, fields in NUMBERS.items():
        values |= _table(name, content.get(name), fields, path, text)
    found = VerdictLimits(**values)
    for lower, upper in (
        ("stands_shortfall", "shortfall"), ("shortfall", "shortfall_castings"), ("stands_over", "over"),
    ):  # fmt: skip
        if values[lower] > values[upper]:
            raise InputError(
                f"{path.name}: {_typed(lower)} = {values[lower]:g} is above {_typed(upper)} = {values[upper]:g}; "
                f"give at most {values[upper]:g}"
            )
    return found


def _table(name: str, table: Any, fields: dict[str, str], path: Path, text: str) -> dict[str, float]:
    """The numbers of one table, by the fields of the limits."""
    if not isinstance(table, dict):
        raise InputError(f"{path.name}: table [{name}] is missing; it needs {', '.join(fields)}")
    for key in table:
        if key not in fields:
            raise unknown_name(f"limit of {path.name}:{line_of(text, f'{name}.{key}')}", key, list(fields))
    values = {}
    for key, field in fields.items():
        value = read_quantity(table, key, path, _from(text, f"{name}.{key}"), kinds=(*KINDS, "choice")).value
        low, high = BOUNDS.get(field, FACTORS)
        if not low <= value <= high:
            where = f"{path.name}:{line_of(text, f'{name}.{key}')}"
            raise InputError(f"{where}: {name}.{key} = {value:g} is outside {low:g} to {high:g}")
        values[field] = value
    return values


def _from(text: str, entry: str) -> str:
    """The text from an entry on, the lines before it empty: a message names its line, not one that says its name."""
    lines = text.splitlines()
    start = next((row for row, line in enumerate(lines) if line.strip().startswith(f"[{entry}]")), 0)
    return "\n".join([""] * start + lines[start:])


def _typed(field: str) -> str:
    """A field as it stands in the file."""
    return next(f"{name}.{key}" for name, keys in NUMBERS.items() for key, known in keys.items() if known == field)

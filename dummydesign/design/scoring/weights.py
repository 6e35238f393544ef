"""The weights of the score, read from ``materials/score.toml``: which set an aim is scored by, and its numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import find, read_toml
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import Quantity, line_of, read_quantity

KIND, NAME = "materials", "score"
PARTS = ("aim", "steady_state_range", "force_variation_range", "parametric")
OTHERS = ("low_aim", "not_representative", "borderline", "resolution")
AIMS = ("average", "safe-side", "subject")


@dataclass(frozen=True)
class Weights:
    """One set of weights.

    Attributes
    ----------
    name : str
        Of the set.
    origin : str
        ``built-in`` or ``user``.
    numbers : tuple of (str, Quantity)
        Weight of each part of the total, share of small forces in the merit, what the merit of a design counts that
        is not representative, and the difference in worth below which castings decide.
    """

    name: str
    origin: str
    numbers: tuple[tuple[str, Quantity], ...]

    def __getitem__(self, name: str) -> float:
        """Value of a number of the set."""
        return dict(self.numbers)[name].value

    @property
    def parts(self) -> dict[str, float]:
        """Weights of the parts of the total; they sum to 1."""
        return {name: self[name] for name in PARTS if name in dict(self.numbers)}

    def without(self, part: str) -> Weights:
        """The set without a part that a tissue does not have; the other parts grow so that they sum to 1."""
        rest = 1.0 - self[part]
        if not rest > 0.0:
            raise InputError(f"weights {self.name}: nothing but {part} is weighed, which this tissue does not have")
        kept = []
        for name, number in self.numbers:
            if name in PARTS and name != part:
                value = number.value / rest
                number = replace(number, value=value, low=min(number.low, value), high=max(number.high, value))
            if name != part:
                kept.append((name, number))
        return replace(self, numbers=tuple(kept))

    @property
    def low_aim(self) -> float:
        """Share, in the merit, of the closeness to the aim below the lowest force."""
        return self["low_aim"]

    @property
    def worth(self) -> tuple[float, float, float]:
        """What the merit of a design counts by its :mod:`~dummydesign.design.scoring.acceptability`."""
        return self["not_representative"], self["borderline"], 1.0

    @property
    def resolution(self) -> float:
        """Difference in worth below which designs are alike."""
        return self["resolution"]

    def to_dict(self) -> dict[str, Any]:
        """Return the set's name, where it comes from and its values."""
        return {"set": self.name, "origin": self.origin, **{name: number.value for name, number in self.numbers}}


def weights_of(aim: str) -> Weights:
    """The set of weights that an aim is scored by.

    Parameters
    ----------
    aim : str
        ``average``, ``safe-side`` or ``subject:NAME``.

    Raises
    ------
    InputError
        With file and line when the file breaks its form.
    """
    entry = find(KIND, "score", NAME)
    return _read(entry.path, entry.origin, entry.path.stat().st_mtime_ns)[aim.lower().partition(":")[0]]


@lru_cache(maxsize=4)
def _read(path: Path, origin: str, changed_ns: int) -> dict[str, Weights]:
    """Sets by aim; read again when the file has changed."""
    content, text = read_toml(path)
    for key in content:
        if key not in ("schema", "aims", "sets"):
            raise unknown_name(f"entry of {path.name}:{line_of(text, key)}", key, ["schema", "aims", "sets"])
    if content.get("schema") != 1:
        raise InputError(f"{path.name}: schema = {content.get('schema')!r} is not 1")
    aims, sets = content.get("aims"), content.get("sets")
    if not isinstance(aims, dict) or not isinstance(sets, dict):
        raise InputError(f"{path.name}: needs a table [aims] and tables [sets.NAME.WEIGHT]")
    read = {name: _set(name, table, path, text, origin) for name, table in sets.items()}
    for aim in AIMS:
        if aims.get(aim) not in read:
            raise InputError(f"{path.name}: aim {aim} = {aims.get(aim)!r} names no set; known are {', '.join(read)}")
    return {aim: read[aims[aim]] for aim in AIMS}


def _set(name: str, table: Any, path: Path, text: str, origin: str) -> Weights:
    if not isinstance(table, dict):
        raise InputError(f"{path.name}: set '{name}' is no table of weights")
    for key in table:
        if key not in (*PARTS, *OTHERS):
            raise unknown_name(f"weight of {path.name}:{line_of(text, f'{name}.{key}')}", key, [*PARTS, *OTHERS])
    found = Weights(name, origin, tuple((key, read_quantity(table, key, path, text)) for key in (*PARTS, *OTHERS)))
    for key, number in found.numbers:
        if not 0.0 <= number.value <= 1.0:
            where = f"{path.name}:{line_of(text, f'{name}.{key}')}"
            raise InputError(f"{where}: {key} = {number.value:g} of set '{name}' is outside 0 to 1")
    if abs(sum(found.parts.values()) - 1.0) > 1e-9:
        raise InputError(f"{path.name}: the weights {', '.join(PARTS)} of set '{name}' sum to "
                         f"{sum(found.parts.values()):g}, not 1")  # fmt: skip
    return found

"""Weights of the score and limits of the verdict, read from data files."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import KINDS, Quantity
from dummydesign.core.serialise import Serialised
from dummydesign.core.toml_schema import TomlTable, read_table
from dummydesign.core.user_library import find
from dummydesign.tissue.model.people_share import is_share

PARTS = ("aim", "steady_state_range", "force_variation_range", "parametric")
# Entries of earlier editions in a user's own file, and what to do with them.
OLD_WEIGHTS = dict.fromkeys(
    ("low_aim", "not_representative", "borderline", "resolution"),
    "pads are chosen by the castings that are usable, not by a score: delete it",
)
AIMS = ("average", "safe-side", "subject")


@dataclass(frozen=True)
class Weights:
    """One set of weights."""

    name: str
    origin: str
    numbers: dict[str, Quantity]

    def __getitem__(self, name: str) -> float:
        """Value of a number of the set."""
        return self.numbers[name].value

    @property
    def parts(self) -> dict[str, float]:
        """Weights of the parts of the total; they sum to 1."""
        return {name: self[name] for name in PARTS if name in self.numbers}

    def without(self, part: str) -> Weights:
        """The set without a part that a tissue does not have; the other parts grow so that they sum to 1."""
        rest = 1.0 - self[part]
        if not rest > 0.0:
            message = f"weights {self.name}: nothing but {part} is weighed, which this tissue does not have"
            raise InputError(message, "inconsistent", "weights", self.name)
        kept = {name: number for name, number in self.numbers.items() if name != part}
        for name in PARTS:
            if name != part:
                number, value = kept[name], self[name] / rest
                kept[name] = replace(number, value=value, low=min(number.low, value), high=max(number.high, value))
        return replace(self, numbers=kept)

    def to_dict(self) -> dict[str, Any]:
        """Return the set's name, where it comes from and its values."""
        return {"set": self.name, "origin": self.origin, **{name: self[name] for name in self.numbers}}


FILES = ("score", "verdict", "puck", "making")


def settings_files() -> dict[str, Path]:
    """Files of weights, limits, puck's error and making, the user's own where there are any, by what they are."""
    return {f"materials/{name}": find("materials", name, name).path for name in FILES}


def puck_error() -> float:
    """Read the standard deviation of ln modulus that a puck's test leaves: the user's own file or the built-in one."""
    top = read_table(find("materials", "puck", "puck").path, ("schema", "modulus_error"))
    return _bounded(top, "modulus_error", 0.0, 1.0).value


@dataclass(frozen=True)
class CrownMaking(Serialised):
    """Errors of a crown, by the step that makes them: print, plug (its finish) and cast.

    ``height_mm`` is that of the height over the flat, ``tip_radius_percent`` that of the tip radius.
    """

    height_mm: dict[str, Quantity]
    tip_radius_percent: dict[str, Quantity]


STEPS = ("print", "plug", "cast")
LARGEST_ERROR = 2.0
"""Largest error of weighing [g] and of the thickness [mm]."""


@dataclass(frozen=True)
class PadMaking:
    """How well any pad is made, even within plus and minus the errors, and how many castings are drawn at least."""

    weighing_g: float = 0.1
    thickness_mm: float = 0.2
    castings: int = 1200


def pad_making() -> PadMaking:
    """Read how well a pad is made: the user's own file, else the built-in one; what it lacks has its usual value."""
    top = _making()
    errors = ("weighing_g", "thickness_mm")
    given = {name: _bounded(top, name, 0.0, LARGEST_ERROR).value for name in errors if name in top}
    return PadMaking(**given, castings=top.count("castings", PadMaking.castings))


def _making() -> TomlTable:
    keys = ("schema", "castings", "weighing_g", "thickness_mm", "crown_height_mm", "tip_radius_percent")
    return read_table(find("materials", "making", "making").path, keys)


def crown_making() -> CrownMaking:
    """Read how true a crown is made: the user's own file, else the built-in one."""
    top = _making()
    heights, radii = top.table("crown_height_mm").only(STEPS), top.table("tip_radius_percent").only(STEPS)
    return CrownMaking(
        {name: _bounded(heights, name, -1.0, 1.0) for name in STEPS},
        {name: _bounded(radii, name, -50.0, 50.0) for name in STEPS},
    )


def weights_of(aim: str) -> Weights:
    """The set of weights that an aim is scored by; a share of people is scored as the safe side is."""
    entry = find("materials", "score", "score")
    name = "safe-side" if is_share(aim) else aim.lower().partition(":")[0]
    return _read_weights(entry.path, entry.origin, entry.path.stat().st_mtime_ns)[name]


@lru_cache(maxsize=4)
def _read_weights(path: Path, origin: str, changed_ns: int) -> dict[str, Weights]:
    """Sets by aim; read again when the file has changed."""
    top = read_table(path, ("schema", "aims", "sets"))
    aims, sets = top.table("aims"), top.table("sets")
    read = {name: _set(sets.table(name), name, origin) for name in sets.data}
    return {aim: read[aims.string(aim, choices=list(read))] for aim in AIMS}


def _set(table: TomlTable, name: str, origin: str) -> Weights:
    _refuse_old(table, OLD_WEIGHTS)
    table.only(PARTS)
    weights = Weights(name, origin, {key: _bounded(table, key, 0.0, 1.0) for key in PARTS})
    total = sum(weights.parts.values())
    if abs(total - 1.0) > 1e-9:
        message = f"{table.where()}: the weights {', '.join(PARTS)} of set '{name}' sum to {total:g}, not 1"
        raise InputError(message, "inconsistent", table.name)
    return weights


def _refuse_old(table: TomlTable, entries: dict[str, str]) -> None:
    """Refuse what an earlier edition read and this one does not, with what to do."""
    for key, advice in entries.items():
        if key in table:
            raise InputError(
                f"{table.where(key)}: '{key}' is of an earlier edition; {advice}", "unknown_key", f"{table.name}.{key}"
            )


def _bounded(table: TomlTable, key: str, low: float, high: float, kinds: tuple[str, ...] = KINDS) -> Quantity:
    """Read a quantity and refuse a value outside a range."""
    number = table.quantity(key, kinds)
    if not low <= number.value <= high:
        name = f"{table.name}.{key}"
        message = f"{table.where(key)}: {name} = {number.value:g} is outside {low:g} to {high:g}"
        raise InputError(message, "out_of_range", name, number.value, (low, high))
    return number


# Field of the limits by its place in the file.
NUMBERS = {
    "stands_for": {"shortfall": "stands_shortfall", "over": "stands_over", "inside": "stands_inside"},
    "usable": {name: name for name in ("shortfall", "over", "beyond_people")},
    "castings": {"share": "share"},
    "bottoming_out": {"gel_compression": "gel_compression"},
}
BOUNDS = {
    "beyond_people": (1.0, 10.0),
    "stands_inside": (0.0, 1.0),
    "share": (0.5, 0.999),
    "gel_compression": (0.05, 0.6),
}
# Allowed range of shortfalls and over-readings.
FACTORS = (1.0, 3.0)
# Each limit and one that it must not exceed.
RISING = (("stands_shortfall", "shortfall"), ("stands_over", "over"))
OLD_LIMITS = {
    "usable": {"shortfall_castings": "there is one row of limits: give this value as usable.shortfall and delete it"},
    "choice": {"tie": "nothing is tied by a limit any more: delete the table [choice]"},
}


@dataclass(frozen=True)
class VerdictLimits(Serialised):
    """Limits of shortfall and over-reading of a casting, of the share of castings, and of the gel's compression.

    A casting within ``stands_*`` stands for the subjects, one within ``shortfall`` and ``over`` is usable with a
    correction. ``stands_inside`` is the least share of peaks and of the steady curve among the subjects.
    ``beyond_people`` limits the largest steady force of the test over the hardest press of people.
    """

    stands_shortfall: float
    stands_over: float
    stands_inside: float
    shortfall: float
    over: float
    beyond_people: float
    share: float
    gel_compression: float
    origin: str = "built-in"

    def moved(self, name: str, factor: float) -> VerdictLimits:
        """The limits with one of them multiplied by a factor."""
        return replace(self, **{name: factor * getattr(self, name)})


def verdict_limits() -> VerdictLimits:
    """Read the limits: the user's own file where there is one, else the built-in one."""
    entry = find("materials", "verdict", "verdict")
    return replace(_read_limits(entry.path, entry.path.stat().st_mtime_ns), origin=entry.origin)


@lru_cache(maxsize=4)
def _read_limits(path: Path, changed_ns: int) -> VerdictLimits:
    """Read again when the file has changed."""
    top = read_table(path, ("schema", *NUMBERS, "choice"))
    for name, entries in OLD_LIMITS.items():
        _refuse_old(top.table(name, required=False), entries)
    values: dict[str, Any] = {}
    typed: dict[str, str] = {}
    for name, keys in NUMBERS.items():
        table = top.table(name)
        table.only(keys)
        for key, field in keys.items():
            values[field] = _bounded(table, key, *BOUNDS.get(field, FACTORS), (*KINDS, "choice")).value
            typed[field] = f"{name}.{key}"
    for lower, upper in RISING:
        if values[lower] > values[upper]:
            raise InputError(
                f"{path.name}: {typed[lower]} = {values[lower]:g} is above {typed[upper]} = {values[upper]:g}; "
                f"give at most {values[upper]:g}",
                "inconsistent",
                typed[lower],
                values[lower],
            )
    return VerdictLimits(**values)

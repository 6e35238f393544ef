"""Calibration files: written as JSON, and read so that any other content ends in an InputError that names the place."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign._version import __version__
from dummydesign.core.errors import InputError
from dummydesign.core.files import reading, write_text
from dummydesign.geometry.interface import BASES, CONDITIONS, FRICTION, Interface
from dummydesign.loop.calibration import PADS, Calibration, Model, Posterior
from dummydesign.loop.data.pad_modulus_factors import USUAL
from dummydesign.loop.effects.learned import Learned, SmoothChange, followed_by
from dummydesign.loop.effects.registry import known_effects
from dummydesign.loop.model.forward_model import (
    SMOOTH_TERMS,
    WAVES,
    Active,
    BaseParameters,
    base_names,
    parameter_names,
)
from dummydesign.loop.model.material import widest_bounds

SCHEMA = "dummydesign.calibration/1"
VERDICTS = ("effect", "none", "unexplained", "ambiguous")
SHAPES = ("slab", "cylinder")
LARGEST, LARGEST_CHANGE = 1e12, 10.0
LARGEST_LAW_ERROR = 0.5  # bound of the fit on each term of the law error
ROUNDING = 1e-6  # by how much of its range a number may lie outside, as one written at a bound may


def write_calibration(calibration: Calibration, path: str | Path) -> Path:
    """Write a calibration as JSON."""
    content = {
        "schema": SCHEMA,
        "version": __version__,
        "verdict": calibration.verdict,
        "unexplained_because": list(calibration.unexplained_because),
        "base": calibration.base.to_dict(),
        "after": calibration.after.to_dict(),
        "remainder_rmse_N": calibration.remainder_N,
        "noise_floor_N": calibration.noise_floor_N,
        "pad": calibration.pad,
        **({} if calibration.posterior is None else {"posterior": calibration.posterior.to_dict()}),
    }
    return write_text(path, json.dumps(content, indent=1) + "\n")


def read_calibration(path: str | Path) -> Calibration:
    """Read a calibration file.

    Keys that are not known are passed over, so that files of later versions can be read; ``belongs_to`` of an
    effect is written for the reader of the file, what counts is the effect's class.
    """
    path = Path(path)
    name = f"calibration file '{path.name or path}'"
    with reading("calibration file", path, "calibration"):
        text = path.read_text(encoding="utf-8")
    try:
        data = json.loads(text)
    except (RecursionError, ValueError) as problem:
        raise InputError(f"{name} cannot be read: {problem}", "file_unreadable", "calibration") from None
    version = str(data.get("schema")) if isinstance(data, dict) else ""
    if version != SCHEMA and version.startswith(SCHEMA.rpartition("/")[0]):
        raise InputError(
            f"{name} is of another version: schema = {_shown(version)}, this one reads {SCHEMA}; run loop "
            "again, or update dummydesign",
            "unsupported",
            "schema",
            allowed=SCHEMA,
        )
    if not isinstance(data, dict) or version != SCHEMA:
        raise InputError(f"{name} is not one: schema must be {SCHEMA}", "file_unreadable", "calibration")
    try:
        return _calibration(_Entry(data))
    except _Fault as fault:
        raise InputError(f"{name} is damaged: {fault}; run loop again", "malformed", "calibration") from None


class _Fault(Exception):
    """An entry that cannot be used."""


KINDS: dict[Any, str] = {dict: "a table", list: "a list", str: "a text"}


@dataclass(frozen=True)
class _Entry:
    """A value of the file, and where it lies in it."""

    value: Any
    at: str = ""

    def fault(self, words: str) -> _Fault:
        """Make the fault of this entry: where it is, its value, and what is wrong."""
        return _Fault(f"{self.at} = {_shown(self.value)} {words}")

    def of(self, kind: type) -> Any:
        """Return the value, of one kind."""
        if not isinstance(self.value, kind):
            raise self.fault(f"is not {KINDS[kind]}")
        return self.value

    def __getitem__(self, key: str) -> _Entry:
        at = f"{self.at}.{key}" if self.at else key
        if key not in self.of(dict):
            raise _Fault(f"{at} is missing")
        return _Entry(self.value[key], at)

    def get(self, key: str) -> _Entry | None:
        """Return an entry that may be left out or null."""
        return None if self.of(dict).get(key) is None else self[key]

    def items(self) -> list[_Entry]:
        """Return the entries of a list."""
        return [_Entry(value, f"{self.at}[{number}]") for number, value in enumerate(self.of(list))]

    def text(self, choices: tuple[str, ...] = ()) -> str:
        """Return a text, one of the choices where there are any."""
        if self.of(str) not in choices and choices:
            raise self.fault(f"is not one of {', '.join(choices)}")
        return self.value

    def interface(self, known: tuple[str, ...]) -> str:
        """Return how two faces meet: one of some names, or a friction."""
        if Interface.find(self.of(str), known) is None:
            raise self.fault(f"is not one of {', '.join(known)}, {FRICTION}")
        return self.value

    def number(self, low: float, high: float = math.inf) -> float:
        """Return a finite number within its range, both ends included."""
        value = self.value
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
            raise self.fault("is not a finite number")
        slack = ROUNDING * (high - low if math.isfinite(high - low) else 0.0)
        if not low - slack <= value <= high + slack:
            raise _Fault(f"{self.at} = {value:g} is outside the allowed range {low:g} to {high:g}")
        return float(value)

    def positive(self) -> float:
        """Return a number above 0."""
        value = self.number(0.0)
        if value == 0.0:
            raise self.fault("must be above 0")
        return value

    def numbers(self, low: float, high: float) -> list[float]:
        """Return a list of numbers."""
        return [one.number(low, high) for one in self.items()]


def _shown(value: Any) -> str:
    """A value in a message: short, on one line, in printable characters."""
    text = ascii(value) if isinstance(value, str) else type(value).__name__
    if isinstance(value, bool | int | float):
        text = f"{value}" if not isinstance(value, int) or value.bit_length() < 64 else "a number of many digits"
    return text if len(text) <= 60 else text[:57] + "..."


def _calibration(data: _Entry) -> Calibration:
    after, reasons, posterior = _model(data["after"]), data.get("unexplained_because"), data.get("posterior")
    left = data["remainder_rmse_N"]
    return Calibration(
        _model(data["base"]),
        after,
        data["verdict"].text(VERDICTS),
        {phase: left[phase].number(0.0) for phase in left.of(dict)},
        data["noise_floor_N"].number(0.0),
        _pad(data["pad"]),
        () if reasons is None else tuple(one.text() for one in reasons.items()),
        None if posterior is None else _posterior(posterior, after),
    )


def _posterior(table: _Entry, after: Model) -> Posterior:
    """Mean and covariance of the corrected model's parameters; the intervals in the file are for its reader."""
    names, forms = parameter_names(len(after.base.tau_s), [one.effect for one in after.active]), _forms(after)
    held = [name for name in names if name not in forms or name in table["names"].of(list)]
    if table["names"].value != held:
        raise _Fault(f"posterior.names must be {', '.join(names)}")
    mean = table["mean"].numbers(-LARGEST, LARGEST)
    matrix = [row.numbers(-LARGEST, LARGEST) for row in table["covariance"].items()]
    if {len(mean), len(matrix), *(len(row) for row in matrix)} != {len(held)}:
        raise _Fault(f"posterior must hold {len(held)} means and as many rows and columns of covariance")
    covariance = np.array(matrix)
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    if not np.allclose(covariance, covariance.T, rtol=1e-6, atol=1e-12 * (1.0 + spread.max()) ** 2):
        raise _Fault("posterior.covariance is not symmetric")
    scaled = covariance / np.outer(np.maximum(spread, 1e-150), np.maximum(spread, 1e-150))
    if np.diag(covariance).min() < 0.0 or np.linalg.eigvalsh(scaled)[0] < -1e-6:
        raise _Fault("posterior.covariance has a negative variance")
    for place, name in enumerate(names):
        if name not in held:  # a form that an earlier version did not have: its usual value, known as before any data
            usual, deviation = forms[name]
            mean.insert(place, usual)
            covariance = np.insert(np.insert(covariance, place, 0.0, axis=0), place, 0.0, axis=1)
            covariance[place, place] = deviation**2
    level, slope, curve = (table["pad_to_pad"][key].number(0.0, LARGEST_CHANGE) for key in PADS)
    return Posterior(tuple(names), np.array(mean), covariance, (level, slope, curve))


def _forms(after: Model) -> dict[str, tuple[float, float]]:
    """Usual value and standard deviation of each parameter of form, as a posterior keeps them."""
    pairs = [(one.effect, p) for one in after.active for p in one.effect.parameters]
    values = [(np.log(p.null), p.spread) if p.log else (p.null, p.spread * p.typical) for _, p in pairs if p.of_form]
    names = parameter_names(0, [one.effect for one in after.active])[1:]
    return dict(zip([name for name, (_, p) in zip(names, pairs) if p.of_form], values))


def _pad(table: _Entry) -> dict[str, Any]:
    """Set-up of the campaign; what was not declared is None."""
    young, resin, ratio, shape, base, contact, punch = (
        table.get(key) for key in ("young_kPa_expected", "resin", "ratio", "shape", "base", "contact", "punch")
    )
    slab = shape is None or shape.text(SHAPES) == "slab"
    if slab:
        table["base"].interface(BASES)
    return {
        "young_kPa_expected": young and young.positive(),
        "resin": resin and resin.text(),
        "ratio": ratio and ratio.positive(),
        "base": base and base.text(),
        "shape": "slab" if slab else "cylinder",
        "contact": contact and contact.interface(CONDITIONS),
        **({"punch": punch.text()} if punch else {}),
        **{key: usual.positive() for key in (*USUAL, "ogden_alpha") if (usual := table.get(key))},
    }


def _model(data: _Entry) -> Model:
    return Model(_base(data["base"]), _effects(data["effects"]), *_law_error(data["law_error"]))


def _base(table: _Entry) -> BaseParameters:
    count = sum(key.startswith("beta_") for key in table.of(dict))
    low, high = (1e3 ** (np.arange(1 + 2 * count) == 0) * np.exp(ends) for ends in widest_bounds(count))
    young, *arms = (table[key].number(*ends) for key, *ends in zip(base_names(count), low.tolist(), high.tolist()))
    return BaseParameters(1e-3 * young, tuple(arms[::2]), tuple(arms[1::2]))


def _effects(entries: _Entry) -> tuple[Active, ...]:
    known = {effect.name: effect for effect in known_effects()}
    active: dict[str, Active] = {}
    for entry in entries.items():
        name = entry["name"].text()
        follows = followed_by(name)
        if follows is not None:
            known[name] = _learned(entry, follows)
        if name not in known:
            own = "; an effect of your own is given with --effect FILE.py"
            raise entry["name"].fault(f"is not one of {', '.join(known)}{own}")
        if name in active:
            raise _Fault(f"{entry.at}: {name} is listed twice")
        given = entry["parameters"]
        # earlier versions have fewer parameters of form
        numbers = {
            p.name: p.null if p.of_form and p.name not in given.of(dict) else given[p.name].number(p.low, p.high)
            for p in known[name].parameters
        }
        active[name] = Active(known[name], numbers)
    return tuple(active.values())


def _learned(entry: _Entry, follows: tuple[str, ...]) -> Learned:
    """An effect that was learned, with its change over one quantity or two."""
    knots, values, pair = entry["knots"], entry["relative_change"], len(follows) == 2
    axes = [axis.numbers(-LARGEST, LARGEST) for axis in (knots.items()[:2] if pair else [knots])]
    table = [row.numbers(-LARGEST_CHANGE, LARGEST_CHANGE) for row in (values.items() if pair else [values])]
    counts = [len(table), *{len(row) for row in table}] if pair else [len(table[0])]
    rising = all(len(axis) >= 2 and all(a < b for a, b in pairwise(axis)) for axis in axes)
    if not rising or counts != [len(axis) for axis in axes]:
        raise _Fault(f"{entry.at}.knots must hold two numbers or more that rise, and relative_change as many")
    changes = tuple(tuple(row) for row in table)
    return Learned(SmoothChange(follows, tuple(tuple(axis) for axis in axes), changes if pair else changes[0]))


def _law_error(table: _Entry) -> tuple[tuple[tuple[str, float], ...], np.ndarray, float, float]:
    """Pads, of each shape by rising thickness; level, slope, curvature and waves (terms, pads); share of a level that
    goes over to other pads; depth over thickness to which the error was seen."""
    thickness = table["thickness_mm"].numbers(0.0, math.inf)
    terms = [row.numbers(-LARGEST_LAW_ERROR, LARGEST_LAW_ERROR) for row in table["level_slope_curve"].items()]
    shapes = tuple(one.text() for one in table["shape"].items()) if "shape" in table.value else ()
    if shapes and len(shapes) != len(thickness):
        raise _Fault(f"{table.at}.shape must hold {len(thickness)} texts")
    pads = tuple(zip(shapes or [""] * len(thickness), thickness))
    if not thickness or min(thickness) <= 0.0 or any(b[0] == a[0] and b[1] <= a[1] for a, b in pairwise(pads)):
        raise table["thickness_mm"].fault("must hold thicknesses above 0 that rise")
    waves = [[0.0] * len(thickness)] * WAVES
    if "waves" in table.value:
        waves = [row.numbers(-LARGEST_LAW_ERROR, LARGEST_LAW_ERROR) for row in table["waves"].items()]
    for name, rows, count in (("level_slope_curve", terms, SMOOTH_TERMS), ("waves", waves, WAVES)):
        if len(rows) != count or any(len(row) != len(thickness) for row in rows):
            raise _Fault(f"{table.at}.{name} must hold {count} rows of {len(thickness)} numbers")
    carried, reach = table.get("carried_to_other_pads"), table.get("known_to_depth_over_thickness")
    ends = 1.0 if carried is None else carried.number(0.0, 1.0), np.inf if reach is None else reach.positive()
    return pads, np.array(terms + waves), *ends

"""Calibration files: written as JSON, and read so that any other content ends in an InputError that names the place."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign._version import __version__
from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.geometry.interface import BASES, CONDITIONS, FRICTION, Interface
from dummydesign.loop.calibration import Calibration, Model
from dummydesign.loop.effects import known_effects
from dummydesign.loop.fitting.noise import LAW_TERMS
from dummydesign.loop.learned.effect import Learned, Shape
from dummydesign.loop.learned.pair import LearnedPair, Surface, followed_by
from dummydesign.loop.model.forward_model import Active
from dummydesign.loop.model.parameters import HIGH, LOW, NAMES, BaseParameters
from dummydesign.loop.posterior import PADS, Posterior

SCHEMA = "dummydesign.calibration/1"
VERDICTS = ("effect", "none", "unexplained")
SHAPES = ("slab", "cylinder")
LARGEST, LARGEST_CHANGE = 1e12, 10.0
LARGEST_LAW_ERROR = 0.5
"""Bound of the fit on each term of the law error."""
ROUNDING = 1e-6
"""By how much of its range a number may lie outside, as one written at a bound may."""


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
    }
    if calibration.posterior is not None:
        content["posterior"] = calibration.posterior.to_dict()
    return write_text(path, json.dumps(content, indent=1) + "\n")


def read_calibration(path: str | Path) -> Calibration:
    """Read a calibration file.

    Keys that are not known are passed over, so that files of later versions can be read; ``belongs_to`` of an
    effect is written for the reader of the file, what counts is the effect's class.

    Raises
    ------
    InputError
        When it is missing, not a calibration, or damaged, with the entry and what is allowed there.
    """
    path = Path(path)
    name = f"calibration file '{path.name}'"
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"calibration file '{path}' does not exist") from None
    except RecursionError:
        raise InputError(f"{name} cannot be read: nested too deeply") from None
    except (OSError, ValueError) as problem:
        raise InputError(f"{name} cannot be read: {problem}") from None
    version = str(data.get("schema")) if isinstance(data, dict) else ""
    if version != SCHEMA and version.startswith(SCHEMA.rpartition("/")[0]):
        raise InputError(f"{name} is of another version: schema = {_shown(version)}, this one reads {SCHEMA}; run loop "
                         "again, or update dummydesign")  # fmt: skip
    if not isinstance(data, dict) or version != SCHEMA:
        raise InputError(f"{name} is not one: schema must be {SCHEMA}")
    try:
        return _calibration(data)
    except _Fault as fault:
        raise InputError(f"{name} is damaged: {fault}; run loop again") from None


class _Fault(Exception):
    """An entry that cannot be taken."""


def _calibration(data: dict[str, Any]) -> Calibration:
    left = _entry(data, "remainder_rmse_N", dict, "")
    after = _model(_entry(data, "after", dict, ""), "after")
    return Calibration(
        _model(_entry(data, "base", dict, ""), "base"),
        after,
        _choice(data, "verdict", VERDICTS, ""),
        {phase: _number(left, phase, "remainder_rmse_N", 0.0) for phase in left},
        _number(data, "noise_floor_N", "", 0.0),
        _pad(_entry(data, "pad", dict, "")),
        _reasons(data),
        _posterior(_entry(data, "posterior", dict, ""), after) if "posterior" in data else None,
    )


def _posterior(table: dict[str, Any], after: Model) -> Posterior:
    """Mean and covariance of the corrected model's parameters; the intervals in the file are for its reader."""
    parameters = [(one.effect.name, p) for one in after.active for p in one.effect.parameters]
    added = {f"{name}.{p.name}" for name, p in parameters if p.added_later}
    names = [f"log {name}" for name in NAMES] + [f"{'log ' if p.log else ''}{name}.{p.name}" for name, p in parameters]
    written = _entry(table, "names", list, "posterior")
    if written != [name for name in names if name not in added or name in written]:
        raise _Fault(f"posterior.names must be {', '.join(names)}")
    names = written
    mean = _row(_entry(table, "mean", list, "posterior"), "posterior.mean", -LARGEST, LARGEST)
    rows = _entry(table, "covariance", list, "posterior")
    matrix = [_row(row, f"posterior.covariance[{place}]", -LARGEST, LARGEST) for place, row in enumerate(rows)]
    if len(mean) != len(names) or len(matrix) != len(names) or any(len(row) != len(names) for row in matrix):
        raise _Fault(f"posterior must hold {len(names)} means and as many rows and columns of covariance")
    covariance = np.array(matrix)
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    if not np.allclose(covariance, covariance.T, rtol=1e-6, atol=1e-12 * (1.0 + spread.max()) ** 2):
        raise _Fault("posterior.covariance is not symmetric")
    scaled = covariance / np.outer(np.maximum(spread, 1e-150), np.maximum(spread, 1e-150))
    if np.diag(covariance).min() < 0.0 or np.linalg.eigvalsh(scaled)[0] < -1e-6:
        raise _Fault("posterior.covariance has a negative variance")
    pads = _entry(table, "pad_to_pad", dict, "posterior")
    level, slope, curve = (_number(pads, key, "posterior.pad_to_pad", 0.0, LARGEST_LAW_ERROR) for key in PADS)
    return Posterior(tuple(names), np.array(mean), covariance, (level, slope, curve))


def _reasons(data: dict[str, Any]) -> tuple[str, ...]:
    """Why the verdict is unexplained; files of earlier versions do not say it."""
    rows = _entry(data, "unexplained_because", list, "") if "unexplained_because" in data else []
    for place, row in enumerate(rows):
        if not isinstance(row, str):
            raise _Fault(f"unexplained_because[{place}] = {_shown(row)} is not a text")
    return tuple(rows)


def _pad(table: dict[str, Any]) -> dict[str, Any]:
    """Set-up of the campaign; what was not declared is None."""

    def given(key: str) -> bool:
        return table.get(key) is not None

    shape = _choice(table, "shape", SHAPES, "pad") if given("shape") else "slab"
    if shape == "slab":
        base = _entry(table, "base", str, "pad")
        if Interface.find(base, BASES) is None:
            raise _Fault(f"pad.base = {_shown(base)} is not one of {', '.join(BASES)}, {FRICTION}")
    else:
        base = _entry(table, "base", str, "pad") if given("base") else None
    return {
        "young_kPa_expected": _positive(table, "young_kPa_expected", "pad") if given("young_kPa_expected") else None,
        "resin": _entry(table, "resin", str, "pad") if given("resin") else None,
        "ratio": _positive(table, "ratio", "pad") if given("ratio") else None,
        "base": base, "shape": shape,
        "contact": _contact(table) if given("contact") else None,
        **({"punch": _entry(table, "punch", str, "pad")} if given("punch") else {}),
    }


def _contact(table: dict[str, Any]) -> str:
    contact = _entry(table, "contact", str, "pad")
    if Interface.find(contact, CONDITIONS) is None:
        raise _Fault(f"pad.contact = {_shown(contact)} is not one of {', '.join(CONDITIONS)}, {FRICTION}")
    return contact


def _model(data: dict[str, Any], where: str) -> Model:
    return Model(
        _base(_entry(data, "base", dict, where), f"{where}.base"),
        _effects(_entry(data, "effects", list, where), f"{where}.effects"),
        *_law_error(_entry(data, "law_error", dict, where), f"{where}.law_error"),
    )


def _base(table: dict[str, Any], where: str) -> BaseParameters:
    units = (1e3, 1.0, 1.0, 1.0, 1.0)
    young, tau_1, beta_1, tau_2, beta_2 = (
        _number(table, key, where, float(unit * np.exp(low)), float(unit * np.exp(high)))
        for key, unit, low, high in zip(NAMES, units, LOW, HIGH)
    )
    return BaseParameters(1e-3 * young, (tau_1, tau_2), (beta_1, beta_2))


def _effects(entries: list[Any], where: str) -> tuple[Active, ...]:
    known = {effect.name: effect for effect in known_effects()}
    active: list[Active] = []
    for place, entry in enumerate(entries):
        at = f"{where}[{place}]"
        if not isinstance(entry, dict):
            raise _Fault(f"{at} = {_shown(entry)} is not a table")
        name = _entry(entry, "name", str, at)
        follows = followed_by(name)
        if follows is not None:
            known[name] = _learned(entry, follows, at)
        if name not in known:
            own = "; an effect of your own is given with --effect FILE.py"
            raise _Fault(f"{at}.name = {_shown(name)} is not one of {', '.join(known)}{own}")
        effect = known[name]
        if any(one.effect is effect for one in active):
            raise _Fault(f"{at}: {effect.name} stands there twice")
        values = _entry(entry, "parameters", dict, at)
        within = f"{at}.parameters"
        given = [p for p in effect.parameters if p.name in values or not p.added_later]
        numbers = {p.name: _number(values, p.name, within, p.low, p.high) for p in given}
        active.append(Active(effect, effect.null_values() | numbers))
    return tuple(active)


def _learned(entry: dict[str, Any], follows: tuple[str, ...], at: str) -> Learned:
    """An effect that was learned, with its curve or surface."""
    knots, values = (_entry(entry, key, list, at) for key in ("knots", "relative_change"))
    pair = len(follows) == 2
    axes = [_row(row, f"{at}.knots", -LARGEST, LARGEST) for row in ((*knots, [], [])[:2] if pair else [knots])]
    rows = values if pair else [values]
    table = [_row(row, f"{at}.relative_change", -LARGEST_CHANGE, LARGEST_CHANGE) for row in rows]
    for one, count in ((axes[0], len(table if pair else table[0])), *((axes[-1], len(row)) for row in table)):
        if len(one) < 2 or count != len(one) or any(b <= a for a, b in pairwise(one)):
            raise _Fault(f"{at}.knots must hold two numbers or more that rise, and relative_change as many")
    if not pair:
        return Learned(Shape(follows[0], tuple(axes[0]), tuple(table[0])))
    return LearnedPair(Surface((follows[0], follows[1]), (tuple(axes[0]), tuple(axes[1])), tuple(map(tuple, table))))


def _law_error(table: dict[str, Any], where: str) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Thicknesses (h,), of each shape rising; level, slope and curvature (3, h); shapes, empty for slabs alone."""
    thickness = _row(_entry(table, "thickness_mm", list, where), f"{where}.thickness_mm", 0.0, math.inf)
    rows = _entry(table, "level_slope_curve", list, where)
    terms = [
        _row(row, f"{where}.level_slope_curve[{place}]", -LARGEST_LAW_ERROR, LARGEST_LAW_ERROR)
        for place, row in enumerate(rows)
    ]
    shapes = tuple(_entry(table, "shape", list, where)) if "shape" in table else ()
    if shapes and (len(shapes) != len(thickness) or not all(isinstance(one, str) for one in shapes)):
        raise _Fault(f"{where}.shape must hold {len(thickness)} texts")
    pads = list(zip(shapes or [""] * len(thickness), thickness))
    if not thickness or min(thickness) <= 0.0 or any(b[0] == a[0] and b[1] <= a[1] for a, b in pairwise(pads)):
        raise _Fault(f"{where}.thickness_mm = {_shown(thickness)} must hold thicknesses above 0 that rise")
    if len(terms) != LAW_TERMS or any(len(term) != len(thickness) for term in terms):
        raise _Fault(f"{where}.level_slope_curve must hold {LAW_TERMS} rows of {len(thickness)} numbers")
    return np.array(thickness), np.array(terms), shapes


def _row(values: Any, where: str, low: float, high: float) -> list[float]:
    if not isinstance(values, list):
        raise _Fault(f"{where} = {_shown(values)} is not a list")
    return [_within(value, f"{where}[{place}]", low, high) for place, value in enumerate(values)]


def _entry(table: dict[str, Any], key: str, kind: type, where: str) -> Any:
    """A required entry of one kind."""
    at = f"{where}.{key}" if where else key
    if key not in table:
        raise _Fault(f"{at} is missing")
    if not isinstance(table[key], kind):
        called = {dict: "a table", list: "a list", str: "a text"}[kind]
        raise _Fault(f"{at} = {_shown(table[key])} is not {called}")
    return table[key]


def _choice(table: dict[str, Any], key: str, known: tuple[str, ...], where: str) -> str:
    value = _entry(table, key, str, where)
    if value not in known:
        raise _Fault(f"{where + '.' if where else ''}{key} = {_shown(value)} is not one of {', '.join(known)}")
    return value


def _number(table: dict[str, Any], key: str, where: str, low: float, high: float = math.inf) -> float:
    """A required finite number within its range, both ends included."""
    at = f"{where}.{key}" if where else key
    if key not in table:
        raise _Fault(f"{at} is missing")
    return _within(table[key], at, low, high)


def _positive(table: dict[str, Any], key: str, where: str) -> float:
    value = _number(table, key, where, 0.0)
    if value == 0.0:
        raise _Fault(f"{where}.{key} = 0 must be above 0")
    return value


def _within(value: Any, at: str, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        raise _Fault(f"{at} = {_shown(value)} is not a finite number")
    slack = ROUNDING * (high - low if math.isfinite(high - low) else 0.0)
    if not low - slack <= value <= high + slack:
        raise _Fault(f"{at} = {value:g} is outside the allowed range {low:g} to {high:g}")
    return float(value)


def _shown(value: Any) -> str:
    """A value in a message: short, on one line, in printable characters."""
    text = ascii(value) if isinstance(value, str) else type(value).__name__
    if isinstance(value, bool | int | float):
        text = f"{value}" if not isinstance(value, int) or value.bit_length() < 64 else "a number of many digits"
    return text if len(text) <= 60 else text[:57] + "..."

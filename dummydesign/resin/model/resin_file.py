"""Read resin files: schema checks with file and line, then physics checks, then a :class:`Resin`."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.datafiles import Entry, find, read_toml
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import Quantity, line_of, read_quantity
from dummydesign.resin.model.liquid import Liquid
from dummydesign.resin.model.modulus_laws import LAWS, Law
from dummydesign.resin.model.puck_point import read_puck_point
from dummydesign.resin.model.resin import Arm, Resin

KIND = "materials/resins"
DEFAULT = "polyurethane-nagoya"
PROPERTIES = (
    "density_g_per_cm3",
    "viscosity_Pa_s",
    "pot_life_min",
    "degas_pressure_kPa",
    "cure_temperature_C",
    "cure_time_h",
    "age_before_test_days",
    "shrinkage_percent",
)
_TOP = {
    "schema", "name", "title", "ratio_meaning", "ratio_min", "ratio_max", "ratio_step", "references", "notes",
    "component", "modulus", "relaxation", "property", "point", "contradictions",
}  # fmt: skip
_LIQUID = ("name", "parts", "density_g_per_cm3", "viscosity_Pa_s")
_NEEDED = ("schema", "name", "ratio_meaning", "ratio_min", "ratio_max", "component", "modulus", "relaxation")


def load_resin(name: str = DEFAULT) -> Resin:
    """Load a resin by name (user's own first, any case) or from a TOML file.

    Parameters
    ----------
    name : str
        Name in the library or path of a file.

    Returns
    -------
    Resin

    Raises
    ------
    InputError
        When it does not exist or its file breaks the schema or the physics, with file and line.

    Examples
    --------
    >>> resin = load_resin("polyurethane-nagoya")
    >>> round(resin.young_MPa(15.4) * 1e3, 1)
    38.7
    >>> [(part.name, round(part.mass_g, 1)) for part in resin.recipe(15.4, 100.0)]
    [('polyol', 86.7), ('isocyanate', 13.3)]
    """
    return read_resin(find(KIND, "resin", name))


def read_resin(entry: Entry) -> Resin:
    """Read and check one resin file; see :func:`load_resin`."""
    content, text = read_toml(entry.path)
    return _parse_resin(content, text, entry.path, entry.origin)


def _check_keys(table: Mapping[str, Any], known: Iterable[str], path: Path, text: str, *where: str) -> None:
    """Refuse keys that are not in the schema, with file, line and the nearest known key (InputError)."""
    allowed = sorted(known)
    for key in table:
        if key not in allowed:
            near = difflib.get_close_matches(key, allowed, n=1, cutoff=0.6)
            hint = f"did you mean '{near[0]}'? " if near else ""
            message = f"unknown key '{key}': {hint}known are {', '.join(allowed)}"
            raise _fault(path, text, (*where, key), message)


def _parse_resin(content: Mapping[str, Any], text: str, path: Path, origin: str) -> Resin:
    """Make a resin from the content of a file; ``text`` and ``path`` serve the messages."""
    _check_keys(content, _TOP, path, text)
    for key in _NEEDED:
        if key not in content:
            raise InputError(f"{path.name}: '{key}' is missing")
    if content["schema"] != 1:
        raise _fault(path, text, "schema", f"schema = {content['schema']!r}; known is 1")
    low, high = (_number(content, key, path, text) for key in ("ratio_min", "ratio_max"))
    step = _number(content, "ratio_step", path, text) if "ratio_step" in content else 0.1
    if not (0 <= low < high and step > 0):
        message = f"needs 0 <= ratio_min < ratio_max and ratio_step > 0, given {low}, {high}, {step}"
        raise _fault(path, text, "ratio_min", message)
    law, numbers, posterior, prior = _modulus(content["modulus"], path, text)
    arms, ratio_ref, softness, prior_arms = _relaxation(content["relaxation"], path, text, low, high)
    properties = content.get("property", {})
    _check_keys(properties, PROPERTIES, path, text, "[property")
    resin = Resin(
        name=str(content["name"]),
        title=str(content.get("title", content["name"])),
        origin=origin,
        ratio_meaning=str(content["ratio_meaning"]),
        ratio_min=low,
        ratio_max=high,
        ratio_step=step,
        liquids=_liquids(content["component"], path, text),
        law=law,
        numbers=numbers,
        arms=arms,
        relaxation_ratio_ref=ratio_ref,
        softness_exponent=softness,
        properties={key: _positive(properties, key, path, text) for key in properties},
        references=tuple(str(item) for item in content.get("references", [])),
        notes=tuple(str(item) for item in content.get("notes", [])),
        points=tuple(_point(item, path, text) for item in content.get("point", [])),
        contradictions=tuple(str(item) for item in content.get("contradictions", [])),
        posterior=posterior,
        prior_numbers=prior,
        prior_relaxation=prior_arms,
    )
    _check_physics(resin, path, text)
    return resin


def _fault(path: Path, text: str, keys: str | tuple[str, ...], message: str) -> InputError:
    """Make the error for the line on which the last of ``keys`` stands."""
    names = (keys,) if isinstance(keys, str) else keys
    return InputError(f"{path.name}:{line_of(text, *names)}: {message}")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def read_points(path: Path) -> tuple[str, str, list[tuple[float, Quantity]]]:
    """Read a file of measured points: ``base``, ``name`` and ``[[point]]`` tables (ratio, young_kPa).

    Returns
    -------
    base, name : str
        Resin to update and the name of what results (default: the file's own name).
    points : list of (ratio, modulus in kPa)

    Raises
    ------
    InputError
        With file and line when something is missing, unknown or not a number.
    """
    content, text = read_toml(path)
    _check_keys(content, ("schema", "base", "name", "point"), path, text)
    if "point" not in content:
        raise InputError(f"{path.name}: 'point' is missing; give [[point]] tables with ratio and young_kPa")
    points = [_point(item, path, text) for item in _tables(content["point"], "point", path, text)]
    read = [(item["ratio"], item["young_kPa"]) for item in points]
    return str(content.get("base", DEFAULT)), str(content.get("name", path.stem)), read


def _number(table: Mapping[str, Any], key: str, path: Path, text: str) -> float:
    if not _is_number(table[key]):
        raise _fault(path, text, key, f"'{key}' = {table[key]!r} is not a finite number")
    return float(table[key])


def _table(value: Any, key: str, path: Path, text: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise _fault(path, text, key, f"'{key}' must be a table")
    return value


def _tables(value: Any, key: str, path: Path, text: str) -> list[dict[str, Any]]:
    if not isinstance(value, list) or not value or not all(isinstance(item, dict) for item in value):
        raise _fault(path, text, key, f"'{key}' must be one or more tables [[{key}]]")
    return value


def _positive(table: Mapping[str, Any], key: str, path: Path, text: str, zero: bool = False) -> Quantity:
    quantity = read_quantity(dict(table), key, path, text)
    if quantity.low < 0 or (quantity.low == 0 and not zero):
        bound = "at least 0" if zero else "above 0"
        raise InputError(f"{path.name}:{line_of(text, key)}: '{key}' low = {quantity.low}; it must be {bound}")
    return quantity


def _liquids(value: Any, path: Path, text: str) -> tuple[Liquid, ...]:
    """Read the components; exactly one of them is weighed by the ratio."""
    liquids = []
    for item in _tables(value, "component", path, text):
        _check_keys(item, _LIQUID, path, text, "[[component]]")
        name, parts = str(item.get("name", "")).strip(), item.get("parts")
        if not name:
            raise _fault(path, text, "[[component]]", "a component lacks its 'name'")
        if parts is None or (parts != "ratio" and not (_is_number(parts) and parts > 0)):
            message = f"'parts' of {name} = {parts!r}; it must be a number above 0 or \"ratio\""
            raise _fault(path, text, (name, "parts"), message)
        density = _positive(item, "density_g_per_cm3", path, text)
        viscosity = _positive(item, "viscosity_Pa_s", path, text)
        liquids.append(Liquid(name, None if parts == "ratio" else float(parts), density, viscosity))
    by_ratio = sum(liquid.parts is None for liquid in liquids)
    if by_ratio != 1 or len({liquid.name for liquid in liquids}) < len(liquids):
        message = 'components need different names and exactly one of them parts = "ratio"'
        raise _fault(path, text, "[[component]]", message)
    return tuple(liquids)


def _modulus(
    value: Any, path: Path, text: str
) -> tuple[Law, dict[str, Quantity], dict[str, np.ndarray] | None, dict[str, Quantity] | None]:
    """Read the law of the modulus, its numbers and, after an update, its joint draws."""
    table = _table(value, "modulus", path, text)
    name = str(table.get("law", ""))
    if name not in LAWS:
        raise _fault(path, text, ("[modulus]", "law"), str(unknown_name("law of the modulus", name, LAWS)))
    law = LAWS[name]
    _check_keys(table, {"law", "posterior", "prior", *law.parameters}, path, text, "[modulus")
    numbers = {key: _positive(table, key, path, text) for key in law.parameters}
    if "posterior" not in table:
        return law, numbers, None, None
    draws = _table(table["posterior"], "posterior", path, text)
    _check_keys(draws, law.parameters, path, text, "[modulus.posterior]")
    try:
        columns = {key: np.asarray(draws[key], dtype=float) for key in law.parameters}
    except (KeyError, TypeError, ValueError):
        columns = {}
    shapes = {column.shape for column in columns.values()}
    finite = all(np.all(np.isfinite(column)) for column in columns.values())
    if len(shapes) != 1 or len(next(iter(shapes))) != 1 or not finite:
        message = f"needs one equally long list of numbers for each of {', '.join(law.parameters)}"
        raise _fault(path, text, "[modulus.posterior]", message)
    prior = _table(table.get("prior"), "modulus.prior", path, text)
    _check_keys(prior, law.parameters, path, text, "[modulus.prior")
    return law, numbers, columns, {key: _positive(prior, key, path, text) for key in law.parameters}


def _relaxation(
    value: Any, path: Path, text: str, low: float, high: float
) -> tuple[tuple[Arm, ...], float, Quantity, tuple[tuple[Arm, ...], float] | None]:
    """Read the arms, the ratio they belong to, how they grow when the resin softens, and the arms before any puck."""
    table = _table(value, "relaxation", path, text)
    _check_keys(table, ("ratio_ref", "softness_exponent", "term", "prior"), path, text, "[relaxation")
    for key in ("ratio_ref", "softness_exponent"):
        if key not in table:
            raise InputError(f"{path.name}:{line_of(text, '[relaxation')}: '{key}' is missing in [relaxation]")
    arms, ratio_ref = _arms(table, path, text, low, high)
    prior = None
    if "prior" in table:
        before = _table(table["prior"], "prior", path, text)
        _check_keys(before, ("ratio_ref", "term"), path, text, "[relaxation.prior")
        prior = _arms({"ratio_ref": ratio_ref, **before}, path, text, low, high)
    return arms, ratio_ref, _positive(table, "softness_exponent", path, text, zero=True), prior


def _arms(table: Mapping[str, Any], path: Path, text: str, low: float, high: float) -> tuple[tuple[Arm, ...], float]:
    ratio_ref = _number(table, "ratio_ref", path, text)
    if not low <= ratio_ref <= high:
        message = f"ratio_ref = {ratio_ref} is outside the resin's range {low} to {high}"
        raise _fault(path, text, ("[relaxation", "ratio_ref"), message)
    arms = []
    for item in _tables(table["term"], "relaxation.term", path, text) if table.get("term") else []:
        _check_keys(item, ("tau_s", "beta"), path, text, "[[relaxation.term]]")
        arms.append(Arm(_positive(item, "tau_s", path, text), _positive(item, "beta", path, text, zero=True)))
    return tuple(arms), ratio_ref


def _point(item: Any, path: Path, text: str) -> dict[str, Any]:
    """Read one measured modulus: a ratio and a quantity."""
    table = _table(item, "point", path, text)
    _check_keys(table, ("ratio", "young_kPa", "puck"), path, text, "[[point]]")
    if "ratio" not in table:
        raise InputError(f"{path.name}:{line_of(text, '[[point]]')}: a point lacks its 'ratio'")
    return {
        "ratio": _number(table, "ratio", path, text),
        "young_kPa": _positive(table, "young_kPa", path, text),
        **({"puck": read_puck_point(table["puck"], path)} if "puck" in table else {}),
    }


def _check_physics(resin: Resin, path: Path, text: str) -> None:
    """Refuse a law whose central curve is not positive or does not run its law's way over the range."""
    central = {name: np.asarray(value) for name, value in resin.central.items()}
    if not np.all(resin.law.valid(resin.ratio_min, central)):
        message = (
            f"the law {resin.law.name} is not valid down to ratio_min = {resin.ratio_min} with its central "
            "values; is the gel point below it?"
        )
        raise _fault(path, text, "[modulus]", message)
    young = resin.young_MPa(np.linspace(resin.ratio_min, resin.ratio_max, 101))
    if not np.all(np.isfinite(young) & (young > 0)):
        raise _fault(path, text, "[modulus]", "the modulus is not positive over the whole ratio range")
    if not np.all(np.diff(young) * resin.law.direction > 0):
        way = "grow" if resin.law.direction > 0 else "fall"
        raise _fault(path, text, "[modulus]", f"the modulus must {way} with {resin.ratio_meaning}")

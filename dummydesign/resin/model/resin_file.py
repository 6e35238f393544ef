"""Read resin files: keys, types and ranges with file and line, then physics checks."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import output_folder, write_text
from dummydesign.core.parsing import UNITS, YOUNG
from dummydesign.core.quantity import Quantity
from dummydesign.core.toml_schema import REQUIRED, TomlTable, read_table
from dummydesign.core.user_library import Entry, data_folder, find, read_toml, toml_table, user_folder
from dummydesign.measurement.trace import Trace
from dummydesign.resin.model.modulus_laws import CHEMISTRIES, LAWS, ModulusLaw, guessed_chemistry, read_ratio_meaning
from dummydesign.resin.model.resin import MIXED, WRITTEN, Liquid, Point, PuckPoint, Resin, ResinArm

KIND = "materials/resins"
DEFAULT = "polyurethane-nagoya"
DENSITY = "density_g_per_cm3"
PROPERTIES = (
    DENSITY,
    "viscosity_Pa_s",
    "pot_life_min",
    "degas_pressure_kPa",
    "cure_temperature_C",
    "cure_time_h",
    "age_before_test_days",
    "shrinkage_percent",
)
KEYS = ("schema", *WRITTEN, "component", "modulus", "elastic", "relaxation", "property", "point")


def recording_sha256(trace: Trace) -> str:
    """Return the SHA-256 of a trace's numbers."""
    columns = trace.time_s, trace.displacement_mm, trace.force_N
    return hashlib.sha256(b"".join(column.astype("<f8").tobytes() for column in columns)).hexdigest()


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


def save_resin(resin: Resin, path: Path | None = None) -> Path:
    """Write a resin file, in the user's own folder without a path, under its final name only when complete."""
    return write_text(path or output_folder(user_folder() / KIND) / f"{resin.name}.toml", toml_table(resin.to_dict()))


def read_resin(entry: Entry) -> Resin:
    """Read and check one resin file; see :func:`load_resin`."""
    top = read_table(entry.path, KEYS)
    low, high, step = top.number("ratio_min"), top.number("ratio_max"), top.number("ratio_step", 0.1)
    if not (0 <= low <= high and step > 0):
        raise top.fault(
            "ratio_min",
            f"needs 0 <= ratio_min <= ratio_max and ratio_step > 0, given {low}, {high}, {step}",
            "inconsistent",
        )
    liquids = _liquids(top)
    also = " / ".join((str(top.data.get("title", "")), *(liquid.name for liquid in liquids)))
    meaning, by, per = read_ratio_meaning(top, also)
    if per == "mix" and high >= 100.0:
        raise top.fault("ratio_max", "must be below 100 parts of the mix", "out_of_range", (0, 100))
    law, numbers, posterior, prior = _modulus(top.table("modulus"))
    relaxation = top.table("relaxation").only(("ratio_ref", "softness_exponent", "term", "prior"))
    name = top.string("name")
    arms, ratio_ref = _arms(relaxation, low, high)
    before = relaxation.table("prior", required=False).only(("ratio_ref", "term"))
    properties = top.table("property", required=False).only(PROPERTIES)
    resin = Resin(
        name=name,
        title=top.string("title", name),
        origin=entry.origin,
        ratio_meaning=meaning,
        ratio_by=by,
        chemistry=top.string("chemistry", guessed_chemistry(name, also), choices=CHEMISTRIES),
        ratio_per=per,
        ratio_min=low,
        ratio_max=high,
        ratio_step=step,
        liquids=liquids,
        law=law,
        numbers=numbers,
        arms=arms,
        relaxation_ratio_ref=ratio_ref,
        softness_exponent=_positive(relaxation, "softness_exponent", zero=True),
        properties={key: _positive(properties, key) for key in properties.data},
        **{key: top.strings(key, ()) for key in ("references", "notes", "contradictions")},
        points=tuple(map(_point, top.tables("point", required=False))),
        posterior=posterior,
        prior_numbers=prior,
        ogden_alpha=_alpha(top.table("elastic", required=False).only(("ogden_alpha",)), "ogden_alpha"),
        prior_relaxation=_arms(before, low, high, ratio_ref) if "prior" in relaxation else None,
    )
    _check_units(top, given=entry.origin == "file")
    _check_physics(resin, top.table("modulus"))
    return resin


def read_points(path: Path) -> tuple[str, str, list[Point]]:
    """Read a file of measured points: the resin to update, the name of what results, and the points.

    The name is the file's own where it has none. An InputError names file and line.
    """
    top = read_table(path, ("schema", "base", "name", "point"), schema=None)
    _check_units(top, given=True)
    return top.string("base", DEFAULT), top.string("name", path.stem), list(map(_point, top.tables("point")))


@cache
def _plausible() -> dict[str, dict[str, Any]]:
    """Range and likely units by key; moduli have the range of a typed one."""
    modulus = {"low": YOUNG.usual[0], "high": YOUNG.usual[1], "unit": "kPa", "units": UNITS["kPa"]}
    own = read_toml(data_folder() / "materials" / "plausible-resin.toml")[0]
    return own | {key: modulus for law in LAWS.values() for key in ("young_kPa", *law.parameters) if "young" in key}


def _check_units(table: TomlTable, given: bool) -> None:
    """Ask where another unit explains a number of a file that is ``given``; about a density in any file.

    A source that names the number with its unit settles it.
    """
    for key, one in table.data.items():
        if isinstance(one, list) and one and isinstance(one[0], dict):
            for item in table.tables(key):
                _check_units(item, given)
        elif isinstance(one, dict) and not (key in _plausible() and "value" in one):
            _check_units(table.table(key), given)
        elif isinstance(one, dict) and (given or key == DENSITY):
            _check_unit(table, key, table.quantity(key))


def _check_unit(table: TomlTable, key: str, quantity: Quantity) -> None:
    value, (low, high, unit, sizes) = (
        quantity.value,
        (_plausible()[key][one] for one in ("low", "high", "unit", "units")),
    )
    fits = [f"{value * size:.4g} {unit} from {name}" for name, size in sizes.items() if low <= value * size <= high]
    settled = key != DENSITY and (not fits or f"{value:g} {unit}" in quantity.source)
    if not (settled or low <= value <= high):
        likely = f"; give {' or '.join(fits)}" if fits else ""
        words = "" if key == DENSITY else f". Where {value:g} {unit} is meant, name it in the source with its unit"
        message = f"{table.where(key)}: '{key}' = {value:g} is not from {low:g} to {high:g} {unit}{likely}{words}"
        raise InputError(message, "implausible_unit", key, value, (low, high))


def _positive(table: TomlTable, key: str, zero: bool = False) -> Quantity:
    quantity = table.quantity(key)
    if quantity.low < 0 or (quantity.low == 0 and not zero):
        raise table.fault(
            key, f"has low = {quantity.low}; it must be {'at least 0' if zero else 'above 0'}", "out_of_range"
        )
    return quantity


def _liquids(top: TomlTable) -> tuple[Liquid, ...]:
    """Read the components; exactly one of them is weighed by the ratio."""
    liquids = []
    for item in top.tables("component"):
        item.only(("name", "parts", *MIXED))
        parts = item.get("parts", (int, float, str), 'a number above 0 or "ratio"')
        if parts != "ratio" and not (isinstance(parts, int | float) and 0 < parts < float("inf")):
            raise item.fault("parts", 'must be a number above 0 or "ratio"', "malformed")
        properties = (_positive(item, key) for key in MIXED)
        liquids.append(Liquid(item.string("name"), None if parts == "ratio" else float(parts), *properties))
    if sum(liquid.parts is None for liquid in liquids) != 1 or len({liquid.name for liquid in liquids}) < len(liquids):
        raise top.fault("component", 'needs different names, and parts = "ratio" exactly once', "inconsistent")
    return tuple(liquids)


Numbers = dict[str, Quantity]


def _modulus(table: TomlTable) -> tuple[ModulusLaw, Numbers, dict[str, NDArray] | None, Numbers | None]:
    """Read the law of the modulus, its numbers and, after an update, its joint draws and prior."""
    law = LAWS[table.string("law", choices=LAWS)]
    table.only({"law", "posterior", "prior", *law.parameters})
    numbers = {key: _positive(table, key) for key in law.parameters}
    if "posterior" not in table:
        return law, numbers, None, None
    draws, prior = (table.table(key).only(law.parameters) for key in ("posterior", "prior"))
    columns = {key: np.array(draws.numbers(key)) for key in law.parameters}
    if len({len(column) for column in columns.values()}) != 1:
        raise table.fault(
            "posterior", f"needs equally long lists of numbers for {', '.join(law.parameters)}", "malformed"
        )
    return law, numbers, columns, {key: _positive(prior, key) for key in law.parameters}


def _arms(table: TomlTable, low: float, high: float, default: Any = REQUIRED) -> tuple[tuple[ResinArm, ...], float]:
    """Read arms and the ratio they belong to."""
    ratio_ref = table.number("ratio_ref", default, low=low, high=high)
    terms = [item.only(("tau_s", "beta")) for item in table.tables("term", required=False)]
    return tuple(ResinArm(_positive(item, "tau_s"), _positive(item, "beta", zero=True)) for item in terms), ratio_ref


def _point(table: TomlTable) -> Point:
    """Read one measured modulus: a ratio, a quantity and, where it is known, the puck's recording."""
    table.only(("ratio", "young_kPa", "puck"))
    ratio, young = table.number("ratio"), _positive(table, "young_kPa")
    if "puck" not in table:
        return Point(ratio, young)
    puck = table.table("puck").only(("sha256", "file", "diameter_mm", "height_mm", "seen_s", "arm", "plates", "alpha"))
    seen = puck.numbers("seen_s", None)
    if seen is not None and len(seen) != 2:
        raise puck.fault("seen_s", "must be the shortest and the longest time", "malformed")
    recordings = PuckPoint(
        puck.string("sha256"),
        puck.string("file"),
        puck.number("diameter_mm"),
        puck.number("height_mm"),
        seen,
        tuple(ResinArm(arm.quantity("tau_s"), arm.quantity("beta")) for arm in puck.tables("arm", required=False)),
        puck.string("plates", ""),
        _alpha(puck, "alpha"),
    )
    return Point(ratio, young, recordings)


def _alpha(table: TomlTable, key: str) -> Quantity | None:
    """Read the exponent of a one-term Ogden law; None without one."""
    return _positive(table, key) if key in table else None


def _check_physics(resin: Resin, modulus: TomlTable) -> None:
    """Refuse a law whose central curve is not positive or does not run its law's way over the range."""
    if not np.all(resin.law.valid(resin.ratio_min, resin.central)):
        raise modulus.fault(
            "law",
            f"is not valid down to ratio_min = {resin.ratio_min} with its central values; is the gel point below?",
            "inconsistent",
        )
    young = resin.young_MPa(np.linspace(resin.ratio_min, resin.ratio_max, 101))
    if not np.all(np.isfinite(young) & (young > 0)):
        raise modulus.fault("law", "gives a modulus that is not positive over the whole ratio range", "inconsistent")
    if resin.ratio_min < resin.ratio_max and not np.all(np.diff(young) * resin.law.direction > 0):
        raise modulus.fault(
            "law", f"gives a modulus that does not {resin.law.way} with {resin.ratio_meaning}", "inconsistent"
        )

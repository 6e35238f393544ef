"""Read mould presets and put a specification together; no CAD."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.datafiles import find, read_toml
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.quantity import read_quantity
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.mold.bone.insert import Insert
from dummydesign.mold.model.pad_kind import PUCK, canonical_kind
from dummydesign.mold.model.spec import (
    Acceptance,
    Aids,
    BaseLayer,
    Body,
    Box,
    Closure,
    MouldSpec,
    PadGeometry,
    Pour,
)
from dummydesign.mold.model.validate import validate
from dummydesign.mold.printed.surface import read_surface
from dummydesign.mold.shop.products import read_machines, read_plastic, read_silicone
from dummydesign.mold.shop.tables import known_keys, named_source, number, read_table

if TYPE_CHECKING:
    from dummydesign.resin import Resin

_POUR = (
    "film_loss_g",
    "extra_percent",
    "silicone_extra_percent",
    "surface_tension_N_per_m",
    "contact_angle_deg",
    "resin_expansion_per_K",
)
_PROCESS = ("room_temperature_C", "degas", "foam_factor", "pour_and_degas_min")
_TABLES = {"pad", "body", "box", "aids", "process", "closure", "pour", "surface"}
_TOP = {"schema", "name", "title", "style", "silicone", "machines", "plastic", "acceptance"} | _TABLES
# What a resin may leave out; each is plain room-temperature practice and listed as assumed in the answer.
_RESIN_FALLBACK = {
    "pot_life_min": 20.0,
    "shrinkage_percent": 0.0,
    "cure_time_h": 24.0,
    "age_before_test_days": 7.0,
    "degas_pressure_kPa": 3.0,
}


def mould_spec(
    thickness_mm: float,
    length_mm: float = PAD_LENGTH_MM,
    width_mm: float = PAD_WIDTH_MM,
    preset: str = "open",
    resin: str | Resin | None = None,
    ratio: float = 15.0,
    kind: str = "slab",
    parameters: tuple[tuple[str, float], ...] = (),
    base_ratio: float | None = None,
    machines: str | None = None,
    silicone: str | None = None,
    face_sheet_mm: float | None = None,
    count: int = 1,
    insert: Insert | None = None,
) -> MouldSpec:
    """Put together and check the specification of a mould.

    Parameters
    ----------
    thickness_mm, length_mm, width_mm : float
        The finished pad. [mm]
    preset : str
        Name of a preset or path of a preset file.
    resin : str or Resin, optional
        Resin by name, file or object; the paper's polyurethane by default.
    ratio : float
        Mixing ratio of the resin, see its ``ratio_meaning``.
    kind, parameters : str, tuple of (str, float)
        Shape of the pad, see :func:`dummydesign.geometry.shapes.make_shape`; or ``"puck"``, a plain cylinder.
    base_ratio : float, optional
        Mixing ratio of a layered pad's base; by default the one whose modulus is that of the upper layer times
        the shape's ``modulus_ratio``.
    machines, silicone : str, optional
        Names or files that take the place of those the preset names.
    face_sheet_mm : float, optional
        Thickness of the sheet of glass let in as the tested face, in place of the preset's; 0 for none. [mm]
    count : int
        Cavities side by side in one mould.
    insert : Insert, optional
        A bone from a file, of a boned pad whose parameters are the dome nearest to it.

    Returns
    -------
    MouldSpec
        Checked by :func:`dummydesign.mold.model.validate.validate`.

    Raises
    ------
    InputError
        When a file or a value is not acceptable.
    """
    kind, parameters = canonical_kind(kind, parameters)
    entry = find("molds", "mould preset", preset)
    data, text = read_toml(entry.path)
    known_keys(data, _TOP, entry.path, text)
    printed = data.get("style") == "printed"
    of_style = ("plastic", "surface") if printed else ("silicone",)
    for key in ("style", "machines", *of_style, *sorted(_TABLES - {"closure", "surface"})):
        if key not in data:
            raise InputError(f"{entry.path.name}: '{key}' is missing")
    if printed and (silicone or "silicone" in data):
        raise InputError(f"{entry.path.name}: a printed mould has no silicone; leave it out")
    pad = read_table(PadGeometry, data["pad"], entry.path, text, "pad", thickness_mm=float(thickness_mm))
    pad |= {"length_mm": float(length_mm), "width_mm": float(width_mm), "kind": kind, "parameters": parameters}
    if kind == PUCK:
        # A specimen between plates is a plain cylinder; a soft mould gives it up without draft.
        pad |= {"draft_deg": 0.0, "corner_radius_mm": pad["length_mm"] / 2, "edge_radius_mm": 0.0}
    pad = PadGeometry(**pad)
    if pad.shape.sharp_edge:
        pad = replace(pad, edge_radius_mm=0.0)
    elif pad.edge_radius_mm > pad.edge_room_mm:
        pad = replace(pad, edge_radius_mm=max(pad.edge_room_mm, 0.0))
    resin = _resin(resin)
    pour, sources = _read_pour(data, entry.path, text, resin, ratio)
    product, more = (None, []) if printed else read_silicone(silicone or str(data["silicone"]), entry.path)
    plastic, its_sources = read_plastic(str(data["plastic"]), entry.path) if "plastic" in data else (None, [])
    if printed and (plastic is None or plastic.expansion_per_K is None):
        named = data["plastic"]
        raise InputError(f"plastic '{named}' of a printed mould needs expansion_per_K and young_MPa in its file")
    surface, of_surface = read_surface(data["surface"], entry.path, text) if printed else (None, [])
    box = Box(**read_table(Box, data["box"], entry.path, text, "box"))
    if face_sheet_mm is not None:
        box = replace(box, face_sheet_mm=float(face_sheet_mm))
    its_machines, of_machines = read_machines(machines or str(data["machines"]), entry.path)
    closure = data.get("closure")
    limits = read_table(Acceptance, data.get("acceptance", {}), entry.path, text, "acceptance")
    spec = MouldSpec(
        preset=entry.name,
        pad=pad,
        body=Body(**read_table(Body, data["body"], entry.path, text, "body", style=str(data["style"]))),
        box=box,
        aids=Aids(**read_table(Aids, data["aids"], entry.path, text, "aids")),
        silicone=product,
        pour=pour,
        machines=its_machines,
        closure=Closure(**read_table(Closure, closure, entry.path, text, "closure")) if closure is not None else None,
        sources=tuple(dict.fromkeys(sources + more + its_sources + of_machines + of_surface)),
        base=_base_layer(pad.shape, pour, resin, base_ratio),
        plastic=plastic,
        acceptance=Acceptance(**limits),
        surface=surface,
        count=count,
        insert=insert,
    )
    validate(spec)
    return spec


def _resin(resin: str | Resin | None) -> Resin:
    if resin is None or isinstance(resin, str):
        from dummydesign.resin import load_resin

        return load_resin(resin) if resin else load_resin()
    return resin


def _base_layer(shape: PadShape, pour: Pour, resin: Resin, base_ratio: float | None) -> BaseLayer | None:
    """The second resin of a layered pad: the same family at another ratio."""
    layers = shape.layers()
    if layers is None:
        if base_ratio is not None:
            raise InputError(f"base_ratio = {base_ratio:g} belongs to a layered pad; the shape is {shape.name}")
        return None
    upper = resin.young_MPa(pour.ratio)
    if base_ratio is None:
        base_ratio = _ratio_of_base(resin, pour, upper, layers[1])
    numbers = _resin_numbers(resin, base_ratio, pour.room_temperature_C)
    return BaseLayer(replace(pour, **numbers), resin.young_MPa(base_ratio) / upper)


def _ratio_of_base(resin: Resin, pour: Pour, upper_MPa: float, modulus_ratio: float) -> float:
    """Ratio whose modulus is that of the upper layer times ``modulus_ratio``."""
    ends = sorted(resin.young_MPa(end) for end in (resin.ratio_min, resin.ratio_max))
    low, high = (end / upper_MPa for end in ends)
    if not low <= modulus_ratio <= high:
        raise InputError(
            f"modulus_ratio = {modulus_ratio:g} asks {1e3 * modulus_ratio * upper_MPa:.3g} kPa of {resin.name} for the "
            f"base; with the upper layer at ratio {pour.ratio:g} ({1e3 * upper_MPa:.3g} kPa) allowed is {low:.3g} to "
            f"{high:.3g}"
        )
    return resin.ratio_for(modulus_ratio * upper_MPa)


def _read_pour(
    data: dict[str, Any], path: Path, text: str, resin: Resin, ratio: float
) -> tuple[Pour, list[str]]:
    """Join the preset's pouring numbers with the resin's."""
    process = data["process"]
    known_keys(process, set(_PROCESS), path, text)
    known_keys(data["pour"], set(_POUR), path, text)
    for key in _PROCESS:
        if key not in process:
            raise InputError(f"{path.name}: table [process] lacks {key}")
    loose = {key: read_quantity(data["pour"], key, path, text) for key in _POUR}
    room = number(process["room_temperature_C"], "room_temperature_C", path, text)
    liquid = _resin_numbers(resin, ratio, room)
    sources = [named_source(key, quantity) for key, quantity in loose.items()]
    sources += [f"resin {resin.name}: {reference}" for reference in resin.references[:1]]
    values = {key: quantity.value for key, quantity in loose.items()}
    for key in ("foam_factor", "pour_and_degas_min"):
        values[key] = number(process[key], key, path, text)
    return Pour(**liquid, **values, room_temperature_C=room, degas=str(process["degas"])), sources


def _resin_numbers(resin: Resin, ratio: float, room_temperature_C: float) -> dict[str, Any]:
    """Collect what pouring needs from a resin at a ratio; what it does not know takes room-temperature practice."""
    if not math.isfinite(ratio):
        raise out_of_range("ratio", ratio, resin.ratio_min, resin.ratio_max, resin.ratio_meaning)
    parts = resin.recipe(ratio, 1.0)
    known = set(resin.property_names())
    fallback = {**_RESIN_FALLBACK, "cure_temperature_C": room_temperature_C}
    numbers = {name: resin.property(name, ratio).value if name in known else value for name, value in fallback.items()}
    return {
        "resin": resin.name,
        "ratio": float(ratio),
        "ratio_meaning": resin.ratio_meaning,
        "components": tuple((part.name, float(part.mass_g)) for part in parts),
        "density_g_per_cm3": float(resin.property("density_g_per_cm3", ratio).value),
        "viscosity_Pa_s": float(resin.property("viscosity_Pa_s", ratio).value),
        "young_kPa": 1e3 * float(resin.young_MPa(ratio)),
        **numbers,
    }

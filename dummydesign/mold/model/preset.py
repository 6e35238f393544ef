"""Read mould presets and put a specification together; no CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.toml_schema import TomlTable, read_table
from dummydesign.core.user_library import find
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.mold.model.products import (
    Machines,
    Plastic,
    Silicone,
    Surface,
    product_file,
    read_machines,
    read_numbers,
    read_product,
    read_quantities,
    read_quantity_table,
)
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
    canonical_kind,
)
from dummydesign.mold.model.validate import validate

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
_KEYS = (
    "schema",
    "name",
    "title",
    "style",
    "silicone",
    "machines",
    "plastic",
    "acceptance",
    "pad",
    "body",
    "box",
    "aids",
    "process",
    "closure",
    "pour",
    "surface",
)
# What a resin may leave out; each is plain room-temperature practice and listed as assumed in the answer.
_RESIN_FALLBACK = {
    "pot_life_min": 20.0,
    "shrinkage_percent": 0.0,
    "cure_time_h": 24.0,
    "age_before_test_days": 7.0,
    "degas_pressure_kPa": 3.0,
}
ASSUMED_SOURCE = "usual practice at room temperature, by judgement"


def mould_spec(
    thickness_mm: float,
    length_mm: float = PAD_LENGTH_MM,
    width_mm: float = PAD_WIDTH_MM,
    preset: str | Preset = "open",
    resin: str | Resin | None = None,
    ratio: float = 15.0,
    kind: str = "slab",
    parameters: tuple[tuple[str, float], ...] = (),
    base_ratio: float | None = None,
    machines: str | None = None,
    silicone: str | None = None,
    face_sheet_mm: float | None = None,
    count: int = 1,
) -> MouldSpec:
    """Put together and check the specification of a mould; machines and silicone are those of a preset by name."""
    kind, parameters = canonical_kind(kind, parameters)
    used = preset if isinstance(preset, Preset) else read_preset(preset, machines, silicone)
    top = used.top
    pad = read_numbers(
        PadGeometry, top.table("pad"), thickness_mm=float(thickness_mm), kind=kind, parameters=parameters
    )
    pad = _fitted(replace(pad, length_mm=float(length_mm), width_mm=float(width_mm)))
    if resin is None or isinstance(resin, str):
        from dummydesign.resin import load_resin

        resin = load_resin(resin) if resin else load_resin()
    pour, sources = _read_pour(top, resin, ratio)
    box = read_numbers(Box, top.table("box"))
    if face_sheet_mm is not None:
        box = replace(box, face_sheet_mm=float(face_sheet_mm))
    spec = MouldSpec(
        preset=used.name,
        pad=pad,
        body=read_numbers(Body, top.table("body"), style=used.style),
        box=box,
        aids=read_numbers(Aids, top.table("aids")),
        silicone=used.silicone,
        pour=pour,
        machines=used.machines,
        closure=read_numbers(Closure, top.table("closure")) if "closure" in top else None,
        sources=tuple(dict.fromkeys((*sources, *used.sources))),
        base=_base_layer(pad.shape, pour, resin, base_ratio),
        plastic=used.plastic,
        acceptance=read_numbers(Acceptance, top.table("acceptance", required=False)),
        surface=used.surface,
        count=count,
    )
    validate(spec)
    return spec


@dataclass(frozen=True)
class Preset:
    """A mould preset with the products and machines it names; ``files`` are what was read, by what they are."""

    name: str
    style: str
    top: TomlTable
    machines: Machines
    silicone: Silicone | None
    plastic: Plastic | None
    surface: Surface | None
    sources: tuple[str, ...]
    files: dict[str, Path]


def read_preset(preset: str = "open", machines: str | None = None, silicone: str | None = None) -> Preset:
    """Read a preset by name or file, with other machines or another silicone than it names where they are given."""
    entry = find("molds", "mould preset", preset)
    path, top = entry.path, read_table(entry.path, _KEYS, None)
    style = str(top.data.get("style", ""))
    printed = style == "printed"
    if printed and (silicone or "silicone" in top):
        raise InputError(
            f"{top.where('silicone')}: a printed mould has no silicone; leave it out", "not_applicable", "silicone"
        )
    for key in ("style", "machines", *(("plastic", "surface") if printed else ("silicone",))):
        if key not in top:
            raise top.fault(key, "is missing", "missing")
    names = {
        "silicone": None if printed else silicone or str(top.data["silicone"]),
        "plastic": str(top.data["plastic"]) if "plastic" in top else None,
        "machine": machines or str(top.data["machines"]),
    }
    product, more = (None, []) if names["silicone"] is None else read_product(Silicone, names["silicone"], path)
    plastic, of_plastic = (None, []) if names["plastic"] is None else read_product(Plastic, names["plastic"], path)
    if printed and (plastic is None or plastic.expansion_per_K is None):
        message = "of a printed mould needs expansion_per_K and young_MPa in its file"
        raise InputError(
            f"{top.where('plastic')}: plastic '{top.data['plastic']}' {message}", "missing", "plastic.expansion_per_K"
        )
    surface, of_surface = read_quantity_table(Surface, top.table("surface"), "surface ") if printed else (None, [])
    its_machines, of_machines = read_machines(str(names["machine"]), path)
    files = {f"{what} {name}": product_file(name, path, what).path for what, name in names.items() if name is not None}
    sources = (*more, *of_plastic, *of_machines, *of_surface)
    return Preset(
        entry.name,
        style,
        top,
        its_machines,
        product,
        plastic,
        surface,
        sources,
        {f"mould preset {entry.name}": path, **files},
    )


def _fitted(pad: PadGeometry) -> PadGeometry:
    """The pad with an edge that its shape has room for; a puck without draft, which a soft mould gives up."""
    if pad.is_puck:
        return replace(pad, draft_deg=0.0, corner_radius_mm=pad.length_mm / 2, edge_radius_mm=0.0)
    most = 0.0 if pad.shape.sharp_edge else max(pad.edge_room_mm, 0.0)
    return replace(pad, edge_radius_mm=min(pad.edge_radius_mm, most))


def _base_layer(shape: PadShape, pour: Pour, resin: Resin, base_ratio: float | None) -> BaseLayer | None:
    """The second resin of a layered pad: the same family at another ratio."""
    layers = shape.layers()
    if layers is None:
        if base_ratio is not None:
            message = f"base_ratio = {base_ratio:g} belongs to a layered pad; the shape is {shape.name}"
            raise InputError(message, "not_applicable", "base_ratio", base_ratio)
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
            f"{high:.3g}",
            "out_of_range",
            "modulus_ratio",
            modulus_ratio,
            (low, high),
        )
    return resin.ratio_for(modulus_ratio * upper_MPa)


def _read_pour(top: TomlTable, resin: Resin, ratio: float) -> tuple[Pour, list[str]]:
    """Join the preset's pouring numbers with the resin's."""
    process, pour = top.table("process"), top.table("pour")
    process.only(("room_temperature_C", "degas", "foam_factor", "pour_and_degas_min"))
    pour.only(_POUR)
    values, sources = read_quantities(pour, _POUR)
    room = process.number("room_temperature_C")
    result = Pour(
        **_resin_numbers(resin, ratio, room),
        **values,
        room_temperature_C=room,
        degas=process.string("degas"),
        foam_factor=process.number("foam_factor"),
        pour_and_degas_min=process.number("pour_and_degas_min"),
    )
    sources += [
        f"resin {resin.name} {name} = {getattr(result, name):g} (assumed): not in its file, {ASSUMED_SOURCE}"
        for name in result.assumed
    ]
    return result, sources + [f"resin {resin.name}: {reference}" for reference in resin.references[:1]]


def _resin_numbers(resin: Resin, ratio: float, room_temperature_C: float) -> dict[str, Any]:
    """Collect what pouring needs from a resin at a ratio; what it does not know takes room-temperature practice."""
    from dummydesign.resin.model.hardness import expected_hardness

    if not math.isfinite(ratio):
        raise out_of_range("ratio", ratio, resin.ratio_min, resin.ratio_max, resin.ratio_meaning)
    parts, modulus = resin.recipe(ratio, 1.0), resin.modulus_kPa(ratio)
    known = set(resin.property_names())
    fallback = {**_RESIN_FALLBACK, "cure_temperature_C": room_temperature_C}
    numbers = {name: resin.property(name, ratio).value if name in known else value for name, value in fallback.items()}
    for name in ("density_g_per_cm3", "viscosity_Pa_s"):
        numbers[name] = float(resin.property(name, ratio).value)
    return {
        "resin": resin.name,
        "ratio": float(ratio),
        "ratio_meaning": resin.ratio_meaning,
        "components": tuple((part.name, float(part.mass_g)) for part in parts),
        "young_kPa": float(modulus.value),
        "expected_kPa": (modulus.low, modulus.high),
        "hardness": expected_hardness(resin, ratio).text,
        **numbers,
        "ratio_component": next((liquid.name for liquid in resin.liquids if liquid.parts is None), ""),
        "ratio_by": resin.ratio_by,
        "ratio_per": resin.ratio_per,
        "component_densities_g_per_cm3": _densities(resin, [part.name for part in parts]),
        "assumed": tuple(name for name in fallback if name not in known),
        "chemistry": resin.chemistry,
    }


def _densities(resin: Resin, names: list[str]) -> tuple[float, ...]:
    """Density of each component of a recipe by volume; none by weight, where nothing follows from it."""
    densities = {liquid.name: liquid.density_g_per_cm3.value for liquid in resin.liquids}
    return tuple(densities[name] for name in names) if resin.ratio_by == "volume" else ()

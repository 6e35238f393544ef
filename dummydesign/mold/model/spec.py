"""The specification of a mould: frozen, checked, hashed; kinds of pad, hardware."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.parsing import PAD_THICKNESS, read_number
from dummydesign.core.serialise import rebuild, to_plain
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import make_shape, read_shape, shape_kinds
from dummydesign.mold.model.products import Machines, Plastic, Silicone, Surface


@dataclass(frozen=True)
class Body:
    """The silicone block around the cavity and the label cut into its land."""

    style: str
    wall_mm: float
    floor_mm: float
    outer_corner_radius_mm: float
    outer_draft_deg: float
    brim_step_mm: float
    freeboard_mm: float
    label_height_mm: float
    label_stroke_mm: float
    label_depth_mm: float


@dataclass(frozen=True)
class Closure:
    """Lid, keys, gutter, sprue and vents of a lidded mould."""

    lid_mm: float
    backer_mm: float
    key_radius_mm: float
    key_clearance_mm: float
    key_shift_mm: float
    gutter_radius_mm: float
    gutter_distance_mm: float
    sprue_small_mm: float
    sprue_large_mm: float
    vent_small_mm: float
    vent_large_mm: float
    sprue_inset_mm: float
    vent_inset_mm: float
    pin_handle_mm: float
    pin_spigot_mm: float


@dataclass(frozen=True)
class Box:
    """The rigid master's base plate and the lift-off frame.

    ``face_sheet_mm`` is the thickness of a sheet of glass or acrylic let into the plug's top as the tested face, with
    a bond of ``sheet_bond_mm`` under it; 0 without one.
    """

    base_mm: float
    frame_wall_mm: float
    flange_mm: float
    flange_thickness_mm: float
    bolt_hole_mm: float
    rim_mm: float
    rim_step_mm: float
    face_sheet_mm: float = 0.0
    sheet_bond_mm: float = 0.1
    sheet_rim_mm: float = 4.0


@dataclass(frozen=True)
class Aids:
    """Strike-off plate, carrier tray and degassing collar."""

    plate_mm: float
    plate_clearance_mm: float
    tray_floor_mm: float
    tray_rim_mm: float
    tray_rim_height_mm: float
    tray_clearance_mm: float
    level_screw_hole_mm: float
    collar_wall_mm: float


PUCK = "puck"


def read_thickness(given: float | str) -> float:
    """Read the thickness of the one pad that a mould is for. [mm]"""
    if isinstance(given, Iterable) and (not isinstance(given, str) or "," in given):
        message = f"thickness in mm = {given}: a mould is for one thickness; run 'dummydesign mold' once for each"
        raise InputError(message, "not_a_number", "thickness_mm")
    return read_number(given, PAD_THICKNESS)


def read_kind(text: str) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Read a shape as typed into name and parameters; a ``puck`` takes none."""
    name, _, rest = text.partition(":")
    if name.lower() not in shape_kinds():
        return canonical_kind(name, (("0", 0.0),) if rest else ())
    shape = read_shape(text)
    return shape.name, shape.parameters


def canonical_kind(kind: str, parameters: tuple[tuple[str, float], ...]) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Name in small letters and every parameter by its name, so that equal shapes are stored alike."""
    if kind.lower() == PUCK:
        if parameters:
            message = "shape puck takes no parameters; its diameter is given by --length and --width"
            raise InputError(message, "unknown_key", "shape_parameter", parameters[0][0])
        return PUCK, ()
    if kind.lower() not in shape_kinds():
        raise unknown_name("shape", kind, [*shape_kinds(), PUCK])
    shape = make_shape(kind, parameters)
    return shape.name, shape.parameters


WARM_K = 5.0
"""A cure that is warmer than the room by no more than this needs no oven."""


@dataclass(frozen=True)
class PadGeometry:
    """The pad as it shall be after cure, at room temperature.

    The highest point of the face that is tested lies on z = 0 (the mould's floor), its flat at
    ``face_height_mm``, where the outline is ``length_mm`` by ``width_mm``; the walls open by ``draft_deg``
    towards the free face at z = ``thickness_mm``. ``parameters`` belong to the shape named by ``kind``, all of
    them by name, so that equal shapes make equal specifications.
    """

    thickness_mm: float
    length_mm: float = PAD_LENGTH_MM
    width_mm: float = PAD_WIDTH_MM
    draft_deg: float = 2.0
    corner_radius_mm: float = 5.0
    edge_radius_mm: float = 1.5
    kind: str = "slab"
    parameters: tuple[tuple[str, float], ...] = ()

    @cached_property
    def shape(self) -> PadShape:
        """The shape as the finite-element model knows it; a puck is a slab with a round outline."""
        return make_shape("slab" if self.is_puck else self.kind, self.parameters)

    @property
    def is_puck(self) -> bool:
        """Whether this is a plain cylinder, pressed between plates."""
        return self.kind == PUCK

    @property
    def face_height_mm(self) -> float:
        """Height of the tested face's flat above its highest point, the mould's lowest."""
        return self.shape.face_height_mm(self)

    @property
    def least_gel_mm(self) -> float:
        """Thinnest gel of the pad: beside a crown, over a bone, or a layer."""
        return self.shape.least_gel_mm(self)

    @property
    def edge_room_mm(self) -> float:
        """Radius of the tested face's edge that rim and upper layer have room for, in whole tenths. [mm]"""
        layers = self.shape.layers()
        room = min(0.9 * (self.thickness_mm - self.face_height_mm), layers[0] if layers else math.inf)
        return math.floor(10.0 * room + 1e-9) / 10.0 if math.isfinite(room) else room

    @property
    def title(self) -> str:
        """Shape and size in words."""
        return f"{self.kind} pad {self.length_mm:g} x {self.width_mm:g} x {self.thickness_mm:g} mm"

    @property
    def name(self) -> str:
        """The shape as typed, or the puck."""
        return self.kind if self.is_puck else str(self.shape)

    @property
    def prefix(self) -> str:
        """Name of the kind before other words; empty for what is plain."""
        return "" if self.shape.plain else self.kind


@dataclass(frozen=True)
class Pour:
    """The resin as a liquid to be weighed and poured; ``components`` are (name, mass fraction).

    ``young_kPa`` is the modulus that the design counts on, ``hardness`` the durometer's reading to expect of it, in
    words. The ratio is the amount of ``ratio_component`` over that of the others, in parts; it is unknown in
    specifications of earlier versions, and no part of the mould. Parts are by weight or by volume (``ratio_by``), to
    those of the others or in 100 of the mix (``ratio_per``).
    ``assumed`` names what the resin's file does not state, ``chemistry`` what it is where that is known.
    ``expected_kPa`` are the moduli between which 95 % of the batches come out, ``usable_kPa`` those with which the
    answer that the mould belongs to calls the pad usable; empty without an answer.
    """

    resin: str
    ratio: float
    ratio_meaning: str
    components: tuple[tuple[str, float], ...]
    density_g_per_cm3: float
    viscosity_Pa_s: float
    pot_life_min: float
    shrinkage_percent: float
    cure_temperature_C: float
    cure_time_h: float
    age_before_test_days: float
    degas_pressure_kPa: float
    room_temperature_C: float
    resin_expansion_per_K: float
    film_loss_g: float
    extra_percent: float
    silicone_extra_percent: float
    surface_tension_N_per_m: float
    contact_angle_deg: float
    degas: str
    foam_factor: float
    pour_and_degas_min: float
    young_kPa: float
    hardness: str = ""
    ratio_component: str = ""
    ratio_by: str = "weight"
    ratio_per: str = "others"
    component_densities_g_per_cm3: tuple[float, ...] = ()
    assumed: tuple[str, ...] = ()
    chemistry: str = ""
    expected_kPa: tuple[float, ...] = ()
    usable_kPa: tuple[float, ...] = ()

    def mark(self, *names: str) -> str:
        """Return `` (assumed)`` where the resin's file states none of these numbers, else nothing."""
        return " (assumed)" if set(names) & set(self.assumed) else ""

    @property
    def cures_cold(self) -> bool:
        """Whether the cure needs a refrigerator: more than :data:`WARM_K` below the room."""
        return self.cure_temperature_C < self.room_temperature_C - WARM_K

    @property
    def cure_place(self) -> str:
        """Temperature and place of the cure; the cavity is compensated for this temperature."""
        at = f"at {self.cure_temperature_C:g} C{self.mark('cure_temperature_C')}"
        if self.cures_warm:
            return f"{at} in the vented oven"
        return f"{at} in a refrigerator" if self.cures_cold else f"{at}, room temperature"

    @property
    def as_hashed(self) -> Pour:
        """Return the pour without what makes no other mould."""
        return replace(self, ratio_component="", assumed=(), chemistry="", expected_kPa=(), usable_kPa=())

    @property
    def has_isocyanate(self) -> bool:
        """Whether a component of the resin is an isocyanate."""
        return any("isocyanate" in name.lower() for name, _ in self.components)

    @property
    def is_degassed(self) -> bool:
        """Whether a vacuum takes the air out of the resin."""
        return self.degas != "none"

    @property
    def cures_warm(self) -> bool:
        """Whether the cure needs an oven: more than :data:`WARM_K` above the room."""
        return self.cure_temperature_C > self.room_temperature_C + WARM_K


USUAL_POUR = {
    "ratio_by": "weight",
    "ratio_per": "others",
    "component_densities_g_per_cm3": (),
    "assumed": (),
    "chemistry": "",
    "expected_kPa": (),
    "usable_kPa": (),
}
"""Fields of a pour that are left out of a specification when they are as usual."""


def without_usual(pour: dict[str, Any]) -> dict[str, Any]:
    """A pour in plain values without the fields that are as usual, so that older specifications keep their hash."""
    return {key: value for key, value in pour.items() if key not in USUAL_POUR or list(value) != list(USUAL_POUR[key])}


def without_zeros(plain: dict[str, Any], *keys: str) -> dict[str, Any]:
    """Plain values without those of the keys that are 0, so that older specifications keep their hash."""
    return {key: value for key, value in plain.items() if value or key not in keys}


@dataclass(frozen=True)
class BaseLayer:
    """The second resin of a layered pad: how it is poured and its modulus over that of the upper layer."""

    pour: Pour
    modulus_ratio: float


@dataclass(frozen=True)
class Acceptance:
    """How far a cast pad may be off: mean thickness, its spread over five places, mass.

    ``modulus_percent`` limits nothing: presets of earlier versions hold it, and so does the hash of their moulds.
    """

    thickness_percent: float = 3.0
    spread_percent: float = 5.0
    mass_percent: float = 2.0
    modulus_percent: float = 10.0


@dataclass(frozen=True)
class MouldSpec:
    """Everything a mould is made from; equal specifications have equal hashes and equal files."""

    preset: str
    pad: PadGeometry
    body: Body
    box: Box
    aids: Aids
    silicone: Silicone | None
    pour: Pour
    machines: Machines
    closure: Closure | None = None
    sources: tuple[str, ...] = ()
    base: BaseLayer | None = None
    plastic: Plastic | None = None
    acceptance: Acceptance = Acceptance()
    surface: Surface | None = None
    count: int = 1

    @property
    def is_printed(self) -> bool:
        """Whether the pad is cast in the printed mould itself, without silicone."""
        return self.body.style == "printed"

    @property
    def tool(self) -> Silicone | Plastic:
        """What the cavity is made of: the silicone, or the plastic of a printed mould."""
        made_of = self.plastic if self.is_printed else self.silicone
        assert made_of is not None
        return made_of

    @property
    def lid(self) -> Closure:
        """Lid, gutter and funnels of a lidded mould."""
        assert self.closure is not None
        return self.closure

    def to_dict(self) -> dict[str, Any]:
        """Return nested plain dictionaries, tuples as lists; what the mould does not have is left out."""
        plain = _without_none(to_plain(asdict(self)))
        plain.setdefault("closure", None)
        for holder in [plain, *([plain["base"]] if self.base else [])]:
            holder["pour"] = without_usual(holder["pour"])
        if self.count == 1:
            del plain["count"]
        plain["machines"] = without_zeros(plain["machines"], "layer_mm", "bed_diameter_mm")
        if not self.box.face_sheet_mm:
            plain["box"] = {key: value for key, value in plain["box"].items() if "sheet" not in key}
        return plain

    def canonical(self) -> str:
        """Return the specification as JSON with sorted keys and no blanks, one text for one mould."""
        return json.dumps(self.to_dict(), sort_keys=True, separators=(",", ":"), allow_nan=False)

    @cached_property
    def hash(self) -> str:
        """First eight hexadecimal digits (upper case) of the SHA-256 of :meth:`canonical`.

        The name of the ratio's component, the chemistry and what is assumed are left out: they make no other mould.
        """
        base = self.base and replace(self.base, pour=self.base.pour.as_hashed)
        same = replace(self, pour=self.pour.as_hashed, base=base)
        text = same.canonical().replace('"ratio_component":"",', "")
        return hashlib.sha256(text.encode()).hexdigest()[:8].upper()

    @property
    def tag(self) -> str:
        """Thickness as it stands in file names, after the shape's name: ``t5``, ``t7.5``, ``crowned_t5``, ``t5_x4``."""
        prefix = self.pad.prefix
        several = f"_x{self.count}" if self.count > 1 else ""
        return f"{prefix + '_' if prefix else ''}t{self.pad.thickness_mm:g}{several}"

    @staticmethod
    def from_dict(data: dict[str, Any]) -> MouldSpec:
        """Rebuild a specification from :meth:`to_dict`."""
        return rebuild(MouldSpec, {"silicone": None, **data})


def _without_none(value: Any) -> Any:
    """Return nested dictionaries without the keys whose value is None."""
    if isinstance(value, dict):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    return value

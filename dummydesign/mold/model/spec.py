"""The specification of a mould: frozen, checked, hashed; everything else is computed from it."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from dummydesign.geometry.shapes import PadShape, make_shape
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.mold.bone.insert import Insert
from dummydesign.mold.model.hardware import Aids, Body, Box, Closure
from dummydesign.mold.model.pad_kind import PUCK
from dummydesign.mold.model.spec_json import plain_data, rebuild
from dummydesign.mold.printed.surface import Surface
from dummydesign.mold.shop.items import Machines, Plastic, Silicone

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
        """Thinnest gel of the pad: beside a crown or a bump, over a bone, or a layer."""
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
        size = f"{self.length_mm:g} x {self.width_mm:g} x {self.thickness_mm:g} mm"
        return f"{self.name} pad {size}"

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

    ``young_kPa`` is the modulus that the design counts on, None in specifications of earlier editions.
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
    young_kPa: float | None = None

    @property
    def cures_warm(self) -> bool:
        """Whether the cure needs an oven: more than :data:`WARM_K` above the room."""
        return self.cure_temperature_C > self.room_temperature_C + WARM_K


@dataclass(frozen=True)
class BaseLayer:
    """The second resin of a layered pad: how it is poured and its modulus over that of the upper layer."""

    pour: Pour
    modulus_ratio: float


@dataclass(frozen=True)
class Acceptance:
    """How far a cast pad may be off: mean thickness, its spread over five places, mass, modulus of the witness."""

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
    insert: Insert | None = None

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

    def to_dict(self) -> dict[str, Any]:
        """Return nested plain dictionaries, tuples as lists; a base layer or plastic that is not there is left out."""
        plain = plain_data(asdict(self))
        absent = [(plain, name) for name in ("base", "plastic", "silicone", "surface", "insert")]
        for table, name in (*absent, (plain["pour"], "young_kPa")):
            if table[name] is None:
                del table[name]
        if plain.get("plastic", {}).get("expansion_per_K", 1.0) is None:
            del plain["plastic"]["expansion_per_K"], plain["plastic"]["young_MPa"]
        if not plain["machines"]["layer_mm"]:
            del plain["machines"]["layer_mm"]
        if plain["machines"]["fit"] is None:
            del plain["machines"]["fit"]
        if plain["count"] == 1:
            del plain["count"]
        if not plain["box"]["face_sheet_mm"]:
            for name in ("face_sheet_mm", "sheet_bond_mm", "sheet_rim_mm"):
                del plain["box"][name]
        return plain

    def canonical(self) -> str:
        """Return the specification as JSON with sorted keys and no blanks, one text for one mould."""
        return json.dumps(self.to_dict(), sort_keys=True, separators=(",", ":"), allow_nan=False)

    @cached_property
    def hash(self) -> str:
        """First eight hexadecimal digits (upper case) of the SHA-256 of :meth:`canonical`."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()[:8].upper()

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

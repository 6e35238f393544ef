"""Whether a cast pad is the one that was designed: gauge points, readings, limits; what an error of a crown's height
over the flat or of its tip radius makes of the force, and what of it is allowed.

Forces on crowns are those at a quarter of the designed thickness from touch, glued, under a square punch of 14 mm, by
the shape's response table.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.serialise import Serialised
from dummydesign.geometry.dimensions import GAUGE_FOOT_MM, PUNCH_RADIUS_MM, RIM_FREE_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.mold.model.spec import MouldSpec, PadGeometry
from dummydesign.mold.pour.plan import PourPlan
from dummydesign.mold.pour.steps import BLANK

# Gauge points are stated in hundredths of a millimetre.
ROUNDING_MM = 0.005
CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))


@dataclass(frozen=True)
class GaugePoint(Serialised):
    """One place of the pad, from its middle: x along the length, y across, seen on the tested face. [mm]

    ``nominal_mm`` is the thickness from the base to the tested face, ``gel_mm`` the part of it that is gel: less over a
    bone. ``pressed`` says that the gel there is what lies under the punch.
    """

    name: str
    x_mm: float
    y_mm: float
    nominal_mm: float
    low_mm: float
    high_mm: float
    gel_mm: float
    pressed: bool


def gauge_points(spec: MouldSpec) -> tuple[GaugePoint, ...]:
    """Return the gauge points of a pad: tips or middle, what its shape adds, four corners.

    Nominal values come from the shape's own heights. Each limit is the preset's share of the pad's full thickness on
    either side: a plate that lies too high adds as much at every point. At a crown's tip and beside it, it is also that
    of the force (:func:`dummydesign.mold.pour.acceptance.crown_limits`). Points without room on a flat are left out.
    """
    points = tuple(_point(spec, name, at) for name, at in gauge_places(spec).items() if at is not None)
    limits = crown_limits(spec.pad, spec.acceptance.thickness_percent)
    if limits is None:
        return points
    low, high = (one - spec.pad.thickness_mm for one in limits.thickness_mm)
    return tuple(
        replace(one, low_mm=one.nominal_mm + low, high_mm=one.nominal_mm + high)
        if one.pressed or one.name == SHOULDER
        else one
        for one in points
    )


def gauge_places(spec: MouldSpec) -> dict[str, tuple[float, float] | None]:
    """Where each gauge point lies; None where no flat has room for the gauge's foot. [mm]"""
    pad, shape = spec.pad, spec.pad.shape
    first, stands = "middle" if shape.flat_top else "tip", shape.places_mm
    places: dict[str, tuple[float, float] | None] = {
        first if len(stands) == 1 else f"{first}{i}": point for i, point in enumerate(stands, 1)
    }
    clear = pad.edge_radius_mm + GAUGE_FOOT_MM
    most = min(RIM_FREE_MM, min(pad.length_mm, pad.width_mm) / 4)
    corners = [_corner(pad, inset) for inset in (max(most, clear), clear)]
    tries = {} if pad.is_puck else dict(shape.gauge_places())
    for i, (a, b) in enumerate(CORNERS, 1):
        tries[f"{'edge' if pad.is_puck else 'corner'}{i}"] = tuple((a * x, b * y) for x, y in corners)
    return places | {name: next((one for one in tried if _on_flat(pad, one)), None) for name, tried in tries.items()}


def _corner(pad: PadGeometry, inset: float) -> tuple[float, float]:
    """Distances of a corner's gauge point from the pad's middle. [mm]"""
    radius = pad.corner_radius_mm
    # Inside the rounded corner the same distance from the edge, along the corner's diagonal.
    back = inset if radius <= inset else radius - (radius - inset) / math.sqrt(2.0)
    return pad.length_mm / 2 - back, pad.width_mm / 2 - back


def _on_flat(pad: PadGeometry, at: tuple[float, float]) -> bool:
    """Whether the gauge's foot lies whole on a flat of the tested face, off slopes and the rounded edge."""
    clear = pad.edge_radius_mm + GAUGE_FOOT_MM
    radius = max(pad.corner_radius_mm - clear, 0.0)
    beyond = (max(abs(x) + clear + radius - side / 2, 0.0) for x, side in zip(at, (pad.length_mm, pad.width_mm)))
    angle, share = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 145), (0.0, 0.25, 0.5, 0.75, 1.0))
    foot = (GAUGE_FOOT_MM - ROUNDING_MM) * share
    x, y = at[0] + foot * np.cos(angle), at[1] + foot * np.sin(angle)
    return math.hypot(*beyond) <= radius + ROUNDING_MM and float(np.ptp(_drop_mm(pad, x, y))) < 1e-9


def _drop_mm(pad: PadGeometry, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """How far the tested face lies below its tips, of all of which the nearest counts. [mm]"""
    return np.min([pad.shape.drop_mm(x - a, y - b) for a, b in pad.shape.places_mm], axis=0)


def _point(spec: MouldSpec, name: str, at: tuple[float, float]) -> GaugePoint:
    pad, shape = spec.pad, spec.pad.shape
    x, y = (np.array(at) - shape.places_mm).T
    nominal = pad.thickness_mm - float(_drop_mm(pad, np.array(at[0]), np.array(at[1])))
    gel = nominal - float(np.max(shape.bone_mm(x, y)))
    middle = pad.thickness_mm - shape.bone_height_mm
    allowed = pad.thickness_mm * spec.acceptance.thickness_percent / 100
    return GaugePoint(
        name,
        round(at[0], 2),
        round(at[1], 2),
        nominal,
        nominal - allowed,
        nominal + allowed,
        gel,
        abs(nominal - pad.thickness_mm) < 1e-9 and abs(gel - middle) < 1e-9,
    )


def points_rows(points: Sequence[GaugePoint], blank: str, first_pad: int = 1, pads: int = 1) -> list[tuple[str, ...]]:
    """Table of the gauge points with free columns, the first row its head."""
    bone = any(one.gel_mm < one.nominal_mm - 1e-9 for one in points)
    free = ["measured, mm"] if first_pad == pads == 1 else [f"pad {first_pad + i}, mm" for i in range(pads)]
    part = ["of it gel, mm"] if bone else []
    head = ("gauge point", "x, mm", "y, mm", "nominal, mm", *part, "allowed, mm", *free)

    def row(one: GaugePoint) -> tuple[str, ...]:
        gel = (f"{one.gel_mm:.2f}",) if bone else ()
        allowed = f"{one.low_mm:.2f} to {one.high_mm:.2f}"
        return one.name, f"{one.x_mm:g}", f"{one.y_mm:g}", f"{one.nominal_mm:.2f}", *gel, allowed, *[blank] * pads

    return [head, *map(row, points)]


@lru_cache(maxsize=512)
def _force(shape: PadShape, thicknesses_mm: tuple[float, ...], designed_mm: float) -> np.ndarray:
    """Force over modulus of glued pads at a quarter of the designed thickness, under a square punch of 14 mm. [mm2]"""
    from dummydesign.pad.tables.shape import TabulatedShapeLaw
    from dummydesign.pad.tables.slab import load_table

    law = load_table("bonded") if shape.plain else TabulatedShapeLaw(shape)
    return law.force(COMPARED_DEPTH * designed_mm, np.array(thicknesses_mm), 1.0, PUNCH_RADIUS_MM)


def change_percent(pad: PadGeometry, made: PadShape, thickness_mm: float) -> float | None:
    """Change of the force at a given depth when a pad has another shape and thickness than designed. [%]

    None for a puck, and where the response table does not hold one of the two pads.
    """
    if pad.is_puck:
        return None
    h = pad.thickness_mm
    try:
        change = 100 * float(_force(made, (thickness_mm,), h)[0] / _force(pad.shape, (h,), h)[0] - 1)
    except InputError:
        return None
    return change if math.isfinite(change) else None


def force_at_thickness(spec: MouldSpec, shares: tuple[float, ...]) -> tuple[float, ...] | None:
    """Force at a given depth of pads whose thickness is a share of the designed one, over that of the designed one.

    None as :func:`change_percent`.
    """
    pad, h = spec.pad, spec.pad.thickness_mm
    if pad.is_puck:
        return None
    try:
        designed, *others = _force(pad.shape, (h, *(share * h for share in shares)), h)
    except InputError:
        return None
    over = tuple(float(one / designed) for one in others)
    return over if all(map(math.isfinite, over)) else None


def force_change_percent(spec: MouldSpec, share: float) -> float | None:
    """Change of the force at a given depth for a thickness that is a share of the designed one. [%]"""
    force = force_at_thickness(spec, (share,))
    return None if force is None else 100 * (force[0] - 1)


def force_per_thickness(spec: MouldSpec) -> float | None:
    """Relative change of the force at a given depth for a relative change of the thickness, d ln F / d ln h.

    Central difference over one per cent of :func:`force_at_thickness`; None where that is not known.
    """
    step = 0.01
    force = force_at_thickness(spec, (1.0 - step, 1.0 + step))
    if force is None:
        return None
    return float(np.log(force[1] / force[0]) / np.log((1.0 + step) / (1.0 - step)))


def spread_mm(spec: MouldSpec) -> float:
    """How much the offsets of gauge points may differ, the crown's own height taken out. [mm]

    That of the preset; of a crowned pad at most what half of it at the tip changes the force by 5 %.
    """
    most = spec.pad.thickness_mm * spec.acceptance.spread_percent / 100
    limits = crown_limits(spec.pad, spec.acceptance.thickness_percent)
    return most if limits is None else min(most, limits.thickness_mm[1] - limits.thickness_mm[0])


WRONG_MODULUS = "wrong ratio, moist or old resin: cast again, or design again with resins add-compression"
NO_WINDOW = "no limit: a mould alone does not say which moduli are usable; ask suggest --mould with this batch's resin"
BUBBLES = "reject; degas longer or at a lower pressure"


def acceptance_rows(spec: MouldSpec, plan: PourPlan) -> list[tuple[str, ...]]:
    """Table of what is measured on the finished pad, what is allowed, what it costs and what to do; a row each."""
    limits, h, mass = spec.acceptance, spec.pad.thickness_mm, plan.cast_mass_g
    slope = force_per_thickness(spec)

    def costs(percent: float) -> str:
        return "not known" if slope is None else f"{abs(slope) * percent:.0f} % of force at a given depth"

    usable, expected = (
        " to ".join(f"{one:.3g}" for one in pair) for pair in (spec.pour.usable_kPa, spec.pour.expected_kPa)
    )
    crown = crown_limits(spec.pad, limits.thickness_percent)
    gauged = crown is not None and gauge_places(spec).get(SHOULDER) is not None
    within, at_limit = f"within {h * limits.thickness_percent / 100:.2f} mm", costs(limits.thickness_percent)
    spread, heights = "deviation from nominal, largest minus smallest", list[tuple[str, ...]]()
    if crown is not None:
        spread += ", without the crown's height"
        at_limit = f"{MOST_PERCENT:g} % of force at a given depth at most"
        within = "table above"
        height = "{:.2f} to {:.2f} mm".format(*crown.height_mm)
        again = "enter the readings in the record (below); cast again when the plug is off, too"
        row = ("height over the flat: tip less shoulder", f"{spec.pad.shape.relief_mm:.2f} mm", height)
        heights = [(*row, at_limit, BLANK, again)] if gauged else []
    light, heavy = (mass * (1 + sign * limits.mass_percent / 100) for sign in (-1, 1))
    return [
        ("measured", "wanted", "allowed", "effect at the limit", "measured value", "if outside"),
        (
            "thickness at each gauge point",
            "its nominal",
            within,
            at_limit,
            "table above",
            "enter the measured thickness in the record (below); beyond twice the limit cast again",
        ),
        *heights,
        (
            spread,
            "0 mm",
            f"{spread_mm(spec):.2f} mm",
            costs(100 * spread_mm(spec) / h / 2.0),
            BLANK,
            "level again with the weight in the mould, cast again",
        ),
        (
            "mass",
            f"{mass:.1f} g",
            f"{light:.1f} to {heavy:.1f} g",
            costs(limits.mass_percent),
            BLANK,
            "too light: air inside or a leak; too heavy: overfilled",
        ),
        # the modulus of a puck is what it is cast for
        *(
            []
            if spec.pad.is_puck
            else [
                (
                    "modulus of the witness",
                    f"{spec.pour.young_kPa:.1f} kPa",
                    f"{usable} kPa" if usable else f"no limit here; 95 % of batches: {expected} kPa",
                    "1 % of force a per cent" + ("; outside the pad is not usable" if usable else ""),
                    BLANK,
                    WRONG_MODULUS if usable else NO_WINDOW,
                )
            ]
        ),
        ("bubbles over 1 mm under the punch", "none", "none", "softer there; size not known", BLANK, BUBBLES),
    ]


def when_it_fails(spec: MouldSpec) -> tuple[str, ...]:
    """What to do when a step of the pour fails, for the kind of mould that is poured."""
    lidded, boned = spec.body.style == "lidded", bool(spec.pad.shape.bone_height_mm)
    mix = "mix the missing mass within the pot life"
    if lidded:
        little, much, air = (
            f"Too little poured, a vent stays empty: raise its end, tap the mould, {mix} and pour on.",
            "Too much poured: wipe what comes out of the vents off the backer before it gels.",
            "Air under the lid: prop the vent end up again and wait until it has come out; never open the lid.",
        )
    elif boned:
        little, much, air = (
            f"Too little poured: {mix} and top up through a vent.",
            "Too much poured: wipe what comes out of the vents off the plate before it gels.",
            "Air under the plate of the bone: lift one edge, let it out, lower again until all vents show resin.",
        )
    else:
        little, much, air = (
            f"Too little poured: {mix}, or strike off lower and enter the mass.",
            "Too much poured: take it off with a syringe from a corner before it gels.",
            "Air under the plate: lift one edge, let it out, lower again.",
        )
    torn, cast = (
        (
            "A joint that leaks: seal it with wax from outside. A chipped wall of the cavity: print the part anew.",
            "release agent",
        )
        if spec.is_printed
        else (
            "A torn corner of the mould: outside the land it may be glued with silicone; in the cavity cast a new "
            "mould.",
            "silicone",
        )
    )
    return (
        "Foam does not fall within the time: the pump is too weak or the resin is moist. Throw the batch away.",
        f"{little} Never stretch a batch after it thickens.",
        much,
        "The mould was bumped: level again at once while the resin still flows; once it has gelled, cast again.",
        air,
        f"A face that stays tacky: cure inhibition or a wrong ratio. Test print, {cast} and resin on scraps before the "
        "next pour.",
        torn,
    )


def measured_blanks(count: int) -> str:
    """Line for the mass of each pad that came out."""
    if count == 1:
        return f"Weigh the trimmed pad: {BLANK} g"
    pads = "; ".join(f"pad {number}: {BLANK} g" for number in range(1, count + 1))
    return f"Weigh each trimmed pad, by the cavities' order: {pads}"


# Depth over thickness at which the force's sensitivity to lengths is stated.
COMPARED_DEPTH = 0.25
MOST_PERCENT = 5.0
"""Change of the force that one length of a crowned pad may make, the others as designed."""
# Lengths are gauged to a hundredth of a millimetre, tip radii to a tenth.
STEP_MM, RADIUS_STEP_MM = 0.01, 0.1
# Share of a crown's height or tip radius within which limits are sought.
SOUGHT = 0.4


@dataclass(frozen=True)
class CrownLimits:
    """Lowest and highest height over the flat, thickness of a pad whose crown is as designed, and tip radius. [mm]"""

    height_mm: tuple[float, float]
    thickness_mm: tuple[float, float]
    tip_radius_mm: tuple[float, float]


def crown_shape(shape: PadShape, higher_mm: float = 0.0, blunter: float = 1.0) -> PadShape:
    """The shape with its crown higher and its tip radius larger, on the same foot."""
    now: Any = shape
    # without the last digits of a sum: the shape is kept as text
    changed: dict[str, Any] = {"height_mm": round(now.height_mm + higher_mm, 9), "radius_mm": now.radius_mm * blunter}
    return replace(shape, **changed)


def crown_change_percent(
    pad: PadGeometry, higher_mm: float = 0.0, thicker_mm: float = 0.0, blunter: float = 1.0
) -> float | None:
    """Change of the force at a given depth for a crown that is higher, on a flat that is thicker. [%]

    None for a pad without a crown, and where the response table does not hold one of the two pads.
    """
    if not pad.shape.crowned:
        return None
    made = crown_shape(pad.shape, higher_mm, blunter)
    return change_percent(pad, made, pad.thickness_mm + higher_mm + thicker_mm)


@lru_cache(maxsize=64)
def crown_limits(pad: PadGeometry, thickness_percent: float) -> CrownLimits | None:
    """Limits of the lengths of a crowned pad, each of which changes the force by 5 % at most.

    The thickness keeps the preset's limit too. None for a pad whose force is not known.
    """
    if crown_change_percent(pad) is None:
        return None
    shape: Any = pad.shape
    h, most = pad.thickness_mm, pad.thickness_mm * thickness_percent / 100
    height, tip = shape.height_mm, shape.radius_mm
    return CrownLimits(
        _allowed(lambda x: crown_change_percent(pad, higher_mm=x), height, SOUGHT * height, STEP_MM),
        _allowed(lambda x: crown_change_percent(pad, thicker_mm=x), h, most, STEP_MM),
        _allowed(lambda x: crown_change_percent(pad, blunter=1 + x / tip), tip, SOUGHT * tip, RADIUS_STEP_MM),
    )


def _allowed(change: Callable[[float], float | None], nominal: float, most: float, step: float) -> tuple[float, float]:
    """Limits of a length that is off by ``most`` at most, rounded to steps that are read, never outwards."""
    low, high = (nominal + _reach(change, side * most) for side in (-1, 1))
    inner = math.ceil(low / step - 1e-6) * step, math.floor(high / step + 1e-6) * step
    # never beyond the nominal
    return min(round(inner[0], 6), nominal), max(round(inner[1], 6), nominal)


def _reach(change: Callable[[float], float | None], most: float) -> float:
    """How far a length may be off, up to ``most`` (above or below 0), until the force has changed by 5 %."""

    def kept(off: float) -> bool:
        found = change(off)
        return found is not None and abs(found) <= MOST_PERCENT

    if kept(most):
        return most
    good, bad = 0.0, most
    for _ in range(10):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if kept(middle) else (good, middle)
    return good


@dataclass(frozen=True)
class MeasuredCrown:
    """How much a cast crown is higher over the flat than designed, and the flat thicker; number of tips gauged. [mm]"""

    higher_mm: float
    thicker_mm: float
    tips: int = 1

    def change_percent(self, pad: PadGeometry) -> float | None:
        """Change of the force at a given depth. [%]"""
        return crown_change_percent(pad, self.higher_mm, self.thicker_mm)

    def gauge_percent(self, pad: PadGeometry, gauge_mm: float) -> float | None:
        """Standard error of that change for the standard error of one reading, at tip and shoulder. [%]"""
        found = self.change_percent(pad)
        others = (
            crown_change_percent(pad, self.higher_mm + gauge_mm, self.thicker_mm),
            crown_change_percent(pad, self.higher_mm - gauge_mm, self.thicker_mm + gauge_mm),
        )
        if found is None or None in others:
            return None
        tip, shoulder = (float(one or 0.0) - found for one in others)
        return math.hypot(tip / math.sqrt(self.tips), shoulder)

    def differs(self, gauge_mm: float, limits: CrownLimits | None, relief_mm: float) -> bool:
        """Whether the height is beyond its limits, or off by more than twice the error with which it is gauged."""
        error = gauge_mm * math.sqrt(1.0 + 1.0 / self.tips)
        low, high = (-math.inf, math.inf) if limits is None else (one - relief_mm for one in limits.height_mm)
        return not low - 1e-9 <= self.higher_mm <= high + 1e-9 or abs(self.higher_mm) > 2.0 * error


SHOULDER, TIP = "shoulder", "tip"


def measured_crown(readings: Mapping[str, float], pad: PadGeometry) -> MeasuredCrown | None:
    """Read the lengths of a crown from its tips, by their mean, and the flat beside them; None of a pad without one.

    The flat is that of the gauge point next to the crown: at the corners a plate that sags or lies askew leaves
    another.
    """
    tips = [value for name, value in readings.items() if name.startswith(TIP)]
    if not (pad.shape.crowned and tips and SHOULDER in readings):
        return None
    thicker = readings[SHOULDER] - (pad.thickness_mm - pad.shape.relief_mm)
    return MeasuredCrown(sum(tips) / len(tips) - pad.thickness_mm - thicker, thicker, len(tips))

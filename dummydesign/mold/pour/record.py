"""A pad as it was really cast, judged by the limits of its design: what is missed and what it costs. No CAD."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.measurement.pad_record import PadRecord, thickness_error
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import (
    BUBBLES,
    NO_WINDOW,
    SHOULDER,
    TIP,
    WRONG_MODULUS,
    GaugePoint,
    MeasuredCrown,
    crown_change_percent,
    crown_limits,
    crown_shape,
    force_change_percent,
    gauge_points,
    measured_crown,
    spread_mm,
)
from dummydesign.mold.pour.plan import pour_plan

PLACES = 5
GAUGE_MM = 0.05
"""Standard error of a thickness gauge on a gel, when none is given: judgement, its foot sinks in by some 0.05 mm."""


SCALE_G = 0.1
"""Limit of a scale's error when none is given, as ``suggest`` takes it."""


@dataclass(frozen=True)
class Measured:
    """What was measured of a cast pad; None where it was not.

    ``points`` are the gauge points of ``thicknesses_mm`` by name, empty for a plain list. ``weighed_g`` are the masses
    of the liquids that were weighed in, by name, each within plus and minus ``scale_g``.
    """

    thicknesses_mm: tuple[float, ...]
    mass_g: float
    young_kPa: float | None = None
    level_deg: float | None = None
    bubbles: int | None = None
    gauge_mm: float = GAUGE_MM
    note: str = ""
    points: tuple[str, ...] = ()
    young_sd_kPa: float | None = None
    weighed_g: Mapping[str, float] = field(default_factory=dict)
    scale_g: float = SCALE_G

    @property
    def readings(self) -> dict[str, float]:
        """Thickness by the name of its gauge point; empty for a plain list. [mm]"""
        return dict(zip(self.points, self.thicknesses_mm))


@dataclass(frozen=True)
class LimitCheck:
    """One limit: what was found, what is allowed, what it costs in force at a given depth, what to do when missed."""

    what: str
    value: float
    unit: str
    low: float | None
    high: float | None
    missed: bool
    force_percent: float | None
    advice: str


def allowed_words(low: float | None, high: float | None) -> str:
    """The limits of a check."""
    if high is None:
        return "no limit"
    return f"at most {high:.4g}" if low is None else f"{low:.4g} to {high:.4g}"


def read_spec(folder: str | Path) -> MouldSpec:
    """Read the specification in the folder of a mould."""
    path, content = _read(folder)
    try:
        spec, recorded = MouldSpec.from_dict(content["spec"]), content["hash"]
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        raise _damaged(path, problem) from None
    if spec.hash != recorded:
        message = f"'{path}' was changed: its hash is {spec.hash}, not {recorded}; make the mould again"
        raise InputError(message, "inconsistent", "hash", spec.hash, recorded)
    return spec


def read_points(folder: str | Path) -> tuple[GaugePoint, ...]:
    """Read the gauge points that the pour sheet of a mould lists."""
    path, content = _read(folder)
    try:
        return tuple(GaugePoint(**one) for one in content["gauge_points"])
    except (KeyError, TypeError) as problem:
        message = f"'{path}' is damaged at gauge_points ({problem}); make the mould again"
        raise InputError(message, "malformed", "gauge_points") from None


def _read(folder: str | Path) -> tuple[Path, dict[str, Any]]:
    path = Path(folder) / "spec.json"
    try:
        return path, dict(json.loads(path.read_text(encoding="utf-8")))
    except FileNotFoundError:
        message = f"'{folder}' has no spec.json; give the folder that 'dummydesign mold' wrote"
        raise InputError(message, "file_not_found", "mould_folder", str(folder)) from None
    except (OSError, ValueError, TypeError) as problem:
        raise _damaged(path, problem) from None


def _damaged(path: Path, problem: Exception) -> InputError:
    message = f"'{path}' is damaged ({problem}); make the mould again"
    return InputError(message, "file_unreadable", "mould_folder", str(path.parent))


def check_measured(measured: Measured, spec: MouldSpec, points: tuple[GaugePoint, ...]) -> None:
    """Refuse what cannot have been measured on this pad, so that a slip of the pen does not become a pad."""
    h, count = spec.pad.thickness_mm, len(measured.thicknesses_mm)
    if measured.points:
        check_readings(measured.readings, points)
    elif not spec.pad.shape.flat_top:
        raise InputError(
            f"--thickness without names cannot be judged: a {spec.pad.shape.title} is not equally thick "
            f"everywhere; give the reading at each gauge point: {example(points)}",
            "malformed",
            "thickness",
        )
    elif count < PLACES:
        message = f"--thickness has {count} values; measure at {PLACES} places or more"
        raise InputError(message, "not_enough_data", "thickness", count, (PLACES, None))
    for one in () if measured.points else measured.thicknesses_mm:
        if not 0.5 * h <= one <= 2.0 * h:
            raise out_of_range("--thickness", f"{one:g} mm", f"{0.5 * h:g}", f"{2 * h:g} mm", f"the pad is of {h:g} mm")
    wanted = pour_plan(spec).cast_mass_g
    if not 0.3 * wanted <= measured.mass_g <= 3.0 * wanted:
        advice = f"the pad is of {wanted:.1f} g"
        raise out_of_range("--mass", f"{measured.mass_g:g} g", f"{0.3 * wanted:.0f}", f"{3 * wanted:.0f} g", advice)
    for name, value, low, high in (
        ("--modulus", measured.young_kPa, 0.5, 5000.0),
        ("--modulus-error", measured.young_sd_kPa, 0.0, 0.5 * (measured.young_kPa or 5000.0)),
        ("--scale", measured.scale_g, 0.0, 10.0),
        ("--level", measured.level_deg, 0.0, 10.0),
        ("--bubbles", measured.bubbles, 0, 10000),
        ("--gauge", measured.gauge_mm, 0.0, 0.2 * h),
    ):
        if value is not None and not low <= value <= high:
            raise out_of_range(name, f"{value:g}", f"{low:g}", f"{high:g}")


def check_readings(readings: Mapping[str, float], points: Sequence[GaugePoint]) -> None:
    """Refuse readings of unknown points, missing points and values that this pad cannot have."""
    names = [point.name for point in points]
    for name in readings:
        if name not in names:
            raise unknown_name("gauge point", name, names)
    if missing := [name for name in names if name not in readings]:
        raise InputError(f"--thickness lacks {', '.join(missing)}; give {example(points)}", "missing", "thickness")
    for point in points:
        value, nominal = readings[point.name], point.nominal_mm
        if not 0.5 * nominal <= value <= 2.0 * nominal:
            raise out_of_range(
                f"--thickness {point.name}",
                f"{value:g} mm",
                f"{0.5 * nominal:g}",
                f"{2 * nominal:g} mm",
                f"its nominal is {nominal:.2f} mm",
            )


def example(points: Sequence[GaugePoint]) -> str:
    """How readings are typed: every name with its nominal thickness."""
    return ",".join(f"{point.name}={point.nominal_mm:.2f}" for point in points)


def offsets_mm(readings: Mapping[str, float], points: Sequence[GaugePoint]) -> dict[str, float]:
    """Reading less nominal thickness by name. [mm]"""
    return {point.name: readings[point.name] - point.nominal_mm for point in points}


def pressed_thickness_mm(readings: Mapping[str, float], points: Sequence[GaugePoint], thickness_mm: float) -> float:
    """Thickness of the pad as its force law means it. [mm]

    Of a pad with tips the mean reading at them; of a flat pad the designed thickness and the mean offset of all points.
    """
    flat = all(abs(point.nominal_mm - thickness_mm) < 1e-9 for point in points)
    off = offsets_mm(readings, points)
    counted = [off[point.name] for point in points if flat or point.pressed]
    return thickness_mm + sum(counted) / len(counted)


def record_pad(measured: Measured, spec: MouldSpec, points: tuple[GaugePoint, ...] | None = None) -> PadRecord:
    """Judge a cast pad.

    The force is that at a quarter of the designed thickness by the response table, over that of the designed pad:
    by the thickness and in proportion to the witness's modulus. The thickness is the mean of a flat pad's readings
    and the reading at the tip of a pad that is not flat; of a crowned pad the height of the crown over the flat beside
    it counts too.
    """
    points = points or gauge_points(spec)
    check_measured(measured, spec, points)
    pad, young, crown = spec.pad, measured.young_kPa, measured_crown(measured.readings, spec.pad)
    evened = _evened_mm(measured, spec, points)
    thickness = sum(evened) / len(evened)
    if measured.points:
        thickness = pressed_thickness_mm(measured.readings, points, pad.thickness_mm)
    by_lengths = _by_lengths(crown, thickness, spec)
    limits = judge(measured, spec, points)
    ratio = weighed_ratio(measured, spec) if measured.weighed_g else (None, None)
    stiffer = 1.0 if young is None or spec.base is not None else young / spec.pour.young_kPa
    return PadRecord(
        specification=spec.hash,
        shape=pad.name,
        length_mm=pad.length_mm,
        width_mm=pad.width_mm,
        resin=spec.pour.resin,
        ratio=spec.pour.ratio,
        design_thickness_mm=pad.thickness_mm,
        thicknesses_mm=measured.thicknesses_mm,
        points=measured.points,
        thickness_mm=thickness,
        # one reading shows no scatter
        thickness_sd_mm=thickness_error(evened, measured.gauge_mm) if len(evened) > 1 else measured.gauge_mm,
        mass_g=measured.mass_g,
        design_young_kPa=spec.pour.young_kPa,
        young_kPa=young,
        level_deg=measured.level_deg,
        bubbles=measured.bubbles,
        accepted=not any(one.missed for one in limits),
        force_percent=None if by_lengths is None else 100 * ((1 + by_lengths / 100) * stiffer - 1),
        missed=tuple(_words(one) for one in limits if one.missed),
        note=measured.note,
        limits=tuple(asdict(one) for one in limits),
        young_sd_kPa=measured.young_sd_kPa,
        weighed_ratio=ratio[0],
        weighed_ratio_sd=ratio[1],
        cast_shape=_cast_shape(crown, measured.gauge_mm, spec),
        force_sd_percent=None if crown is None else crown.gauge_percent(pad, measured.gauge_mm),
    )


def _by_lengths(crown: MeasuredCrown | None, thickness_mm: float, spec: MouldSpec) -> float | None:
    """Change of the force for the lengths of a cast pad. [%]"""
    if crown is None:
        return force_change_percent(spec, thickness_mm / spec.pad.thickness_mm)
    return crown.change_percent(spec.pad)


def _cast_shape(crown: MeasuredCrown | None, gauge_mm: float, spec: MouldSpec) -> str:
    """The pad's shape with the height that was gauged, in micrometres; empty where the gauge cannot tell another."""
    limits = crown_limits(spec.pad, spec.acceptance.thickness_percent)
    if crown is None or not crown.differs(gauge_mm, limits, spec.pad.shape.relief_mm):
        return ""
    return str(crown_shape(spec.pad.shape, round(crown.higher_mm, 3)))


def weighed_ratio(measured: Measured, spec: MouldSpec) -> tuple[float, float]:
    """The mixing ratio that the weighed masses make, and its standard error; each is even within the scale's limit."""
    from dummydesign.resin import load_resin

    resin, masses = load_resin(spec.pour.resin), dict(measured.weighed_g)
    parts = resin.parts(spec.pour.ratio)
    for name, mass in masses.items():
        if name not in parts:
            raise unknown_name("weighed liquid", name, tuple(parts), quantity="weighed")
        if not (math.isfinite(mass) and mass > 0.0):
            raise InputError(f"--weighed {name}={mass:g} must be above 0 g", "out_of_range", "weighed", mass)
    if missing := [name for name in parts if name not in masses]:
        message = f"--weighed lacks {', '.join(missing)}; give NAME=G of every liquid of {resin.name}"
        raise InputError(message, "missing", "weighed")
    by_ratio = next(liquid.name for liquid in resin.liquids if liquid.parts is None)
    rest = sum(mass for name, mass in masses.items() if name != by_ratio)
    ratio = float(resin.ratio_of(masses))
    if not 0.5 * spec.pour.ratio <= ratio <= 2.0 * spec.pour.ratio:
        meant = f"the mould is for ratio {spec.pour.ratio:g}"
        raise out_of_range(
            "--weighed", f"ratio {ratio:.4g}", f"{0.5 * spec.pour.ratio:g}", f"{2 * spec.pour.ratio:g}", meant
        )
    each = measured.scale_g / math.sqrt(3.0)
    share = 1.0 - ratio / 100.0 if resin.ratio_per == "mix" else 1.0
    return ratio, share * ratio * each * math.hypot(1.0 / masses[by_ratio], math.sqrt(len(masses) - 1) / rest)


def _evened_mm(measured: Measured, spec: MouldSpec, points: tuple[GaugePoint, ...]) -> tuple[float, ...]:
    """Readings as a flat pad would have them: designed thickness and offset from the nominal of each point. [mm]

    Of what stands over the flat, tips and all, a crown's own error of height is taken out.
    """
    if not measured.points:
        return measured.thicknesses_mm
    crown = measured_crown(measured.readings, spec.pad)
    higher = 0.0 if crown is None else crown.higher_mm
    return tuple(
        spec.pad.thickness_mm + off - (higher if name.startswith(TIP) else 0.0)
        for name, off in offsets_mm(measured.readings, points).items()
    )


def judge(measured: Measured, spec: MouldSpec, points: tuple[GaugePoint, ...] | None = None) -> tuple[LimitCheck, ...]:
    """Each limit of acceptance with what was measured; those that were not measured are left out."""
    limits, pad, points = spec.acceptance, spec.pad, points or gauge_points(spec)
    h, values = pad.thickness_mm, _evened_mm(measured, spec, points)
    mean, spread = sum(values) / len(values), max(values) - min(values)
    again = "level again with the load in the mould, cast again"
    if measured.points:
        crown = measured_crown(measured.readings, pad)
        checks = [_at(point, measured.readings[point.name], spec, crown) for point in points]
        checks += _crown_checks(measured.readings, spec)
    else:
        cost = force_change_percent(spec, mean / h)
        checks = [_around("thickness, mean", mean, "mm", h, limits.thickness_percent, cost, _advice(mean, spec))]
    what = "thickness, largest less smallest" if pad.shape.flat_top else "off nominal, largest less smallest"
    checks += [
        _at_most(
            what,
            spread,
            "mm",
            spread_mm(spec),
            force_change_percent(spec, 1 + spread / 2 / h),
            f"{again}; until then press in one place and gauge it there",
        ),
        _mass(measured, spec, mean),
    ]
    if measured.young_kPa is not None:
        change = 100 * (measured.young_kPa / spec.pour.young_kPa - 1) if spec.base is None else None
        low, high = spec.pour.usable_kPa or (None, None)
        missed = low is not None and high is not None and not low <= measured.young_kPa <= high
        advice = NO_WINDOW if low is None else WRONG_MODULUS
        checks.append(
            LimitCheck("modulus of the witness", measured.young_kPa, "kPa", low, high, missed, change, advice)
        )
    if measured.level_deg is not None:
        half_mm = formula.tilt_error_mm(max(pad.length_mm, pad.width_mm), measured.level_deg) / 2
        checks.append(
            _at_most(
                "level",
                measured.level_deg,
                "deg",
                pour_plan(spec).level_deg,
                force_change_percent(spec, 1 + half_mm / h),
                again,
            )
        )
    if measured.bubbles is not None:
        checks.append(_at_most("bubbles over 1 mm under the punch", measured.bubbles, "", 0.0, None, BUBBLES))
    return tuple(checks)


def _at(point: GaugePoint, value: float, spec: MouldSpec, crown: MeasuredCrown | None) -> LimitCheck:
    """The thickness at a gauge point; its cost in force where it is the gel under the punch.

    A crown's tip costs what its height over the flat and the flat's thickness cost together.
    """
    h, off = spec.pad.thickness_mm, value - point.nominal_mm
    cost = _by_lengths(crown, h + off, spec) if point.pressed else None
    missed = not point.low_mm <= value <= point.high_mm
    return LimitCheck(
        f"thickness at {point.name}", value, "mm", point.low_mm, point.high_mm, missed, cost, _advice(h + off, spec)
    )


def _crown_checks(readings: Mapping[str, float], spec: MouldSpec) -> list[LimitCheck]:
    """The height of each crown over the flat beside it, where its limits are known."""
    limits, nominal = crown_limits(spec.pad, spec.acceptance.thickness_percent), spec.pad.shape.relief_mm
    if limits is None or SHOULDER not in readings:
        return []
    checks = []
    low, high = limits.height_mm
    for name in (name for name in readings if name.startswith(TIP)):
        value = readings[name] - readings[SHOULDER]
        cost = crown_change_percent(spec.pad, value - nominal)
        missed = not low - 1e-9 <= value <= high + 1e-9
        checks.append(LimitCheck(f"height over the flat at {name}", value, "mm", low, high, missed, cost, OFF_HEIGHT))
    return checks


OFF_HEIGHT = "usable with its real heights: give this record to the campaign, gauge the plug before the next pad"


def _at_most(what: str, value: float, unit: str, high: float, cost: float | None, advice: str) -> LimitCheck:
    return LimitCheck(what, value, unit, None, high, value > high, None if cost is None else abs(cost), advice)


def _around(
    what: str, value: float, unit: str, wanted: float, percent: float, cost: float | None, advice: str
) -> LimitCheck:
    low, high = wanted * (1 - percent / 100), wanted * (1 + percent / 100)
    return LimitCheck(what, value, unit, low, high, not low <= value <= high, cost, advice)


def _advice(thickness_mm: float, spec: MouldSpec) -> str:
    if abs(thickness_mm / spec.pad.thickness_mm - 1) > 2 * spec.acceptance.thickness_percent / 100:
        return "beyond twice the limit: cast again"
    return "usable with its real thickness: give this record to the campaign"


def _mass(measured: Measured, spec: MouldSpec, mean: float) -> LimitCheck:
    """The mass; its cost is the thickness's, and what thickness does not explain is air or resin outside."""
    wanted, h = pour_plan(spec).cast_mass_g, spec.pad.thickness_mm
    grown = mean / h if spec.pad.shape.flat_top else 1 + pour_plan(spec).gram_per_mm_g * (mean - h) / wanted
    left = 100 * (measured.mass_g / wanted / grown - 1)
    why = f"{abs(left):.1f} % {'lighter' if left < 0 else 'heavier'} than its thickness explains: "
    if abs(left) <= spec.acceptance.mass_percent:
        why = "as its thickness explains"
    else:
        why += "air inside, hardly to be used" if left < 0 else "resin outside the outline, or the gauge sank in"
    return _around("mass", measured.mass_g, "g", wanted, spec.acceptance.mass_percent, None, why)


def _words(one: LimitCheck) -> str:
    return f"{one.what} {one.value:.4g} {one.unit}".rstrip() + f" (allowed {allowed_words(one.low, one.high)})"

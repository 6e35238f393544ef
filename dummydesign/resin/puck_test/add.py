"""Modulus and relaxation of a batch from one compression curve of its puck, and the resin it becomes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.datafiles import entries, user_folder
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.files import output_folder
from dummydesign.core.own_files import check_name, hidden_by
from dummydesign.core.quantity import Quantity
from dummydesign.resin.model.puck_point import PuckPoint, recording_sha256
from dummydesign.resin.model.resin_file import DEFAULT, KIND, load_resin
from dummydesign.resin.model.resin_writer import save_resin
from dummydesign.resin.update.modulus import Point
from dummydesign.resin.update.pucks import known_puck, with_point, without_puck

if TYPE_CHECKING:
    from dummydesign.measurement.landmarks import Hold
    from dummydesign.measurement.trace import Trace
    from dummydesign.pad.tables.pucks.response import PuckTable
    from dummydesign.resin.model.resin import Resin
    from dummydesign.resin.puck_test.relaxation_fit import Found, PuckRelaxation

Array = np.ndarray

FIRST_SHARE, LAST_SHARE = 0.03, 0.5
"""Compressions that are used, in heights: past the toe, and short of where the side lies on the plates."""

STEPS = 60


@dataclass(frozen=True)
class Compressed:
    """What one puck's curve says; ``young_kPa`` is of this puck alone, ``relaxation`` None without a hold.

    ``action`` is ``added``, ``unchanged`` (the resin has this puck at this ratio) or ``replaced`` (it had it at
    another ratio or size, said in ``before``).
    """

    name: str
    base: str
    ratio: float
    young_kPa: Quantity
    alpha: float
    friction: dict[str, float | None]
    rmse_N: float
    compression_mm: tuple[float, float]
    file: str
    relaxation: dict[str, Any] | None = None
    warnings: tuple[dict[str, str], ...] = ()
    action: str = "added"
    before: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; ``law`` names the elastic law that was fitted."""
        return {
            "name": self.name,
            "base": self.base,
            "ratio": self.ratio,
            "young_kPa": self.young_kPa.to_dict(),
            "law": {"name": "ogden, one term", "alpha": self.alpha},
            "friction": self.friction,
            "rmse_N": self.rmse_N,
            "compression_mm": list(self.compression_mm),
            "relaxation": self.relaxation,
            "warnings": list(self.warnings),
            "action": self.action,
            "before": self.before,
            "files": {"resin": self.file},
        }


def loading(displacement_mm: Array, force_N: Array) -> tuple[Array, Array]:
    """The first loading of a trace: up to its largest displacement, on rising displacements only.

    Returns
    -------
    compression, load : ndarray
        Strictly rising compressions [mm] and the mean load at each [N].
    """
    end = int(np.argmax(displacement_mm)) + 1
    rising = np.maximum.accumulate(displacement_mm[:end])
    place, index = np.unique(rising, return_inverse=True)
    return place, np.bincount(index, force_N[:end]) / np.bincount(index)


def add_compression(
    file: str | Path, diameter_mm: float, height_mm: float, name: str, ratio: float, base: str | None = None,
    replace_own: bool = False,
) -> Compressed:  # fmt: skip
    """Fit a puck's compression curve and keep the resin that its modulus makes of a law.

    A curve without a hold: load = A E u(c; alpha) B(c; alpha, friction), see
    :mod:`dummydesign.resin.puck_test.loading_fit`; modulus, stiffening, plate friction and contact offset
    together. The modulus is that of the press, slow against relaxation: press slowly, or what has not relaxed
    counts as stiffness. With one or more holds the relaxation is fitted too, see
    :mod:`dummydesign.resin.puck_test.relaxation_fit`: the modulus is then the long-term one, and the arms go into
    the resin by the rule of :mod:`dummydesign.resin.update.relaxation`. What friction leaves open is
    in the intervals of both.

    A recording that the resin has is known by its numbers: at the same ratio and size nothing is changed, else its
    point is replaced, as if it had not been there before.

    Parameters
    ----------
    file : path
        Trace CSV of one loading, or of ramps and holds; displacement is the compression. [s, mm, N]
    diameter_mm, height_mm : float
        Undeformed puck, of proportions for which there is a friction table. [mm]
    name : str
        Name of the resin that results; one of that name in the user's folder gets this point besides its own.
    ratio : float
        Mixing ratio of the puck.
    base : str, optional
        Resin whose law is updated; by default the one called NAME, else the paper's polyurethane.
    replace_own : bool
        Begin a resin of the user that has this name again, without the points it has.

    Raises
    ------
    InputError
        For a bad file, shape, name or ratio, or a compression that is too small.
    """
    from dummydesign.measurement.landmarks import find_holds
    from dummydesign.measurement.trace import read_trace
    from dummydesign.pad.tables.pucks.proportions import table_for

    for what, value in (("diameter_mm", diameter_mm), ("height_mm", height_mm)):
        if not (np.isfinite(value) and value > 0.0):
            raise out_of_range(what, value, "above 0", "any finite value")
    check_name("resin", name)
    known = entries(KIND).get(name.lower())
    own = known if known is not None and known.origin == "user" else None
    if own and base is not None and base.lower() != name.lower() and not replace_own:
        raise InputError(
            f"resin '{own.name}' exists; leave --resin out to add this puck to it, or --replace to begin it again"
        )
    if own and replace_own and base is None:
        raise InputError(f"--replace begins resin '{own.name}' again; say from which one with --resin")
    resin = load_resin(base or (name if known is not None else DEFAULT))
    resin.check_ratio(ratio)
    table = table_for(diameter_mm, height_mm)
    trace = read_trace(file)
    window = _window(trace, height_mm, table)
    source = f"puck {diameter_mm:g} x {height_mm:g} mm, {trace.name}, fitted with plate friction left open"
    puck = PuckPoint(recording_sha256(trace), trace.name, diameter_mm, height_mm)
    seen = find_holds(trace.time_s, trace.displacement_mm)
    holds = tuple(hold for hold in seen if window[0] < hold.displacement_mm <= window[1])
    if seen and not holds:
        raise InputError(
            f"{trace.name}: holds at {', '.join(f'{hold.displacement_mm:.3g}' for hold in seen)} mm; one must lie "
            f"between {window[0]:.3g} and {window[1]:.3g} mm, or cut the file at the end of the loading"
        )
    before = known_puck(resin, puck.sha256)
    fitted = _with_holds if holds else _without_hold
    found, point = fitted(trace, holds, table, window, puck, ratio, source)
    found = replace(found, name=name, base=resin.name)
    path = user_folder() / KIND / f"{name if known is None or not own else known.name}.toml"
    if before is not None and _same(before, point):
        return replace(found, action="unchanged", file=str(path))
    if before is not None:
        resin = without_puck(resin, puck.sha256)
        found = replace(found, action="replaced", before=_place(before))
    kept, updates, said = with_point(resin, point, path.stem)
    warnings = (*found.warnings, *({"code": "relaxation_update", "message": text} for text in said))
    warnings += () if own else tuple(hidden_by(KIND, "resin", name))
    relaxation = None
    if found.relaxation is not None:
        relaxation = found.relaxation | {"updates": [one.to_dict() for one in updates]}
    return replace(found, relaxation=relaxation, warnings=warnings, file=_keep(kept))


def _same(before: Point, now: Point) -> bool:
    """Whether a puck is known at this ratio and size."""
    return before.ratio == now.ratio and all(
        getattr(before.puck, size) == getattr(now.puck, size) for size in ("diameter_mm", "height_mm")
    )


def _place(point: Point) -> str:
    return f"ratio {point.ratio:g}, {point.puck.diameter_mm:g} x {point.puck.height_mm:g} mm" if point.puck else ""


def _window(trace: Trace, height_mm: float, table: PuckTable) -> tuple[float, float]:
    """Compressions that are used. [mm]"""
    largest = float(np.max(trace.displacement_mm))
    share = min(LAST_SHARE, float(table.compression[-1]) - 0.02)
    first, last = FIRST_SHARE * height_mm, min(share * height_mm, largest)
    if last < 4.0 * first:
        raise InputError(
            f"{trace.name}: largest displacement_mm = {largest:.3g} is too small; compress the puck by at least "
            f"{4.0 * first:.3g} mm, better {share * height_mm:.3g} mm"
        )
    return first, last


def _without_hold(
    trace: Trace, holds: tuple[Hold, ...], table: PuckTable, window: tuple[float, float], puck: PuckPoint,
    ratio: float, source: str,
) -> tuple[Compressed, Point]:  # fmt: skip
    from dummydesign.resin.puck_test.loading_fit import Curve, fit_pucks

    first, last = window
    place, load = loading(trace.displacement_mm, trace.force_N)
    grid = np.concatenate([[0.0], np.linspace(first, last, STEPS)])
    curve = Curve(trace.name, "puck", grid, np.interp(grid, place, load))
    found = fit_pucks([curve], puck.diameter_mm, puck.height_mm, table, (first * (1 - 1e-9), last))
    young = Quantity(found.young_kPa, found.young_low_kPa, found.young_high_kPa, "fitted", source)
    friction = _friction(found.friction, found.friction_low, found.friction_high)
    absolute = found.rmse * float(np.sqrt(np.mean(curve.load_N[1:] ** 2)))
    told = Compressed("", "", ratio, young, found.alpha, friction, absolute, (first, last), "")
    return told, Point(ratio, young, puck)


def _with_holds(
    trace: Trace, holds: tuple[Hold, ...], table: PuckTable, window: tuple[float, float], puck: PuckPoint,
    ratio: float, source: str,
) -> tuple[Compressed, Point]:  # fmt: skip
    from dummydesign.resin.puck_test.reduction import reduce_press
    from dummydesign.resin.puck_test.relaxation_fit import fit_relaxation

    # half a hundredth of the height more, so that a hold at the very end is not cut by its own noise
    press = reduce_press(
        trace.time_s, trace.displacement_mm, trace.force_N, holds, (window[0], window[1] + 0.005 * puck.height_mm)
    )
    found = fit_relaxation(press, puck.diameter_mm, puck.height_mm, table)
    young = Quantity(found.young_kPa.value, found.young_kPa.low, found.young_kPa.high, "fitted", source)
    told = f"holds of puck {puck.diameter_mm:g} x {puck.height_mm:g} mm, {trace.name}"

    def quantity(one: Found) -> Quantity:
        return Quantity(one.value, one.low, one.high, "fitted", told)

    arms = [(quantity(arm.tau_s), quantity(arm.beta)) for arm in found.arms if not arm.reason]
    warnings = [{"code": "not_identifiable", "message": _flag(arm.reason)} for arm in found.arms if arm.reason]
    shown = Compressed(
        "", "", ratio, young, found.alpha, _friction(found.friction.value, found.friction.low, found.friction.high),
        found.rmse_N, window, "", relaxation_dict(found, holds), tuple(warnings),
    )  # fmt: skip
    return shown, Point(ratio, young, replace(puck, seen_s=(found.seen_s[0], found.seen_s[1]), arms=tuple(arms)))


def _flag(reason: str) -> str:
    return f"an arm of the relaxation has no value: {reason}"


def relaxation_dict(found: PuckRelaxation, holds: tuple[Hold, ...]) -> dict[str, Any]:
    """Holds, arms and their rivals as plain values; an arm that is not identifiable has null and its reason."""
    return {
        "holds": [
            {"start_s": hold.start_s, "end_s": hold.end_s, "displacement_mm": hold.displacement_mm} for hold in holds
        ],
        "seen_s": list(found.seen_s),
        "prony": [
            {"tau_s": arm.tau_s.to_dict(), "beta": arm.beta.to_dict()} for arm in found.arms if not arm.reason
        ],
        "not_identifiable": [
            {"tau_s": None, "beta": None, "reason": arm.reason} for arm in found.arms if arm.reason
        ],
        "comparison": found.comparison,
        "noise": found.noise.to_dict(),
    }


def _keep(resin: Resin) -> str:
    return str(save_resin(resin, output_folder(user_folder() / KIND) / f"{resin.name}.toml"))


def _friction(value: float, low: float, high: float) -> dict[str, float | None]:
    """Friction with its interval; None for plates that hold the faces."""
    return {
        key: number if np.isfinite(number) else None
        for key, number in (("value", value), ("low", low), ("high", high))
    }

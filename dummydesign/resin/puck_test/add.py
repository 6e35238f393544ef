"""Modulus and relaxation of a batch from one compression curve of its puck, and the resin it becomes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.datafiles import entries, user_folder
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.files import output_folder
from dummydesign.core.quantity import Quantity
from dummydesign.resin.model.resin_file import DEFAULT, KIND, load_resin
from dummydesign.resin.model.resin_writer import save_resin
from dummydesign.resin.update.modulus import Point, update_resin

if TYPE_CHECKING:
    from dummydesign.measurement.landmarks import Hold
    from dummydesign.measurement.trace import Trace
    from dummydesign.pad.tables.puck import PuckTable
    from dummydesign.resin.model.resin import Resin
    from dummydesign.resin.puck_test.relaxation_fit import PuckRelaxation

Array = np.ndarray

FIRST_SHARE, LAST_SHARE = 0.03, 0.5
"""Compressions that are used, in heights: past the toe, and short of where the side lies on the plates."""

STEPS = 60


@dataclass(frozen=True)
class Compressed:
    """What one puck's curve says; ``young_kPa`` is of this puck alone, ``relaxation`` None without a hold."""

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
    file: str | Path, diameter_mm: float, height_mm: float, name: str, ratio: float, base: str | None = None
) -> Compressed:
    """Fit a puck's compression curve and keep the resin that its modulus makes of a law.

    A curve without a hold: load = A E u(c; alpha) B(c; alpha, friction), see
    :mod:`dummydesign.resin.puck_test.loading_fit`; modulus, stiffening, plate friction and contact offset
    together. The modulus is that of the press, slow against relaxation: press slowly, or what has not relaxed
    counts as stiffness. With one or more holds the relaxation is fitted too, see
    :mod:`dummydesign.resin.puck_test.relaxation_fit`: the modulus is then the long-term one, and the arms go into
    the resin by the rule of :mod:`dummydesign.resin.update.relaxation`. What friction leaves open is
    in the intervals of both.

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
        Resin whose law is updated; by default the user's own NAME, else the paper's polyurethane.

    Raises
    ------
    InputError
        For a bad file, shape, name or ratio, or a compression that is too small.
    """
    from dummydesign.measurement.landmarks import find_holds
    from dummydesign.measurement.trace import read_trace
    from dummydesign.pad.tables.puck_proportions import table_for

    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", name):
        raise InputError(f"name = '{name}' cannot be a file name; use letters, digits, '-' and '_'")
    for what, value in (("diameter_mm", diameter_mm), ("height_mm", height_mm)):
        if not (np.isfinite(value) and value > 0.0):
            raise out_of_range(what, value, "above 0", "any finite value")
    known = entries(KIND).get(name.lower())
    own = known is not None and known.origin == "user"
    resin = load_resin(base or (name if own else DEFAULT))
    resin.check_ratio(ratio)
    table = table_for(diameter_mm, height_mm)
    trace = read_trace(file)
    window = _window(trace, height_mm, table)
    source = f"puck {diameter_mm:g} x {height_mm:g} mm, {trace.name}, fitted with plate friction left open"
    seen = find_holds(trace.time_s, trace.displacement_mm)
    holds = tuple(hold for hold in seen if window[0] < hold.displacement_mm <= window[1])
    if seen and not holds:
        raise InputError(
            f"{trace.name}: holds at {', '.join(f'{hold.displacement_mm:.3g}' for hold in seen)} mm; one must lie "
            f"between {window[0]:.3g} and {window[1]:.3g} mm, or cut the file at the end of the loading"
        )
    if holds:
        return _with_holds(trace, holds, (diameter_mm, height_mm), table, window, resin, name, ratio, source)
    place, load = loading(trace.displacement_mm, trace.force_N)
    return _without_hold(trace, place, load, (diameter_mm, height_mm), table, window, resin, name, ratio, source)


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
    trace: Trace, place: Array, load: Array, size_mm: tuple[float, float], table: PuckTable,
    window: tuple[float, float], resin: Resin, name: str, ratio: float, source: str,
) -> Compressed:  # fmt: skip
    from dummydesign.resin.puck_test.loading_fit import Curve, fit_pucks

    first, last = window
    grid = np.concatenate([[0.0], np.linspace(first, last, STEPS)])
    curve = Curve(trace.name, "puck", grid, np.interp(grid, place, load))
    found = fit_pucks([curve], *size_mm, table, (first * (1 - 1e-9), last))
    young = Quantity(found.young_kPa, found.young_low_kPa, found.young_high_kPa, "fitted", source)
    path = _keep(update_resin(resin, [Point(ratio, young)], name))
    friction = _friction(found.friction, found.friction_low, found.friction_high)
    absolute = found.rmse * float(np.sqrt(np.mean(curve.load_N[1:] ** 2)))
    return Compressed(name, resin.name, ratio, young, found.alpha, friction, absolute, (first, last), path)


def _with_holds(
    trace: Trace, holds: tuple[Hold, ...], size_mm: tuple[float, float], table: PuckTable,
    window: tuple[float, float], resin: Resin, name: str, ratio: float, source: str,
) -> Compressed:  # fmt: skip
    from dummydesign.resin.puck_test.reduction import reduce_press
    from dummydesign.resin.puck_test.relaxation_fit import fit_relaxation
    from dummydesign.resin.update.relaxation import update_relaxation

    # half a hundredth of the height more, so that a hold at the very end is not cut by its own noise
    press = reduce_press(
        trace.time_s, trace.displacement_mm, trace.force_N, holds, (window[0], window[1] + 0.005 * size_mm[1])
    )
    found = fit_relaxation(press, *size_mm, table)
    young = Quantity(found.young_kPa.value, found.young_kPa.low, found.young_kPa.high, "fitted", source)
    kept = update_resin(resin, [Point(ratio, young)], name)
    told = f"holds of puck {size_mm[0]:g} x {size_mm[1]:g} mm, {trace.name}"
    measured = [
        tuple(Quantity(one.value, one.low, one.high, "fitted", told) for one in (arm.tau_s, arm.beta))
        for arm in found.arms
        if not arm.reason
    ]
    kept, updates, said = update_relaxation(kept, measured, ratio, found.seen_s)
    path = _keep(kept)
    warnings = [{"code": "not_identifiable", "message": _flag(arm.reason)} for arm in found.arms if arm.reason]
    warnings += [{"code": "relaxation_update", "message": text} for text in said]
    return Compressed(
        name, resin.name, ratio, young, found.alpha,
        _friction(found.friction.value, found.friction.low, found.friction.high), found.rmse_N, window, path,
        relaxation_dict(found, holds) | {"updates": [one.to_dict() for one in updates]}, tuple(warnings),
    )  # fmt: skip


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

"""Modulus and relaxation of a batch from one compression curve of its puck, and the resin it becomes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.files import output_folder
from dummydesign.core.library import check_name, entries, hidden_by, user_folder
from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.resin.model.resin import Arm, Interval, Point, PuckPoint, save_resin
from dummydesign.resin.model.resin_file import DEFAULT, KIND, load_resin, recording_sha256
from dummydesign.resin.update.modulus import known_puck, with_point, without_puck

if TYPE_CHECKING:
    from dummydesign.measurement.landmarks import Hold
    from dummydesign.measurement.trace import Trace
    from dummydesign.pad.tables.puck import PuckTable

Array = np.ndarray
Window = tuple[float, float]

FIRST_SHARE, LAST_SHARE = 0.03, 0.5
"""Compressions that are used, in heights: past the toe, and short of where the side lies on the plates."""

STEPS = 60
LARGEST_MISFIT = 0.1
"""Misfit over the rms force from which on a trace is doubted: three times the largest of 19 silicones between plates,
0.8 to 3.2 % (``materials/measured/ecoflex-moduli.csv``)."""


@dataclass(frozen=True)
class Compressed(Serialised):
    """What one puck's curve says; ``young_kPa`` is of this puck alone, ``relaxation`` None without a hold.

    ``law`` is the elastic law that was fitted, ``action`` is ``added``, ``unchanged`` (the resin has this puck at this
    ratio) or ``replaced`` (it had it at another ratio or size, named in ``before``).
    """

    name: str
    base: str
    ratio: float
    young_kPa: Quantity
    law: dict[str, Any]
    friction: dict[str, float]
    rmse_N: float
    compression_mm: Window
    relaxation: dict[str, Any] | None
    warnings: tuple[dict[str, str], ...]
    action: str
    before: str | None
    files: dict[str, str]


@dataclass(frozen=True)
class _Fit:
    """The fit of one press; a relaxation with what the resin learns of it in ``puck``, only where there are holds."""

    young_kPa: Interval
    alpha: float
    friction: Interval
    rmse_N: float
    puck: PuckPoint
    relaxation: dict[str, Any] | None = None
    warnings: tuple[dict[str, str], ...] = ()


def loading(displacement_mm: Array, force_N: Array) -> tuple[Array, Array]:
    """The first loading of a trace: up to its largest displacement, on rising displacements only."""
    end = int(np.argmax(displacement_mm)) + 1
    depth, index = np.unique(np.maximum.accumulate(displacement_mm[:end]), return_inverse=True)
    return depth, np.bincount(index, force_N[:end]) / np.bincount(index)


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
    """
    from dummydesign.measurement.landmarks import find_holds
    from dummydesign.measurement.trace import read_trace
    from dummydesign.pad.tables.puck import table_for

    for what, value in (("diameter_mm", diameter_mm), ("height_mm", height_mm)):
        if not (np.isfinite(value) and value > 0.0):
            raise out_of_range(what, value, "above 0", "any finite value")
    check_name("resin", name)
    known = entries(KIND).get(name.lower())
    own = known if known is not None and known.origin == "user" else None
    if own and base is not None and base.lower() != name.lower() and not replace_own:
        raise InputError(f"resin '{own.name}' exists; leave --resin out to add this puck to it, or --replace to begin "
                         "it again", "file_exists", "resin", own.name)  # fmt: skip
    if own and replace_own and base is None:
        message = f"--replace begins resin '{own.name}' again; say from which one with --resin"
        raise InputError(message, "missing", "resin")
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
            f"between {window[0]:.3g} and {window[1]:.3g} mm, or cut the file at the end of the loading",
            "out_of_range", "displacement_mm", [hold.displacement_mm for hold in seen], window,
        )  # fmt: skip
    before = known_puck(resin, puck.sha256)
    fit = _fit_holds(trace, holds, table, window, puck) if holds else _fit_loading(trace, table, window, puck)
    point = Point(ratio, Quantity(*fit.young_kPa, "fitted", source), fit.puck)
    path = user_folder() / KIND / f"{own.name if own else name}.toml"
    was = (before.ratio, before.puck.diameter_mm, before.puck.height_mm) if before and before.puck else None
    action = "added" if was is None else "unchanged" if was == (ratio, diameter_mm, height_mm) else "replaced"
    former = "ratio {:g}, {:g} x {:g} mm".format(*was) if was and action == "replaced" else None
    warnings, relaxation = (*fit.warnings, *_misfit(trace, window, fit.rmse_N)), fit.relaxation
    if action != "unchanged":
        kept, updates, notices = with_point(without_puck(resin, puck.sha256) if was else resin, point, path.stem)
        warnings += tuple({"code": "relaxation_update", "message": text} for text in notices)
        warnings += () if own else tuple(hidden_by(KIND, "resin", name))
        if relaxation is not None:
            relaxation |= {"updates": [one.to_dict() for one in updates]}
        save_resin(kept, output_folder(path.parent) / path.name)
    return Compressed(
        name, resin.name, ratio, point.young_kPa, {"name": "ogden, one term", "alpha": fit.alpha},
        fit.friction._asdict(), fit.rmse_N, window, relaxation, warnings, action, former, {"resin": str(path)},
    )  # fmt: skip


def _window(trace: Trace, height_mm: float, table: PuckTable) -> Window:
    """Compressions that are used. [mm]"""
    largest = float(np.max(trace.displacement_mm))
    share = min(LAST_SHARE, float(table.compression[-1]) - 0.02)
    first, last = FIRST_SHARE * height_mm, min(share * height_mm, largest)
    if last < 4.0 * first:
        raise InputError(
            f"{trace.name}: largest displacement_mm = {largest:.3g} is too small; compress the puck by at least "
            f"{4.0 * first:.3g} mm, better {share * height_mm:.3g} mm", "out_of_range", "displacement_mm", largest,
        )  # fmt: skip
    return first, last


def _misfit(trace: Trace, window: Window, rmse_N: float) -> tuple[dict[str, str], ...]:
    """A warning where the puck's law misses the forces as no real puck did."""
    used = (trace.displacement_mm >= window[0]) & (trace.displacement_mm <= window[1])
    share = rmse_N / max(float(np.sqrt(np.mean(trace.force_N[used] ** 2))), 1e-300) if used.any() else 0.0
    if share <= LARGEST_MISFIT:
        return ()
    message = (
        f"the law of a puck misses the forces by {100 * share:.0f} % (19 silicones: 1 to 3 %); check that "
        f"{trace.name} is of a puck between plates, its diameter, its height and the zero of its displacement"
    )
    return ({"code": "lack_of_fit", "message": message},)


def _fit_loading(trace: Trace, table: PuckTable, window: Window, puck: PuckPoint) -> _Fit:
    from dummydesign.resin.puck_test.loading_fit import LoadingCurve, fit_pucks

    first, last = window
    depth, load = loading(trace.displacement_mm, trace.force_N)
    grid = np.concatenate([[0.0], np.linspace(first, last, STEPS)])
    curve = LoadingCurve(trace.name, "puck", grid, np.interp(grid, depth, load))
    fit = fit_pucks([curve], puck.diameter_mm, puck.height_mm, table, (first * (1 - 1e-9), last))
    young = Interval(fit.young_kPa, fit.young_low_kPa, fit.young_high_kPa)
    friction = Interval(fit.friction, fit.friction_low, fit.friction_high)
    return _Fit(young, fit.alpha, friction, fit.rmse * float(np.sqrt(np.mean(curve.load_N[1:] ** 2))), puck)


def _fit_holds(trace: Trace, holds: tuple[Hold, ...], table: PuckTable, window: Window, puck: PuckPoint) -> _Fit:
    from dummydesign.resin.puck_test.loading_fit import reduce_press
    from dummydesign.resin.puck_test.relaxation_fit import fit_relaxation

    # half a hundredth of the height more, so that a hold at the very end is not cut by its own noise
    wider = window[0], window[1] + 0.005 * puck.height_mm
    press = reduce_press(trace.time_s, trace.displacement_mm, trace.force_N, holds, wider)
    fit = fit_relaxation(press, puck.diameter_mm, puck.height_mm, table)
    source = f"holds of puck {puck.diameter_mm:g} x {puck.height_mm:g} mm, {trace.name}"
    known = [arm for arm in fit.arms if not arm.reason]
    reasons = [arm.reason for arm in fit.arms if arm.reason]
    arms = tuple(Arm(*(Quantity(*one, "fitted", source) for one in (arm.tau_s, arm.beta))) for arm in known)
    relaxation = {
        "holds": holds, "seen_s": fit.seen_s,
        "prony": [{"tau_s": arm.tau_s._asdict(), "beta": arm.beta._asdict()} for arm in known],
        "not_identifiable": [{"tau_s": None, "beta": None, "reason": reason} for reason in reasons],
        "comparison": fit.comparison, "noise": fit.noise,
    }  # fmt: skip
    said = [f"an arm of the relaxation has no value: {reason}" for reason in reasons]
    warnings = tuple({"code": "not_identifiable", "message": message} for message in said)
    puck = replace(puck, seen_s=fit.seen_s, arms=arms)
    return _Fit(fit.young_kPa, fit.alpha, fit.friction, fit.rmse_N, puck, to_plain(relaxation), warnings)

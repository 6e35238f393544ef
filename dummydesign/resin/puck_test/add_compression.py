"""Modulus and relaxation of a batch from compression curves of its puck, and the resin it becomes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import to_plain
from dummydesign.core.user_library import check_name, entries, hidden_by, user_folder
from dummydesign.measurement.importing.press_checks import doubts_of
from dummydesign.measurement.ramp_detection import Hold, find_holds
from dummydesign.measurement.trace import Trace, read_trace
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.tables.puck import PuckTable, table_for
from dummydesign.resin.model.resin import Point, PuckPoint, ResinArm
from dummydesign.resin.model.resin_file import DEFAULT, KIND, load_resin, recording_sha256, save_resin
from dummydesign.resin.puck_test.contradictions import (
    check_slips,
    odd_press,
    other_height,
    pairs_of,
    size_not_weighed,
    warnings_of,
)
from dummydesign.resin.puck_test.loading_fit import LoadingCurve, PuckFit, fit_pucks, reduce_press
from dummydesign.resin.puck_test.plates import Plates, read_plates
from dummydesign.resin.puck_test.relaxation_fit import PuckRelaxation, fit_relaxation
from dummydesign.resin.update import ArmUpdate, known_puck, rebuild

FIRST_SHARE, LAST_SHARE = 0.03, 0.5
"""Compressions that are used, in heights: past the toe, and short of where the side lies on the plates."""

STEPS = 60
LARGEST_MISFIT = 0.1
"""Misfit over the rms force from which on a trace is doubted: three times the largest of 19 silicones between plates,
0.8 to 3.2 % (``materials/measured/ecoflex-moduli.csv``)."""


def loading(displacement_mm: np.ndarray, force_N: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The first loading of a trace: up to its largest displacement, on rising displacements only."""
    end = int(np.argmax(displacement_mm)) + 1
    depth, index = np.unique(np.maximum.accumulate(displacement_mm[:end]), return_inverse=True)
    return depth, np.bincount(index, force_N[:end]) / np.bincount(index)


def steps(
    displacement_mm: np.ndarray, force_N: np.ndarray, window: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """The first loading before zero and over a window: means over equal steps of displacement, for noise to fall."""
    depth, load = loading(displacement_mm, force_N)
    edges = np.linspace(window[0], min(window[1], float(depth[-1])), STEPS + 1)
    work = np.r_[0.0, np.cumsum(0.5 * (load[1:] + load[:-1]) * np.diff(depth))]
    mean = np.diff(np.interp(edges, depth, work)) / np.diff(edges)
    # medians of a rising curve are a point of it, also where contact lies before the machine's zero
    before = slice(int(np.argmax(displacement_mm > 0.0)) or 1)
    at, zero = np.median(displacement_mm[before]), np.median(force_N[before])
    return np.r_[at, 0.5 * (edges[1:] + edges[:-1])], np.r_[zero, mean]


def add_compression(
    file: str | Path | Sequence[str | Path],
    diameter_mm: float,
    height_mm: float,
    name: str,
    ratio: float,
    base: str | None = None,
    replace_own: bool = False,
    friction: str | float | None = None,
    mass_g: float | None = None,
) -> dict[str, Any]:
    """Fit a puck's compression curves and keep the resin that its modulus makes of a law.

    Curves without a hold: load = A E u(c; alpha) B(c; alpha, friction), see
    :mod:`dummydesign.resin.puck_test.loading_fit`; modulus, stiffening, plate friction and contact offsets
    together. The modulus is that of the press, slow against relaxation: press slowly, or what has not relaxed
    counts as stiffness. With one or more holds in every curve the relaxation is fitted too, see
    :mod:`dummydesign.resin.puck_test.relaxation_fit`: the modulus is then the long-term one, and the arms go into
    the resin by the rule of :mod:`dummydesign.resin.update`. Several curves of one puck are fitted together.

    ``friction`` declares the plates: ``lubricated`` (a prior), ``bonded`` or a coefficient (exact); without it any
    friction counts. Modulus and friction are medians over their intervals. A declaration that the curves contradict
    is reported. ``mass_g`` is checked against density and size.

    Recordings that the resin has are known by their numbers: the same at the same ratio, size and plates change
    nothing, else their points are replaced, as if they had not been there before. The order of pucks does not matter.

    The answer has plain values: ``young_kPa`` is of this puck alone, ``law`` the elastic law that was fitted,
    ``relaxation`` None without a hold, ``action`` is ``added``, ``unchanged`` (the resin has this puck at this ratio)
    or ``replaced`` (it had it at another ratio, size or other plates, named in ``before``).

    A modulus far from the resin's that a usual mistake explains (unit of the force, radius for diameter) is refused;
    what else contradicts is in ``contradictions`` and in the first warnings.
    """
    for what, value in (("diameter_mm", diameter_mm), ("height_mm", height_mm), ("mass_g", mass_g or 1.0)):
        if not (np.isfinite(value) and value > 0.0):
            raise out_of_range(what, value, "above 0", "any finite value")
    check_name("resin", name)
    plates = read_plates(friction)
    known = entries(KIND).get(name.lower())
    own = known if known is not None and known.origin == "user" else None
    if own and base is not None and base.lower() != name.lower() and not replace_own:
        raise InputError(
            f"resin '{own.name}' exists; leave --resin out to add this puck to it, or --replace to begin it again",
            "file_exists",
            "resin",
            own.name,
        )
    if own and replace_own and base is None:
        raise InputError(
            f"--replace begins resin '{own.name}' again; say from which one with --resin", "missing", "resin"
        )
    resin = load_resin(base or (name if known is not None else DEFAULT))
    resin.check_ratio(ratio)
    # their order does not matter
    traces = sorted(
        map(read_trace, [file] if isinstance(file, str | Path) else file),
        key=lambda trace: (trace.name, recording_sha256(trace)),
    )
    sha256 = [recording_sha256(trace) for trace in traces]
    if len(set(sha256)) < len(traces):
        raise InputError("a recording is listed twice; give each press once", "duplicate", "file")
    names = ", ".join(trace.name for trace in traces)
    window = _window(traces, height_mm, table_for(diameter_mm, height_mm))
    source = f"puck {diameter_mm:g} x {height_mm:g} mm, {names}, fitted with {plates.words}"
    puck = PuckPoint(" ".join(sorted(sha256)), names, diameter_mm, height_mm, plates=plates.name)
    held = [_holds(trace, window) for trace in traces]
    if any(held) and not all(held):
        without = ", ".join(trace.name for trace, holds in zip(traces, held) if not holds)
        raise InputError(
            f"{without}: no hold; curves with and without holds are not fitted together, leave one kind out",
            "inconsistent",
            "file",
        )

    def fitted(height_mm: float) -> PuckFit:
        table = table_for(diameter_mm, height_mm)
        window = _window(traces, height_mm, table)
        if all(held):
            return _fit_holds(traces, held, table, window, replace(puck, height_mm=height_mm), plates)
        curves = [LoadingCurve(one.name, "puck", *steps(one.displacement_mm, one.force_N, window)) for one in traces]
        return fit_pucks(curves, diameter_mm, height_mm, table, (window[0] * (1 - 1e-9), window[1]), plates)

    before = known_puck(resin, puck.sha256)
    relaxation: dict[str, Any] | None = None
    unseen: list[dict[str, str]] = []
    fit = fitted(height_mm)
    if isinstance(fit, PuckRelaxation):
        puck, (relaxation, unseen) = _with_arms(puck, fit), _of_holds(fit, held)
    # without holds the presses also differ by what had not relaxed
    rates = [0.0 if relaxation else _unrelaxed(trace, resin.prony(ratio)) for trace in traces]
    alpha, young = fit.known.alpha, Quantity(*fit.known.young_kPa, "fitted", source)
    point = Point(ratio, young, replace(puck, alpha=Quantity(*alpha, "fitted", source)))
    others = [one for one in resin.points if one.puck is None or not one.puck.has(puck.sha256)]
    pairs = pairs_of(replace(resin, points=tuple(others)), point, mass_g)
    check_slips(pairs)
    pairs += other_height(fit, height_mm, fitted)
    pairs += odd_press(
        [trace.name for trace in traces], young.value, fit.levels, fit.level_covariance + np.outer(rates, rates)
    )
    path = user_folder() / KIND / f"{own.name if own else name}.toml"
    action, former = "added", ""
    if before and before.puck:
        was, now = before.puck, (ratio, diameter_mm, height_mm, plates.name)
        same = (before.ratio, was.diameter_mm, was.height_mm, was.plates) == now
        action = "unchanged" if same and set(puck.sha256.split()) <= set(was.sha256.split()) else "replaced"
        end = f", plates {was.plates}" if was.plates else ""
        former = f"ratio {before.ratio:g}, {was.diameter_mm:g} x {was.height_mm:g} mm{end}"
    contradictions, first = warnings_of(pairs, alpha.value)
    asked = [] if mass_g else [size_not_weighed(young.value, resin.property("density_g_per_cm3", ratio).value, puck)]
    warnings = [*first, *asked, *unseen, *_doubts(fit, plates, traces, window)]
    if action != "unchanged":
        changed, became = rebuild(resin, [*others, point], path.stem)
        updates = became.get(puck.sha256, ())
        warnings += [_update_warning(one, traces, held, puck) for one in updates if one.notice]
        warnings += [] if own else hidden_by(KIND, "resin", name)
        if relaxation is not None:
            relaxation |= {"updates": [one.to_dict() for one in updates]}
        save_resin(changed)
    return to_plain(
        {
            "name": name,
            "base": resin.name,
            "ratio": ratio,
            "young_kPa": young,
            "law": {"name": "ogden, one term", "alpha": alpha.value, "alpha_low": alpha.low, "alpha_high": alpha.high},
            "plates": plates.name or None,
            "friction": fit.known.friction._asdict(),
            "rmse_N": fit.rmse_N,
            "compression_mm": window,
            "relaxation": relaxation,
            "warnings": warnings,
            "action": action,
            "before": former if action == "replaced" else None,
            "files": {"resin": str(path)},
            "contradictions": contradictions,
        }
    )


RAMP_TIMES = 10.0
"""A term is seen well by a ramp of this many of its times: a tenth of its force is left when the ramp ends."""
SAMPLES_A_TIME = 20.0
LOOKED_FOR = ("clipped", "drop_out", "spike", "not_explained")
"""Faults of a press that a puck's reading warns of as well; stages and loadings without a hold are usual there."""
SPEEDS = (1.0, 2.0, 5.0, 10.0)


def _update_warning(
    update: ArmUpdate, traces: Sequence[Trace], held: Sequence[tuple[Hold, ...]], puck: PuckPoint
) -> dict[str, str]:
    """What became of an arm; of one too fast for the presses also how to press so that it shows."""
    if update.came_from != "base" or puck.seen_s is None or update.tau_s >= puck.seen_s[0]:
        return {"code": "relaxation_update", "message": update.notice}
    advice = []
    # mean speed from contact to the first hold
    touched = [float(trace.time_s[int(np.argmax(trace.displacement_mm > 0.0))]) for trace in traces]
    fastest = max(one[0].displacement_mm / max(one[0].start_s - at, 1e-9) for one, at in zip(held, touched))
    needed = max(holds[0].displacement_mm for holds in held) / (RAMP_TIMES * update.tau_s)
    if fastest < needed:
        advice.append(f"press at {_round_up(needed):g} mm/s or faster (fastest ramp here: {fastest:.2g} mm/s)")
    step = min(float(np.median(np.diff(trace.time_s))) for trace in traces)
    if step > update.tau_s / SAMPLES_A_TIME:
        advice.append(f"sample at {_round_up(SAMPLES_A_TIME / update.tau_s):g} Hz or more (here: {1.0 / step:.0f} Hz)")
    advice = advice or ["press with less noise of the force"]
    return {"code": "relaxation_not_seen", "message": f"{update.notice}; to measure it {' and '.join(advice)}"}


def _round_up(value: float) -> float:
    """Next of 1, 2, 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(one for one in SPEEDS if one * power >= value * (1 - 1e-9)) * power)


def _holds(trace: Trace, window: tuple[float, float]) -> tuple[Hold, ...]:
    """Holds of a trace inside the compressions that are used."""
    seen = find_holds(trace.time_s, trace.displacement_mm)
    holds = tuple(hold for hold in seen if window[0] < hold.displacement_mm <= window[1])
    if seen and not holds:
        raise InputError(
            f"{trace.name}: holds at {', '.join(f'{hold.displacement_mm:.3g}' for hold in seen)} mm; one must lie "
            f"between {window[0]:.3g} and {window[1]:.3g} mm, or cut the file at the end of the loading",
            "out_of_range",
            "displacement_mm",
            [hold.displacement_mm for hold in seen],
            window,
        )
    return holds


def _window(traces: Sequence[Trace], height_mm: float, table: PuckTable) -> tuple[float, float]:
    """Compressions that are used: up to the deepest press. [mm]"""
    first, last = FIRST_SHARE * height_mm, min(LAST_SHARE, float(table.compression[-1]) - 0.02) * height_mm
    for trace in traces:
        largest = float(np.max(trace.displacement_mm))
        if largest >= height_mm:
            raise out_of_range("displacement in mm", largest, 0, height_mm, f"{trace.name}: the puck's height")
        if largest < 4.0 * first:
            raise InputError(
                f"{trace.name}: largest displacement_mm = {largest:.3g} is too small; compress the puck by at least "
                f"{4.0 * first:.3g} mm, better {last:.3g} mm",
                "out_of_range",
                "displacement_mm",
                largest,
            )
    return first, min(last, max(float(np.max(trace.displacement_mm)) for trace in traces))


def _doubts(fit: PuckFit, plates: Plates, traces: Sequence[Trace], window: tuple[float, float]) -> list[dict[str, str]]:
    """Warnings where the curves contradict what was declared of the plates, or are those of no real puck."""
    doubts = {}
    if fit.contradicts:
        doubts["plates_doubted"] = (
            f"the curves contradict plates declared {plates.name}; check the declaration, the height and the diameter, "
            "or leave --friction out: the modulus is then fitted with any friction"
        )
    used = [
        trace.force_N[(trace.displacement_mm >= window[0]) & (trace.displacement_mm <= window[1])] for trace in traces
    ]
    share = fit.rmse_N / max(float(np.sqrt(np.mean(np.concatenate(used) ** 2))), 1e-300)
    if share > LARGEST_MISFIT:
        doubts["lack_of_fit"] = (
            f"the law of a puck misses the forces by {100 * share:.0f} % (19 silicones: 1 to 3 %); check that "
            f"{', '.join(trace.name for trace in traces)} is of a puck between plates, its diameter, its height and "
            "the zero of its displacement"
        )
    looked_at = (doubt for trace in traces for doubt in doubts_of(trace) if doubt["code"] in LOOKED_FOR)
    return [*({"code": code, "message": message} for code, message in doubts.items()), *looked_at]


def _unrelaxed(trace: Trace, arms: Sequence[PronyTerm]) -> float:
    """ln of the force over the relaxed one, half-way through a steady loading, by the arms that the resin has."""
    depth = trace.displacement_mm
    half_s = 0.5 * float(trace.time_s[int(np.argmax(depth))] - trace.time_s[int(np.argmax(depth > 0.0))])
    times = np.array([arm.tau_s for arm in arms]) / half_s
    return math.log1p(float(np.array([arm.beta for arm in arms]) @ (times * -np.expm1(-1.0 / times))))


def _fit_holds(
    traces: Sequence[Trace],
    held: Sequence[tuple[Hold, ...]],
    table: PuckTable,
    window: tuple[float, float],
    puck: PuckPoint,
    plates: Plates,
) -> PuckRelaxation:
    # half a hundredth of the height more, so that a hold at the very end is not cut by its own noise
    wider = window[0], window[1] + 0.005 * puck.height_mm
    presses = [
        reduce_press(trace.time_s, trace.displacement_mm, trace.force_N, holds, wider)
        for trace, holds in zip(traces, held)
    ]
    return fit_relaxation(presses, puck.diameter_mm, puck.height_mm, table, plates)


def _with_arms(puck: PuckPoint, fit: PuckRelaxation) -> PuckPoint:
    """The puck with the arms that its holds showed, and as much of a slow one as relaxed within them."""
    source = f"holds of puck {puck.diameter_mm:g} x {puck.height_mm:g} mm, {puck.file}"
    shown = [(arm, "fitted", source) for arm in fit.arms if not arm.reason]
    slow = f"{source}; what relaxes within them, the time may be longer"
    shown += [(arm, "inferred", slow) for arm in fit.arms if arm.slow]
    arms = (ResinArm(Quantity(*arm.tau_s, *how), Quantity(*arm.beta, *how)) for arm, *how in shown)
    return replace(puck, seen_s=fit.seen_s, arms=tuple(arms))


def _of_holds(fit: PuckRelaxation, held: Sequence[tuple[Hold, ...]]) -> tuple[dict[str, Any], list[dict[str, str]]]:
    """The relaxation as the answer has it, and a warning for each arm without a value."""
    reasons = [arm.reason for arm in fit.arms if arm.reason]
    return {
        "holds": [hold for holds in held for hold in holds],
        "seen_s": fit.seen_s,
        "prony": [{"tau_s": arm.tau_s._asdict(), "beta": arm.beta._asdict()} for arm in fit.arms if not arm.reason],
        "not_identifiable": [{"tau_s": None, "beta": None, "reason": reason} for reason in reasons],
        "comparison": fit.comparison,
        "noise": fit.noise,
    }, [
        {"code": "not_identifiable", "message": f"an arm of the relaxation has no value: {reason}"}
        for reason in reasons
    ]

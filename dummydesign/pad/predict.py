"""Predict the force of one pad: at static depths, or under a motion with relaxation.

The error of the quick prediction (elastic table convolved with Prony terms) was measured against finite strain:
``python -m studies.tables.separability`` solves presses and holds at finite strain over depth, thickness
and base and stores

    rho = (F - F_quick) / (F_quick - F_elastic),

the error as a share of the viscous part of the force, for single arms over the rise time in units of the arm's time. An
arm much slower than the rise has rho near 0 (its stress is that of a jump, which is separable in a hold); one much
faster has the largest, because the second Piola stress then lags by the current deformation and not by that of the
past. The stress of the arms adds, and the field of deformation hardly depends on them.

Whole sets of arms and shaped pads were pressed too. To them is fitted, by kind of shape, what share of that sum, and of
what relaxes in the rise, the error is, and how far it scatters: :func:`departure` has both, as a part of the interval
of every dynamic prediction. A tip that is pressed flat counts as a slab of the same mean compression.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from dummydesign.core import user_library as json_table
from dummydesign.core.errors import InputError, NoAnswerError, out_of_range
from dummydesign.core.parsing import positive
from dummydesign.core.progress import reporting_depths
from dummydesign.core.serialise import Serialised
from dummydesign.core.user_library import fill_table
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.pad.force_law import Array, ForceCurve
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.pad_under_punch import SLAB, Pad, Puck

# By how much the face round a tip sinks away from the punch, in its drop: 1 is not at all, 2 Hertz's contact. With it
# the sum over single arms of the crowns that were solved needs hardly a factor of its own (1.0 to 1.1).
SINK = 1.65
# Points under the punch over which the compression is averaged, each for the same area, turned by the golden angle.
POINTS, TURN = np.sqrt((np.arange(200) + 0.5) / 200.0), 2.39996 * np.arange(200)
NAME = "quick-error.json"
COMMAND = "python -m studies.tables.separability"


@dataclass(frozen=True)
class QuickError:
    """rho of one arm at the stop on a grid of a / h, d / h and rise time over the arm's time, all increasing."""

    ratio: Array
    depth: Array
    rise: Array
    rho: Array

    def at(self, ratio: float, depth: Array, rise: float) -> Array:
        """rho at one a / h, any d / h and one rise time.

        Linear between the grid in ln(a/h), d/h and ln(rise). Held at the ends of a / h and for longer rises;
        in proportion to shorter ones; extrapolated linearly in d / h beyond its end.
        """
        width = np.clip(np.log(ratio), *np.log(self.ratio[[0, -1]]))
        time = np.clip(np.log(rise), *np.log(self.rise[[0, -1]]))
        rows = np.apply_along_axis(lambda column: np.interp(width, np.log(self.ratio), column), 0, self.rho)
        row = np.apply_along_axis(lambda column: np.interp(time, np.log(self.rise), column), 1, rows)
        beyond = np.maximum(depth - self.depth[-1], 0.0) * (row[-1] - row[-2]) / (self.depth[-1] - self.depth[-2])
        return min(rise / self.rise[0], 1.0) * (np.interp(depth, self.depth, row) + beyond)


@lru_cache(maxsize=4)
def load_quick_error(base: str = "bonded") -> QuickError:
    """Read the stored values for a base."""
    return json_table.read(NAME, "table", COMMAND, lambda data: fill_table(QuickError, data["grids"][base]))


def sums_of_arms(
    base: str, ratio: float, relative_depth: Array, time_s: Array, elastic: Array, prony: Sequence[PronyTerm]
) -> Array:
    """Sums (2, n) over arms of their viscous force times rho of a slab, and times what relaxes of it in the rise.

    [unit of force]
    """
    deepest = np.maximum.accumulate(np.maximum(relative_depth, 0.0))
    touch, stop = int(np.argmax(deepest > 0.0)), int(np.argmax(deepest >= 0.99 * deepest[-1]))
    whole, sums = time_s[stop] - time_s[max(touch - 1, 0)], np.zeros((2, len(deepest)))
    for term in prony:
        rise = max(whole / term.tau_s, 1e-9)
        viscous = relaxed_force(time_s, elastic, (term,)) - elastic
        sums += viscous * [
            load_quick_error(base).at(ratio, deepest, rise),
            np.full(len(viscous), 1.0 + np.expm1(-rise) / rise),
        ]
    return sums


def slab_depth(shape: PadShape, thickness_mm: float, ratio: float, relative_depth: Array) -> Array:
    """Relative depth of the slab that is compressed as much: over the gel, or in the mean under the punch."""
    if shape.flat_top:
        return relative_depth * thickness_mm / (thickness_mm - shape.bone_height_mm)
    reach = ratio * thickness_mm * POINTS
    drop = shape.drop_mm(reach * np.cos(TURN), reach * np.sin(TURN)) / thickness_mm
    return np.asarray(np.maximum(relative_depth[:, None] - SINK * drop, 0.0).mean(axis=-1) / (1.0 - drop.mean()))


@lru_cache(maxsize=8)
def kind_shares(kind: str) -> Array:
    """Shares (2, 2) of both sums over arms: in the error, and in its 95 % about that.

    Fitted to the pads of a kind that were solved; a kind of which none was has all shaped ones.
    """
    known = json_table.read(NAME, "table", COMMAND, lambda data: data["shares"])
    return np.array(known.get(kind, known["shaped"]))


def departure(
    base: str,
    ratio: float,
    relative_depth: Array,
    time_s: Array,
    elastic: Array,
    prony: Sequence[PronyTerm],
    shape: PadShape = SLAB,
    thickness_mm: float = 1.0,
) -> Array:
    """Ends (2, n) of the 95 % by which finite strain moves a force off the quick prediction. [unit of force]

    For a base with friction, which was not measured, those of both limits.
    """
    depth, bases = slab_depth(shape, thickness_mm, ratio, relative_depth), (base,) if base in BASES else BASES
    parts = np.stack([sums_of_arms(one, ratio, depth, time_s, elastic, prony) for one in bases])
    middle, spread = kind_shares(shape.name)
    # as wide in the hold as at the stop: the solved presses are fitted at their peaks
    half = spread @ np.maximum.accumulate(np.abs(parts), axis=-1)
    return np.stack([np.min(middle @ parts - half, axis=0), np.max(middle @ parts + half, axis=0)])


@dataclass(frozen=True, eq=False)
class StaticPrediction(Serialised):
    """Force at static depths with the model's own uncertainty; arrays of one length."""

    depth_mm: Array
    force_N: Array
    force_low_N: Array
    force_high_N: Array
    local_exponent: Array
    fidelity: str
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class MotionPrediction(Serialised):
    """Force under a motion with the model's own uncertainty; arrays of one length."""

    time_s: Array
    displacement_mm: Array
    force_N: Array
    force_low_N: Array
    force_high_N: Array
    peak_force_N: float
    peak_time_s: float
    steady_force_N: float
    fidelity: str
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()


def predict_static(
    pad: Pad | Puck,
    depth_mm: Sequence[float],
    fidelity: str = "table",
    progress: Callable[[float], None] | None = None,
) -> StaticPrediction:
    """Long-term force at static depths."""
    if fidelity == "viscoelastic":
        message = "fidelity = viscoelastic needs a motion; static depths are long-term: table or axisymmetric"
        raise InputError(message, "not_applicable", "fidelity", fidelity)
    depth = np.asarray(depth_mm, dtype=float)
    if depth.ndim != 1 or not len(depth) or not np.isfinite(depth).all():
        raise InputError(f"depth_mm = {depth_mm} must be a list of finite numbers", "malformed", "depth_mm")
    with reporting_depths(progress):
        curve = elastic_curve(pad, fidelity, float(depth.max()), depth)
    if depth.min() < 0.0:
        raise out_of_range("depth in mm", f"{depth.min():g}", 0, f"{curve.limit_mm:.4g}")
    _check_depth(depth, curve, pad)
    force, error = curve.force(depth), curve.relative_error(depth)
    step = 1e-4 * pad.thickness_mm
    # at the surface itself that of the first such step
    at = np.where(depth > 0.0, depth, 2.0 * step)
    half = np.minimum(step, 0.5 * at)
    low, high = at - half, np.minimum(at + half, curve.limit_mm)
    exponent = np.log(curve.force(high) / curve.force(low)) / np.log(high / low)
    return StaticPrediction(
        depth, force, force * (1.0 - error), force * (1.0 + error), exponent, fidelity, curve.solver, curve.notes
    )


def predict_motion(
    pad: Pad | Puck,
    motion: Motion,
    fidelity: str = "table",
    progress: Callable[[float], None] | None = None,
) -> MotionPrediction:
    """Force along a motion: elastic force of the depth, convolved with the Prony terms.

    F(t) = integral of (1 + sum beta_i exp(-(t - s) / tau_i)) dF_inf(d(s)); the pad does not pull, so the
    force is never below zero. The motion is piecewise linear; long steps are divided so that the elastic
    force is followed within them.

    A finite-strain pad is not separable: how far its force may lie from this one was measured (see
    ``separability``) and widens ``force_low_N`` and ``force_high_N``. With fidelity ``viscoelastic`` the
    motion is solved at finite strain, and the force is multiplied by the ratio found (``finite_strain_ratio``).
    """
    deepest = float(np.max(motion.displacement_mm))
    if deepest <= 0.0:
        message = f"largest displacement_mm = {deepest:.4g} never reaches the pad; compression is positive"
        raise InputError(message, "out_of_range", "displacement_mm", deepest)
    with reporting_depths(progress):
        return motion_on_curve(pad, motion, elastic_curve(pad, fidelity, deepest), fidelity)


def motion_on_curve(pad: Pad | Puck, motion: Motion, curve: ForceCurve, fidelity: str = "table") -> MotionPrediction:
    """Force along a motion as :func:`predict_motion` gives it, by a long-term force that is there already."""
    _check_depth(motion.displacement_mm, curve, pad)
    time, depth, keep = _divide(motion, 0.005 * pad.thickness_mm)
    elastic = curve.force(depth)
    force = np.maximum(relaxed_force(time, elastic, pad.prony), 0.0)[keep]
    deepest_yet = np.maximum.accumulate(np.maximum(motion.displacement_mm, 0.0))
    error = force * curve.relative_error(deepest_yet)
    solver, viscous = curve.solver, np.abs(force - np.maximum(elastic[keep], 0.0))
    if fidelity == "viscoelastic" and isinstance(pad, Pad):
        from dummydesign.pad.axisymmetric.case import Case
        from dummydesign.pad.axisymmetric.finite_strain import nodes_of_motion, ratio_error, solve_ratio

        nodes = nodes_of_motion(motion.time_s, motion.displacement_mm / pad.thickness_mm, pad.prony)
        path = solve_ratio(Case.of(pad), pad.prony, *nodes)
        cost = path.solver
        force = force * np.interp(motion.time_s, path.time_s, path.ratio)
        above = ratio_error(cost["rim_over_scale"]) * viscous
        below = -above
        solver = cost | {name: solver[name] + cost[name] for name in ("load_steps", "newton_iterations", "seconds")}
    else:
        # Not measured for a puck: that of a glued slab.
        base = "bonded" if isinstance(pad, Puck) else pad.base
        shape = SLAB if isinstance(pad, Puck) else pad.geometry
        args = (
            pad.radius_mm / pad.thickness_mm,
            depth / pad.thickness_mm,
            time,
            elastic,
            pad.prony,
            shape,
            pad.thickness_mm,
        )
        below, above = departure(base, *args)[:, keep]
    peak = int(np.argmax(force))
    return MotionPrediction(
        motion.time_s,
        motion.displacement_mm,
        force,
        np.maximum(force - error + np.minimum(below, 0.0), 0.0),
        force + error + np.maximum(above, 0.0),
        float(force[peak]),
        float(motion.time_s[peak]),
        float(force[-1]),
        fidelity,
        solver,
        curve.notes,
    )


def depth_for_steady_force(
    pad: Pad | Puck,
    force_N: float,
    hold_s: float,
    motion_to: Callable[[float], Motion],
    fidelity: str = "table",
    curve: ForceCurve | None = None,
) -> float:
    """Depth at which the force at the end of a ramp and hold is the wanted one. [mm]"""
    positive("force in N", force_N)
    positive("hold in s", hold_s)
    curve = curve or elastic_curve(pad, fidelity)

    def steady(depth: float) -> float:
        motion = motion_to(depth)
        time, travel, keep = _divide(motion, 0.01 * pad.thickness_mm)
        return float(relaxed_force(time, curve.force(travel), pad.prony)[keep][-1])

    low, high = 1e-3 * pad.thickness_mm, curve.limit_mm
    most = steady(high)
    if most < force_N:
        raise NoAnswerError(
            "out_of_reach",
            f"steady force = {force_N:g} N is out of reach: the pad of {pad.thickness_mm:g} mm carries {most:.3g} N "
            f"at its depth limit {high:.3g} mm; take a stiffer resin or a thinner pad",
            quantity="force_N",
        )
    if steady(low) > force_N:
        raise InputError(
            f"force in N = {force_N:g} is below {steady(low):.3g}, the force at 0.1 % of the thickness: press harder, "
            f"or check the modulus, {1e3 * pad.young_MPa:g} kPa",
            "out_of_range",
            "force_N",
            force_N,
        )
    from scipy.optimize import brentq

    return float(brentq(lambda depth: steady(depth) - force_N, low, high, xtol=1e-9))


def _check_depth(depth: Array, curve: ForceCurve, pad: Pad | Puck) -> None:
    worst, limit = float(np.max(depth)), curve.limit_mm
    if worst <= limit * (1.0 + 1e-9):
        return
    # A solve may have ended early, with a note; a law holds to that depth.
    stopped = bool(curve.notes) and curve.solver["unknowns"] > 0
    reason = "; ".join(curve.notes) if stopped else "beyond it the pad model is not validated"
    message = (
        f"depth in mm = {worst:.4g} is outside the allowed range 0 to {limit:.4g} "
        f"(d/h = {limit / pad.thickness_mm:.3g} for a pad of {pad.thickness_mm:g} mm); {reason}"
    )
    if stopped and worst <= MAX_DEPTH_OVER_THICKNESS * pad.thickness_mm * (1.0 + 1e-9):
        raise NoAnswerError("no_convergence", message, quantity="depth_mm")
    raise InputError(message, "out_of_range", "depth_mm", worst, (0.0, limit))


def _divide(motion: Motion, largest_mm: float) -> tuple[Array, Array, Array]:
    """Cut the steps of a motion to at most ``largest_mm``; return times, places and where the given ones are."""
    time, depth = motion.time_s, motion.displacement_mm
    parts = np.maximum(1, np.ceil(np.abs(np.diff(depth)) / largest_mm)).astype(int)
    at = np.concatenate([[0], np.cumsum(parts)])
    fine = np.arange(at[-1] + 1)
    return np.interp(fine, at, time), np.interp(fine, at, depth), at


@dataclass(frozen=True, eq=False)
class RampPress:
    """One ramp and hold."""

    steady_force_N: float
    velocity_mm_s: float
    depth_mm: float | None
    prediction: MotionPrediction | None
    out_of_reach: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return force, speed, depth and, where the force is in reach, the curves and their peak as plain values."""
        asked = {"steady_force_N": self.steady_force_N, "velocity_mm_s": self.velocity_mm_s, "depth_mm": self.depth_mm}
        if self.prediction is None:
            return {**asked, "peak_force_N": None, "out_of_reach": self.out_of_reach}
        values = self.prediction.to_dict()
        curves = ("peak_force_N", "peak_time_s", "time_s", "displacement_mm", "force_N", "force_low_N", "force_high_N")
        return {**asked, **{name: values[name] for name in curves}}


# A solve goes this much deeper than the depth at which the table has a force.
BEYOND_TABLE = 1.1


def curve_to(pad: Pad | Puck, fidelity: str, enough: Callable[[Array, Array], Array]) -> ForceCurve:
    """The long-term force of a pad, solved as deep as is needed: where a table knows how deep that is.

    ``enough`` says of depths from 0 on, shape (n,), and the forces there whether the press ends before each.
    """
    if fidelity == "table":
        return elastic_curve(pad, fidelity)
    try:
        table = elastic_curve(pad, "table")
    except InputError:
        return elastic_curve(pad, fidelity)
    depth = np.linspace(0.0, table.limit_mm, 200)
    reached = np.flatnonzero(enough(depth, table.force(depth)))
    if not len(reached) or BEYOND_TABLE * depth[reached[0]] >= MAX_DEPTH_OVER_THICKNESS * pad.thickness_mm:
        return elastic_curve(pad, fidelity)
    curve = elastic_curve(pad, fidelity, float(BEYOND_TABLE * depth[reached[0]]))
    depth = np.linspace(0.0, curve.limit_mm, 200)
    return curve if enough(depth, curve.force(depth))[-1] else elastic_curve(pad, fidelity)


def press_to_forces(
    pad: Pad | Puck,
    force_N: Sequence[float],
    velocity_mm_s: Sequence[float],
    hold_s: float,
    deceleration_mm_s2: float,
    fidelity: str = "table",
    progress: Callable[[float], None] | None = None,
) -> tuple[RampPress, ...]:
    """Press a pad to every force at every speed."""
    presses: list[RampPress] = []
    out_of_reach: NoAnswerError | None = None
    with reporting_depths(progress):
        curve = curve_to(pad, fidelity, lambda depth, force: force >= max(force_N))
    for velocity in velocity_mm_s:

        def motion_to(depth: float, velocity: float = velocity) -> Motion:
            return ramp_and_hold(velocity, depth, hold_s, deceleration_mm_s2)

        for force in force_N:
            try:
                depth = depth_for_steady_force(pad, force, hold_s, motion_to, fidelity, curve)
            except NoAnswerError as problem:
                if problem.code != "out_of_reach":
                    raise
                out_of_reach = out_of_reach or problem
                presses.append(RampPress(force, velocity, None, None, str(problem)))
                continue
            prediction = motion_on_curve(pad, motion_to(depth), curve, fidelity)
            presses.append(RampPress(force, velocity, depth, prediction))
    if out_of_reach is not None and all(press.prediction is None for press in presses):
        raise out_of_reach
    return tuple(presses)

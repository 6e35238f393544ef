"""Predict the force of one pad: at static depths, or under a motion with relaxation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.errors import InputError, NoAnswerError, unknown_name
from dummydesign.pad.checks import positive
from dummydesign.pad.laws import Law, Yeoh
from dummydesign.pad.quick_error import allowance
from dummydesign.pad.relaxation import PronyTerm, relaxed_force
from dummydesign.protocol.motion import Motion

if TYPE_CHECKING:
    from dummydesign.pad.axisymmetric import PadCurve

Array = np.ndarray
FIDELITIES = ("table", "axisymmetric", "viscoelastic", "3d")
# Depths at which a finite-element curve is solved before it is followed along a motion.
CURVE_POINTS = 16


@dataclass(frozen=True)
class Pad:
    """A slab, its material and the round punch of equal area on it.

    ``young_MPa`` is the long-term modulus; ``prony`` is relative to it. ``law`` is the shape of the
    hyperelastic law (its moduli are scaled), neo-Hookean without it. ``sides_mm`` are the sides of a
    rectangular punch, ``radius_mm`` is then that of the circle of its area.
    ``slab_mm`` are length and width of the slab. ``profile_mm`` holds the radii and heights of a shaped punch.
    ``cylinder`` is a puck of ``radius_mm`` between plates instead of a slab.
    """

    thickness_mm: float
    young_MPa: float
    radius_mm: float
    prony: tuple[PronyTerm, ...] = ()
    base: str = "bonded"
    condition: str = "bonded"
    poisson: float = 0.5
    extent_mm: float | None = None
    law: Law | None = None
    sides_mm: tuple[float, float] | None = None
    slab_mm: tuple[float, float] = (150.0, 120.0)
    profile_mm: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    cylinder: bool = False

    @property
    def shape(self) -> Law:
        """The hyperelastic law with unit shear modulus."""
        if self.law is None:
            return Yeoh(1.0)
        return self.law.scaled(1.0 / self.law.shear_MPa)

    def __post_init__(self) -> None:
        for name in ("thickness_mm", "young_MPa", "radius_mm"):
            positive(name, getattr(self, name))


class _Prediction:
    """What both kinds of prediction have in common."""

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values."""
        return {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in self.__dict__.items()}


@dataclass(frozen=True)
class StaticPrediction(_Prediction):
    """Force at static depths with the model's own uncertainty; arrays of one length."""

    depth_mm: Array
    force_N: Array
    force_low_N: Array
    force_high_N: Array
    local_exponent: Array
    fidelity: str
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class MotionPrediction(_Prediction):
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


@dataclass(frozen=True)
class ElasticCurve:
    """Long-term elastic force as a function of depth, and its relative error."""

    force: Callable[[Array], Array]
    relative_error: Callable[[Array], Array]
    limit_mm: float
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()


def predict_static(
    pad: Pad, depth_mm: Sequence[float], fidelity: str = "table", progress: Callable[[float], None] | None = None
) -> StaticPrediction:
    """Long-term force at static depths.

    Parameters
    ----------
    pad : Pad
    depth_mm : sequence of float
        Depths >= 0 within the validity of the model. [mm]
    fidelity : str
        ``table`` (bonded or sliding base, glued punch, neo-Hookean) or ``axisymmetric`` (solved now).

    Raises
    ------
    InputError
        For a depth outside the validity, or a case the table does not hold.
    NoAnswerError
        When the finite elements do not reach a wanted depth.
    """
    if fidelity == "viscoelastic":
        raise InputError("fidelity = viscoelastic needs a motion; static depths are long-term: table or axisymmetric")
    depth = np.asarray(depth_mm, dtype=float)
    if depth.ndim != 1 or not len(depth) or not np.isfinite(depth).all():
        raise InputError(f"depth_mm = {depth_mm} must be a list of finite numbers")
    curve = elastic_curve(pad, fidelity, float(depth.max()), depth, progress)
    _check_depth(depth, curve, pad)
    force, error = curve.force(depth), curve.relative_error(depth)
    step = 1e-4 * pad.thickness_mm
    low, high = np.maximum(depth - step, step), np.minimum(np.maximum(depth, 2.0 * step) + step, curve.limit_mm)
    exponent = np.log(curve.force(high) / curve.force(low)) / np.log(high / low)
    return StaticPrediction(
        depth, force, force * (1.0 - error), force * (1.0 + error), exponent, fidelity, curve.solver, curve.notes
    )


def predict_motion(
    pad: Pad, motion: Motion, fidelity: str = "table", progress: Callable[[float], None] | None = None
) -> MotionPrediction:
    """Force along a motion: elastic force of the depth, convolved with the Prony terms.

    F(t) = integral of (1 + sum beta_i exp(-(t - s) / tau_i)) dF_inf(d(s)); the pad does not pull, so the
    force is never below zero. The motion is piecewise linear; long steps are divided so that the elastic
    force is followed within them.

    A finite-strain pad is not separable: how far its force may lie from this one was measured (see
    ``quick_error``) and widens ``force_low_N`` and ``force_high_N``. With fidelity ``viscoelastic`` the
    motion is solved at finite strain, and the force is multiplied by the ratio found (``viscoelastic_ratio``).

    Raises
    ------
    InputError, NoAnswerError
        As :func:`predict_static`.
    """
    deepest = float(np.max(motion.displacement_mm))
    if deepest <= 0.0:
        raise InputError(f"largest displacement_mm = {deepest:.4g} never reaches the pad; compression is positive")
    curve = elastic_curve(pad, fidelity, deepest, None, progress)
    _check_depth(motion.displacement_mm, curve, pad)
    time, place, keep = _divide(motion, 0.005 * pad.thickness_mm)
    elastic = curve.force(place)
    force = np.maximum(relaxed_force(time, elastic, pad.prony), 0.0)[keep]
    deepest_yet = np.maximum.accumulate(np.maximum(motion.displacement_mm, 0.0))
    error = force * curve.relative_error(deepest_yet)
    solver, viscous = curve.solver, np.abs(force - np.maximum(elastic[keep], 0.0))
    if fidelity == "viscoelastic":
        from dummydesign.pad.viscoelastic_ratio import ratio_error

        ratio, cost = _finite_strain_ratio(pad, motion, progress)
        force, below = force * ratio, ratio_error(cost["rim_over_scale"]) * viscous
        above = below
        solver = cost | {name: solver[name] + cost[name] for name in ("load_steps", "newton_iterations", "seconds")}
    else:
        ratio = pad.radius_mm / pad.thickness_mm
        below, above = allowance(pad.base, ratio, place / pad.thickness_mm, time, elastic, pad.prony)
        below, above = below[keep], above[keep]
    peak = int(np.argmax(force))
    return MotionPrediction(
        motion.time_s, motion.displacement_mm, force, np.maximum(force - error - below, 0.0), force + error + above,
        float(force[peak]), float(motion.time_s[peak]), float(force[-1]), fidelity, solver, curve.notes,
    )  # fmt: skip


def _finite_strain_ratio(
    pad: Pad, motion: Motion, progress: Callable[[float], None] | None
) -> tuple[Array, dict[str, Any]]:
    """Finite-strain force over separable force at the motion's times, and what it cost."""
    from dummydesign.pad.axisymmetric import STANDARD_EXTENT_MM, Slab
    from dummydesign.pad.viscoelastic_ratio import nodes_of_motion, solve_ratio

    extent = STANDARD_EXTENT_MM if pad.extent_mm is None else pad.extent_mm
    slab = Slab(pad.radius_mm / pad.thickness_mm, extent / pad.thickness_mm, pad.base, pad.condition)
    nodes = nodes_of_motion(motion.time_s, motion.displacement_mm / pad.thickness_mm, pad.prony)
    path = solve_ratio(slab, pad.shape, pad.prony, *nodes, poisson=pad.poisson, progress=progress)
    return np.interp(motion.time_s, path.time_s, path.ratio), path.solver


def depth_for_steady_force(
    pad: Pad, force_N: float, hold_s: float, motion_to: Callable[[float], Motion], fidelity: str = "table"
) -> float:
    """Depth at which the force at the end of a ramp and hold is the wanted one. [mm]

    Parameters
    ----------
    motion_to : callable
        Gives the motion to a depth, with a hold of ``hold_s``.

    Raises
    ------
    NoAnswerError
        When the force is out of reach within the depth limit; the message says what is reached.
    """
    positive("force_N", force_N)
    positive("hold_s", hold_s)
    curve = elastic_curve(pad, fidelity, None, None, None)

    def steady(depth: float) -> float:
        motion = motion_to(depth)
        time, place, keep = _divide(motion, 0.01 * pad.thickness_mm)
        return float(relaxed_force(time, curve.force(place), pad.prony)[keep][-1])

    low, high = 1e-3 * pad.thickness_mm, curve.limit_mm
    most = steady(high)
    if most < force_N:
        raise NoAnswerError(
            "out_of_reach",
            f"steady force = {force_N:g} N is out of reach: the pad of {pad.thickness_mm:g} mm carries {most:.3g} N "
            f"at its depth limit {high:.3g} mm; take a stiffer resin or a thinner pad",
        )
    if steady(low) > force_N:
        raise InputError(f"force_N = {force_N:g} is below {steady(low):.3g} N, the force at 0.1 % of the thickness")
    from scipy.optimize import brentq

    return float(brentq(lambda depth: steady(depth) - force_N, low, high, xtol=1e-9))


def elastic_curve(
    pad: Pad,
    fidelity: str,
    deepest_mm: float | None,
    depths_mm: Array | None,
    progress: Callable[[float], None] | None,
) -> ElasticCurve:
    """Long-term force as a function of depth, by the table or solved by finite elements.

    ``deepest_mm`` None asks for the whole valid range; ``depths_mm`` are met exactly by a solve.
    """
    if fidelity not in FIDELITIES:
        raise unknown_name("fidelity", fidelity, FIDELITIES)
    if fidelity == "3d":
        return _in_space(pad, deepest_mm, depths_mm, progress)
    if fidelity == "table" or (fidelity == "viscoelastic" and _in_table(pad)):
        curve = _by_table(pad)
    else:
        curve = _by_elements(pad, deepest_mm, depths_mm, progress)
    if not has_square_factor(pad):
        return curve
    from dummydesign.pad.square import square_factor

    return _times(curve, lambda depth: square_factor(depth, pad.thickness_mm, pad.radius_mm, pad.base))


def has_square_factor(pad: Pad) -> bool:
    """Whether the punch is a square whose factor over the circle of its area is tabulated."""
    return pad.sides_mm is not None and pad.sides_mm[0] == pad.sides_mm[1] and _tabulated(pad)


def _tabulated(pad: Pad) -> bool:
    """Whether base, law and a / h are within the tables."""
    from dummydesign.pad.table import BASES, load_table

    if pad.base not in BASES or not _in_table(pad):
        return False
    low, high = load_table(pad.base).ratio_range
    return low <= pad.radius_mm / pad.thickness_mm <= high


def _times(curve: ElasticCurve, factor: Callable[[Array], tuple[Array, Array]]) -> ElasticCurve:
    """Multiply a curve by a factor that gives its own relative error; the errors add up."""
    return replace(
        curve,
        force=lambda depth: curve.force(depth) * factor(depth)[0],
        relative_error=lambda depth: curve.relative_error(depth) + factor(depth)[1],
    )


def _in_space(
    pad: Pad, deepest_mm: float | None, depths_mm: Array | None, progress: Callable[[float], None] | None
) -> ElasticCurve:
    """The axisymmetric curve of the circle of equal area, times the ratio solved in space on twin cells."""
    from dummydesign.pad.spatial import Block
    from dummydesign.pad.spatial_curve import solve_factor

    if pad.sides_mm is None:
        raise InputError("fidelity = 3d is for square and rectangular punches; a round one is solved by axisymmetric")
    h = pad.thickness_mm
    sides, slab = (tuple(0.5 * side / h for side in pair) for pair in (pad.sides_mm, pad.slab_mm))
    block = Block(sides, slab, pad.base, pad.condition)
    curve = _by_elements(pad, deepest_mm, depths_mm, progress)
    if curve.notes and _tabulated(pad):
        # The table averages over many neighbouring solves and reaches where a single one may stop.
        note = f"the round twin's curve is the response table's: the solve was not complete ({curve.notes[0]})"
        curve = replace(_by_table(pad), solver=curve.solver, notes=(note,))
    deepest = min(deepest_mm or curve.limit_mm, curve.limit_mm) / h
    solved = solve_factor(block, pad.shape, pad.poisson, deepest, progress)
    solver = {name: curve.solver[name] + solved.solver[name] for name in solved.solver}
    solver["unknowns"] = solved.solver["unknowns"]
    return replace(_times(curve, lambda depth: solved.factor(depth / h)), solver=solver)


def _in_table(pad: Pad) -> bool:
    plain = pad.profile_mm is None and not pad.cylinder
    return plain and pad.condition == "bonded" and pad.poisson == 0.5 and pad.shape == Yeoh(1.0)


def _by_table(pad: Pad) -> ElasticCurve:
    from dummydesign.pad.table import load_table

    law = "neo-hookean" if pad.shape == Yeoh(1.0) else type(pad.shape).__name__.lower()
    for name, value, held in (
        ("punch", "profile" if pad.profile_mm else "plate" if pad.cylinder else "flat", "flat"),
        ("punch condition", pad.condition, "bonded"),
        ("poisson", pad.poisson, 0.5),
        ("law", law, "neo-hookean"),
    ):
        if value != held:
            raise InputError(f"{name} = {value} is not in the table (only {held}); add --fidelity axisymmetric")
    table = load_table(pad.base)
    args = (pad.thickness_mm, pad.radius_mm)
    limit = float(table.depth_limit_mm(*args))
    nothing = {"unknowns": 0, "load_steps": 0, "newton_iterations": 0, "seconds": 0.0}
    return ElasticCurve(
        lambda depth: table.force(depth, pad.thickness_mm, pad.young_MPa, pad.radius_mm),
        lambda depth: table.relative_error(np.clip(depth, 0.0, limit), *args),
        limit,
        nothing,
    )


def _by_elements(
    pad: Pad, deepest_mm: float | None, depths_mm: Array | None, progress: Callable[[float], None] | None
) -> ElasticCurve:
    from scipy.interpolate import PchipInterpolator

    from dummydesign.pad.axisymmetric import MAX_DEPTH_OVER_THICKNESS

    limit = MAX_DEPTH_OVER_THICKNESS * pad.thickness_mm
    deepest = limit if deepest_mm is None else min(max(deepest_mm, 0.02 * pad.thickness_mm), limit)
    grid = np.linspace(0.0, deepest, CURVE_POINTS + 1)[1:]
    if depths_mm is not None:
        grid = np.union1d(grid[::2], depths_mm[(depths_mm > 0.0) & (depths_mm <= limit)])
    if pad.condition != "bonded" and not pad.cylinder:
        # A face that slides needs some depth to start from.
        grid = grid[grid >= min(0.025 * pad.thickness_mm, 0.25 * deepest)]
    solved = _solve(pad, grid, progress)
    depth, force = solved.depth_mm, solved.force_N
    if len(depth) < 2:
        raise NoAnswerError("no_convergence", f"the pad could be solved at {len(depth)} depth only: {solved.notes[0]}")
    # F / d varies little; what lies between solved depths is a monotone cubic through it.
    stiffness = PchipInterpolator(depth, np.log(force / depth), extrapolate=True)
    error = solved.error_N / force

    def value(at: Array) -> Array:
        at = np.asarray(at, dtype=float)
        inside = np.clip(at, 0.0, depth[-1])
        return np.where(at > 0.0, inside * np.exp(stiffness(inside)), 0.0)

    return ElasticCurve(
        value, lambda at: np.interp(at, depth, error), float(depth[-1]), solved.solver, solved.notes
    )


def _solve(pad: Pad, grid: Array, progress: Callable[[float], None] | None) -> PadCurve:
    """Solve the static curve by the elements that fit the punch and its contact."""
    from dummydesign.pad.axisymmetric import STANDARD_EXTENT_MM, solve_curve
    from dummydesign.pad.indent import profile, solve_flat, solve_shaped
    from dummydesign.pad.puck import solve_puck

    common: dict[str, Any] = {"poisson": pad.poisson, "law": pad.shape}
    if pad.cylinder:
        sizes = (2.0 * pad.radius_mm, pad.thickness_mm)
        return solve_puck(*sizes, pad.young_MPa, grid, plates=pad.condition, progress=progress, **common)
    extent = pad.extent_mm or STANDARD_EXTENT_MM
    if pad.profile_mm is not None:
        punch = profile(*pad.profile_mm)
        return solve_shaped(
            punch, pad.thickness_mm, pad.young_MPa, grid, pad.radius_mm, pad.condition, base=pad.base,
            extent_mm=extent, **common,
        )  # fmt: skip
    solve = solve_curve if pad.condition == "bonded" else solve_flat
    return solve(
        pad.thickness_mm, pad.radius_mm, pad.young_MPa, grid, condition=pad.condition, base=pad.base,
        extent_mm=extent, progress=progress, **common,
    )  # fmt: skip


def _check_depth(depth: Array, curve: ElasticCurve, pad: Pad) -> None:
    worst, limit = float(np.max(depth)), curve.limit_mm
    if worst <= limit * (1.0 + 1e-9):
        return
    reason = "; ".join(curve.notes) or "beyond it the pad model is not validated"
    message = (
        f"depth_mm = {worst:.4g} is outside the allowed range 0 to {limit:.4g} "
        f"(d/h = {limit / pad.thickness_mm:.3g} for a pad of {pad.thickness_mm:g} mm); {reason}"
    )
    if curve.notes and worst <= 0.6 * pad.thickness_mm * (1.0 + 1e-9):
        raise NoAnswerError("no_convergence", message)
    raise InputError(message)


def _divide(motion: Motion, largest_mm: float) -> tuple[Array, Array, Array]:
    """Cut the steps of a motion to at most ``largest_mm``; return times, places and where the given ones are."""
    time, place = motion.time_s, motion.displacement_mm
    parts = np.maximum(1, np.ceil(np.abs(np.diff(place)) / largest_mm)).astype(int)
    at = np.concatenate([[0], np.cumsum(parts)])
    fine = np.arange(at[-1] + 1)
    return np.interp(fine, at, time), np.interp(fine, at, place), at

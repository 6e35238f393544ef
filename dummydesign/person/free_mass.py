"""A free mass that one body alone stops: people, or the pad."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.interpolation import monotone_cubic
from dummydesign.core.progress import reporting_depths
from dummydesign.core.serialise import Serialised
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.measurement.motion import Motion
from dummydesign.pad.force_law import ForceCurve
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.predict import MotionPrediction, curve_to, motion_on_curve
from dummydesign.person.integrate import TOLERANCE, PersonResponse, PressedBody, run_robot
from dummydesign.person.smoothing import RobotArm

LONGEST_S, AFTER_STOP = 60.0, 1.0
CURVE_STEPS = 400
POINTS = 600
"""Depths at which the force of a pad is kept, closer towards the surface."""
APPROACH, APPROACH_STEPS = 0.3, 60
"""Free flight before contact, over the time to the stop, and its samples."""
ROUNDS, SAME = 4, 1e-3
"""How often a path is followed again with the finite-strain force on it, and the change of the depth that ends it."""


def stop_mass(
    body: PressedBody, mass_kg: float, velocity_mm_s: NDArray, keep: bool = True, tolerance: float = TOLERANCE
) -> PersonResponse:
    """Stop a free mass, M x'' = -F from the speed at contact on; with curves, as long again for the rebound.

    References
    ----------
    ISO/TS 15066:2016, annex A (effective mass of the robot); here the body does not give way.
    """
    scale = body.depth_taking(float(0.5e-3 * mass_kg * np.max(velocity_mm_s) ** 2))
    longest = 4.0 * float(np.max(scale / velocity_mm_s)) / CURVE_STEPS
    arm, given = RobotArm(0.0, mass_kg), (velocity_mm_s, scale, lambda time: longest)
    run = run_robot(body, arm, _nothing, LONGEST_S, *given, until_stop=True, keep=False, tolerance=tolerance)
    if not keep:
        return run
    curve = run_robot(body, arm, _nothing, (1.0 + AFTER_STOP) * float(np.max(run.stop_s)), *given, tolerance=tolerance)
    names = ("time_s", "depth_curve_mm", "force_curve_N")
    return replace(run, **{name: getattr(curve, name) for name in names})


def _nothing(time: float) -> tuple[float, float]:
    return 0.0, 0.0


class PadBody:
    """A pad as a body of :func:`stop_mass`: its long-term force with Prony arms, F = A(x) + sum beta q.

    q' = A'(x) x' - q / tau. Beyond the depth of the curve the force goes on from its tangent, ever steeper, so that a
    mass that is not stopped within it is seen soon. ``over`` is the factor of finite strain on the force, over depth.
    """

    def __init__(
        self, curve: ForceCurve, prony: tuple[PronyTerm, ...], over: Callable[[NDArray], NDArray] = np.ones_like
    ) -> None:
        depth = curve.limit_mm * np.linspace(0.0, 1.0, POINTS) ** 2
        force = np.r_[0.0, curve.force(depth[1:])]
        self.depth_mm, self.force_N, self._over = depth, force, over
        self._force = monotone_cubic(depth, force)
        self._stiffness_N_per_mm = float((force[-1] - force[-2]) / (depth[-1] - depth[-2]))
        self._tau = np.array([term.tau_s for term in prony])
        self._beta = np.array([term.beta for term in prony])

    def __len__(self) -> int:
        return 1

    def at_rest(self) -> NDArray:
        """Forces of the arms before contact, shape (1, arms). [N]"""
        return np.zeros((1, len(self._tau)))

    def elastic(self, depth: NDArray) -> NDArray:
        """Long-term force at depths. [N]"""
        limit = self.depth_mm[-1]
        beyond = np.maximum(depth - limit, 0.0)
        wall = self._stiffness_N_per_mm * beyond * (1.0 + (beyond / limit) ** 6)
        return self._force(np.clip(depth, 0.0, limit)) + wall

    def slope(self, depth: NDArray) -> NDArray:
        """Its tangent stiffness. [N/mm]"""
        step = 1e-5 * self.depth_mm[-1]
        return (self.elastic(depth + step) - self.elastic(depth - step)) / (2.0 * step)

    def carried(self, depth: NDArray, stretch: NDArray, new: NDArray, step: float) -> tuple[NDArray, NDArray]:
        """Forces of the arms after a step of even elastic rate, and their slopes over the new depth, both (1, arms)."""
        ratio = step / self._tau
        share = -np.expm1(-ratio) / ratio
        rise = self.elastic(new) - self.elastic(depth)
        return stretch * np.exp(-ratio) + share * rise[:, None], share * self.slope(new)[:, None]

    def force_of(self, depth: NDArray, stretch: NDArray) -> NDArray:
        """Force at depths (1,), not below 0. [N]"""
        return np.maximum(self.elastic(depth) + stretch @ self._beta, 0.0) * self._over(depth)

    def slope_of(self, depth: NDArray, stretch: NDArray, gain: NDArray) -> NDArray:
        """Slope of the force over depth within a step, shape (1,). [N/mm]"""
        return (self.slope(depth) + gain @ self._beta) * self._over(depth)

    def depth_taking(self, energy_mJ: float) -> NDArray:
        """Depth at which an energy is taken at rest, at most that of the curve, shape (1,). [mm]"""
        return np.atleast_1d(np.interp(energy_mJ, work_over(self.depth_mm, self.force_N), self.depth_mm))


def work_over(depth_mm: NDArray, force_N: NDArray) -> NDArray:
    """Integral of F dx from the first sample to each, by trapezoids, shape (n,). [mJ]"""
    return np.r_[0.0, np.cumsum(0.5 * (force_N[1:] + force_N[:-1]) * np.diff(depth_mm))]


@dataclass(frozen=True, eq=False)
class MassPress(Serialised):
    """A free mass on a pad: the press from a short free flight to the rebound, and its numbers."""

    prediction: MotionPrediction
    depth_mm: float
    depth_at_peak_mm: float
    stop_s: float
    energy_mJ: float

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers beside the curves."""
        names = ("depth_mm", "depth_at_peak_mm", "stop_s", "energy_mJ")
        return {name: getattr(self, name) for name in names}


def mass_on_pad(
    pad: Pad | Puck,
    mass_kg: float,
    velocity_mm_s: float,
    fidelity: str = "table",
    progress: Callable[[float], None] | None = None,
) -> MassPress:
    """Stop a free mass by a pad alone.

    Raises
    ------
    NoAnswerError
        When the pad bottoms out: the mass goes deeper than its force is known.
    """
    energy = 0.5e-3 * mass_kg * velocity_mm_s**2
    with reporting_depths(progress):
        curve = curve_to(pad, fidelity, lambda depth, force: work_over(depth, force) >= energy)
    body, before = PadBody(curve, pad.prony), np.inf
    for _ in range(ROUNDS):
        run = stop_mass(body, mass_kg, np.array([velocity_mm_s]))
        deepest, stop = float(run.depth_mm[0]), float(np.squeeze(run.stop_s))
        if deepest > curve.limit_mm:
            raise _bottoms_out(pad, curve, run, mass_kg, velocity_mm_s, energy)
        time, path = run.time_s, run.depth_curve_mm[0]
        flight = -APPROACH * stop * np.linspace(1.0, 0.0, APPROACH_STEPS, endpoint=False)
        motion = Motion(np.r_[flight, time], np.r_[velocity_mm_s * flight, path])
        prediction = motion_on_curve(pad, motion, curve, fidelity)
        if fidelity != "viscoelastic" or abs(deepest - before) <= SAME * deepest:
            break
        before = deepest
        body = PadBody(curve, pad.prony, _finite_strain_factor(pad, motion, curve, prediction.force_N))
    bounces = replace(prediction, steady_force_N=np.nan)
    at_peak = float(prediction.displacement_mm[int(np.argmax(prediction.force_N))])
    return MassPress(bounces, deepest, at_peak, stop, float(run.energy_mJ[0]))


def _finite_strain_factor(
    pad: Pad | Puck, motion: Motion, curve: ForceCurve, force_N: NDArray
) -> Callable[[NDArray], NDArray]:
    """Factor of a force at finite strain over the separable one, over the depths on the way in."""
    plain = motion_on_curve(pad, motion, curve).force_N
    way_in = slice(int(np.argmax(plain > 0.0)), int(np.argmax(motion.displacement_mm)) + 1)
    depth, factor = motion.displacement_mm[way_in], (force_N / np.where(plain > 0.0, plain, 1.0))[way_in]
    return lambda at: np.interp(at, depth, factor)


def _bottoms_out(
    pad: Pad | Puck, curve: ForceCurve, run: PersonResponse, mass_kg: float, velocity_mm_s: float, energy_mJ: float
) -> NoAnswerError:
    """Say how much of a mass's energy the pad absorbs to the depth where its force is known."""
    path, limit = run.depth_curve_mm[0], curve.limit_mm
    way_in = slice(0, int(np.argmax(path >= limit)) + 1)
    absorbed = float(np.interp(limit, path[way_in], work_over(path[way_in], run.force_curve_N[0][way_in])))
    share, brought = limit / pad.thickness_mm, f"{energy_mJ:.3g} mJ ({mass_kg:g} kg at {velocity_mm_s:g} mm/s)"
    unsolved = curve.solver["unknowns"] > 0 and share < MAX_DEPTH_OVER_THICKNESS * (1.0 - 1e-6)
    code, ends = ("no_convergence", "its solution ends") if unsolved else ("bottoms_out", "bottoms out")
    message = (
        f"the pad absorbs {absorbed:.3g} of {brought}, then {ends} at {limit:.3g} mm, {share:.2f} of its thickness; "
        "take a smaller mass or speed, or a thicker pad"
    )
    found = {"energy_mJ": energy_mJ, "absorbed_mJ": absorbed, "depth_limit_mm": limit}
    return NoAnswerError(code, "; ".join([message, *curve.notes]), found, "energy_mJ")

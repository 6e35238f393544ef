"""The paper's three dummies pressed in simulation: every base, modulus and law of the study."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.press_simulation import PadBatch, SlabCurves, make_curves, press_to_depth, steady_depth
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.interface import BASES
from dummydesign.measurement.motion import contact_velocity
from dummydesign.measurement.trace import Trace
from dummydesign.pad.fe_force_law import SolvedSlab, law_of
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.square import punch_law
from studies.paper_dummies.dummies import (
    APPROACH_S,
    ARM_TAU_S,
    FORCES_N,
    PUNCH,
    RADIUS_MM,
    RATE_HZ,
    RATIO,
    RESIN,
    SAMPLING,
    SITES,
    STEADY_GRID_N,
    STIFFENING,
    VELOCITIES_MM_S,
    Dummy,
    PressFigures,
    Variant,
    variants,
)
from studies.thickness import stiffening, unit_slab

if TYPE_CHECKING:
    from dummydesign.tissue.model.maxwell_law import Parameters
    from dummydesign.tissue.model.tissue import Tissue


def stiffening_cases() -> list[Pad]:
    """Slabs that the response tables do not hold."""
    return [
        unit_slab(thickness, RADIUS_MM, base, c2)
        for c2 in STIFFENING
        if c2
        for base in BASES
        for _, thickness in SITES.values()
    ]


def force_laws(slabs: list[SolvedSlab]) -> dict[tuple[str, float], ForceLaw]:
    """Force laws of the square punch by (base, c2 / mu): tables, and the solved stiffening slabs.

    The square's factor is that of a neo-Hookean slab for all: no other was computed.
    """
    from dummydesign.pad.tables.slab import load_table

    laws: dict[tuple[str, float], ForceLaw] = {(base, 0.0): load_table(base) for base in BASES}
    groups: dict[tuple[str, float], list[SolvedSlab]] = {}
    for slab in slabs:
        groups.setdefault((slab.pad.base, stiffening(slab.pad)), []).append(slab)
    laws |= {key: law_of(group) for key, group in groups.items()}
    return {(base, c2): punch_law(law, PUNCH, base=base) for (base, c2), law in laws.items()}


def press_dummy(
    name: str, law: ForceLaw, young_MPa: float, prony: tuple[PronyTerm, ...], only_steady: bool = False
) -> Dummy:
    """Press one dummy at 5, 10, 15 N and 10, 250 mm/s, hold 10 s, fit it and hold it against its tissue.

    Parameters
    ----------
    name : str
        ``I``, ``II`` or ``III``.
    law : ForceLaw
        Elastic force of slabs under the punch.
    young_MPa : float
        Long-term modulus. [MPa]
    prony : tuple of PronyTerm
        Relaxation on top (one separable law for all depths).
    only_steady : bool
        Leave out presses and fit.
    """
    from dummydesign.tissue.model.tissue_file import load_tissue

    site, thickness = SITES[name]
    tissue = load_tissue(site)
    taus, betas = tuple(term.tau_s for term in prony), np.array([[term.beta for term in prony]])
    curves = make_curves(law, thickness, RADIUS_MM, MAX_DEPTH_OVER_THICKNESS)
    slabs = PadBatch(curves, np.array([0]), np.array([young_MPa]), taus, betas)
    depth = steady_depth(slabs, STEADY_GRID_N, VELOCITIES_MM_S[0], SAMPLING)[0]
    deepest = press_to_depth(slabs, curves.limit_mm, VELOCITIES_MM_S[0], SAMPLING)
    reach = float(deepest.force_N[0, -1])
    if only_steady:
        return Dummy(name, thickness, tissue, reach, depth, {}, None, None, {})
    presses = {}
    for velocity in VELOCITIES_MM_S:
        for force, reached in zip(FORCES_N, steady_depth(slabs, FORCES_N, velocity, SAMPLING, exact=True)[0]):
            if math.isfinite(reached):
                presses[force, velocity] = _press(slabs, float(reached), force, velocity, tissue)
    both = len({velocity for _, velocity in presses}) == len(VELOCITIES_MM_S)
    parameters, rmse = fit_presses(presses, tissue.law) if both else (None, None)
    return Dummy(name, thickness, tissue, reach, depth, presses, parameters, rmse, arm_weights(curves, young_MPa))


def arm_weights(curves: SlabCurves, young_MPa: float, force_N: float = 10.0) -> dict[float, NDArray]:
    """Largest extra force of single arms of strength 1 over the relaxed force, by speed; shape of ``ARM_TAU_S``.

    A dummy whose weights are all smaller than another's has the smaller peak with any single arm. In a sum of
    arms the largest extra forces lie at slightly different times (while braking, or at the stop), so the sum of
    weights bounds the peak from above only.

    Parameters
    ----------
    curves : Curves
        Elastic curves at 1 MPa; the first is used.
    young_MPa : float
        Long-term modulus. [MPa]
    force_N : float
        Long-term force at the depth where the punch stops. [N]

    Returns
    -------
    dict
        Weights by speed (mm/s), each an ndarray; empty where the force is out of the slab's reach.
    """
    count = len(ARM_TAU_S)
    none, each = np.zeros(count, int), np.full(count, young_MPa)
    slabs = PadBatch(curves, none, each, tuple(ARM_TAU_S), np.eye(count))
    depth = curves.depth_at(none, np.full(count, force_N / young_MPa))
    if not np.isfinite(depth).all():
        return {}
    weights = {}
    for velocity in VELOCITIES_MM_S:
        press = press_to_depth(slabs, depth, velocity, SAMPLING)
        elastic = young_MPa * curves.area_at(none, SAMPLING.motion(velocity, depth).displacement_mm)
        weights[velocity] = (press.force_N - elastic).max(axis=-1) / force_N
    return weights


def fit_presses(presses: dict[tuple[float, float], PressFigures], law: str) -> tuple[Parameters, float]:
    """Fit the five-element law per speed, as the command ``fit`` does, without its rivals and intervals.

    Returns
    -------
    Parameters, float
        Parameters, and rms residual of the binned traces [N].
    """
    from dummydesign.tissue.fitting.problem import TissueProblem, trace_residuals
    from dummydesign.tissue.fitting.reduction import reduce_trace, speed_groups
    from dummydesign.tissue.model.maxwell_law import Parameters

    groups = speed_groups([reduce_trace(press.trace) for press in presses.values()])
    problem = TissueProblem(law, [group for _, group in groups], None)
    optimum = problem.optimum(2)
    gamma1, gamma, dampers = problem.split(optimum.solution.parameters, 2)
    by_speed = tuple((speed, tuple(np.exp(row))) for (speed, _), row in zip(groups, dampers))
    parameters = Parameters(law, float(np.exp(gamma1)), tuple(np.exp(gamma)), by_speed)
    return parameters, float(trace_residuals([(problem, optimum)])["rmse_N"])


def _press(slabs: PadBatch, depth_mm: float, force_N: float, velocity_mm_s: float, tissue: Tissue) -> PressFigures:
    press = press_to_depth(slabs, np.array([depth_mm]), velocity_mm_s, SAMPLING)
    time, force, stop = press.time_s[0], press.force_N[0], float(press.stop_s[0])
    band = tissue.force_range(force_N, velocity_mm_s, SAMPLING.hold_s, SAMPLING.deceleration_mm_s2)
    inside = {key: float(share) for key, share in band.inside(time, force, stop).items()}
    moved = SAMPLING.motion(velocity_mm_s, np.array([depth_mm])).displacement_mm[0]
    trace = _trace(f"{force_N:g} N at {velocity_mm_s:g} mm/s", time, moved, force, velocity_mm_s, depth_mm)
    return PressFigures(depth_mm, time, force, stop, band, inside, trace)


def _trace(name: str, time: NDArray, moved: NDArray, force: NDArray, velocity_mm_s: float, depth_mm: float) -> Trace:
    """Sample a press evenly in time with the free way before contact."""
    before = np.arange(-APPROACH_S, 0.0, 1.0 / RATE_HZ)
    grid = np.concatenate([before, np.arange(0.0, time[-1], 1.0 / RATE_HZ)])
    deceleration = SAMPLING.deceleration_mm_s2
    touch = float(contact_velocity(velocity_mm_s, depth_mm, deceleration))
    # a robot that has to brake before it touches comes on faster the further away it is
    braked = np.minimum(-before, (velocity_mm_s - touch) / deceleration)
    way = touch * braked + 0.5 * deceleration * braked**2 + velocity_mm_s * (-before - braked)
    pressed = grid[len(before) :]
    x = np.concatenate([-way, np.interp(pressed, time, moved)])
    return Trace(name, grid, x, np.concatenate([0.0 * before, np.interp(pressed, time, force)]))


def study(slabs: list[SolvedSlab], chosen: list[Variant] | None = None) -> dict[Variant, dict[str, Dummy]]:
    """Press all three dummies in every variant (or the chosen ones): {variant: {dummy: what came out}}.

    The relaxation is that of the resin at 100:15 in all of them.
    """
    from dummydesign.resin import load_resin

    laws, prony = force_laws(slabs), load_resin(RESIN).prony(RATIO)
    return {
        variant: {
            name: press_dummy(name, laws[variant.base, variant.stiffening], 1e-3 * variant.young_kPa, prony)
            for name in SITES
        }
        for variant in chosen or variants()
    }


def steady_scan(slabs: list[SolvedSlab]) -> dict[Variant, dict[str, Dummy]]:
    """Steady curves only, over all bases and laws and moduli of 15 to 50 kPa in steps of 1 kPa."""
    from dummydesign.resin import load_resin

    laws, prony = force_laws(slabs), load_resin(RESIN).prony(RATIO)
    return {
        Variant(base, young, c2): {name: press_dummy(name, law, 1e-3 * young, prony, True) for name in SITES}
        for (base, c2), law in laws.items()
        for young in np.arange(15.0, 50.5, 1.0)
    }

"""How the recommended pad reacts to what is not exact: thickness, weighing, modulus, relaxation, one at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.presses import Curves, ForceLaw, Slabs, make_curves, press_to_depth, steady_depth

if TYPE_CHECKING:
    from dummydesign.design.suggestion import Suggestion


def ratio_error(answer: Suggestion) -> float:
    """Largest error of the ratio when both components are weighed off by the tolerance, in opposite ways."""
    masses = {item["name"]: item["mass_g"] for item in answer.batch["components"]}
    by_ratio = next(liquid.name for liquid in answer.resin.liquids if liquid.parts is None)
    varied = masses.get(by_ratio, 0.0)
    rest = sum(mass for name, mass in masses.items() if name != by_ratio)
    error = answer.request.weighing_g
    if varied <= 0.0 or rest <= 0.0:
        return 0.0
    return float(answer.best.ratio * ((1.0 + error / varied) / (1.0 - error / rest) - 1.0))


@dataclass(frozen=True)
class Reaction:
    """Change in per cent of depth (middle force, slow) and peak (middle force, fast) between both ends."""

    name: str
    depth_percent: tuple[float, float]
    peak_percent: tuple[float, float]


def reactions(answer: Suggestion, law: ForceLaw) -> list[Reaction]:
    """How depth and peak of the recommended pad react to each thing that is not exact, one at a time."""
    resin, best, tolerance = answer.resin, answer.best, answer.request.thickness_tolerance_mm
    ratio, thickness, young = best.ratio, best.thickness_mm, resin.young_MPa(best.ratio)
    beta, radius = np.array([term.beta for term in resin.prony(ratio)]), answer.radius_mm
    ends = [np.array([getattr(arm.beta, end) / arm.beta.value for arm in resin.arms]) for end in ("low", "high")]
    smallest, largest = law.ratio_range
    thin = np.clip([thickness - tolerance, thickness + tolerance], radius / largest, radius / smallest)
    curves = make_curves(law, [thickness, *thin], radius)
    off = ratio_error(answer)
    lean, rich = (min(max(ratio + sign * off, resin.ratio_min), resin.ratio_max) for sign in (-1, 1))
    modulus = resin.modulus_kPa(ratio)
    nominal = _measure(curves, 0, young, beta, answer)
    cases = {
        f"thickness ± {tolerance:g} mm": [(1, young, beta), (2, young, beta)],
        f"weighing ± {answer.request.weighing_g:g} g": [
            (0, resin.young_MPa(value), np.array([term.beta for term in resin.prony(value)])) for value in (lean, rich)
        ],
        "modulus, 95 %": [(0, 1e-3 * modulus.low, beta), (0, 1e-3 * modulus.high, beta)],
        "relaxation, 95 %": [(0, young, beta * end) for end in ends],
    }
    found = []
    for name, pair in cases.items():
        change = np.array([100.0 * (_measure(curves, *case, answer) / nominal - 1.0) for case in pair])
        # an end at which the force cannot be reached has no number: the bar then ends at no change, and says so
        name += "" if np.isfinite(change).all() else " *"
        low, high = np.fmin.reduce([*change, 0 * nominal]), np.fmax.reduce([*change, 0 * nominal])
        found.append(Reaction(name, (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))))
    return found


def _measure(curves: Curves, slab: int, young_MPa: float, beta: NDArray, answer: Suggestion) -> NDArray:
    """Depth at the middle steady force when slow, and peak at it when fast."""
    tau = tuple(arm.tau_s.value for arm in answer.resin.arms)
    protocol, sampling = answer.targets.protocol, answer.targets.sampling
    slabs = Slabs(curves, np.array([slab]), np.array([young_MPa]), tau, beta[None, :])
    speeds = protocol.slow_mm_s, protocol.fast_mm_s
    slow, fast = (steady_depth(slabs, protocol.needed_N, velocity, sampling.coarse) for velocity in speeds)
    return np.array([slow[0], press_to_depth(slabs, fast, speeds[1], sampling.coarse).peak_N[0]])

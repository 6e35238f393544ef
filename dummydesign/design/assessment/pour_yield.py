"""What share of pours stays inside the band, given weighing, thickness and what is not known of the resin."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.presses import ForceLaw, Slabs, make_curves, steady_depth
from dummydesign.design.scoring.targets import Targets
from dummydesign.resin.model.resin import Resin

POURS, SEED, NODES = 2000, 11, 9


@dataclass(frozen=True)
class Tolerances:
    """How well a pad is made. Errors are even within plus and minus these limits.

    ``pour_g`` is the whole mass that is weighed in.
    """

    pour_g: float
    weighing_g: float = 0.1
    thickness_mm: float = 0.2

    def to_dict(self) -> dict[str, Any]:
        """Return the limits."""
        return asdict(self)


@dataclass(frozen=True)
class PourYield:
    """Share of pours inside the steady-state range.

    Attributes
    ----------
    yield_fraction : float
        Share that stays inside at every force where the nominal pad is inside, with every uncertainty;
        0 when the nominal pad is inside nowhere.
    judged_at_N : tuple of float
        These forces, out of those of the test.
    making_only_fraction : float
        The same if the resin properties were known exactly: weighing and thickness alone.
    by_force : dict
        {force: fraction in range at this force}, every uncertainty.
    by_force_making_only : dict
        {force: share}, weighing and thickness alone.
    young_spread_percent : float
        Spread of the modulus from weighing alone (one standard deviation).
    """

    yield_fraction: float
    judged_at_N: tuple[float, ...]
    making_only_fraction: float
    by_force: dict[str, float]
    by_force_making_only: dict[str, float]
    young_spread_percent: float
    pours: int
    tolerances: Tolerances

    def to_dict(self) -> dict[str, Any]:
        """Return the shares and what they were computed for."""
        return asdict(self)


@dataclass(frozen=True)
class Pours:
    """Pads that may come out of one design: ``thickness_mm``, ``young_MPa`` (n,) and ``beta`` (n, arms)."""

    thickness_mm: NDArray
    young_MPa: NDArray
    beta: NDArray


def draw_pours(
    resin: Resin, thickness_mm: float, ratio: float, tolerances: Tolerances, pours: int = POURS, seed: int = SEED
) -> tuple[Pours, Pours]:
    """Draw pours of one design: with all that is not known, and with errors of weighing and thickness alone.

    Parameters
    ----------
    resin : Resin
    thickness_mm, ratio : float
        The design. [mm, resin's ratio]
    tolerances : Tolerances
    pours : int
        How many.
    seed : int
        The same seed gives the same pours.
    """
    rng = np.random.default_rng(seed)
    weighed = _weighed_ratio(resin, ratio, tolerances, pours, rng)
    thickness = thickness_mm + tolerances.thickness_mm * rng.uniform(-1.0, 1.0, pours)
    drawn = resin.draw(pours, rng)
    central = {name: np.full(pours, value) for name, value in resin.central.items()}
    stated = replace(
        drawn,
        numbers=central,
        beta_ref=np.tile([arm.beta.value for arm in resin.arms], (pours, 1)),
        softness_exponent=np.full(pours, resin.softness_exponent.value),
    )
    kept = np.clip(weighed, resin.ratio_min, resin.ratio_max)
    every, making = (
        Pours(thickness, np.maximum(numbers.young_MPa(weighed), 1e-9), numbers.beta(kept))
        for numbers in (drawn, stated)
    )
    return every, making


def pour_yield(
    law: ForceLaw,
    resin: Resin,
    targets: Targets,
    thickness_mm: float,
    ratio: float,
    radius_mm: float,
    tolerances: Tolerances,
    pours: int = POURS,
    seed: int = SEED,
) -> PourYield:
    """Pour one design many times and press each pad at the speed of the slow condition.

    Parameters
    ----------
    law, resin, targets
        As for :func:`dummydesign.design.search.slabs.search`.
    thickness_mm, ratio : float
        The design. [mm, resin's ratio]
    radius_mm : float
        Radius of the circle of the punch's area. [mm]
    tolerances : Tolerances
        Limits of the errors.
    pours : int
        Number of pours.
    seed : int
        The same seed gives the same pours.

    Returns
    -------
    PourYield
    """
    shares = {}
    for name, poured in zip(("all", "making"), draw_pours(resin, thickness_mm, ratio, tolerances, pours, seed)):
        shares[name] = _inside(law, resin, targets, poured.thickness_mm, poured.young_MPa, poured.beta, radius_mm)
        spread = float(np.std(np.log(poured.young_MPa)))
    nominal = _nominal(law, resin, targets, thickness_mm, ratio, radius_mm)
    return PourYield(
        _stays(shares["all"], nominal),
        tuple(float(force) for force in np.array(targets.protocol.forces_N)[nominal]),
        _stays(shares["making"], nominal),
        _by_force(shares["all"], targets.protocol.forces_N),
        _by_force(shares["making"], targets.protocol.forces_N),
        100.0 * spread,
        pours,
        tolerances,
    )


def _stays(inside: NDArray, nominal: NDArray) -> float:
    """Share of pours inside wherever the nominal pad is."""
    return float(inside[:, nominal].all(axis=-1).mean()) if nominal.any() else 0.0


def _nominal(
    law: ForceLaw, resin: Resin, targets: Targets, thickness_mm: float, ratio: float, radius_mm: float
) -> NDArray:
    """Whether the pad without any error is inside at each force."""
    beta = np.array([[term.beta for term in resin.prony(ratio)]])
    thickness, young = np.array([thickness_mm]), np.array([resin.young_MPa(ratio)])
    return _inside(law, resin, targets, thickness, young, beta, radius_mm)[0]


def _weighed_ratio(resin: Resin, ratio: float, tolerances: Tolerances, pours: int, rng: np.random.Generator) -> NDArray:
    """Ratio that is really in the cup when every component is weighed with an error of its own."""
    parts = resin.parts(ratio)
    by_ratio = next(liquid.name for liquid in resin.liquids if liquid.parts is None)
    true_g = {component.name: component.mass_g for component in resin.recipe(ratio, tolerances.pour_g)}
    weighed = {
        name: np.maximum(mass + tolerances.weighing_g * rng.uniform(-1.0, 1.0, pours), 0.0)
        for name, mass in true_g.items()
    }
    others = sum(value for name, value in parts.items() if name != by_ratio)
    rest = sum(mass for name, mass in weighed.items() if name != by_ratio)
    return others * weighed.get(by_ratio, np.zeros(pours)) / np.maximum(rest, 1e-9)


def _inside(
    law: ForceLaw,
    resin: Resin,
    targets: Targets,
    thickness: NDArray,
    young: NDArray,
    beta: NDArray,
    radius_mm: float,
) -> NDArray:
    """Whether each pour is inside the steady-state range at each force, shape (pours, forces)."""
    forces = np.array(targets.protocol.forces_N)
    depth = _depth_mm(law, resin, targets, Pours(thickness, young, beta), radius_mm, forces)
    stiff, soft = targets.depth_range_mm(forces)
    with np.errstate(invalid="ignore"):
        return (depth >= stiff) & (depth <= soft)


def depth_band_mm(
    law: ForceLaw, resin: Resin, targets: Targets, thickness_mm: float, ratio: float, radius_mm: float,
    tolerances: Tolerances, force_N: NDArray, pours: int = 400,
) -> tuple[NDArray, NDArray]:  # fmt: skip
    """Depths between which 95 % of the castings of one design are, with every uncertainty.

    Parameters
    ----------
    law, resin, targets, thickness_mm, ratio, radius_mm, tolerances
        As for :func:`pour_yield`.
    force_N : ndarray, shape (n,)
        Steady forces. [N]
    pours : int
        How many castings are drawn.

    Returns
    -------
    stiff, soft : ndarray, shape (n,)
        NaN where that casting does not reach the force. [mm]
    """
    poured, _ = draw_pours(resin, thickness_mm, ratio, tolerances, pours)
    depth = _depth_mm(law, resin, targets, poured, radius_mm, np.asarray(force_N, float))
    # a casting out of reach is deeper than those in reach
    ordered = np.sort(np.where(np.isfinite(depth), depth, np.inf), axis=0)
    ends = (ordered[int(np.floor(share * (pours - 1)))] for share in (0.025, 0.975))
    stiff, soft = (np.where(np.isfinite(end), end, np.nan) for end in ends)
    return stiff, soft


def _depth_mm(
    law: ForceLaw, resin: Resin, targets: Targets, poured: Pours, radius_mm: float, forces: NDArray
) -> NDArray:
    """Depth of each pour at each steady force, shape (pours, forces); NaN out of reach."""
    # a pad thinner or thicker than the law knows is taken at the law's end
    smallest, largest = law.ratio_range
    thickness, young, beta = poured.thickness_mm, poured.young_MPa, poured.beta
    thickness = np.clip(thickness, radius_mm / largest, radius_mm / smallest)
    low, high = float(thickness.min()), float(thickness.max())
    nodes = np.linspace(low, high, NODES) if high > low else np.array([low])
    curves = make_curves(law, nodes, radius_mm)
    place = (thickness - low) / (high - low) * (NODES - 1) if high > low else np.zeros(len(thickness))
    left = np.minimum(place.astype(int), max(len(nodes) - 2, 0))
    share = (place - left)[:, None]
    tau = tuple(arm.tau_s.value for arm in resin.arms)
    slow = targets.protocol.slow_mm_s
    sampling = targets.sampling.coarse
    at_left = steady_depth(Slabs(curves, left, young, tau, beta), forces, slow, sampling)
    at_right = steady_depth(
        Slabs(curves, np.minimum(left + 1, len(nodes) - 1), young, tau, beta), forces, slow, sampling
    )
    return np.asarray(at_left + share * (at_right - at_left))


def _by_force(inside: NDArray, forces_N: tuple[float, ...]) -> dict[str, float]:
    return {f"{force:g}": float(share) for force, share in zip(forces_N, inside.mean(axis=0))}

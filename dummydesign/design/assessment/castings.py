"""The castings of an answer: drawn once, in named groups, for every fraction and quantile."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.core.serialise import Serialised
from dummydesign.design.scoring.presses import Slabs, make_curves, steady_depth
from dummydesign.design.scoring.score import Evaluation, evaluate
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import Readings, Verdict, ranges_of, readings_of, verdict
from dummydesign.pad.force_law import ForceLaw

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import DesignCandidate, SearchSpace
    from dummydesign.resin.model.resin import Resin


MODULUS, RELAXATION, MAKING, FORCE_LAW, TISSUE = GROUPS = ("modulus", "relaxation", "making", "force_law", "tissue")
RESIN = frozenset((MODULUS, RELAXATION))
# Castings: a share of 1200 has a standard error of at most 1.45 points.
COUNT, SEED, MOST = 1200, 11, 100_000
NODES, AT_LIMIT = 41, 0.99


@dataclass(frozen=True)
class Tolerances(Serialised):
    """How well a pad is made. Errors are even within plus and minus these limits.

    ``pour_g`` is the whole mass that is weighed in.
    """

    pour_g: float
    weighing_g: float = 0.1
    thickness_mm: float = 0.2


@dataclass(frozen=True)
class Pours:
    """Pads that may come out of one design: ``thickness_mm``, ``young_MPa`` (n,) and ``beta`` (n, arms)."""

    thickness_mm: NDArray
    young_MPa: NDArray
    beta: NDArray

    def first(self, count: int) -> Pours:
        """The first of them."""
        return Pours(self.thickness_mm[:count], self.young_MPa[:count], self.beta[:count])


@dataclass(frozen=True)
class Castings:
    """Deviates of n castings of a resin; see :meth:`of_pad`."""

    resin: Resin
    n: int = COUNT
    seed: int = SEED

    def __post_init__(self) -> None:
        if not COUNT <= self.n <= MOST:
            message = f"castings = {self.n} is outside {COUNT} to {MOST}: fewer leave percentages too uncertain"
            raise InputError(message, "out_of_range", "castings", self.n, (COUNT, MOST))

    @cached_property
    def _drawn(self) -> dict[str, Any]:
        # a stream of its own for each group, so that none depends on another
        of_resin, of_making, of_law = np.random.default_rng(self.seed).spawn(3)
        weighed = {liquid.name: of_making.uniform(-1.0, 1.0, self.n) for liquid in self.resin.liquids}
        thickness, law = of_making.uniform(-1.0, 1.0, self.n), of_law.standard_normal(self.n)
        resin = self.resin.draw(self.n, of_resin)
        central = {name: np.full(self.n, value) for name, value in self.resin.central.items()}
        beta = np.tile([arm.beta.value for arm in self.resin.arms], (self.n, 1))
        softness = np.full(self.n, self.resin.softness_exponent.value)
        stated = replace(resin, numbers=central, beta_ref=beta, softness_exponent=softness)
        return {"weighed": weighed, "thickness": thickness, "law": law, "resin": resin, "central": stated}

    def pours(
        self, thickness_mm: float, ratio: float, tolerances: Tolerances, error: float = 0.0, known: Collection[str] = ()
    ) -> Pours:
        """Pads that may come out of one design."""
        drawn, making = self._drawn, MAKING not in known
        weighed = self._weighed_ratio(ratio, tolerances) if making else np.full(self.n, ratio)
        thickness = thickness_mm + (tolerances.thickness_mm * drawn["thickness"] if making else np.zeros(self.n))
        modulus, relaxation = (drawn["central" if group in known else "resin"] for group in (MODULUS, RELAXATION))
        off = np.zeros(self.n) if FORCE_LAW in known else error / HALF_WIDTH * drawn["law"]
        kept = np.clip(weighed, self.resin.ratio_min, self.resin.ratio_max)
        young = np.maximum(modulus.young_MPa(weighed), 1e-9) * np.exp(off)
        return Pours(thickness, young, relaxation.beta(kept))

    def _weighed_ratio(self, ratio: float, tolerances: Tolerances) -> NDArray:
        """Ratio that is in the cup when every component is weighed with an error of its own."""
        parts = self.resin.parts(ratio)
        by_ratio = next(liquid.name for liquid in self.resin.liquids if liquid.parts is None)
        masses = {item.name: item.mass_g for item in self.resin.recipe(ratio, tolerances.pour_g)}
        weighed = {
            name: np.maximum(mass + tolerances.weighing_g * self._drawn["weighed"][name], 0.0)
            for name, mass in masses.items()
        }
        others = sum(value for name, value in parts.items() if name != by_ratio)
        rest = sum(mass for name, mass in weighed.items() if name != by_ratio)
        return others * weighed.get(by_ratio, np.zeros(self.n)) / np.maximum(rest, 1e-9)


@dataclass(frozen=True)
class PadCastings:
    """The castings of one pad, pressed by the test."""

    castings: Castings
    law: ForceLaw
    candidate: DesignCandidate
    space: SearchSpace
    tolerances: Tolerances

    @cached_property
    def error(self) -> float:
        """Largest stated error of the force law over the pressed depths; 0 where none is stated."""
        depth = self.candidate.depth_mm
        known = depth[np.isfinite(depth)]
        stated = np.asarray(self.law.relative_error(known, self.candidate.thickness_mm, self.space.radius_mm))
        return float(np.max(stated[np.isfinite(stated)], initial=0.0))

    def pours(self, known: Collection[str] = (), ratio: float | None = None) -> Pours:
        """See :meth:`Castings.pours`; of another ratio where one is given."""
        at = self.candidate.ratio if ratio is None else ratio
        return self.castings.pours(self.candidate.thickness_mm, at, self.tolerances, self.error, known)

    def slabs(self, pours: Pours) -> Slabs:
        """Pours as designs to press."""
        return poured_slabs(self.law, pours, self.space)

    def pressed(self, known: Collection[str] = ()) -> Evaluation:
        """Scores and presses of all castings."""
        return evaluate(self.slabs(self.pours(known)), self.space.targets, self.space.sampling.coarse)

    def readings(self, known: Collection[str] = ()) -> Readings:
        """Readings of all castings, shapes (n, c) and (n, g)."""
        return readings_of(self.every if not known else self.pressed(known))

    @cached_property
    def over_tissues(self) -> list[NDArray]:
        """Scores of the first castings for every tissue; filled where they are first wanted."""
        return []

    @cached_property
    def every(self) -> Evaluation:
        """Scores and presses of all castings with nothing known."""
        return self.pressed()

    def depth_band_mm(self, force_N: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Depths between which 95 % of the castings are at steady forces, and the share that is out of reach."""
        slow = self.space.targets.protocol.slow_mm_s
        depth = steady_depth(self.slabs(self.pours()), np.asarray(force_N, float), slow, self.space.sampling.coarse)
        # a casting out of reach is deeper than those in reach
        ordered = np.sort(np.where(np.isfinite(depth), depth, np.inf), axis=0)
        ends = (ordered[int(np.floor(share * (len(depth) - 1)))] for share in (0.025, 0.975))
        stiff, soft = (np.where(np.isfinite(end), end, np.nan) for end in ends)
        return stiff, soft, np.mean(~np.isfinite(depth), axis=0)


def poured_slabs(law: ForceLaw, pours: Pours, space: SearchSpace) -> Slabs:
    """Pours as designs to press; their thicknesses are taken at the nearest of 41 even steps.

    These are a hundredth of a millimetre apart for 0.2 mm either way.
    """
    smallest, largest = law.ratio_range
    thickness = np.clip(pours.thickness_mm, space.radius_mm / largest, space.radius_mm / smallest)
    low, high = float(thickness.min()), float(thickness.max())
    nodes = np.linspace(low, high, NODES) if high > low else np.array([low])
    index = np.rint((thickness - low) / max(high - low, 1e-12) * (len(nodes) - 1)).astype(int)
    return Slabs(make_curves(law, nodes, space.radius_mm), index, pours.young_MPa, space.resin.tau_s, pours.beta)


def limits_that_bind(candidate: DesignCandidate, thickness_mm: NDArray, ratio: NDArray) -> tuple[str, ...]:
    """Which limits a design lies at: depth over thickness, and the ends of what was searched."""
    depth, limit, bound = candidate.depth_mm, candidate.limit_mm, []
    if not np.isfinite(depth).all() or np.nanmax(depth) >= AT_LIMIT * limit:
        bound.append(f"depth over thickness (at most {limit / candidate.thickness_mm:.2f})")
    for name, value, steps, unit in (
        ("thickness", candidate.thickness_mm, thickness_mm, " mm"),
        ("ratio", candidate.ratio, ratio, ""),
    ):
        if len(steps) > 1 and value in (steps[0], steps[-1]):
            bound.append(f"{name} ({steps[0]:g} to {steps[-1]:g}{unit})")
    return tuple(bound)


def verdict_of_design(cast: PadCastings, beyond: float = 1.0) -> Verdict:
    """Verdict on a design: at central estimates, over its castings, and with the limits that bind it."""
    space, candidate = cast.space, cast.candidate
    bound = limits_that_bind(candidate, space.thickness_mm, space.ratio)
    return verdict(
        ranges_of(space.targets), candidate.readings, cast.readings(), bound, measured=cast.readings(RESIN),
        limits=space.targets.limits, beyond=beyond,
    )  # fmt: skip


@dataclass(frozen=True)
class PourYield(Serialised):
    """Share of castings inside the steady-state range."""

    yield_fraction: float
    judged_at_N: tuple[float, ...]
    making_only_fraction: float
    by_force: dict[str, float]
    by_force_making_only: dict[str, float]
    young_spread_percent: float
    pours: int
    tolerances: Tolerances


def pour_yield(cast: PadCastings) -> PourYield:
    """Share of the castings of a pad whose steady depths at the slowest speed lie among the subjects'."""
    targets, best = cast.space.targets, cast.candidate
    known = (MODULUS, RELAXATION, FORCE_LAW)
    inside, making = (_inside(evaluation, targets) for evaluation in (cast.every, cast.pressed(known)))
    nominal = _inside(best.evaluation, targets)[best.index]
    forces = targets.protocol.forces_N
    # shares inside wherever the nominal pad is
    stays = [float(one[:, nominal].all(axis=-1).mean()) if nominal.any() else 0.0 for one in (inside, making)]
    every, made = (dict(zip((f"{f:g}" for f in forces), one.mean(axis=0).tolist())) for one in (inside, making))
    spread = 100.0 * float(np.std(np.log(cast.pours(known).young_MPa)))
    judged = tuple(float(force) for force in np.array(forces)[nominal])
    return PourYield(stays[0], judged, stays[1], every, made, spread, cast.castings.n, cast.tolerances)


def _inside(evaluation: Evaluation, targets: Targets) -> NDArray:
    """Whether each pad is inside the steady-state range at each force of the slowest speed, shape (pads, forces)."""
    forces = np.array(targets.protocol.forces_N)
    depth = evaluation.depth_mm[:, : len(forces)]
    stiff, soft = targets.depth_range_mm(forces)
    with np.errstate(invalid="ignore"):
        return np.asarray((depth >= stiff) & (depth <= soft))

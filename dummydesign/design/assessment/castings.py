"""The castings of an answer: drawn once, in named groups, for every share, quantile and factor that is given.

Groups are the resin's modulus, its relaxation, the making (weighing and thickness), the error of the force law, and the
tissue. The same deviates serve every pad and every group that is taken as known, so that figures of one answer agree
and differ only by what they are about.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.design.scoring.acceptability import readings_of
from dummydesign.design.scoring.deviations import Readings
from dummydesign.design.scoring.presses import ForceLaw, Slabs, make_curves, steady_depth
from dummydesign.design.scoring.score import Evaluation, evaluate
from dummydesign.resin.model.distribution import HALF_WIDTH

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.design.search.space import SearchSpace
    from dummydesign.resin.model.resin import Resin

MODULUS, RELAXATION, MAKING, FORCE_LAW, TISSUE = GROUPS = ("modulus", "relaxation", "making", "force_law", "tissue")
RESIN = frozenset((MODULUS, RELAXATION))
COUNT, SEED, MOST = 1200, 11, 100_000
"""Castings: a share of 1200 has a standard error of at most 1.45 points."""
NODES = 41


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
    """Deviates of n castings of a resin; see :meth:`of_pad`.

    Attributes
    ----------
    resin : Resin
    n, seed : int
        How many, and what they are drawn by.
    """

    resin: Resin
    n: int = COUNT
    seed: int = SEED

    def __post_init__(self) -> None:
        if not COUNT <= self.n <= MOST:
            raise InputError(f"castings = {self.n} is outside {COUNT} to {MOST}: fewer leave percentages too uncertain")

    @cached_property
    def _streams(self) -> dict[str, np.random.Generator]:
        """A stream of its own for each group, so that none depends on another."""
        return dict(zip((MODULUS, MAKING, FORCE_LAW), np.random.default_rng(self.seed).spawn(3)))

    @cached_property
    def _drawn(self) -> dict[str, Any]:
        rng = self._streams[MAKING]
        weighed = {liquid.name: rng.uniform(-1.0, 1.0, self.n) for liquid in self.resin.liquids}
        thickness = rng.uniform(-1.0, 1.0, self.n)
        law = self._streams[FORCE_LAW].standard_normal(self.n)
        resin = self.resin.draw(self.n, self._streams[MODULUS])
        central = {name: np.full(self.n, value) for name, value in self.resin.central.items()}
        stated = replace(
            resin,
            numbers=central,
            beta_ref=np.tile([arm.beta.value for arm in self.resin.arms], (self.n, 1)),
            softness_exponent=np.full(self.n, self.resin.softness_exponent.value),
        )
        return {"weighed": weighed, "thickness": thickness, "law": law, "resin": resin, "central": stated}

    def pours(
        self, thickness_mm: float, ratio: float, tolerances: Tolerances, error: float = 0.0,
        known: Collection[str] = (),
    ) -> Pours:
        """Pads that may come out of one design.

        Parameters
        ----------
        thickness_mm, ratio : float
            The design. [mm, resin's ratio]
        tolerances : Tolerances
        error : float
            Of the force law over the force, 95 %.
        known : collection of str
            Groups taken as known: their deviates stay at the centre.
        """
        drawn, making = self._drawn, MAKING not in known
        weighed = self._weighed_ratio(ratio, tolerances) if making else np.full(self.n, ratio)
        thickness = thickness_mm + (tolerances.thickness_mm * drawn["thickness"] if making else np.zeros(self.n))
        modulus = drawn["central" if MODULUS in known else "resin"]
        relaxation = drawn["central" if RELAXATION in known else "resin"]
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
    """The castings of one pad, pressed by the test.

    Attributes
    ----------
    castings : Castings
    law : ForceLaw
        Of the pad as cast.
    candidate : Candidate
    space : SearchSpace
    tolerances : Tolerances
    """

    castings: Castings
    law: ForceLaw
    candidate: Candidate
    space: SearchSpace
    tolerances: Tolerances

    @cached_property
    def error(self) -> float:
        """Largest stated error of the force law over the pressed depths; 0 where none is stated."""
        depth = self.candidate.evaluation.depth_mm[self.candidate.index]
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
    def over_tissues(self) -> dict[int, tuple[NDArray, ...]]:
        """Scores of the first castings for every tissue, by how many; filled where they are first wanted."""
        return {}

    @cached_property
    def every(self) -> Evaluation:
        """Scores and presses of all castings with nothing known."""
        return self.pressed()

    def depth_band_mm(self, force_N: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Depths between which 95 % of the castings are at steady forces, and the share that is out of reach.

        Parameters
        ----------
        force_N : ndarray, shape (m,)

        Returns
        -------
        stiff, soft : ndarray, shape (m,)
            NaN where that casting does not reach the force. [mm]
        unreached : ndarray, shape (m,)
            Share of castings that do not reach each force.
        """
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

    Parameters
    ----------
    law : ForceLaw
        Of the pad as cast.
    pours : Pours
    space : SearchSpace
    """
    smallest, largest = law.ratio_range
    thickness = np.clip(pours.thickness_mm, space.radius_mm / largest, space.radius_mm / smallest)
    low, high = float(thickness.min()), float(thickness.max())
    nodes = np.linspace(low, high, NODES) if high > low else np.array([low])
    place = np.rint((thickness - low) / max(high - low, 1e-12) * (len(nodes) - 1)).astype(int)
    tau = tuple(arm.tau_s.value for arm in space.resin.arms)
    return Slabs(make_curves(law, nodes, space.radius_mm), place, pours.young_MPa, tau, pours.beta)

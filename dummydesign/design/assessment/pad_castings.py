"""The castings of one pad, pressed: readings, shares as poured, with the resin known and after a puck, verdict."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.serialise import Serialised
from dummydesign.design.scoring.castings import FORCE_LAW, MODULUS, RELAXATION, RESIN, Castings, Pours, Tolerances
from dummydesign.design.scoring.crowns import FiniteStrain, crowned_curves
from dummydesign.design.scoring.outlook import Outlook
from dummydesign.design.scoring.press_simulation import PadBatch, SlabCurves, make_curves, steady_depth
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import (
    CLASSES,
    OUTCOMES,
    WITH_CORRECTION,
    Readings,
    Verdict,
    classes,
    deviations,
    factor_of,
    good_share,
    ranges_of,
    shares_of,
    verdict,
)
from dummydesign.design.scoring.windows import CACHED, readings_along
from dummydesign.pad.force_law import ForceLaw

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import DesignCandidate, SearchSpace


# Even steps of thickness at which pours are pressed, and the share of a limit from which a design lies at it.
NODES, AT_LIMIT = 41, 0.99
# Moduli over that of the ratio's centre at which batches of one ratio are pressed.
MODULI = np.exp(np.linspace(-2.0, 2.0, 801))


@dataclass(frozen=True)
class PadCastings:
    """The castings of one pad, pressed by the test; ``outlook`` has its ratios.

    Their readings are the quick ones with what ``finite_strain`` makes of them. ``first`` are as many castings as were
    requested, where these are more.
    """

    castings: Castings
    law: ForceLaw
    candidate: DesignCandidate
    space: SearchSpace
    tolerances: Tolerances
    outlook: Outlook
    finite_strain: FiniteStrain
    first: PadCastings | None = None
    _curves: dict[tuple[bytes, ...], Portions] = field(default_factory=dict, repr=False, compare=False)

    @cached_property
    def error(self) -> float:
        """Largest stated error of the force law over the pressed depths."""
        depth = self.candidate.depth_mm
        known = depth[np.isfinite(depth)]
        stated = np.asarray(self.law.relative_error(known, self.candidate.thickness_mm, self.space.radius_mm))
        return float(np.max(stated, initial=0.0))

    def pours(self, known: Collection[str] = (), ratio: float | NDArray | None = None) -> Pours:
        """See :meth:`Castings.pours`; of other ratios where they are given."""
        at = self.candidate.ratio if ratio is None else ratio
        return self.castings.pours(self.candidate.thickness_mm, at, self.tolerances, self.error, known)

    def slabs(self, pours: Pours) -> Iterator[PadBatch]:
        """Pours as designs to press, one portion after the other: a crown of its own takes a curve of its own."""
        crowns = () if pours.crowns is None else (pours.crowns.higher_mm, pours.crowns.blunter)
        shape = tuple(one.tobytes() for one in (pours.thickness_mm, *crowns))
        if shape not in self._curves:
            self._curves[shape] = poured_curves(self.law, pours, self.space)
        for start in range(0, len(pours.young_MPa), CACHED):
            rows = slice(start, start + CACHED)
            curves, index = self._curves[shape](start)
            resin, young = self.space.resin, pours.young_MPa[rows]
            yield PadBatch(curves, index, young, resin.tau_s, pours.beta[rows], resin.pressed_force)

    def pressed(self, pours: Pours) -> Readings:
        """Readings of pours, shapes (n, c) and (n, g)."""
        targets, sampling = self.space.targets, self.space.sampling.coarse
        grid = targets.protocol.steady_grid_N
        parts = [vars(readings_along(some, targets, grid, sampling)).values() for some in self.slabs(pours)]
        quick = Readings(*(np.concatenate(column) for column in zip(*parts)))
        return self.finite_strain.judged(quick, pours.finite_strain)

    def kinds(self, readings: Readings) -> NDArray:
        """Class of each of several pads for the subjects, shape (n,), as places in ``CLASSES``."""
        targets = self.space.targets
        return classes(deviations(ranges_of(targets), readings), targets.limits)

    def readings(self, known: Collection[str] = (), ratio: float | NDArray | None = None) -> Readings:
        """Readings of all castings."""
        return self._poured if not known and ratio is None else self.pressed(self.pours(known, ratio))

    @cached_property
    def _poured(self) -> Readings:
        return self.pressed(self.pours())

    @property
    def few(self) -> PadCastings:
        """As many castings as were requested: more are drawn for what decides the level alone."""
        return self.first or self

    @cached_property
    def resin_known(self) -> Readings:
        """Readings of castings of the resin's centre, at the ratio chosen for it; of few where these are alike."""
        if self.first and len(np.unique(self.kinds(self.first.resin_known))) == 1:
            return self.first.resin_known
        return self.readings(RESIN, self.outlook.known_ratio)

    @cached_property
    def after_puck(self) -> Readings:
        """Readings of the search's castings, with the ratio chosen anew for each batch after one puck."""
        return self.few.readings((), self.outlook.ratios)

    def steady_depth_mm(self, force_N: ArrayLike, known: Collection[str] = ()) -> NDArray:
        """Depths of all castings at steady forces (m,) of the slowest speed, shape (n, m); NaN out of reach."""
        slow, sampling = self.space.targets.protocol.slow_mm_s, self.space.sampling.coarse
        parts = [steady_depth(some, force_N, slow, sampling) for some in self.slabs(self.pours(known))]
        return np.concatenate(parts)

    def depth_band_mm(self, force_N: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Depths between which 95 % of the castings are at steady forces, and the share that is out of reach."""
        depth = self.steady_depth_mm(force_N)
        # a casting out of reach is deeper than those in reach
        ordered = np.sort(np.where(np.isfinite(depth), depth, np.inf), axis=0)
        ends = (ordered[int(np.floor(share * (len(depth) - 1)))] for share in (0.025, 0.975))
        stiff, soft = (np.where(np.isfinite(end), end, np.nan) for end in ends)
        return stiff, soft, np.mean(~np.isfinite(depth), axis=0)


Portions = Callable[[int], tuple[SlabCurves, NDArray]]


def poured_curves(law: ForceLaw, pours: Pours, space: SearchSpace) -> Portions:
    """What gives curves of a portion of pours from one on, and which each has.

    Their thicknesses are taken at the nearest of 41 even steps, a hundredth of a millimetre apart for 0.2 mm either
    way. Pads whose crowns differ have a curve each; those of the last portion are kept.
    """
    smallest, largest = law.ratio_range
    thickness = np.clip(pours.thickness_mm, space.radius_mm / largest, space.radius_mm / smallest)
    low, high = float(thickness.min()), float(thickness.max())
    nodes = np.linspace(low, high, NODES) if high > low else np.array([low])
    index = np.rint((thickness - low) / max(high - low, 1e-12) * (len(nodes) - 1)).astype(int)
    size = space.radius_mm, space.targets.limits.gel_compression
    curves, crowns = make_curves(law, nodes, *size), pours.crowns
    if crowns is None:
        return lambda start: (curves, index[start : start + CACHED])
    made = crowned_curves(law, crowns, float(np.median(thickness)), *size)

    @lru_cache(maxsize=1)
    def portion(start: int) -> tuple[SlabCurves, NDArray]:
        rows = slice(start, start + CACHED)
        own = index[rows]
        return made(crowns.take(rows), curves.take(own)), np.arange(len(own))

    return portion


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
        ranges_of(space.targets),
        candidate.readings,
        cast.readings(),
        bound,
        known=cast.resin_known,
        limits=space.targets.limits,
        beyond=beyond,
        measure="the cast pad" if space.resin.measured else "one puck",
        after_puck=None if space.resin.measured else cast.after_puck,
    )


@dataclass(frozen=True)
class Share(Serialised):
    """Exclusive shares of one set of castings, which sum to 1, at a ratio or, batch by batch, between two.

    ``usable`` are those that stand for the subjects and those that need a correction together.
    """

    also: ClassVar[tuple[str, ...]] = ("usable",)

    ratio: float | tuple[float, float]
    stands_for: float
    with_correction: float
    reads_low: float
    over: float
    out_of_reach: float
    standard_error: float

    @property
    def usable(self) -> float:
        """Share that the screen calls usable."""
        return self.stands_for + self.with_correction


@dataclass(frozen=True)
class AfterPuck(Share):
    """The same with the ratio chosen anew for each batch; ``no_ratio`` is the share of batches that none fits.

    ``factor`` is by what readings are multiplied so that those of 95 % of the castings in reach are below no subject's;
    ``force_factor`` that for forces alone.
    """

    no_ratio: float
    no_ratio_reason: str | None
    factor: float | None
    force_factor: float | None


@dataclass(frozen=True)
class Shares(Serialised):
    """Castings of one pad: all unknown; the resin at its centre; every batch after one puck of it."""

    as_poured: Share
    resin_known: Share
    after_puck: AfterPuck
    window_kPa: tuple[float, float] | None


def shares_of_pad(cast: PadCastings) -> Shares:
    """Count the castings of a pad as poured, with the resin known, and after a puck."""
    targets, outlook = cast.space.targets, cast.outlook
    ranges, limits = ranges_of(targets), targets.limits

    def share(readings: Readings) -> dict[str, float]:
        found = shares_of(deviations(ranges, readings), limits)
        good, count = good_share(found, ranges.strict), len(readings.peak_N)
        return {**found, "standard_error": float(np.sqrt(good * (1.0 - good) / count))}

    after, none = cast.after_puck, ~outlook.possible
    differences = deviations(ranges, after)
    kinds = classes(differences, limits)[none]
    counts = {name: int((kinds == CLASSES.index(name)).sum()) for name in OUTCOMES}
    most = max(counts, key=lambda name: counts[name])
    reason = OUTCOMES[most] if none.any() and counts[most] else None
    ends = (float(outlook.ratios.min()), float(outlook.ratios.max()))
    short, _, force = differences.quantiles
    return Shares(
        Share(cast.candidate.ratio, **share(cast.readings())),
        Share(outlook.known_ratio, **share(cast.resin_known)),
        AfterPuck(
            ends,
            **share(after),
            no_ratio=float(none.mean()),
            no_ratio_reason=reason,
            factor=factor_of(short),
            force_factor=factor_of(force),
        ),
        window_kPa(cast),
    )


def window_kPa(cast: PadCastings) -> tuple[float, float] | None:
    """Moduli between which batches of the ratio to pour are usable, the pad as designed; None without any. [kPa]

    All relax as the resin's centre does at this ratio: batches of one ratio differ in modulus, and a stiffer one does
    not relax less, as one of another ratio does.
    """
    space, ratio, count = cast.space, cast.candidate.ratio, len(MODULI)
    young = space.resin.young_MPa(ratio) * MODULI
    beta = np.tile([term.beta for term in space.resin.prony(ratio)], (count, 1))
    read = cast.pressed(Pours(np.full(count, cast.candidate.thickness_mm), young, beta, np.zeros(count)))
    # on the safe side no casting has the second of the two classes
    good = cast.kinds(read) <= CLASSES.index(WITH_CORRECTION)
    usable = 1e3 * young[good]
    return (float(usable[0]), float(usable[-1])) if len(usable) else None


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
    cast, targets, best = cast.few, cast.space.targets, cast.candidate
    known = (MODULUS, RELAXATION, FORCE_LAW)
    forces = targets.protocol.forces_N
    depths = cast.steady_depth_mm(forces), cast.steady_depth_mm(forces, known), best.depth_mm[: len(forces)]
    inside, making, nominal = (_inside(depth, targets) for depth in depths)
    # shares inside wherever the nominal pad is
    stays = [float(one[:, nominal].all(axis=-1).mean()) if nominal.any() else 0.0 for one in (inside, making)]
    every, made = (dict(zip((f"{f:g}" for f in forces), one.mean(axis=0).tolist())) for one in (inside, making))
    spread = 100.0 * float(np.std(np.log(cast.pours(known).young_MPa)))
    judged = tuple(float(force) for force in np.array(forces)[nominal])
    return PourYield(stays[0], judged, stays[1], every, made, spread, cast.castings.n, cast.tolerances)


def _inside(depth_mm: NDArray, targets: Targets) -> NDArray:
    """Whether depths at the test's forces, (m,) or (n, m), are inside the steady-state range."""
    stiff, soft = targets.depth_range_mm(np.array(targets.protocol.forces_N))
    with np.errstate(invalid="ignore"):
        return np.asarray((depth_mm >= stiff) & (depth_mm <= soft))

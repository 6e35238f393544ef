"""Windows of moduli in which a pad is usable, batch by batch, and the shares of castings that follow from them.

At a given shape and thickness the readings of a pad depend on the modulus by scale and on the relaxation smoothly. So
each batch of a resin has a window of moduli in which the pad is usable; a recipe puts the batch somewhere along it, and
the making of the pad scatters it there. What is wanted of the castings is then an integral over windows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.crowns import EXACT, FiniteStrain
from dummydesign.design.scoring.press_simulation import (
    PadBatch,
    PadRows,
    Sampling,
    SlabCurves,
    rest_after_hold,
    take_rows,
)
from dummydesign.design.scoring.score import press_all
from dummydesign.design.scoring.settings import VerdictLimits
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import Deviations, Ranges, Readings, deviations, ranges_of
from dummydesign.resin.model.resin import Draws

# Moduli of each batch that are pressed, even in ln E about the pad's own, how far, and steady forces that are compared.
NODES, REACH, STEADY = 12, 0.9, 9
# Fine grid of ln E over which windows are kept, and how far beyond the nodes.
FINE, MARGIN = 241, 0.3
# Designs whose windows are worked out at once: more only take memory; and whose presses stay in the processor's cache.
AT_ONCE, CACHED = 20_000, 2400


@dataclass(frozen=True, eq=False)
class Batches:
    """n batches: ln modulus (n, R) over the ratios of a search [MPa], and what their relaxation follows from."""

    draws: Draws
    ratio: NDArray
    log_young: NDArray
    log_reference: NDArray

    @classmethod
    def of(cls, draws: Draws, ratio: NDArray, count: int) -> Batches:
        """The first of the draws."""
        kept = take_rows(draws, slice(count))
        young = np.stack([np.asarray(kept.young_MPa(float(value))) for value in ratio], axis=-1)
        reference = np.asarray(kept.young_MPa(draws.resin.relaxation_ratio_ref))
        # a batch beyond its gel point carries nothing
        return cls(kept, ratio, np.log(np.maximum(young, 1e-7)), np.log(np.maximum(reference, 1e-7)))

    def __len__(self) -> int:
        return len(self.log_young)

    def strengths(self, log_young: NDArray) -> NDArray:
        """Strengths of the arms, shape (n, ..., arms), of batches cured to ln moduli (n, ...)."""
        lead = (slice(None), *([None] * (log_young.ndim - 1)))
        exponent = self.draws.softness_exponent[lead] * (self.log_reference[lead] - log_young)
        return np.asarray(self.draws.beta_ref[(*lead, slice(None))] * np.exp(exponent)[..., None])


def unlike(batches: Batches, count: int) -> Batches:
    """A few batches that stand for all: evenly spaced in the sum of their strengths."""
    order = np.argsort(batches.draws.beta_ref.sum(axis=-1), kind="stable")
    chosen = order[((np.arange(count) + 0.5) / count * len(order)).astype(int)]
    kept = take_rows(batches.draws, chosen)
    return Batches(kept, batches.ratio, batches.log_young[chosen], batches.log_reference[chosen])


@dataclass(frozen=True, eq=False)
class Windows(PadRows):
    """Of P pads and n batches: how far readings are beyond the verdict's limits along ln E.

    ``log_young`` (P, F) is a fine even grid about each pad's own modulus. ``beyond_stands`` and ``beyond_usable``
    (P, n, F) are ln of the largest reading over its limit, at most 0 inside the window; infinite where a force of the
    test is not reached.
    """

    log_young: NDArray
    beyond_stands: NDArray
    beyond_usable: NDArray

    @property
    def stands(self) -> NDArray:
        """Where a pad stands for the subjects, shape (P, n, F)."""
        return self.beyond_stands <= 0.0

    @property
    def usable(self) -> NDArray:
        """Where a pad is usable, shape (P, n, F)."""
        return self.beyond_usable <= 0.0


def readings_along(slabs: PadBatch, targets: Targets, forces_N: NDArray, sampling: Sampling) -> Readings:
    """Readings of designs alone, without scores: the rise is enough, for the force falls in the hold."""
    rise, parts = replace(sampling, hold_points=0), list[list[NDArray]]()
    for start in range(0, len(slabs.slab), CACHED):
        own = slabs.take(np.arange(start, min(start + CACHED, len(slabs.slab))))
        depth, presses = press_all(own, targets, forces_N, rise)
        columns = [np.stack([getattr(one, name) for one in presses], axis=-1) for name in ("peak_N", "energy_mJ")]
        parts.append([*columns, depth])
    return Readings(*(np.concatenate(column) for column in zip(*parts)))


def coarse_ranges(targets: Targets) -> Ranges:
    """The subjects' ranges with a few steady forces, enough for a window."""
    whole = ranges_of(targets)
    chosen = np.unique(np.linspace(0, len(whole.steady_N) - 1, STEADY).round().astype(int))
    return replace(
        whole, steady_N=whole.steady_N[chosen], stiff_mm=whole.stiff_mm[chosen], soft_mm=whole.soft_mm[chosen]
    )


def excess(differences: Deviations, limits: VerdictLimits) -> tuple[NDArray, NDArray]:
    """ln of the largest reading over its limit, to stand for people and to be usable, each (n,); NaN unreached."""
    with np.errstate(invalid="ignore", divide="ignore"):
        short, over = np.log(differences.shortfall), np.log(differences.over)
    if differences.ranges.strict:
        alone = short - np.log(limits.stands_shortfall)
        return alone, alone
    stands, usable = (
        np.maximum(short - np.log(low), over - np.log(high))
        for low, high in ((limits.stands_shortfall, limits.stands_over), (limits.shortfall, limits.over))
    )
    return stands, usable


def windows_of(
    curves: SlabCurves,
    centre: NDArray,
    batches: Batches,
    targets: Targets,
    sampling: Sampling,
    nodes: int = NODES,
    finite_strain: FiniteStrain = EXACT,
    deviates: Sequence[float] = (0.0,),
) -> Windows:
    """Press P pads as cured by n batches to moduli about each pad's own; ``centre`` (P,) is its ln E. [ln MPa]

    With several deviates of finite strain all pads come again for each of them.
    """
    pads, count = len(centre), len(batches)
    least = _least_log_young(curves, centre, batches, targets, sampling)
    wanted = centre[:, None, None] + np.linspace(-REACH, REACH, nodes)
    at = np.maximum(wanted, least[..., None] + 1e-6)
    ranges = coarse_ranges(targets)
    beyond = np.empty((2, len(deviates), *at.shape))
    step = max(1, AT_ONCE // (count * nodes))
    for start in range(0, pads, step):
        some = slice(start, min(start + step, pads))
        own = at[some]
        beta = np.moveaxis(batches.strengths(np.moveaxis(own, 0, 1)), 0, 1)
        slab = np.repeat(np.arange(start, start + len(own)), count * nodes)
        strengths, resin = beta.reshape(own.size, -1), batches.draws.resin
        slabs = PadBatch(curves, slab, np.exp(own).ravel(), resin.tau_s, strengths, resin.pressed_force)
        readings = readings_along(slabs, targets, ranges.steady_N, sampling)
        for which, deviate in enumerate(deviates):
            found = excess(deviations(ranges, finite_strain.judged(readings, deviate)), targets.limits)
            beyond[:, which, some] = np.nan_to_num(found, nan=1.0).reshape(2, *own.shape)
    fine = centre[:, None] + np.linspace(-REACH - MARGIN, REACH + MARGIN, FINE)
    reached = fine[:, None] >= least[..., None]
    stands, usable = (
        np.concatenate([np.where(reached, _along(fine, at, values), np.inf) for values in one]) for one in beyond
    )
    return Windows(np.tile(fine, (len(deviates), 1)), stands, usable)


def _least_log_young(
    curves: SlabCurves, centre: NDArray, batches: Batches, targets: Targets, sampling: Sampling
) -> NDArray:
    """ln of the modulus from which each batch (P, n) reaches the largest force inside the depth limit."""
    slow = np.array([targets.protocol.velocities_mm_s])
    bare = np.log(targets.protocol.forces_N[-1] / curves.area_mm2[:, -1])
    least = np.repeat(bare[:, None], len(batches), axis=1)
    for _ in range(3):
        beta = np.moveaxis(batches.strengths(least.T), 0, 1)
        limit = np.repeat(curves.limit_mm, len(batches))[:, None]
        rest = rest_after_hold(beta.reshape(least.size, -1), batches.draws.resin.tau_s, limit, slow, sampling)
        least = bare[:, None] - np.log(rest.min(axis=-1)).reshape(least.shape)
    return np.asarray(least)


def _along(fine: NDArray, at: NDArray, values: NDArray) -> NDArray:
    """Values at nodes (P, n, m), straight between them, along fine grids (P, F); infinite above the last node."""
    found = np.empty((*at.shape[:2], fine.shape[-1]))
    for pad, grid in enumerate(fine):
        for batch in range(at.shape[1]):
            found[pad, batch] = np.interp(grid, at[pad, batch], values[pad, batch], right=np.inf)
    return found

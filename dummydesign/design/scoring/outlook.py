"""What a pad's castings are expected to do at each ratio: as poured, with the resin known, and after one puck."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.settings import VerdictLimits
from dummydesign.design.scoring.verdict import level_number
from dummydesign.design.scoring.windows import Batches, Windows

# Even nodes of a normal distribution for what a puck leaves unknown of the modulus at another ratio: a quarter of its
# deviation apart, for a window has sharp ends.
NORMAL_NODES = np.linspace(-3.0, 3.0, 25)
NORMAL_WEIGHTS = np.exp(-0.5 * NORMAL_NODES**2) / np.exp(-0.5 * NORMAL_NODES**2).sum()
# Shares of two ratios that differ by less are the same; standard errors within which shares of two pads are.
SLACK, SURE = 0.005, 2.0
# A share below this is that of no ratio.
LEAST = 0.01
# What the share of a level is sought above it: castings are drawn, and one may turn out otherwise.
ABOVE = 0.01
# The share that stands for the subjects from which the better level is sought: where fewer can, none will be green.
HALF = 0.5


@dataclass(frozen=True, eq=False)
class Scatter:
    """What scatters the modulus of a pad about its batch's: making and force law, and the error of a puck's test.

    ``making`` is the standard deviation of ln E with the force law's error; ``puck`` that of a puck's modulus, with the
    weighing of its own mix; ``shifts`` (k,) are how far tolerance of thickness moves the windows in ln E, all equally
    likely.
    """

    making: float
    puck: float
    shifts: NDArray


@dataclass(frozen=True)
class Match:
    """How near a pad of modulus E comes to the aim: rms of ln F is sqrt(spread^2 + (ln E - log_young)^2)."""

    log_young: float
    spread: float

    def misfit(self, log_young: NDArray) -> NDArray:
        """Misfit at moduli. [ln MPa -> rms of ln F]"""
        return np.hypot(self.spread, log_young - self.log_young)


@dataclass(frozen=True, eq=False)
class Outlook:
    """Expected shares of usable castings of one pad (that stand for the subjects, on the safe side).

    ``ratio`` is the one to pour first, ``as_poured`` its share and ``stands`` the share that needs no correction;
    ``known_ratio`` and ``known`` are those with the resin at its centre; ``after_puck`` the mean over batches with the
    ratio chosen anew after one puck, ``ratios`` the ratio of each batch then, and ``possible`` (n,) whether any ratio
    will do for it; ``chances`` and ``poured`` (n,) are the batches' own shares after the puck and as poured.
    ``misfit`` is that to the aim after the puck. ``beyond`` is ln of the largest reading over its limit at the resin's
    centre.
    """

    ratio: float
    as_poured: float
    stands: float
    known_ratio: float
    known: float
    after_puck: float
    misfit: float
    beyond: float
    chances: NDArray
    poured: NDArray
    ratios: NDArray
    possible: NDArray

    def ties(self, best: Outlook, poured: bool = False) -> bool:
        """Whether the share after a puck, or as poured, is that of another pad within two standard errors.

        Pads are compared batch by batch, so that what the batches have in common is no error.
        """
        lost = best.poured - self.poured if poured else best.chances - self.chances
        return bool(lost.mean() <= SURE * lost.std() / np.sqrt(len(lost)) + 1e-9)

    def level(self, limits: VerdictLimits, strict: bool) -> int:
        """0 stands for the subjects, 1 usable as poured, 2 usable of an average batch, 3 none of these."""
        return level_number(self.stands, self.as_poured, self.known, limits.share, strict)


def outlook_of(
    windows: Windows,
    central: Windows,
    batches: Batches,
    centre: Batches,
    match: Match,
    scatter: Scatter,
    limits: VerdictLimits,
    strict: bool,
) -> Outlook:
    """Work out the outlook of one pad from the windows of its batches and that of the resin's centre.

    Windows may be several for the same pad, all equally likely, such as for deviates of finite strain; the first are
    those of the middle.
    """
    ratio, count = batches.ratio, len(batches)
    chance = _Chance(windows, scatter)
    best = partial(_best, enough=limits.share, strict=strict)
    misfit = match.misfit(centre.log_young[0])
    each, each_stands = chance(batches.log_young)
    shares = each.mean(axis=0)
    first = int(best(shares, each_stands.mean(axis=0), misfit))
    known, known_stands = _Chance(central, scatter)(centre.log_young)[:, 0]
    best_known = int(best(known, known_stands, misfit))
    beyond = np.interp(
        centre.log_young[0], central.log_young[0], central.beyond_usable[0, 0], left=np.inf, right=np.inf
    )
    if not known[best_known] > LEAST:
        # nowhere usable: where the readings are least beyond the limits
        best_known = int(np.argmin(beyond))
    if not shares[first] > LEAST:
        first = best_known
    mean, spread = _after_puck(batches, first, scatter)
    usable, stands = np.sum([w * chance(mean + spread * z) for z, w in zip(NORMAL_NODES, NORMAL_WEIGHTS)], axis=0)
    chosen = best(usable, stands, match.misfit(mean))
    rows = np.arange(count)
    after = each[rows, chosen]
    return Outlook(
        float(ratio[first]),
        float(shares[first]),
        float(each_stands[:, first].mean()),
        float(ratio[best_known]),
        float(known[best_known]),
        float(after.mean()),
        float(match.misfit(batches.log_young[rows, chosen]).mean()),
        float(beyond[best_known]),
        after,
        each[:, first],
        ratio[chosen],
        windows.usable[0].any(axis=-1),
    )


class _Chance:
    """Probability that a pad of each batch (n,) made for a modulus is usable, and stands for the subjects, (2, n, F):
    over its windows and scatter of making."""

    def __init__(self, windows: Windows, scatter: Scatter) -> None:
        self.grid = grid = windows.log_young[0]
        good = np.stack([windows.usable, windows.stands]).mean(axis=1)
        smooth = smoothed(good.reshape(-1, len(grid)), grid, scatter.making).reshape(good.shape)
        self.table = np.mean([_look(smooth, grid, grid - shift) for shift in scatter.shifts], axis=0)

    def __call__(self, log_young: NDArray) -> NDArray:
        return _look(self.table, self.grid, log_young)


def smoothed(good: NDArray, grid: NDArray, spread: float) -> NDArray:
    """Probability along even grids of ln E that what is made for it is good, made with a normal scatter."""
    sigma = spread / (grid[1] - grid[0])
    far = int(4.0 * sigma + 0.5)
    # of a whole bell, cut off at four deviations; beyond the grid nothing is good
    bell = np.exp(-0.5 * (np.arange(-far, far + 1) / sigma) ** 2)
    bell /= bell.sum()
    steps = np.subtract.outer(np.arange(len(grid)), np.arange(len(grid)))
    weights = np.where(np.abs(steps) <= far, bell[np.clip(steps + far, 0, 2 * far)], 0.0)
    return np.asarray(good.astype(float) @ weights)


def _look(table: NDArray, grid: NDArray, at: NDArray) -> NDArray:
    """Tables (2, n, F) over an even grid at places (F,) or (n, k), straight between; 0 beyond the grid."""
    place = (at - grid[0]) / (grid[1] - grid[0])
    inside = np.clip(place, 0.0, len(grid) - 1.000001)
    left = inside.astype(int)
    share = inside - left
    rows = np.arange(table.shape[1])[:, None]
    value = table[:, rows, left] * (1.0 - share) + table[:, rows, left + 1] * share
    return np.where((place < 0.0) | (place > len(grid) - 1), 0.0, value)


def _best(usable: NDArray, stands: NDArray, misfit: NDArray, enough: float, strict: bool) -> NDArray:
    """Index along the last axis of the ratio of the largest usable share.

    Of those that are as large within a slack it is one of which most stand for the subjects, up to what the level
    needs, where half of them can; of these that of the least misfit.
    """
    # on the safe side more than the share that is needed only reads higher
    held = np.minimum(usable, enough + ABOVE) if strict else usable
    sought = np.where(_as_large(held, enough), np.clip(stands, HALF, enough + ABOVE), 0.0)
    return np.asarray(np.argmin(np.where(_as_large(sought, enough), misfit, np.inf), axis=-1))


def _as_large(share: NDArray, enough: float) -> NDArray:
    """Which shares are the largest within a slack, and enough where that is."""
    most = share.max(axis=-1, keepdims=True)
    return np.asarray(share >= np.where(most >= enough, np.maximum(most - SLACK, enough), most - SLACK))


def _after_puck(batches: Batches, first: int, scatter: Scatter) -> tuple[NDArray, NDArray]:
    """Mean (n, R) and standard deviation (R,) of ln E at each ratio once a puck of one ratio has been pressed.

    What is known of the resin ties its moduli at other ratios to the measured one; the tie is taken as linear in ln E,
    as of jointly normal moduli. The puck's own error is drawn.
    """
    log_young = batches.log_young
    centre, own = log_young.mean(axis=0), log_young[:, first]
    away, error = log_young - centre, scatter.puck
    variance = max(float(own.var()), 1e-12)
    slope = (away * away[:, [first]]).mean(axis=0) / variance
    rest = np.var(away - away[:, [first]] * slope, axis=0)
    believed = variance / (variance + error**2)
    measured = away[:, first] + error * np.random.default_rng(PUCK_SEED).standard_normal(len(own))
    mean = centre + (believed * measured)[:, None] * slope
    return mean, np.sqrt(rest + slope**2 * variance * (1.0 - believed))


PUCK_SEED = 53

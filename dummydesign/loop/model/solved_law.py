"""Force laws of set-ups without a response table of their own: pads solved by finite elements, and mixtures of laws.

A law is bound to trials before it is asked (``on``): each row then has the curve of its own pad.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.model.solved_curve import DENSE, THICKER, SolvedCurve
from dummydesign.measurement.campaign import Trial

OUTLINE_ERROR = 0.01
"""Error of taking a square for the circle of its area on a pad whose own factor is not solved."""
THICKNESS_SLOPE = 1.0
"""-d ln F / d ln h of a usual pad (0.7 at 15 mm, 1.4 at 5 mm), for the error of a measured thickness."""


ROUGHNESS = 0.0015
"""Relative roughness over depth of a pad whose contact grows cell by cell: crowns of 7, 10 and 14 mm on 24 and on 32
cells differ by 0.12 to 0.18 % (root mean square) beside a parabola in depth. Taken for other growing contacts too."""


def error_priors(own: tuple, relative_error: float, outline: bool, thickness: float) -> tuple:
    """Median size and spread of the law error: the usual one with the stated error of a solve and of thickness.

    Parameters
    ----------
    own : tuple
        Of a law without further error: (size, spread) of level, slope and curvature.
    relative_error : float
        Stated by the solve, 95 %.
    outline : bool
        Whether a square was taken for a circle.
    thickness : float
        Standard error of a measured thickness over the thickness.
    """
    solved = 0.5 * relative_error
    shape = OUTLINE_ERROR if outline else 0.0
    more = ((solved, shape, THICKNESS_SLOPE * thickness), (solved, shape, 0.0), (0.5 * solved, 0.0, 0.0))
    return tuple((float(np.linalg.norm([size, *added])), spread) for (size, spread), added in zip(own, more))


@dataclass(frozen=True)
class SolvedLaw:
    """Pads of one shape, each with its own solved curve.

    Attributes
    ----------
    curves : dict
        By the pad's thickness as declared. [mm]
    shape : str
        ``shaped``, or ``cylinder`` for pucks.
    offers : frozenset of str
        What effects may ask of it, see :data:`dummydesign.loop.model.effect.SETUP`.
    error_priors : tuple
    rough : float
        Standard deviation of what the solve leaves beside a smooth error, see :data:`ROUGHNESS`.
    """

    curves: dict[float, SolvedCurve]
    shape: str
    offers: frozenset[str]
    error_priors: tuple
    rough: float = 0.0

    def roughness(self, pad: tuple[str, float]) -> float:
        """Relative roughness of the force on a pad, given by shape and thickness."""
        return self.rough

    def on(self, trials: Sequence[Trial]) -> BoundLaw:
        """The law of these trials, row by row."""
        return BoundLaw(self, np.array([trial.thickness_mm for trial in trials]))

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2] of depths (T, N) on pads as thick as declared (T, 1)."""
        rows = np.broadcast_to(np.asarray(thickness_mm, float), (len(depth_mm), 1))[:, 0]
        return BoundLaw(self, rows)(depth_mm, rows[:, None])

    def limit(self, thickness_mm: NDArray) -> NDArray:
        """Depth to which each pad was solved. [mm]"""
        thickness = np.asarray(thickness_mm, float)
        return np.array([self.curve(float(h)).limit_mm for h in thickness.ravel()]).reshape(thickness.shape)

    def curve(self, thickness_mm: float) -> SolvedCurve:
        """The curve of a pad, of the nearest where none is of its thickness."""
        return self.curves[min(self.curves, key=lambda h: abs(np.log(h / thickness_mm)))]


class BoundLaw:
    """A solved law for given trials: (T,) rows, each on the curve of its pad."""

    def __init__(self, law: SolvedLaw, thickness_mm: NDArray) -> None:
        self.shape, self.offers, self.error_priors = law.shape, law.offers, law.error_priors
        self.radius_mm = next(iter(law.curves.values())).pad.radius_mm
        self._curves = [law.curve(float(h)) for h in thickness_mm]
        self._own = list(dict.fromkeys(id(curve) for curve in self._curves))
        self._row = np.array([self._own.index(id(curve)) for curve in self._curves], dtype=int)
        self._unique = [next(c for c in self._curves if id(c) == one) for one in self._own]
        self._power = np.array([[curve.power] for curve in self._curves])
        self._limit = np.array([[curve.limit_mm] for curve in self._curves])
        self._thickness = np.array([[curve.pad.thickness_mm] for curve in self._curves])
        self._kept: dict[str, NDArray] = {}

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2]; beyond the solved depth the last secant goes on."""
        depth = np.maximum(depth_mm, 0.0)
        log = self._at("secant", depth, lambda curve: curve.log_secant)
        change = np.log(np.asarray(thickness_mm, float) / self._thickness)
        if np.any(np.abs(change) > 1e-12):
            held = np.clip(change, -np.log(THICKER), np.log(THICKER))
            first = self._at("first", depth, lambda curve: curve.with_thickness[0])
            second = self._at("second", depth, lambda curve: curve.with_thickness[1])
            log = log + first * change + second * held * (2.0 * change - held)
        return depth**self._power * np.exp(log)

    def sliding(self) -> Callable[[NDArray, NDArray], NDArray]:
        """The same pads on a base that slides."""

        def slid(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            factor = self._at("sliding", np.maximum(depth_mm, 0.0), lambda curve: curve.log_sliding)
            return np.exp(factor) * self(depth_mm, thickness_mm)

        return slid

    def give(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """c of a compressible pad, F / (1 + (1 - 2 nu) c)."""
        return self._at("give", np.maximum(depth_mm, 0.0), lambda curve: curve.give)

    def _at(self, name: str, depth: NDArray, values: Callable[[SolvedCurve], NDArray]) -> NDArray:
        """Values of each row's curve at depths (T, N), linear between the dense ones, constant outside."""
        if name not in self._kept:
            self._kept[name] = np.stack([values(curve) for curve in self._unique])
        table = self._kept[name]
        place = np.minimum(depth / self._limit, 1.0) * (DENSE - 1)
        low = np.minimum(place.astype(int), DENSE - 2)
        part = place - low
        row = np.broadcast_to(self._row[:, None], low.shape)
        return table[row, low] * (1.0 - part) + table[row, low + 1] * part


@dataclass(frozen=True)
class MixedLaw:
    """Pads of several shapes in one campaign.

    Attributes
    ----------
    laws : dict
        By shape as typed, empty for slabs (see :attr:`Trial.pad`).
    """

    laws: dict[str, object]
    shape: str = "shaped"

    def roughness(self, pad: tuple[str, float]) -> float:
        """Relative roughness of the force on a pad, given by shape and thickness."""
        return getattr(self.laws[pad[0]], "rough", 0.0)

    @property
    def offers(self) -> frozenset[str]:
        """What every pad offers."""
        return frozenset.intersection(*(law.offers for law in self.laws.values()))

    @property
    def error_priors(self) -> tuple:
        """The largest of each term."""
        return tuple(max(terms) for terms in zip(*(law.error_priors for law in self.laws.values())))

    def on(self, trials: Sequence[Trial]) -> BoundMixture:
        """The law of these trials, row by row."""
        return BoundMixture(self, trials)

    def limit_of(self, trials: Sequence[Trial]) -> NDArray:
        """Depth to which the law of each trial's pad holds. [mm]"""
        return np.array([float(np.squeeze(self.laws[t.pad[0]].limit(np.array(t.thickness_mm)))) for t in trials])


class BoundMixture:
    """A mixture of laws for given trials."""

    def __init__(self, mixed: MixedLaw, trials: Sequence[Trial]) -> None:
        self.shape, self.offers, self.error_priors = mixed.shape, mixed.offers, mixed.error_priors
        names = np.array([trial.pad[0] for trial in trials])
        self._count = len(trials)
        self._parts = []
        for name in dict.fromkeys(names.tolist()):
            rows = np.nonzero(names == name)[0]
            self._parts.append((rows, mixed.laws[name].on([trials[row] for row in rows])))
        self.radius_mm = self._parts[0][1].radius_mm

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2]."""
        return self._joined(depth_mm, thickness_mm, [law for _, law in self._parts])

    def sliding(self) -> Callable[[NDArray, NDArray], NDArray]:
        """The same pads on a base that slides."""
        laws = [law.sliding() for _, law in self._parts]
        return lambda depth_mm, thickness_mm: self._joined(depth_mm, thickness_mm, laws)

    def give(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """c of a compressible pad."""
        return self._joined(depth_mm, thickness_mm, [law.give for _, law in self._parts])

    def _joined(self, depth_mm: NDArray, thickness_mm: NDArray, laws: Sequence[Callable]) -> NDArray:
        depth = np.asarray(depth_mm, float)
        thickness = np.broadcast_to(np.asarray(thickness_mm, float), (self._count, 1))
        out = np.empty((self._count, depth.shape[1]))
        for (rows, _), law in zip(self._parts, laws):
            out[rows] = law(depth[rows], thickness[rows])
        return out

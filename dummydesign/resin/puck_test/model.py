"""The model of a puck pressed with holds: force of the bins, starts, least squares, criterion.

See :mod:`dummydesign.resin.puck_test.relaxation_fit` for the law and the references.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.inference.least_squares import solve_by_differences
from dummydesign.inference.model_selection import aicc
from dummydesign.pad.tables.pucks.response import PuckTable, uniaxial
from dummydesign.resin.puck_test.noise import PuckNoise, whitener
from dummydesign.resin.puck_test.reduction import PuckPress

Array = np.ndarray

ALPHA_RANGE = (1.0, 6.0)
LARGEST_OFFSET = 0.04
STRENGTHS = (1e-4, 30.0)


@dataclass(frozen=True, eq=False)
class Trial:
    """Best parameters at one friction, with whitened residuals (bins,) and Jacobian (bins, parameters)."""

    grip: float
    parameters: Array
    chi_square: float
    residual: Array
    jacobian: Array


class PuckProblem:
    """One press: parameters ln E [kPa], alpha, offset over height, then ln beta of the arms, then ln tau [s]."""

    def __init__(self, press: PuckPress, diameter_mm: float, height_mm: float, table: PuckTable) -> None:
        self.press, self.height_mm, self.table = press, height_mm, table
        self.area = 0.25e-3 * np.pi * diameter_mm**2
        self._smooth: dict[float, Callable[[float, Array], Array]] = {}
        self.step = np.diff(press.time_s)
        self.longest = max(hold.duration_s for hold in press.holds)
        shortest = float(np.min(press.end_s - press.start_s))
        self.times = (max(shortest, 1e-4 * self.longest), 10.0 * self.longest)
        self.factor = whitener(press, height_mm, PuckNoise(press.white_N, 1e-3 * press.force_N.max(), 1.0, 0.02))

    def elastic(self, alpha: float, grip: float, offset: float) -> Array:
        """Long-term force over E at the nodes, zeroed where the displacement is zero. [N/kPa]

        Parameters
        ----------
        alpha : float
            Exponent of the one-term Ogden law.
        grip : float
            Friction coordinate of the plates, from 0 (sliding) to 1 (bonded).
        offset : float
            Compression at which the plate touches the puck in truth, over its height.

        Returns
        -------
        ndarray, shape (nodes,)
            Force over Young's modulus. [N/kPa]
        """
        place = np.r_[0.0, self.press.displacement_mm] / self.height_mm
        c = np.maximum(place - offset, 0.0)
        load = self.area * uniaxial(alpha, c) * np.exp(self._log_factor(grip)(alpha, c))
        return load[1:] - load[0]

    def _log_factor(self, grip: float) -> Callable[[float, Array], Array]:
        """ln B of one friction, smooth in alpha and compression: kinks would halt the search."""
        if grip not in self._smooth:
            self._smooth[grip] = _smooth_log_factor(self.table, grip)
        return self._smooth[grip]

    def arm(self, elastic: Array, tau_s: float) -> Array:
        """Force of an arm of strength one at the nodes, exact for forces that are linear between them."""
        ratio = self.step / tau_s
        rise = np.diff(elastic) * (-np.expm1(-ratio) / ratio)
        return np.r_[0.0, linear_recurrence(np.exp(-ratio), rise)]

    def predict(self, q: Array, grip: float) -> Array:
        """Force of the bins. [N]"""
        arms = (len(q) - 3) // 2
        elastic = self.elastic(q[1], grip, q[2])
        total = elastic.copy()
        for beta, tau in zip(np.exp(q[3 : 3 + arms]), np.exp(q[3 + arms :])):
            total += beta * self.arm(elastic, tau)
        return np.exp(q[0]) * (self.press.average @ total)

    def residual(self, q: Array, grip: float) -> Array:
        """Logarithm of fitted over measured force of the bins."""
        return np.log(np.maximum(self.predict(q, grip), 1e-9) / self.press.force_N)

    def box(self, arms: int) -> tuple[Array, Array]:
        """Lowest and highest parameters."""
        weak, strong = np.log(STRENGTHS)
        short, long = np.log(self.times)
        low = [-20.0, ALPHA_RANGE[0], -LARGEST_OFFSET, *[weak] * arms, *[short] * arms]
        high = [20.0, ALPHA_RANGE[1], LARGEST_OFFSET, *[strong] * arms, *[long] * arms]
        return np.array(low), np.array(high)

    def starts(self, arms: int, grip: float, count: int = 2) -> list[Array]:
        """The best of all combinations of times on a grid, E and strengths by non-negative least squares.

        Parameters
        ----------
        arms : int
            Maxwell branches of the relaxation.
        grip : float
            Friction coordinate of the plates, from 0 (sliding) to 1 (bonded).
        count : int
            How many of the best starts are returned.

        Returns
        -------
        list of ndarray
            Each ln E (kPa), alpha, offset, then ln beta and ln tau (s) of the branches.
        """
        from scipy.optimize import nnls

        found = []
        grid = np.geomspace(3.0 * self.times[0], 0.6 * self.longest, 9)
        for alpha in (1.5, 3.0):
            elastic = self.elastic(alpha, grip, 0.0)
            forces = np.stack([elastic, *(self.arm(elastic, tau) for tau in grid)], axis=1)
            columns = self.factor @ ((self.press.average @ forces) / self.press.force_N[:, None])
            goal = self.factor @ np.ones(len(columns))
            for combo in itertools.combinations(range(len(grid)), arms):
                strength, rest = nnls(columns[:, [0, *(1 + k for k in combo)]], goal)
                if strength[0] > 0.0:
                    beta = np.clip(strength[1:] / strength[0], 1e-3, 10.0)
                    found.append((rest, [np.log(strength[0]), alpha, 0.0, *np.log(beta), *np.log(grid[list(combo)])]))
        found.sort(key=lambda pair: pair[0])
        return [np.array(q) for _, q in found[:count]]

    def fit(self, starts: list[Array], grip: float) -> Trial:
        """Trust-region least squares of the whitened residuals; arms in the order of their times."""
        arms = (len(starts[0]) - 3) // 2
        best = solve_by_differences(
            lambda q: self.factor @ self.residual(q, grip), starts, *self.box(arms), tolerance=1e-7, most=60
        )
        assert best.residual is not None and best.jacobian is not None
        order = np.argsort(best.parameters[3 + arms :])
        columns = np.r_[0, 1, 2, 3 + order, 3 + arms + order]
        return Trial(grip, best.parameters[columns], best.chi_square, best.residual, best.jacobian[:, columns])

    def aicc(self, found: Trial) -> float:
        """Corrected Akaike criterion under the whitening of now; friction and two sizes of noise are counted."""
        fit = found.chi_square - 2.0 * float(np.log(np.diag(self.factor)).sum())
        return aicc(fit, len(found.parameters) + 3, len(found.residual))


def _smooth_log_factor(table: PuckTable, grip: float) -> Callable[[float, Array], Array]:
    """Cubic spline of ln B over compression, a polynomial through the table's values of alpha."""
    from scipy.interpolate import CubicSpline

    rows = np.stack([np.log(table.factor(alpha, grip, table.compression)) for alpha in table.alpha], axis=1)
    spline = CubicSpline(table.compression, rows)
    low, high = table.compression[[0, -1]]

    def value(alpha: float, c: Array) -> Array:
        at = table.alpha
        weights = [np.prod((alpha - np.delete(at, k)) / (at[k] - np.delete(at, k))) for k in range(len(at))]
        return spline(np.clip(c, low, high)) @ np.array(weights)

    return value

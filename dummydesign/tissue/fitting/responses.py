"""What each arm does to every bin, tabulated over the arm's rate, so that a fit is cheap.

For a given law the force is gamma1 X + sum gamma_i A(t; r_i) with r_i = gamma_i / c_i. X and A pass through
the sensor filter and the bins, both linear, once; A is kept as a cubic spline in ln r.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.sensor import Lowpass
from dummydesign.tissue.fitting.reduction import ReducedTrace
from dummydesign.tissue.model.laws import law_named

PER_DECADE = 10
SLOWEST_PER_S, FASTEST_PER_S = 1e-3, 3e4
"""Decay rates r x^2 at the depths of the traces between which A is tabulated."""


class Responses:
    """X and A(ln r) of several traces, their bins joined in one vector.

    Attributes
    ----------
    elastic : ndarray, shape (bins,)
        X averaged over each bin. [mm3]
    log_rate : tuple of float
        Ends of the tabulated ln r, r in 1 / (mm2 s).
    """

    def __init__(self, law: str, traces: list[ReducedTrace], lowpass: Lowpass | None) -> None:
        from scipy.interpolate import CubicSpline

        depth = [trace.ramp.depth_mm for trace in traces]
        low, high = np.log(SLOWEST_PER_S / max(depth) ** 2), np.log(FASTEST_PER_S / min(depth) ** 2)
        grid = np.linspace(low, high, int(np.ceil((high - low) / np.log(10.0) * PER_DECADE)) + 1)
        elastic, arms = [], []
        for trace in traces:
            drive = law_named(law).drive(trace.motion)
            # by decades: only the fast ones need the fine quadrature
            parts = [drive.arm(np.exp(part)) for part in np.array_split(grid, max(len(grid) // PER_DECADE, 1))]
            curves = np.vstack([drive.elastic[None], *parts])
            if lowpass is not None:
                curves = lowpass.apply(trace.motion.time_s, curves)
            binned = curves @ trace.average.T
            elastic.append(binned[0])
            arms.append(binned[1:])
        self.elastic = np.concatenate(elastic)
        self.log_rate = (float(low), float(high))
        self._spline = CubicSpline(grid, np.concatenate(arms, axis=1))
        self._slope = self._spline.derivative()

    def arm(self, log_rate: float) -> tuple[NDArray, NDArray]:
        """A and dA / d ln r at one ln r, each of shape (bins,). [mm3]

        Faster than the table an arm is a damper, A falls as 1 / r; slower it is a spring.
        """
        low, high = self.log_rate
        if log_rate > high:
            value = self._spline(high) * np.exp(high - log_rate)
            return value, -value
        if log_rate < low:
            return self._spline(low), np.zeros_like(self.elastic)
        return self._spline(log_rate), self._slope(log_rate)

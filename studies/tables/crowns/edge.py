"""The depth at which the contact reaches the punch's edge, from the states that a path passes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_problem import radius_touched
from dummydesign.pad.contact.axisymmetric import AxisymmetricSurface
from dummydesign.pad.solve.continuation import VisitedState
from dummydesign.pad.solve.equilibrium import ContactProblem

Array = np.ndarray

# Radii over the punch's at which the gap is watched.
PLACES = np.linspace(0.4, 1.0, 7)
# A contact that grows by more than this share of the punch within one depth has met the flat around the crown.
JUMP = 0.1
# What is not known of the depth: after a jump (over h, from gaps carried on to 0), where the flat is near at the last
# depth, and where the contact grows to the edge node by node.
MET, NEAR, GROWN = 0.0008, 0.004, 0.008
# A flat that the last state is no further away from than this, in thicknesses, is near.
NEAR_ENOUGH = 0.03


@dataclass
class EdgeWatch:
    """Contact radius and gaps over the punch's radius and the thickness, by depth, as ``visit`` of ``solve_path``."""

    press: Case
    depth: list[float] = field(default_factory=list)
    touched: list[float] = field(default_factory=list)
    gaps: list[Array] = field(default_factory=list)

    def __call__(self, problem: ContactProblem, end: VisitedState) -> None:
        """Note one state."""
        assert isinstance(problem.surface, AxisymmetricSurface), "a crown is touched by a round punch"
        points = problem.surface.points(end.u).reshape(-1, 2)
        points = points[np.argsort(points[:, 0])]
        self.depth.append(end.depth)
        self.touched.append(radius_touched(problem, end.depth, end.u)[0] / self.press.radius)
        self.gaps.append(np.interp(PLACES * self.press.radius, points[:, 0], -points[:, 1] - end.depth))

    def reached(self, foot: float, fillet: float) -> tuple[float, float] | None:
        """d / h at which the edge is reached, and what is not known of it; None where it was not.

        Parameters
        ----------
        foot : float
            Foot radius of the crown over the punch's radius.
        fillet : float
            Of the solve, over the punch's radius.
        """
        return edge_depth(np.array(self.depth), np.array(self.touched), np.array(self.gaps), foot, fillet)


def edge_depth(depth: Array, touched: Array, gaps: Array, foot: float, fillet: float) -> tuple[float, float] | None:
    """See :meth:`EdgeWatch.reached`.

    Parameters
    ----------
    depth : ndarray, shape (n,)
        Increasing, in thicknesses.
    touched : ndarray, shape (n,)
        Contact radius over the punch's.
    gaps : ndarray, shape (n, 7)
        Between face and surface at ``PLACES``, in thicknesses.
    foot, fillet : float
        Over the punch's radius.
    """
    flat = min(0.93, 1.0 - fillet - 0.015)
    n = int(np.argmax(touched >= flat)) if np.any(touched >= flat) else len(touched)
    if n < 4:
        return None
    grew = np.diff(touched[: n + 1])
    jumps = np.nonzero((grew > JUMP) & (touched[:n][: len(grew)] > 0.3) & (touched[1 : n + 1] > 0.7))[0]
    if not len(jumps) and n < len(touched):
        last = slice(max(0, n - 6), n + 1)
        line = np.polyfit(touched[last], depth[last], 1)
        return float(np.clip(np.polyval(line, 1.0), depth[n] - 0.01, depth[n] + 0.05)), GROWN
    m = int(jumps[0]) + 1 if len(jumps) else n
    closing = [_closed(depth[m - 4 : m], gaps[m - 4 : m, k]) for k in _outside(touched[m - 1], foot)] if m >= 4 else []
    first = np.nanmin(closing) if np.isfinite(closing).any() else np.nan
    if len(jumps):
        middle = 0.5 * (depth[m - 1] + depth[m])
        return float(np.clip(first, depth[m - 1], depth[m])) if np.isfinite(first) else float(middle), MET
    return (float(first), NEAR) if foot < 0.8 and first < depth[-1] + NEAR_ENOUGH else None


def _outside(touched: float, foot: float) -> list[int]:
    """Which places are beyond the contact and the foot; the edge always is."""
    return [k for k, r in enumerate(PLACES) if r > 0.999 or r > max(touched + 0.08, 1.1 * foot)]


def _closed(depth: Array, gap: Array) -> float:
    """Depth at which a gap is 0: a parabola through the last four, carried on."""
    if np.any(gap <= 0.0):
        return float("nan")
    roots = np.roots(np.polyfit(depth - depth[-1], gap, 2))
    real = roots[np.abs(roots.imag) < 1e-9].real
    ahead = real[real > -1e-6]
    return float(depth[-1] + ahead.min()) if len(ahead) else float("nan")

"""Force-depth curves of many slabs at once, per unit modulus, ready to be inverted and pressed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.design.scoring.press import Press
from dummydesign.design.scoring.verdict_limits import verdict_limits
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS
from dummydesign.measurement.motion import DECELERATION_MM_S2, HOLD_S, Motion, ramp_and_hold
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.material.relaxation import arms_in_ramp_and_hold

DEPTH_SHARE = MAX_DEPTH_OVER_THICKNESS
"""Largest depth over thickness that is designed for, as in the contract of the commands."""

SAMPLES = 481


@dataclass(frozen=True)
class Curves:
    """Elastic force per unit modulus of T slabs on even depth grids.

    Attributes
    ----------
    thickness_mm : ndarray, shape (T,)
    limit_mm : ndarray, shape (T,)
        Largest depth: the smaller of 0.6 of the thickness and what the force law allows. [mm]
    area_mm2 : ndarray, shape (T, n)
        F / E at depths 0 .. limit, even steps. [mm2]
    """

    thickness_mm: NDArray
    limit_mm: NDArray
    area_mm2: NDArray

    def take(self, chosen: NDArray) -> Curves:
        """Keep the slabs chosen by index, one row for each."""
        return Curves(self.thickness_mm[chosen], self.limit_mm[chosen], self.area_mm2[chosen])

    @property
    def step_mm(self) -> NDArray:
        """Depth step of each slab's grid, shape (T,). [mm]"""
        return self.limit_mm / (self.area_mm2.shape[-1] - 1)

    def area_at(self, slab: NDArray, depth_mm: NDArray) -> NDArray:
        """F / E at depths (D, n) of slabs given by index (D,), on straight lines between the grid. [mm2]"""
        return _lookup(self.area_mm2, slab, depth_mm / self.step_mm[slab][:, None])

    def depth_at(self, slab: NDArray, area_mm2: NDArray) -> NDArray:
        """Depth at which slabs (D,) reach F / E of shape (D,) or (D, n); NaN beyond their limit. [mm]"""
        wanted = np.asarray(area_mm2, float)
        depth = np.full(wanted.shape, np.nan)
        order = np.argsort(slab, kind="stable")
        known, first = np.unique(slab[order], return_index=True)
        for index, rows in zip(known, np.split(order, first[1:])):
            grid = self.step_mm[index] * np.arange(self.area_mm2.shape[-1])
            depth[rows] = np.interp(wanted[rows], self.area_mm2[index], grid, right=np.nan)
        return depth

    def slope_at(self, slab: NDArray, depth_mm: NDArray) -> NDArray:
        """Tangent d(F / E) / d depth at depths (D, n) of slabs (D,), by central differences. [mm]"""
        known, row = np.unique(slab, return_inverse=True)
        slopes = np.gradient(self.area_mm2[known], axis=-1, edge_order=2) / self.step_mm[known, None]
        return _lookup(slopes, row, depth_mm / self.step_mm[slab][:, None])


def _lookup(table: NDArray, slab: NDArray, position: NDArray) -> NDArray:
    """Interpolate rows ``slab`` of a table at positions counted in grid steps; NaN stays NaN."""
    known = np.nan_to_num(np.clip(position, 0.0, table.shape[-1] - 1.0))
    left = np.minimum(known.astype(int), table.shape[-1] - 2)
    share = known - left
    rows = slab[:, None]
    return np.where(np.isnan(position), np.nan, table[rows, left] * (1.0 - share) + table[rows, left + 1] * share)


def make_curves(
    law: ForceLaw, thickness_mm: ArrayLike, radius_mm: float, depth_share: float | None = None
) -> Curves:
    """Sample the force law for slabs of the given thicknesses (T,).

    Parameters
    ----------
    law : ForceLaw
        Response table, or any other of that contract.
    thickness_mm : array_like, shape (T,)
        Thicknesses inside the law's range. [mm]
    radius_mm : float
        Radius of the punch, or of the circle of equal area. [mm]
    depth_share : float, optional
        Largest depth over thickness, by default the verdict's limit of the gel's compression.
    """
    depth_share = verdict_limits().gel_compression if depth_share is None else depth_share
    thickness = np.atleast_1d(np.asarray(thickness_mm, float))
    limit = np.minimum(depth_share * thickness, law.depth_limit_mm(thickness, radius_mm))
    share = np.linspace(0.0, 1.0, SAMPLES)
    area = np.asarray(law.force(limit[:, None] * share, thickness[:, None], 1.0, radius_mm), float)
    return Curves(thickness, limit, area)


def join_curves(curves: Sequence[Curves]) -> Curves:
    """Curves of several force laws as one set, in their order."""
    names = ("thickness_mm", "limit_mm", "area_mm2")
    return Curves(*(np.concatenate([getattr(one, name) for one in curves]) for name in names))


@dataclass(frozen=True)
class Sampling:
    """How finely presses are sampled, and how the robot moves."""

    ramp_points: int = 60
    brake_points: int = 24
    hold_points: int = 60
    hold_s: float = HOLD_S
    deceleration_mm_s2: float = DECELERATION_MM_S2

    @property
    def coarse(self) -> Sampling:
        """The same hold and braking on the grid that serves for maps and for many pours."""
        return Sampling(16, 8, 20, self.hold_s, self.deceleration_mm_s2)

    def motion(self, velocity_mm_s: ArrayLike, depth_mm: NDArray) -> Motion:
        """Ramp and hold to depths (D,)."""
        return ramp_and_hold(
            velocity_mm_s,
            depth_mm,
            self.hold_s,
            self.deceleration_mm_s2,
            self.ramp_points,
            self.brake_points,
            self.hold_points,
        )

    @property
    def stopped(self) -> int:
        """Sample of the stop."""
        return self.ramp_points + self.brake_points


COARSE = Sampling(16, 8, 20)


@dataclass(frozen=True)
class Slabs:
    """D designs: which slab (index into curves), modulus and relaxation of each.

    ``young_MPa`` has shape (D,), ``tau_s`` (arms,), ``beta`` (D, arms), relative to the long-term modulus.
    """

    curves: Curves
    slab: NDArray
    young_MPa: NDArray
    tau_s: tuple[float, ...]
    beta: NDArray

    def take(self, chosen: NDArray) -> Slabs:
        """Keep the designs chosen by index or mask."""
        return Slabs(self.curves, self.slab[chosen], self.young_MPa[chosen], self.tau_s, self.beta[chosen])

    @property
    def thickness_mm(self) -> NDArray:
        """Thickness of each design, shape (D,). [mm]"""
        return self.curves.thickness_mm[self.slab]


def join_slabs(slabs: Sequence[Slabs]) -> Slabs:
    """Designs of one resin on several sets of curves as one set, in their order; each keeps its own curve only."""
    curves = [one.curves.take(one.slab) for one in slabs]
    young, beta = (np.concatenate([getattr(one, name) for one in slabs]) for name in ("young_MPa", "beta"))
    return Slabs(join_curves(curves), np.arange(len(young)), young, slabs[0].tau_s, beta)


def press_to_depth(slabs: Slabs, depth_mm: NDArray, velocity_mm_s: ArrayLike, sampling: Sampling) -> Press:
    """Press every design to its depth (D,), brake, hold: elastic curve with Prony relaxation on top.

    Parameters
    ----------
    slabs : Slabs
        D designs.
    depth_mm : ndarray, shape (D,)
        Depth of each; NaN for out of reach. [mm]
    velocity_mm_s : array_like, shape () or (D,)
        Speed of the ramp. [mm/s]
    sampling : Sampling
        Hold and braking.

    Returns
    -------
    Press
        Rows of NaN force where out of reach.
    """
    reachable = np.isfinite(depth_mm)
    depth = np.where(reachable, depth_mm, slabs.curves.limit_mm[slabs.slab])
    motion = sampling.motion(velocity_mm_s, depth)
    stop, time = sampling.stopped, motion.time_s
    area = slabs.curves.area_at(slabs.slab, motion.displacement_mm[:, : stop + 1])
    # steps are even in the ramp and in the braking, and the hold has the same times in every press
    ramp, braked = time[:, sampling.ramp_points], time[:, stop]
    ramp, braking = ramp / sampling.ramp_points, (braked - ramp) / sampling.brake_points
    steps = [ramp] * sampling.ramp_points + [braking] * sampling.brake_points
    hold = time[0, stop + 1 :] - time[0, stop]
    relative = arms_in_ramp_and_hold(steps, area, hold, slabs.tau_s, slabs.beta)
    relative[: stop + 1] += area.T
    relative[stop + 1 :] += area[:, stop]
    relative *= slabs.young_MPa
    relative[:, ~reachable] = np.nan
    force, reached = np.ascontiguousarray(relative.T), np.where(reachable, depth_mm, np.nan)
    return Press(time, force, braked, reached, motion.displacement_mm, stop)


def steady_depth(
    slabs: Slabs,
    steady_force_N: ArrayLike,
    velocity_mm_s: ArrayLike,
    sampling: Sampling = COARSE,
    exact: bool = False,
) -> NDArray:
    """Depth whose force at the end of the hold is the given one, shape (D,) or (D, n); NaN out of reach.

    Slow arms have not died out by then: beside the relaxed force a share sum beta_i exp(-hold / tau_i) m_i
    is left, m_i = (tau_i / t_p) (1 - exp(-t_p / tau_i)) for a rise at constant rate (t_p = depth / speed).

    Parameters
    ----------
    slabs : Slabs
        D designs.
    steady_force_N : array_like, shape () or (n,)
        Force at the end of the hold. [N]
    velocity_mm_s : array_like, shape () or (n,)
        Speed of the ramp, for all forces or one each. [mm/s]
    sampling : Sampling
        Hold and braking.
    exact : bool
        Take the share from simulated presses instead of the rise at constant rate.
    """
    forces = np.atleast_1d(np.asarray(steady_force_N, float))
    speeds = np.broadcast_to(np.asarray(velocity_mm_s, float), forces.shape)
    elastic = forces / slabs.young_MPa[:, None]
    depth = slabs.curves.depth_at(slabs.slab, elastic)
    if np.exp(-sampling.hold_s / max(slabs.tau_s, default=1e-9)) > 1e-12:
        left = _left_by_press if exact else _left_by_formula
        rows, some, settled = np.arange(len(depth)), slabs, np.zeros(depth.shape, bool)
        for _ in range(8):
            before = depth[rows]
            # depths that are out of reach are tried at the limit: what is left there may bring them in
            tried = np.where(np.isfinite(before), before, some.curves.limit_mm[some.slab][:, None])
            new = some.curves.depth_at(some.slab, elastic[rows] / left(some, tried, speeds, sampling))
            # a depth that has settled stays, so that no design depends on which others are worked out with it
            depth[rows] = np.where(settled, before, new)
            settled |= np.abs(np.nan_to_num(new / tried, nan=1.0) - 1.0) < 1e-6
            going = ~settled.all(axis=-1)
            if not going.any():
                break
            rows, settled, some = rows[going], settled[going], some.take(going)
    return depth if np.ndim(steady_force_N) else depth[:, 0]


def _left_by_formula(slabs: Slabs, depth_mm: NDArray, velocities_mm_s: NDArray, sampling: Sampling) -> NDArray:
    """Force at the end of the hold over the relaxed force for rises at constant rates (n,), shape (D, n)."""
    share = np.ones_like(depth_mm)
    for arm, tau in enumerate(slabs.tau_s):
        kept = np.exp(-sampling.hold_s / tau)
        if kept < 1e-15:
            continue
        rise = depth_mm / (velocities_mm_s * tau)
        share += slabs.beta[:, arm, None] * (kept * -np.expm1(-rise) / rise)
    return share


def _left_by_press(slabs: Slabs, depth_mm: NDArray, velocities_mm_s: NDArray, sampling: Sampling) -> NDArray:
    """The same from simulated presses."""
    count, columns = depth_mm.shape
    every = slabs.take(np.repeat(np.arange(count), columns))
    press = press_to_depth(every, depth_mm.ravel(), np.tile(velocities_mm_s, count), sampling)
    relaxed = slabs.curves.area_at(slabs.slab, depth_mm) * slabs.young_MPa[:, None]
    return press.force_N[:, -1].reshape(depth_mm.shape) / relaxed

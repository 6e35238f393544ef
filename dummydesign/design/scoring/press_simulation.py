"""Force-depth curves and presses of many designs at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.measurement.motion import DECELERATION_MM_S2, HOLD_S, Motion, ramp_and_hold
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.material.relaxation import PressedForce, arms_in_ramp_and_hold

# Time after the stop from which the hold counts, as in the tissue's own definition. [s]
FIRST_HOLD_S = 0.005
# Largest depth over thickness that is designed for, as in the contract of the commands.
DEPTH_SHARE = MAX_DEPTH_OVER_THICKNESS
SAMPLES = 481
# Curves beyond which depths are sought in all of them at once.
AT_ONCE = 600


def take_rows(batch: Any, chosen: NDArray | slice) -> Any:
    """A frozen dataclass with some of the rows of its arrays, by themselves or by name; all else stays."""
    kept: dict[str, Any] = {}
    for one in fields(batch):
        value = getattr(batch, one.name)
        if isinstance(value, np.ndarray):
            kept[one.name] = value[chosen]
        elif isinstance(value, Mapping):
            kept[one.name] = {name: column[chosen] for name, column in value.items()}
    return replace(batch, **kept)


class PadRows:
    """A frozen dataclass whose arrays have a row a pad."""

    def take(self, chosen: NDArray | slice) -> Self:
        """Keep the pads chosen by index, mask or slice."""
        return take_rows(self, chosen)


@dataclass(frozen=True, eq=False)
class SimulatedPress(PadRows):
    """Presses of D designs at one condition: arrays (D, n) over time, NaN where out of reach.

    Sample ``stopped`` is the stop of each, and from there on all have the same times.
    """

    time_s: NDArray
    force_N: NDArray
    stop_s: NDArray
    depth_mm: NDArray
    displacement_mm: NDArray
    stopped: int

    @cached_property
    def peak_N(self) -> NDArray:
        """Largest force of each press, shape (D,); NaN where out of reach. [N]"""
        return self.force_N.max(axis=-1)

    @cached_property
    def _hold(self) -> NDArray:
        """ln of the time since the stop, at least of 5 ms, in the hold of all presses, shape (n - stopped,)."""
        return np.log(np.maximum(self.time_s[0, self.stopped :] - self.stop_s[0], FIRST_HOLD_S))

    @cached_property
    def counted(self) -> NDArray:
        """Which samples count in a share of the press: not the first 5 ms of the hold. Indices, shape (m,)."""
        first = int(np.argmax(self._hold > np.log(FIRST_HOLD_S))) - 1
        return np.r_[: self.stopped + 1, self.stopped + max(first, 1) : self.time_s.shape[-1]]

    @cached_property
    def sample_weights(self) -> NDArray:
        """What counted samples (D, m) weigh in a share of the press: half the rise in time, half the hold in ln t."""
        weights = np.zeros_like(self.time_s)
        rise = np.diff(self.time_s[:, : self.stopped + 1], axis=-1)
        parts = weights[:, : self.stopped + 1], weights[:, self.stopped :]
        for own, step in zip(parts, (rise, np.diff(self._hold)[None])):
            step = step * (0.25 / step.sum(-1, keepdims=True))
            own[:, 1:] += step
            own[:, :-1] += step
        return weights[:, self.counted]

    @cached_property
    def energy_mJ(self) -> NDArray:
        """Integral of F dx from touch to stop, shape (D,); NaN where out of reach."""
        rise = slice(self.stopped + 1)
        return parabolic_work_mJ(self.displacement_mm[:, rise], self.force_N[:, rise])


def parabolic_work_mJ(displacement_mm: NDArray, force_N: NDArray) -> NDArray:
    """Integral of F dx by parabolas through every three samples, shape (D,). [mJ]

    Straight lines make too much of a force that bends upwards: 1.5 % on the coarse grid. Where a step is zero, and in a
    last step without a partner, lines are taken.
    """
    step = np.diff(displacement_mm, axis=-1)
    lines = 0.5 * (force_N[:, 1:] + force_N[:, :-1]) * step
    pairs = step.shape[-1] // 2 * 2
    first, second = step[:, 0:pairs:2], step[:, 1:pairs:2]
    low, middle, high = (force_N[:, start : start + pairs : 2] for start in range(3))
    whole = first + second
    with np.errstate(invalid="ignore", divide="ignore"):
        curved = (
            ((2.0 - second / first) * low + whole**2 / (first * second) * middle + (2.0 - first / second) * high)
            * whole
            / 6.0
        )
    plain = lines[:, 0:pairs:2] + lines[:, 1:pairs:2]
    work = np.where((first > 0.0) & (second > 0.0), curved, plain)
    return np.asarray(work.sum(axis=-1) + lines[:, pairs:].sum(axis=-1))


@dataclass(frozen=True, eq=False)
class SlabCurves(PadRows):
    """Elastic force per unit modulus of T slabs on even depth grids."""

    thickness_mm: NDArray
    limit_mm: NDArray
    area_mm2: NDArray

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
        if len(self.limit_mm) > AT_ONCE:
            found = self._depth_of_each(slab, wanted.reshape(len(slab), -1))
            return found.reshape(wanted.shape)
        depth = np.full(wanted.shape, np.nan)
        order = np.argsort(slab, kind="stable")
        known, first = np.unique(slab[order], return_index=True)
        steps, count = self.step_mm, np.arange(self.area_mm2.shape[-1])
        for index, start, end in zip(known, first, [*first[1:], len(order)]):
            rows = order[start:end]
            depth[rows] = np.interp(wanted[rows], self.area_mm2[index], steps[index] * count, right=np.nan)
        return depth

    @cached_property
    def _ranked(self) -> NDArray:
        """All curves one after the other as one rising list: the number of each plus half its share of its end."""
        shares = self.area_mm2 * (0.5 / self.area_mm2[:, -1:])
        shares += np.arange(len(shares))[:, None]
        return shares.ravel()

    def _depth_of_each(self, slab: NDArray, wanted: NDArray) -> NDArray:
        """The same for (D, n), by one search in all curves at once."""
        count, end = self.area_mm2.shape[-1], self.area_mm2[slab, -1][:, None]
        place = np.searchsorted(self._ranked, slab[:, None] + wanted * (0.5 / end), "right") - 1
        first = (slab * count)[:, None]
        place = np.clip(place, first, first + count - 2)
        flat = self.area_mm2.ravel()
        low, high = flat.take(place), flat.take(place + 1)
        share = np.clip((wanted - low) / (high - low), 0.0, 1.0)
        found = self.step_mm[slab][:, None] * (place - first + share)
        return np.where(wanted <= end, found, np.nan)

    def slope_at(self, slab: NDArray, depth_mm: NDArray) -> NDArray:
        """Tangent d(F / E) / d depth at depths (D, n) of slabs (D,), by central differences. [mm]"""
        known, row = np.unique(slab, return_inverse=True)
        slopes = np.gradient(self.area_mm2[known], axis=-1, edge_order=2) / self.step_mm[known, None]
        return _lookup(slopes, row, depth_mm / self.step_mm[slab][:, None])


def _lookup(table: NDArray, slab: NDArray, position: NDArray) -> NDArray:
    """Interpolate rows ``slab`` of a table at positions counted in grid steps; NaN stays NaN."""
    known = np.clip(position, 0.0, table.shape[-1] - 1.0)
    left = np.minimum(np.nan_to_num(known).astype(int), table.shape[-1] - 2)
    share = known - left
    left += (slab * table.shape[-1])[:, None]
    flat = table.ravel()
    found: NDArray = flat.take(left)
    found *= 1.0 - share
    left += 1
    share *= flat.take(left)
    found += share
    return found


def designed_depth_mm(law: ForceLaw, thickness_mm: NDArray, radius_mm: float, gel_compression: float) -> NDArray:
    """Depth to which pads (T,) are designed: the law holds, and the gel is not compressed beyond the limit. [mm]"""
    return np.minimum(gel_compression * law.gel_mm(thickness_mm), law.depth_limit_mm(thickness_mm, radius_mm))


def make_curves(law: ForceLaw, thickness_mm: ArrayLike, radius_mm: float, gel_compression: float) -> SlabCurves:
    """Sample the force law for pads of the given thicknesses (T,), to a limit of depth over the gel's thickness."""
    thickness = np.atleast_1d(np.asarray(thickness_mm, float))
    limit = designed_depth_mm(law, thickness, radius_mm, gel_compression)
    share = np.linspace(0.0, 1.0, SAMPLES)
    area = np.asarray(law.force(limit[:, None] * share, thickness[:, None], 1.0, radius_mm), float)
    return SlabCurves(thickness, limit, area)


def join_curves(curves: Sequence[SlabCurves]) -> SlabCurves:
    """Curves of several force laws as one set, in their order."""
    return SlabCurves(*(np.concatenate(columns) for columns in zip(*(vars(one).values() for one in curves))))


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
        points = self.ramp_points, self.brake_points, self.hold_points
        return ramp_and_hold(velocity_mm_s, depth_mm, self.hold_s, self.deceleration_mm_s2, *points)

    @property
    def stopped(self) -> int:
        """Sample of the stop."""
        return self.ramp_points + self.brake_points


COARSE = Sampling(16, 8, 20)


@dataclass(frozen=True, eq=False)
class PadBatch(PadRows):
    """D designs: which slab (index into curves), modulus and relaxation of each.

    ``young_MPa`` has shape (D,), ``tau_s`` (arms,), ``beta`` (D, arms), relative to the long-term modulus;
    ``pressed_force`` is that of arms that change with depth or speed.
    """

    curves: SlabCurves
    slab: NDArray
    young_MPa: NDArray
    tau_s: tuple[float, ...]
    beta: NDArray
    pressed_force: PressedForce | None = None

    @property
    def thickness_mm(self) -> NDArray:
        """Thickness of each design, shape (D,). [mm]"""
        return self.curves.thickness_mm[self.slab]


def join_slabs(slabs: Sequence[PadBatch]) -> PadBatch:
    """Designs of one resin on several sets of curves as one set, in their order; each keeps its own curve only."""
    curves = join_curves([one.curves.take(one.slab) for one in slabs])
    young, beta = (np.concatenate([getattr(one, name) for one in slabs]) for name in ("young_MPa", "beta"))
    return replace(slabs[0], curves=curves, slab=np.arange(len(young)), young_MPa=young, beta=beta)


def press_to_depth(slabs: PadBatch, depth_mm: NDArray, velocity_mm_s: ArrayLike, sampling: Sampling) -> SimulatedPress:
    """Press every design to its depth (D,), brake, hold: elastic curve with Prony relaxation on top."""
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
    if slabs.pressed_force is None:
        relative = arms_in_ramp_and_hold(steps, area, hold, slabs.tau_s, slabs.beta)
        relative[: stop + 1] += area.T
        relative[stop + 1 :] += area[:, stop]
    else:
        share = motion.displacement_mm / slabs.thickness_mm[:, None]
        held = np.concatenate([area, np.repeat(area[:, -1:], len(hold), axis=1)], axis=1)
        relative = slabs.pressed_force(time, held, share, velocity_mm_s, slabs.tau_s, slabs.beta).T
    relative *= slabs.young_MPa
    relative[:, ~reachable] = np.nan
    force, reached = np.ascontiguousarray(relative.T), np.where(reachable, depth_mm, np.nan)
    return SimulatedPress(time, force, braked, reached, motion.displacement_mm, stop)


def steady_depth(
    slabs: PadBatch,
    steady_force_N: ArrayLike,
    velocity_mm_s: ArrayLike,
    sampling: Sampling = COARSE,
    exact: bool = False,
) -> NDArray:
    """Depth whose force at the end of the hold is the given one, shape (D,) or (D, n); NaN out of reach.

    Slow arms have not died out by then: beside the relaxed force a share sum beta_i exp(-hold / tau_i) m_i
    is left, m_i = (tau_i / t_p) (1 - exp(-t_p / tau_i)) for a rise at constant rate (t_p = depth / speed).
    """
    forces = np.atleast_1d(np.asarray(steady_force_N, float))
    speeds = np.broadcast_to(np.asarray(velocity_mm_s, float), forces.shape)
    elastic = forces / slabs.young_MPa[:, None]
    depth = slabs.curves.depth_at(slabs.slab, elastic)
    if np.exp(-sampling.hold_s / max(slabs.tau_s, default=1e-9)) > 1e-12:
        rows, some, settled = np.arange(len(depth)), slabs, np.zeros(depth.shape, bool)
        for _ in range(8):
            before = depth[rows]
            # depths that are out of reach are tried at the limit: the rest there may bring them in
            tried = np.where(np.isfinite(before), before, some.curves.limit_mm[some.slab][:, None])
            left = (
                _left_by_press(some, tried, speeds, sampling)
                if exact
                else rest_after_hold(some.beta, some.tau_s, tried, speeds, sampling)
            )
            new = some.curves.depth_at(some.slab, elastic[rows] / left)
            # a depth that has settled stays, so that no design depends on which others are worked out with it
            depth[rows] = np.where(settled, before, new)
            settled |= ~(np.abs(new - tried) > 1e-6 * tried)  # what is out of reach stays so
            going = np.logical_not(settled.all(axis=-1))
            if not going.any():
                break
            rows, settled, some = rows[going], settled[going], some.take(going)
    return depth if np.ndim(steady_force_N) else depth[:, 0]


def rest_after_hold(
    beta: NDArray, tau_s: Sequence[float], depth_mm: NDArray, velocities_mm_s: NDArray, sampling: Sampling
) -> NDArray:
    """Force at the end of the hold over the relaxed force, shape (D, n), for rises at constant rates (n,) of arms of
    strengths (D, arms) to depths (D, n) or (D, 1)."""
    share = np.ones(np.broadcast_shapes(depth_mm.shape, np.shape(velocities_mm_s)))
    for arm, tau in enumerate(tau_s):
        kept = np.exp(-sampling.hold_s / tau)
        if kept < 1e-15:
            continue
        rise = np.maximum(depth_mm / (velocities_mm_s * tau), 1e-12)  # a pad that cannot be pressed has none
        share += beta[:, arm, None] * (kept * -np.expm1(-rise) / rise)
    return share


def _left_by_press(slabs: PadBatch, depth_mm: NDArray, velocities_mm_s: NDArray, sampling: Sampling) -> NDArray:
    """The same from simulated presses."""
    count, columns = depth_mm.shape
    every = slabs.take(np.repeat(np.arange(count), columns))
    press = press_to_depth(every, depth_mm.ravel(), np.tile(velocities_mm_s, count), sampling)
    relaxed = slabs.curves.area_at(slabs.slab, depth_mm) * slabs.young_MPa[:, None]
    return press.force_N[:, -1].reshape(depth_mm.shape) / relaxed

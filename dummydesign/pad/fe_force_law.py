"""Force laws of slabs from finite elements at several thicknesses, and over the table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.interpolation import locate_on_grid
from dummydesign.geometry.dimensions import EXTENT_OVER_RADIUS, MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.interface import BASES
from dummydesign.pad import force_source
from dummydesign.pad.first_touch import low_end, solvable_depths
from dummydesign.pad.force_law import Array, ForceLaw
from dummydesign.pad.pad_under_punch import Pad

SLAB_SHARES = (0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)
"""Depths over thickness that are solved."""
DEGREE, SLIDING_DEGREE = 6, 4
"""Of the polynomial through a solved curve; a face that slides scatters more, and is followed less closely."""


@dataclass(frozen=True)
class SolvedSlab:
    """Elastic curve of one slab of unit modulus.

    ``depth_mm``, ``area_mm2`` (force over modulus) and ``error`` (relative) have one length; ``notes`` say
    why the curve stops early.
    """

    pad: Pad
    depth_mm: Array
    area_mm2: Array
    error: Array
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class FeForceLaw(ForceLaw):
    """Elastic force of solved slabs, F = E a d exp(p(d / h)) with a polynomial p a thickness.

    ``errors`` are the solved depths of each thickness and the relative errors there.
    """

    radius_mm: float
    polynomials: dict[float, tuple[float, ...]]
    errors: dict[float, tuple[Array, Array]]
    notes: tuple[str, ...]

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Elastic force at solved thicknesses and the one solved radius; see
        :class:`dummydesign.pad.force_law.ForceLaw`. [N]
        """
        radius = np.asarray(radius_mm, float)
        if not np.allclose(radius, self.radius_mm):
            raise ValueError(f"solved for a punch radius of {self.radius_mm} mm, requested {radius}")
        values = (np.asarray(value, float) for value in (depth_mm, thickness_mm, young_MPa))
        depth, thickness, young = np.broadcast_arrays(*values)
        force = np.empty(depth.shape)
        for value in np.unique(thickness):
            at = thickness == value
            # F / d of a flat face is that of the first solved depth down to first touch
            solved = self._solved(float(value))
            held = np.maximum(depth[at], self.errors[solved][0][0])
            series = np.polynomial.polynomial.polyval(held / value, self.polynomials[solved])
            force[at] = young[at] * radius * depth[at] * np.exp(series)
        return force

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Largest depth that was solved. [mm]"""
        thickness = np.asarray(thickness_mm, float)
        limits = [self.errors[self._solved(float(value))][0][-1] for value in thickness.flat]
        return np.array(limits).reshape(thickness.shape)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the force over the force, between solved depths on straight lines; see
        :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        error = np.empty(depth.shape)
        for value in np.unique(thickness):
            at = thickness == value
            error[at] = np.interp(depth[at], *self.errors[self._solved(float(value))])
        return error

    def _solved(self, thickness_mm: float) -> float:
        """The solved thickness that is meant; between them nothing is known."""
        nearest = min(self.polynomials, key=lambda solved: abs(solved - thickness_mm))
        if not np.isclose(nearest, thickness_mm):
            solved = ", ".join(f"{value:g}" for value in self.polynomials)
            raise ValueError(f"solved for thicknesses of {solved} mm, requested {thickness_mm:g} mm")
        return nearest


def corners_known(pad: Pad, fidelity: str) -> bool:
    """Whether this fidelity knows what the corners of the punch do; true for a round one."""
    return pad.sides_mm is None or fidelity == "3d" or force_source.has_square_factor(pad)


def solve_slab(pad: Pad, fidelity: str = "axisymmetric") -> SolvedSlab:
    """Solve one slab of unit modulus to 0.6 of its thickness.

    With ``axisymmetric`` a glued square on a neo-Hookean slab carries its tabulated factor; ``3d`` solves it.
    """
    if pad.sides_mm is not None and not corners_known(pad, fidelity):
        sides = "x".join(f"{side:g}" for side in pad.sides_mm)
        raise InputError(
            f"punch of {sides} mm has no corners at fidelity = axisymmetric, which knows them of a glued square on a "
            "neo-Hookean slab inside the response table only; take fidelity 3d, or a round punch of the same area",
            "unsupported",
            "punch",
        )
    depth = np.array(SLAB_SHARES) * pad.thickness_mm
    if pad.condition != "bonded" and fidelity != "3d":
        solved = force_source.solve_points(pad, depth)
        return SolvedSlab(pad, solved.depth_mm, solved.force_N, solved.error_N / solved.force_N, tuple(solved.notes))
    curve = force_source.elastic_curve(pad, fidelity, float(depth[-1]), depth)
    depth = depth[depth <= curve.limit_mm * (1.0 + 1e-9)]
    return SolvedSlab(pad, depth, curve.force(depth), curve.relative_error(depth), tuple(curve.notes))


def law_of(slabs: Iterable[SolvedSlab]) -> FeForceLaw:
    """Make one force law of slabs solved for the same punch."""
    polynomials, errors, notes, radius = {}, {}, [], 0.0
    for slab in slabs:
        thickness, radius = slab.pad.thickness_mm, slab.pad.radius_mm
        degree = DEGREE if slab.pad.condition == "bonded" else SLIDING_DEGREE
        if len(slab.depth_mm) <= degree:
            message = f"slab of {thickness:g} mm: only {len(slab.depth_mm)} depths solved"
            raise NoAnswerError("no_convergence", message, quantity="pad")
        logarithm = np.log(slab.area_mm2 / (radius * slab.depth_mm))
        fitted = np.polynomial.polynomial.polyfit(slab.depth_mm / thickness, logarithm, degree, w=1.0 / slab.error)
        polynomials[thickness] = tuple(float(value) for value in fitted)
        misfit = np.polynomial.polynomial.polyval(slab.depth_mm / thickness, fitted) - logarithm
        errors[thickness] = (slab.depth_mm, slab.error + np.abs(misfit))
        notes += [f"slab of {thickness:g} mm: {text}" for text in slab.notes]
    return FeForceLaw(radius, polynomials, errors, tuple(notes))


def solve_law(
    thickness_mm: Sequence[float],
    radius_mm: float,
    base: str = "bonded",
    condition: str = "bonded",
    sides_mm: tuple[float, float] | None = None,
    fidelity: str = "axisymmetric",
) -> FeForceLaw:
    """Solve one curve a thickness."""
    slabs = (
        Pad(h, 1.0, radius_mm, base=base, condition=condition, sides_mm=sides_mm)
        for h in sorted({float(value) for value in thickness_mm})
    )
    pads = [pad if corners_known(pad, fidelity) else replace(pad, sides_mm=None) for pad in slabs]
    return law_of(solve_slab(pad, fidelity) for pad in pads)


NODES = 5
BELOW_FIRST = np.geomspace(1e-8, 1.0, 81)[:-1]
"""Depths over the first solved one at which the law of first touch is kept; ln of a factor is straight between them."""
SHARES = MAX_DEPTH_OVER_THICKNESS * np.array([0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
RIM_CHANGE, RIM_DECAY, RIM_COUNTS = 0.5, 1.5, 0.002
"""What a rim takes of the force falls as 0.5 exp(-1.5 way / thickness), way from the punch to it: solved for slabs of
half to four radii, within a factor of two; a change of 0.2 % is solved."""
COARSE_CELLS, COARSE_RINGS = 2, 1
"""Mesh on which pads of two sizes are compared. Its few cells at the sharp edge are the same in both, so what they are
off by falls out of the ratio: it is smooth in depth and within 0.2 % of what three times as many cells give. Ratios
under a small fillet scatter by 0.5 %, as one more or one less of its points is held."""
SCATTER = 0.002


@dataclass(frozen=True)
class Solved:
    """ln of solved over tabulated force at shares of one thickness, and the solve's relative error there, (n,)."""

    thickness_mm: float
    share: Array
    log_factor: Array
    error: Array


@dataclass(frozen=True)
class SlabLawForTest(ForceLaw):
    """A table times what was solved over it."""

    table: ForceLaw
    solved: tuple[Solved, ...]
    doubt: float

    @property
    def ratio_range(self) -> tuple[float, float]:  # type: ignore[override]
        """The table's."""
        return self.table.ratio_range

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Elastic force; see :class:`dummydesign.pad.force_law.ForceLaw`. [N]"""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        factor = np.exp(self._over(depth, thickness, "log_factor"))
        return factor * self.table.force(depth, thickness, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Depth that the table holds and the solves reached. [mm]"""
        thickness = np.asarray(thickness_mm, float)
        nodes = np.log([one.thickness_mm for one in self.solved])
        reached = np.interp(np.log(thickness), nodes, [one.share[-1] for one in self.solved]) * thickness
        return np.minimum(self.table.depth_limit_mm(thickness, radius_mm), reached)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the solves and of what lies between; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        return self._over(depth, thickness, "error") + self.doubt

    def _over(self, depth: Array, thickness: Array, name: str) -> Array:
        """A solved quantity between shares and thicknesses."""
        share = np.log(np.maximum(depth / thickness, 1e-9))
        rows = [_along(one, share, name) for one in self.solved]
        if len(rows) == 1:
            return rows[0]
        left, part = locate_on_grid(np.log([one.thickness_mm for one in self.solved]), np.log(thickness))
        stack = np.stack(rows)
        low, high = (np.take_along_axis(stack, at[None], 0)[0] for at in (left, left + 1))
        return low + part * (high - low)


def _along(one: Solved, log_share: Array, name: str) -> Array:
    return np.interp(log_share, np.log(one.share), getattr(one, name))


def own_slab_law(table: ForceLaw, pad: Pad, thickness_mm: Array) -> ForceLaw:
    """The law of slabs that are pressed as a pad is: the table itself where nothing differs."""
    ends = float(np.min(thickness_mm)), float(np.max(thickness_mm))
    if in_table(pad) and not near_rim(pad, ends[1]):
        return table
    count = 1 if ends[0] == ends[1] else NODES
    solved = tuple(solve_over_table(table, pad, float(h)) for h in np.geomspace(*ends, count))
    return SlabLawForTest(table, solved, _doubt(solved))


def in_table(pad: Pad) -> bool:
    """Whether punch, edge, face and base are those of a table."""
    return pad.profile_mm is None and not pad.edge_radius_mm and pad.base in BASES and pad.condition == "bonded"


def near_rim(pad: Pad, thickness_mm: float) -> bool:
    """Whether a pad's rim is so near to the punch that its force is not that of the table's, larger pads."""
    extents = np.array([EXTENT_OVER_RADIUS * pad.radius_mm, pad.extent_mm])
    taken = RIM_CHANGE * np.exp(-RIM_DECAY * (extents - pad.radius_mm) / thickness_mm)
    return bool(abs(taken[1] - taken[0]) > RIM_COUNTS)


def solve_over_table(table: ForceLaw, pad: Pad, thickness_mm: float) -> Solved:
    """Solve one thickness and put it over the table."""
    limit = float(np.squeeze(table.depth_limit_mm(thickness_mm, pad.radius_mm)))
    share = SHARES[SHARES * thickness_mm <= limit * (1.0 + 1e-9)]
    own = replace(pad, thickness_mm=thickness_mm, young_MPa=1.0, sides_mm=None)
    if in_table(pad):
        inputs = {"radius": pad.radius_mm, "extent": pad.extent_mm, "base": pad.base, "thickness": thickness_mm}
        made = cached("rim", inputs, lambda: _by_rim(own, share))
        depth_share, factor, error = (np.asarray(made[name], float) for name in ("share", "log_factor", "error"))
        error = error + table.relative_error(depth_share * thickness_mm, thickness_mm, pad.radius_mm)
    else:
        curve = force_source.solve_points(own, solvable_depths(own, share * thickness_mm))
        depth, force, error = curve.depth_mm, curve.force_N, curve.error_N / curve.force_N
        if len(depth) > 1:
            end = low_end(own, depth, force, error)
            below = end.first_mm * BELOW_FIRST
            depth, force = np.r_[below, depth], np.r_[end.force(below), force]
            error = np.r_[end.relative_error(below), error]
        depth_share = depth / thickness_mm
        factor = np.log(force / table.force(depth, thickness_mm, 1.0, pad.radius_mm))
    if len(depth_share) < 2:
        message = f"a slab of {thickness_mm:.3g} mm under this punch could not be solved"
        raise NoAnswerError("no_convergence", message, quantity="pad")
    return Solved(thickness_mm, depth_share, factor, error)


def _by_rim(pad: Pad, share: Array) -> dict[str, Any]:
    """Force of the pad over that of one of the table's size, both under a sharp edge of the same coarse cells."""
    from dummydesign.pad.axisymmetric.case import Case, sharp_problem
    from dummydesign.pad.fem.mesh_axisymmetric import Resolution
    from dummydesign.pad.solve.continuation import follow

    a = pad.radius_mm / pad.thickness_mm
    assert pad.extent_mm is not None
    largest = 0.05 * min(a, 1.0)
    problems = [
        sharp_problem(Case(a, extent, pad.base), Resolution(COARSE_CELLS), COARSE_RINGS, quarter_points=False)
        for extent in (pad.extent_mm / pad.thickness_mm, EXTENT_OVER_RADIUS * a)
    ]
    paths = [follow(problem, share, 0.2 * largest, largest, 0.1 * largest) for problem in problems]
    count = min(len(path.depth) for path in paths)
    ratio = np.asarray(paths[0].force[:count]) / np.asarray(paths[1].force[:count])
    return {"share": paths[0].depth[:count], "log_factor": np.log(ratio), "error": SCATTER + 0.1 * np.abs(ratio - 1.0)}


def _doubt(solved: tuple[Solved, ...]) -> float:
    """Error of what is interpolated: a quarter of what leaving a node out changes, its distance being twice."""
    changes = [0.0]
    for before, here, after in zip(solved, solved[1:], solved[2:]):
        share = np.log(here.share[here.share <= min(before.share[-1], after.share[-1]) + 1e-9])
        low, high = (_along(one, share, "log_factor") for one in (before, after))
        changes.append(float(np.max(np.abs(0.5 * (low + high) - here.log_factor[: len(share)]), initial=0.0)))
    return 0.25 * max(changes)

"""Force laws of set-ups without a table of their own: pads solved by finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.interface import BASES
from dummydesign.loop.model.base_law import SlabLaw
from dummydesign.loop.model.effect import UnitForce
from dummydesign.measurement.campaign import Trial
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.first_touch import low_end, touch_of
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.tables.slab import load_table

POINTS, DENSE = 24, 600  # depths that are solved, and at which the curve is kept
STARTS_AT = 0.01
AT_TOUCH = 1e-9  # of the first dense depth: where the law of first touch is taken for depth 0
FINE_CELLS = 24
"""Cells under the punch of a pad with a shape, where a design takes 16: on a crowned pad of 7 mm those are 1.5 % off
cells of half the size in the depths where the contact reaches the flat, these 0.4 %."""
THICKER = 1.15
"""Ratio of thicknesses at which the change with thickness is solved, either way; further out it goes on straight."""
RATIO_CELLS, RATIO_RIM, ENOUGH = (10, 13), 0.1, 0.8
"""Cells and bead of ratios: the next finer ones where this share of the depth was not reached; held beyond."""
POISSON = 0.48
LEAST_DEPTHS = 4


@dataclass(frozen=True)
class SolvedCurve:
    """One pad: F / E over depth, solved to a limit; ``offers`` is what effects may ask of it."""

    pad: Pad | Puck
    deepest_mm: float
    offers: frozenset[str] = frozenset()

    @cached_property
    def _points(self) -> tuple[NDArray, NDArray, NDArray]:
        """Depths that were reached [mm], F / E [mm2], and the relative error stated."""
        from dummydesign.pad.force_source import corners_of, has_square_factor, solve_points

        curve = solve_points(self.pad, self.depths_mm, cells=FINE_CELLS)
        if len(curve.depth_mm) < LEAST_DEPTHS:
            raise self._unsolved(reason=f": {curve.notes[0]}" if curve.notes else "")
        area, error = curve.force_N / self.pad.young_MPa, curve.error_N / curve.force_N
        if isinstance(self.pad, Pad) and has_square_factor(self.pad):
            factor, doubt = corners_of(self.pad)(curve.depth_mm)
            area, error = area * factor, error + doubt
        return curve.depth_mm, area, error

    def _unsolved(self, change: str = "", reason: str = "") -> NoAnswerError:
        """Make the error of a solve that stopped too early."""
        pad, h = self.pad, self.pad.thickness_mm
        name = f"puck of {pad.diameter_mm:g} x {h:g} mm" if isinstance(pad, Puck) else f"{pad.geometry} pad of {h:g} mm"
        return NoAnswerError("no_convergence", f"the {name}{change} could not be solved{reason}", quantity="pad")

    @property
    def depths_mm(self) -> NDArray:
        """Depths that are solved, closer together at the first touch. [mm]"""
        if isinstance(self.pad, Pad) and self.pad.profile_mm is None and self.pad.condition != "bonded":
            # a face that slides needs some depth to start from
            return self.deepest_mm * np.linspace(0.06, 1.0, POINTS)
        return self.deepest_mm * (STARTS_AT + (1.0 - STARTS_AT) * np.linspace(0.0, 1.0, POINTS) ** 1.5)

    @property
    def limit_mm(self) -> float:
        """Depth to which it was solved. [mm]"""
        return float(self._points[0][-1])

    @property
    def relative_error(self) -> float:
        """Median of the solve's stated error over the force."""
        return float(np.median(self._points[2]))

    @property
    def radius_mm(self) -> float:
        """Radius of what is pressed on, of equal area. [mm]"""
        return self.pad.radius_mm

    @cached_property
    def power(self) -> float:
        """d ln F / d ln d at first touch, to the nearest half: 1 of a flat face, 1.5 of a tip, 2 of a cone."""
        touch = touch_of(self.pad)
        return 1.0 if touch is None else round(2.0 * touch.power(float(self.depths_mm[0]))) / 2.0

    @cached_property
    def dense_mm(self) -> NDArray:
        """Even depths at which curves are kept. [mm]"""
        return np.linspace(0.0, self.limit_mm, DENSE)

    @cached_property
    def log_secant(self) -> NDArray:
        """ln of F / (E d^power) at the dense depths; below the first solved one by the law of first touch."""
        from scipy.interpolate import PchipInterpolator

        depth, area, error = self._points
        end = low_end(self.pad, depth, area * self.pad.young_MPa, error)
        dense = np.maximum(self.dense_mm, AT_TOUCH * self.dense_mm[1])
        below = np.log(end.force(dense) / (self.pad.young_MPa * dense**self.power))
        solved = PchipInterpolator(depth, np.log(area / depth**self.power))(np.clip(dense, depth[0], depth[-1]))
        return np.where(dense < depth[0], below, solved)

    @cached_property
    def with_thickness(self) -> tuple[NDArray, NDArray]:
        """First and half the second derivative of ln F at equal depth with respect to ln h, at the dense depths.

        The top of the pad stays what it is, as from a mould that is poured too full. From one side alone, and without
        a second derivative, where the other could not be solved.
        """
        step = np.log(THICKER)
        sides: dict[int, NDArray] = {}
        for sign in (1, -1):
            with suppress(NoAnswerError, InputError):
                sides[sign] = self._log_ratio(thickness_mm=self.pad.thickness_mm * THICKER**sign)
        if not sides:
            raise self._unsolved(" at other thicknesses")
        if len(sides) == 1:
            ((sign, only),) = sides.items()
            return sign * only / step, np.zeros_like(only)
        return (sides[1] - sides[-1]) / (2.0 * step), (sides[1] + sides[-1]) / (2.0 * step**2)

    @cached_property
    def log_sliding(self) -> NDArray:
        """ln of the force on a sliding base over that on the glued one, at the dense depths."""
        return self._log_ratio(base="sliding")

    @cached_property
    def bulk_coefficient(self) -> NDArray:
        """c of F / (1 + (1 - 2 nu) c) at the dense depths, for a Poisson's ratio nu below 1/2."""
        return np.expm1(-self._log_ratio(poisson=POISSON)) / (1.0 - 2.0 * POISSON)

    def _log_ratio(self, **change: Any) -> NDArray:
        """ln of F / E of the pad with a change over this one's at equal depth, both on the same coarser cells; of glued
        slabs by their tables."""
        pads = (self.pad, replace(self.pad, **change))
        slabs = [pad for pad in pads if isinstance(pad, Pad) and _glued_slab(pad)]
        if len(slabs) == len(pads):
            depth = np.maximum(self.dense_mm, 1e-6 * self.limit_mm)
            own, changed = (_log_by_table(pad, depth) for pad in slabs)
            return changed - own
        for cells in RATIO_CELLS:
            own, changed = (_coarse(pad, self.depths_mm, cells) for pad in pads)
            count = min(len(own), len(changed))
            if self.depths_mm[count - 1] >= ENOUGH * self.limit_mm and count >= LEAST_DEPTHS:
                break
        else:
            raise self._unsolved(f" with another {', '.join(change)}")
        # a polynomial takes out the scatter of contact that grows cell by cell
        depth, log = self.depths_mm[:count], np.log(changed[:count] / own[:count])
        smooth = np.polynomial.Polynomial.fit(depth, log, min(5, count - 1))
        return smooth(np.clip(self.dense_mm, depth[0], depth[-1]))

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2] of depths (T, N) on pads about as thick as this one (T, 1); its last secant goes on beyond."""
        depth = np.maximum(depth_mm, 0.0)
        log = self._at(self.log_secant, depth)
        change = np.log(np.asarray(thickness_mm, float) / self.pad.thickness_mm)
        if np.any(np.abs(change) > 1e-12):
            held = np.clip(change, -np.log(THICKER), np.log(THICKER))
            first, second = (self._at(values, depth) for values in self.with_thickness)
            log = log + first * change + second * held * (2.0 * change - held)
        return depth**self.power * np.exp(log)

    def sliding(self) -> UnitForce:
        """The same pad on a base that slides."""
        return lambda depth, h: np.exp(self._at(self.log_sliding, np.maximum(depth, 0.0))) * self(depth, h)

    def compressibility_coefficient(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """c of a compressible pad, F / (1 + (1 - 2 nu) c)."""
        return self._at(self.bulk_coefficient, np.maximum(depth_mm, 0.0))

    def limit(self, thickness_mm: NDArray) -> NDArray:
        """Depth to which it was solved, whatever the thickness. [mm]"""
        return np.full(np.shape(thickness_mm), self.limit_mm)

    def _at(self, values: NDArray, depth: NDArray) -> NDArray:
        """Values at depths (T, N), linear between the dense ones, constant outside."""
        position = np.minimum(depth / self.limit_mm, 1.0) * (DENSE - 1)
        low = np.minimum(position.astype(int), DENSE - 2)
        part = position - low
        return values[low] * (1.0 - part) + values[low + 1] * part


def _glued_slab(pad: Pad) -> bool:
    """Whether a pad is a flat slab under a glued flat punch, sharp or with a fillet."""
    return pad.geometry.plain and pad.profile_mm is None and pad.condition == "bonded" and pad.base in BASES


def _log_by_table(pad: Pad, depth_mm: NDArray) -> NDArray:
    """ln of F / E of a slab by the response table, its ends held, and what a bulk that gives takes off."""
    law, thickness = SlabLaw(load_table(pad.base), pad.radius_mm, False), np.array([[pad.thickness_mm]])
    bulk = law.compressibility_coefficient(depth_mm[None], thickness)[0] if pad.poisson < 0.5 else 0.0
    return np.log(law(depth_mm[None], thickness)[0] / (1.0 + (1.0 - 2.0 * pad.poisson) * bulk))


def _coarse(pad: Pad | Puck, depth_mm: NDArray, cells: int) -> NDArray:
    """F / E at the first depths, on coarse cells with one bead where the elements allow. [mm2]"""
    inputs = {"pad": replace(pad, prony=()), "depth": depth_mm, "cells": cells}
    return np.asarray(cached("loop-coarse", inputs, lambda: _solve_coarse(pad, depth_mm, cells))["area_mm2"], float)


def _solve_coarse(pad: Pad | Puck, depth_mm: NDArray, cells: int) -> dict[str, Any]:
    from dummydesign.pad.axisymmetric.shaped_problem import solve_path
    from dummydesign.pad.force_source import solve_points

    h = pad.thickness_mm
    wanted = depth_mm[depth_mm <= MAX_DEPTH_OVER_THICKNESS * h]
    slides_round = not isinstance(pad, Puck) and pad.edge_radius_mm > 0.0 and pad.condition != "bonded"
    if isinstance(pad, Puck) or pad.profile_mm is not None or pad.base not in BASES or slides_round:
        return {"area_mm2": solve_points(pad, wanted).force_N / pad.young_MPa}
    case = Case.of(replace(pad, law=None))
    # a slab's ratio hardly knows the fillet, which is small beside its cells; a shaped pad's does
    edge = 0.0 if pad.geometry.plain else case.edge
    case = replace(case, edge=edge, first=float(wanted[0]) / h)
    # shear modulus 1, so that Young's modulus is 2 (1 + nu)
    path = solve_path(case, wanted / h, cells, RATIO_RIM)
    return {"area_mm2": path.force * h**2 / (2.0 * (1.0 + pad.poisson))}


OUTLINE_ERROR = 0.01  # error of taking a square for the circle of its area on a pad whose own factor is not solved
THICKNESS_SLOPE = 1.0
"""-d ln F / d ln h of a usual pad (0.7 at 15 mm, 1.4 at 5 mm), for the error of a measured thickness."""


ROUGHNESS = 0.0015
"""Relative roughness over depth of a pad whose contact grows cell by cell: crowns of 7, 10 and 14 mm on 24 and on 32
cells differ by 0.12 to 0.18 % (root mean square) beside a parabola in depth. Taken for other growing contacts too."""


def error_priors(own: tuple, relative_error: float, outline: bool, thickness: float, roughness: float = 0.0) -> tuple:
    """Median size and spread of the law error: the usual one with the stated error of a solve and of thickness."""
    solved = 0.5 * relative_error
    shape = OUTLINE_ERROR if outline else 0.0
    more = (
        (solved, shape, THICKNESS_SLOPE * thickness),
        (solved, shape, 0.0),
        (0.5 * solved, 0.0, 0.0),
        (roughness, 0.0, 0.0),
    )
    return tuple((float(np.linalg.norm([size, *added])), spread) for (size, spread), added in zip(own, more))


@dataclass(frozen=True)
class CampaignForceLaw:
    """The law of each pad of a campaign, by its shape as typed and its thickness: solved, or a slab's by the table."""

    pads: dict[tuple[str, float], SolvedCurve | SlabLaw]
    shape: str
    error_priors: tuple

    @property
    def offers(self) -> frozenset[str]:
        """What every pad offers."""
        return frozenset.intersection(*(law.offers for law in self.pads.values()))

    def law_of(self, pad: tuple[str, float]) -> SolvedCurve | SlabLaw:
        """The law of a pad, of the nearest in thickness where none is of its own."""
        shape, thickness = pad
        own = [known for known in self.pads if known[0] == shape]
        return self.pads[min(own, key=lambda known: abs(np.log(known[1] / thickness)))]

    def on(self, trials: Sequence[Trial]) -> BoundLaw:
        """The law of these trials, row by row."""
        return BoundLaw([self.law_of(trial.pad) for trial in trials])

    def limit_of(self, trials: Sequence[Trial]) -> NDArray:
        """Depth to which the law of each trial's pad holds, shape (T,). [mm]"""
        return np.array([float(np.squeeze(self.law_of(t.pad).limit(np.array(t.thickness_mm)))) for t in trials])


class BoundLaw:
    """A law for given trials: (T,) rows, each on the law of its pad."""

    def __init__(self, laws: Sequence[SolvedCurve | SlabLaw]) -> None:
        self.radius_mm = laws[0].radius_mm
        self._count = len(laws)
        different = {id(one): one for one in laws}
        self._parts = [
            (np.array([row for row, other in enumerate(laws) if other is one]), one) for one in different.values()
        ]

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2]."""
        return self._joined(depth_mm, thickness_mm, [law for _, law in self._parts])

    def sliding(self) -> UnitForce:
        """The same pads on a base that slides."""
        laws = [law.sliding() for _, law in self._parts]
        return lambda depth_mm, thickness_mm: self._joined(depth_mm, thickness_mm, laws)

    def compressibility_coefficient(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """c of a compressible pad."""
        return self._joined(depth_mm, thickness_mm, [law.compressibility_coefficient for _, law in self._parts])

    def _joined(self, depth_mm: NDArray, thickness_mm: NDArray, laws: Sequence[UnitForce]) -> NDArray:
        depth = np.asarray(depth_mm, float)
        thickness = np.broadcast_to(np.asarray(thickness_mm, float), (self._count, 1))
        out = np.empty((self._count, depth.shape[1]))
        for (rows, _), law in zip(self._parts, laws):
            out[rows] = law(depth[rows], thickness[rows])
        return out

"""Force of one pad solved by finite elements, over depth, and how it changes with thickness, base and bulk.

The curve itself is that of :func:`dummydesign.pad.elastic.solve_points`, as a design's, on finer cells. How it changes
is a ratio of solves on coarser cells, the same for both, whose errors cancel; for flat slabs that of their tables.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS, PAD_EXTENT_MM
from dummydesign.pad.pad import Pad, Puck

POINTS, DENSE = 24, 600
"""Depths that are solved, and at which the curve is kept."""
STARTS_AT = 0.01
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
    """One pad: F / E over depth, solved to a limit.

    Attributes
    ----------
    pad : Pad or Puck
        With the modulus for which it is solved: a base that rubs rests by its weight.
    deepest_mm : float
        Depth that is wanted. [mm]
    """

    pad: Pad | Puck
    deepest_mm: float

    @cached_property
    def _points(self) -> tuple[NDArray, NDArray, NDArray]:
        """Depths that were reached [mm], F / E [mm2], and the relative error stated."""
        from dummydesign.pad.elastic import has_square_factor, solve_points
        from dummydesign.pad.tables.square import square_factor

        curve = solve_points(self.pad, self.depths_mm, cells=FINE_CELLS)
        if len(curve.depth_mm) < LEAST_DEPTHS:
            why = f": {curve.notes[0]}" if curve.notes else ""
            raise NoAnswerError("no_convergence", f"the force law of the {self.said} could not be solved{why}")
        area, error = curve.force_N / self.pad.young_MPa, curve.error_N / curve.force_N
        if isinstance(self.pad, Pad) and has_square_factor(self.pad):
            pad, filleted = self.pad, bool(self.pad.edge_radius_mm)
            factor, doubt = square_factor(curve.depth_mm, pad.thickness_mm, pad.radius_mm, pad.base, filleted)
            area, error = area * factor, error + doubt
        return curve.depth_mm, area, error

    @property
    def said(self) -> str:
        """The pad in words."""
        if isinstance(self.pad, Puck):
            return f"puck of {self.pad.diameter_mm:g} x {self.pad.thickness_mm:g} mm"
        return f"{self.pad.geometry} pad of {self.pad.thickness_mm:g} mm"

    @property
    def depths_mm(self) -> NDArray:
        """Depths that are asked for, closer together at the first touch. [mm]"""
        shares = STARTS_AT + (1.0 - STARTS_AT) * np.linspace(0.0, 1.0, POINTS) ** 1.5
        if not isinstance(self.pad, Puck) and self.pad.profile_mm is None and self.pad.condition != "bonded":
            # a face that slides needs some depth to start from
            shares = np.linspace(0.06, 1.0, POINTS)
        return self.deepest_mm * shares

    @property
    def limit_mm(self) -> float:
        """Depth to which it was solved. [mm]"""
        return float(self._points[0][-1])

    @property
    def relative_error(self) -> float:
        """Median of the solve's stated error over the force."""
        return float(np.median(self._points[2]))

    @property
    def power(self) -> float:
        """d ln F / d ln d at first touch."""
        if isinstance(self.pad, Puck):
            return 1.0
        return 1.5 if self.pad.profile_mm is not None else self.pad.geometry.first_exponent

    @cached_property
    def dense_mm(self) -> NDArray:
        """Even depths at which curves are kept. [mm]"""
        return np.linspace(0.0, self.limit_mm, DENSE)

    @cached_property
    def log_secant(self) -> NDArray:
        """ln of F / (E d^power) at the dense depths."""
        from scipy.interpolate import PchipInterpolator

        depth, area, _ = self._points
        value = np.log(area / depth**self.power)
        plain = isinstance(self.pad, Puck) or self.pad.profile_mm is not None
        tip = None if plain else self.pad.geometry.tip_radius_mm
        if tip and self.pad.poisson == 0.5:
            # Hertz, exact at first touch
            depth, value = np.r_[0.0, depth], np.r_[np.log(16.0 / 9.0 * np.sqrt(tip)), value]
        return PchipInterpolator(depth, value)(np.clip(self.dense_mm, depth[0], depth[-1]))

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
                other = replace(self.pad, thickness_mm=self.pad.thickness_mm * THICKER**sign)
                sides[sign] = self._ratio("thickness", other)
        if not sides:
            raise NoAnswerError("no_convergence", f"the {self.said} could not be solved at other thicknesses")
        if len(sides) == 1:
            ((sign, only),) = sides.items()
            return sign * only / step, np.zeros_like(only)
        return (sides[1] - sides[-1]) / (2.0 * step), (sides[1] + sides[-1]) / (2.0 * step**2)

    @cached_property
    def log_sliding(self) -> NDArray:
        """ln of the force on a sliding base over that on the glued one, at the dense depths."""
        return self._ratio("sliding", replace(self.pad, base="sliding"))

    @cached_property
    def give(self) -> NDArray:
        """c of F / (1 + (1 - 2 nu) c) at the dense depths, for a Poisson's ratio nu below 1/2."""
        return np.expm1(-self._ratio("poisson", replace(self.pad, poisson=POISSON))) / (1.0 - 2.0 * POISSON)

    def _ratio(self, what: str, other: Pad | Puck) -> NDArray:
        """ln of F / E of another pad over this one's at equal depth, both on the same coarser cells; of glued slabs by
        their tables."""
        pads = (self.pad, other)
        if all(isinstance(pad, Pad) and _glued_slab(pad) for pad in pads):
            depth = np.maximum(self.dense_mm, 1e-6 * self.limit_mm)
            own, changed = (_log_by_table(pad, depth) for pad in pads)
            return changed - own
        for cells in RATIO_CELLS:
            own, changed = (_coarse(pad, self.depths_mm, cells) for pad in (self.pad, other))
            count = min(len(own), len(changed))
            if self.depths_mm[count - 1] >= ENOUGH * self.limit_mm and count >= LEAST_DEPTHS:
                break
        else:
            raise NoAnswerError("no_convergence", f"the {self.said} with another {what} could not be solved")
        # a polynomial takes out the scatter of contact that grows cell by cell
        depth, log = self.depths_mm[:count], np.log(changed[:count] / own[:count])
        smooth = np.polynomial.Polynomial.fit(depth, log, min(5, count - 1))
        return smooth(np.clip(self.dense_mm, depth[0], depth[-1]))


def _glued_slab(pad: Pad) -> bool:
    """Whether a pad is a flat slab under a glued flat punch, sharp or with a fillet."""
    return pad.geometry.plain and pad.profile_mm is None and pad.condition == "bonded" and pad.base in BASES


def _log_by_table(pad: Pad, depth_mm: NDArray) -> NDArray:
    """ln of F / E of a slab by the response table, its ends held, and what a bulk that gives takes off."""
    from dummydesign.loop.model.base_law import SlabLaw
    from dummydesign.pad.tables.slab import load_table

    law, thickness = SlabLaw(load_table(pad.base), pad.radius_mm, False), np.array([[pad.thickness_mm]])
    give = law.give(depth_mm[None], thickness)[0] if pad.poisson < 0.5 else 0.0
    return np.log(law(depth_mm[None], thickness)[0] / (1.0 + (1.0 - 2.0 * pad.poisson) * give))


def _coarse(pad: Pad | Puck, depth_mm: NDArray, cells: int) -> NDArray:
    """F / E at the first depths, on coarse cells with one bead where the elements allow. [mm2]"""
    inputs = {"pad": replace(pad, prony=()), "depth": depth_mm, "cells": cells}
    return np.asarray(cached("loop-coarse", inputs, lambda: _solve_coarse(pad, depth_mm, cells))["area_mm2"], float)


def _solve_coarse(pad: Pad | Puck, depth_mm: NDArray, cells: int) -> dict[str, Any]:
    from dummydesign.pad.elastic import solve_points
    from dummydesign.pad.material.hyperelastic import Yeoh
    from dummydesign.pad.shaped.axisymmetric import climb
    from dummydesign.pad.shaped.problem import Press

    h = pad.thickness_mm
    wanted = depth_mm[depth_mm <= MAX_DEPTH_OVER_THICKNESS * h]
    slides_round = not isinstance(pad, Puck) and pad.edge_radius_mm > 0.0 and pad.condition != "bonded"
    if isinstance(pad, Puck) or pad.profile_mm is not None or pad.base not in BASES or slides_round:
        return {"area_mm2": solve_points(pad, wanted).force_N / pad.young_MPa}
    press = Press(
        pad.geometry, h, pad.radius_mm / h, (pad.extent_mm or PAD_EXTENT_MM) / h, pad.base, pad.condition, pad.poisson,
        float(wanted[0]) / h,
    )  # fmt: skip
    press.check()
    # shear modulus 1, so that Young's modulus is 2 (1 + nu)
    path = climb(press, Yeoh(1.0), wanted / h, cells, RATIO_RIM)
    return {"area_mm2": path.force * h**2 / (2.0 * (1.0 + pad.poisson))}

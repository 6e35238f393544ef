"""The force law of one pad of a campaign: a curve over depth, and what changes it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.quantity import Quantity
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.interface import BASES
from dummydesign.loop.model.forward_model import REFERENCE_DEPTH
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.first_touch import touch_of, with_foot
from dummydesign.pad.force_law import ForceCurve
from dummydesign.pad.force_source import curve_without_solve, solve_points, solved_curve
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.tables.elastic_law import elastic_factor, mean_drop_mm
from dummydesign.pad.tables.puck import uniaxial
from dummydesign.pad.tables.slab import FILLETS, POWER, load_compressibility, load_table

POINTS, DENSE = 24, 600  # depths that are solved, and at which the curve is kept
STARTS_AT = 0.01
AT_TOUCH = 1e-12  # of the deepest depth: where the force is taken for depth 0
FINE_CELLS = 24
"""Cells under the punch of a pad with a shape, where a design takes 16: on a crowned pad of 7 mm those are 1.5 % off
cells of half the size in the depths where the contact reaches the flat, these 0.4 %."""
THICKER = 1.15
"""Ratio of thicknesses at which the change with thickness is solved, either way; further out it goes on straight."""
RATIO_CELLS, RATIO_RIM, ENOUGH = (10, 13), 0.1, 0.8
"""Cells and bead of ratios: the next finer ones where this share of the depth was not reached; held beyond."""
POISSON = 0.48
LEAST_DEPTHS = 4


@dataclass(frozen=True, eq=False)
class CampaignPadLaw:
    """One pad: F / E over depth, where it needs no solve by the pad model's table or closed form, else solved."""

    pad: Pad | Puck
    deepest_mm: float

    @property
    def name(self) -> str:
        """The pad in words."""
        pad, h = self.pad, self.pad.thickness_mm
        return f"puck of {pad.diameter_mm:g} x {h:g} mm" if isinstance(pad, Puck) else f"{pad.geometry} pad of {h:g} mm"

    @cached_property
    def known(self) -> ForceCurve | None:
        """Its force without a solve; None where it has to be solved."""
        return curve_without_solve(self.pad)

    @property
    def sharp(self) -> bool:
        """Whether its force needs no solve, and no fillet is declared."""
        return self.known is not None and not getattr(self.pad, "edge_radius_mm", 0.0)

    @property
    def offers(self) -> frozenset[str]:
        """What effects may ask of it."""
        pad = self.pad
        if isinstance(pad, Puck):
            return frozenset({"frictionless_plates"} if self.sharp else ())
        flat = pad.profile_mm is None
        glued = flat and pad.base == "bonded" and pad.condition == "bonded"
        has = {
            "flat_faces": flat and pad.geometry.flat_top,
            "sharp_edge": self.sharp,
            "bulk_that_gives": glued,
            "base_that_can_slip": glued and not pad.geometry.bone_height_mm,
        }
        return frozenset(name for name, given in has.items() if given)

    @property
    def grows(self) -> bool:
        """Whether its contact grows cell by cell."""
        pad = self.pad
        held = "flat_faces" in self.offers and isinstance(pad, Pad) and pad.base in BASES and pad.condition == "bonded"
        return isinstance(pad, Pad) and not held

    @cached_property
    def curve(self) -> ForceCurve:
        """Its force over depth, by the pad model."""
        return self.known or solved_curve(self.pad, self.depths_mm, FINE_CELLS)

    def _unsolved(self, *changed: str) -> NoAnswerError:
        """Make the error of solves that stopped too early."""
        message = f"the {self.name} with another {' and '.join(changed)} could not be solved"
        return NoAnswerError("no_convergence", message, quantity="pad")

    @property
    def depths_mm(self) -> NDArray:
        """Depths that are solved, closer together at the first touch. [mm]"""
        if isinstance(self.pad, Pad) and self.pad.profile_mm is None and self.pad.condition != "bonded":
            # a face that slides needs some depth to start from
            return self.deepest_mm * np.linspace(0.06, 1.0, POINTS)
        grid = self.deepest_mm * (STARTS_AT + (1.0 - STARTS_AT) * np.linspace(0.0, 1.0, POINTS) ** 1.5)
        return with_foot(grid, self.pad.geometry, self.pad.radius_mm) if isinstance(self.pad, Pad) else grid

    @property
    def limit_mm(self) -> float:
        """Depth to which it is known. [mm]"""
        return self.curve.limit_mm

    @property
    def relative_error(self) -> float:
        """Median of the stated error over the force."""
        return float(np.median(self.curve.relative_error(self.depths_mm[self.depths_mm <= self.limit_mm])))

    def error_by_exponent(self, alpha: Quantity) -> float:
        """Relative error at a usual depth of an elastic law's exponent that is known to an interval."""
        pad, depth = self.pad, REFERENCE_DEPTH * self.pad.thickness_mm
        if isinstance(pad, Puck):
            low, value, high = (
                uniaxial(one, np.array(REFERENCE_DEPTH)) for one in (alpha.low, alpha.value, alpha.high)
            )
            return float(max(abs(low / value - 1.0), abs(high / value - 1.0)))
        drop = mean_drop_mm(pad.geometry, pad.radius_mm)
        return float(elastic_factor(depth, pad.thickness_mm, pad.radius_mm, alpha, pad.geometry.name, drop)[1])

    @cached_property
    def power(self) -> float:
        """d ln F / d ln d at first touch, to the nearest half: 1 of a flat face, 1.5 of a tip, 2 of a cone."""
        touch = touch_of(self.pad)
        return 1.0 if touch is None else round(2.0 * touch.power(float(self.depths_mm[0]))) / 2.0

    @cached_property
    def dense_mm(self) -> NDArray:
        """Even depths at which curves are kept, the first one close to 0. [mm]"""
        return np.maximum(np.linspace(0.0, self.limit_mm, DENSE), AT_TOUCH * self.limit_mm)

    @cached_property
    def log_secant(self) -> NDArray:
        """ln of F / (E d^power) at the dense depths."""
        return np.log(self.curve.force(self.dense_mm) / (self.pad.young_MPa * self.dense_mm**self.power))

    @cached_property
    def with_thickness(self) -> tuple[NDArray, NDArray]:
        """First and half the second derivative of ln F at equal depth with respect to ln h, at the dense depths.

        The top of the pad stays what it is, as from a mould that is poured too full. From one side alone, and without
        a second derivative, where the other could not be solved.
        """
        sides: dict[float, NDArray] = {}
        for step in (float(np.log(THICKER)), -float(np.log(THICKER))):
            with suppress(NoAnswerError, InputError):
                sides[step] = self._log_ratio(thickness_mm=self.pad.thickness_mm * float(np.exp(step)))
        if not sides:
            raise self._unsolved("thickness_mm")
        powers = np.vander(list(sides), len(sides) + 1, increasing=True)[:, 1:]
        first, *second = np.linalg.solve(powers, np.stack(list(sides.values())))
        return first, second[0] if second else np.zeros(DENSE)

    @cached_property
    def log_sliding(self) -> NDArray:
        """ln of the force on a sliding base over that on the glued one, at the dense depths."""
        return self._log_ratio(base="sliding")

    @cached_property
    def bulk_coefficient(self) -> NDArray:
        """c of F / (1 + (1 - 2 nu) c) at the dense depths, for a Poisson's ratio nu below 1/2."""
        if self.known is not None:
            at = self.dense_mm[None] / self.pad.thickness_mm, np.array([[self.pad.radius_mm / self.pad.thickness_mm]])
            return load_compressibility().coefficient(*at)[0]
        return np.expm1(-self._log_ratio(poisson=POISSON)) / (1.0 - 2.0 * POISSON)

    def _log_ratio(self, **change: Any) -> NDArray:
        """ln of F / E of the pad with a change over this one's at equal depth, held beyond what both know; where they
        need a solve, both on the same coarser cells."""
        pads = (self.pad, replace(self.pad, **change))
        own, changed = map(curve_without_solve, pads)
        if own is not None and changed is not None:
            depth = np.minimum(self.dense_mm, min(own.limit_mm, changed.limit_mm))
            return np.log(changed.force(depth) / own.force(depth))
        for cells in RATIO_CELLS:
            before, after = (_coarse(pad, self.depths_mm, cells) for pad in pads)
            count = min(len(before), len(after))
            if self.depths_mm[count - 1] >= ENOUGH * self.limit_mm and count >= LEAST_DEPTHS:
                break
        else:
            raise self._unsolved(*change)
        # a polynomial takes out the scatter of contact that grows cell by cell
        depth, log = self.depths_mm[:count], np.log(after[:count] / before[:count])
        smooth = np.polynomial.Polynomial.fit(depth, log, min(5, count - 1))
        return smooth(np.clip(self.dense_mm, depth[0], depth[-1]))

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2] of depths (T, N) on pads about as thick as this one (T, 1); its last secant goes on beyond."""
        depth = np.maximum(depth_mm, 0.0)
        log = self.read(self.log_secant, depth)
        change = np.log(np.asarray(thickness_mm, float) / self.pad.thickness_mm)
        # one that needs no solve has its own law at every thickness
        if self.known is None and np.any(np.abs(change) > 1e-12):
            held = np.clip(change, -np.log(THICKER), np.log(THICKER))
            first, second = (self.read(values, depth) for values in self.with_thickness)
            log = log + first * change + second * held * (2.0 * change - held)
        return depth**self.power * np.exp(log)

    def log_filleted(self, edge_radius_mm: float) -> NDArray:
        """ln of the force under a fillet over that under the sharp edge at the dense depths; larger than the table's
        largest as that."""
        share = min(edge_radius_mm / self.pad.radius_mm, float(FILLETS[-1]))
        return self._by_fillet(share**POWER)

    @cached_property
    def _by_fillet(self) -> Callable[[float], NDArray]:
        from scipy.interpolate import PchipInterpolator

        # of a square as of the circle of its area
        circle = replace(self, pad=replace(cast(Pad, self.pad), sides_mm=None))
        rows = [circle._log_ratio(edge_radius_mm=share * self.pad.radius_mm) for share in FILLETS.tolist()]
        return PchipInterpolator(np.r_[0.0, FILLETS**POWER], [np.zeros(DENSE), *rows], axis=0)

    def at(self, thickness_mm: float) -> CampaignPadLaw:
        """The law of the pad at another thickness where that needs no solve, else this one."""
        same = self.known is None or thickness_mm == self.pad.thickness_mm
        return self if same else _of_thickness(self.pad, thickness_mm)

    def read(self, values: NDArray, depth_mm: NDArray) -> NDArray:
        """Values at depths (T, N), linear between the dense ones, constant outside."""
        position = np.clip(depth_mm / self.limit_mm, 0.0, 1.0) * (DENSE - 1)
        low = np.minimum(position.astype(int), DENSE - 2)
        part = position - low
        return values[low] * (1.0 - part) + values[low + 1] * part


@lru_cache(maxsize=512)
def _of_thickness(pad: Pad | Puck, thickness_mm: float) -> CampaignPadLaw:
    """The law of a pad of another thickness, held at the ends of the response table."""
    if isinstance(pad, Pad):
        thickest, thinnest = (pad.radius_mm / ratio for ratio in load_table(pad.base).ratio_range)
        thickness_mm = float(np.clip(thickness_mm, thinnest * (1.0 + 1e-9), thickest * (1.0 - 1e-9)))
    return CampaignPadLaw(replace(pad, thickness_mm=thickness_mm), MAX_DEPTH_OVER_THICKNESS * thickness_mm)


def _coarse(pad: Pad | Puck, depth_mm: NDArray, cells: int) -> NDArray:
    """F / E at the first depths, on coarse cells with one bead where the elements allow. [mm2]"""
    inputs = {"pad": replace(pad, prony=()), "depth": depth_mm, "cells": cells}
    return np.asarray(cached("loop-coarse", inputs, lambda: _solve_coarse(pad, depth_mm, cells))["area_mm2"], float)


def _solve_coarse(pad: Pad | Puck, depth_mm: NDArray, cells: int) -> dict[str, Any]:
    from dummydesign.pad.axisymmetric.shaped_problem import solve_path

    h = pad.thickness_mm
    wanted = depth_mm[depth_mm <= MAX_DEPTH_OVER_THICKNESS * h]
    slides_round = (
        isinstance(pad, Pad) and pad.condition != "bonded" and (pad.edge_radius_mm > 0.0 or pad.geometry.plain)
    )
    if isinstance(pad, Puck) or pad.profile_mm is not None or pad.base not in BASES or slides_round:
        return {"area_mm2": solve_points(pad, wanted).force_N / pad.young_MPa}
    case = Case.of(replace(pad, law=None))
    # a slab's ratio hardly knows the fillet, which is small beside its cells; a shaped pad's does
    edge = 0.0 if pad.geometry.plain else case.edge
    case = replace(case, edge=edge, first=float(wanted[0]) / h)
    # shear modulus 1, so that Young's modulus is 2 (1 + nu)
    path = solve_path(case, wanted / h, cells, RATIO_RIM)
    return {"area_mm2": path.force * h**2 / (2.0 * (1.0 + pad.poisson))}

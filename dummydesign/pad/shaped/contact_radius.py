"""Where a flat punch touches a shaped pad: the radius of the contact, which is how far off centre it may land.

While the contact stays inside the punch's face, the face may be moved sideways without any change: force and
depth are the same. The margin is the punch's half side less the contact's radius.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.shaped.paths import radius_touched
from dummydesign.pad.shaped.problem import CELLS, Press, shaped_problem
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.equilibrium import Solution

Array = np.ndarray


@dataclass(frozen=True)
class Touch:
    """Radius of the contact, in the deformed state, at depths that were reached. [mm]

    ``reaches_edge`` is where the contact has come to the punch's edge.
    """

    depth_mm: Array
    contact_radius_mm: Array
    reaches_edge: Array

    def radius_at(self, depth_mm: Array) -> Array:
        """Contact radius at other depths, on straight lines between the solved ones. [mm]"""
        known = np.concatenate([[0.0], self.depth_mm])
        return np.interp(depth_mm, known, np.concatenate([[0.0], self.contact_radius_mm]), right=np.nan)


def contact_radius(
    shape: PadShape, thickness_mm: float, radius_mm: float, depth_mm: Sequence[float], condition: str = "bonded",
    extent_mm: float = PAD_EXTENT_MM, cells: int = CELLS,
) -> Touch:  # fmt: skip
    """Press a round shaped pad with a round flat punch and find how far the contact reaches.

    Parameters
    ----------
    shape : PadShape
        Round, and touched gradually.
    thickness_mm, radius_mm : float
        Thickness at the highest point and radius of the punch. [mm]
    depth_mm : sequence of float
        Increasing depths above 0. [mm]
    condition, extent_mm, cells
        As for :func:`dummydesign.pad.shaped.axisymmetric.solve_shaped_pad`.

    Returns
    -------
    Touch
        Resolved to about the size of a cell, ``radius_mm / cells``.
    """
    depths = np.asarray(depth_mm, dtype=float) / thickness_mm
    press = Press(shape, float(thickness_mm), radius_mm / thickness_mm, extent_mm / thickness_mm, condition=condition,
                  first=float(depths[0]))  # fmt: skip
    press.check()
    inputs = {"shape": str(shape), "thickness": thickness_mm, "radius": radius_mm, "depth": depths, "cells": cells,
              "condition": condition, "extent": extent_mm}  # fmt: skip
    return Touch(**cached("touch", inputs, lambda: _press(press, depths, cells)))


def _press(press: Press, depths: Array, cells: int) -> dict[str, Any]:
    problem = shaped_problem(press, Yeoh(1.0), cells)
    found: list[float] = []

    def measure(depth: float, solution: Solution) -> None:
        found.append(radius_touched(problem, depth, solution))

    path = follow(problem, depths, 0.25 * float(depths[0]), 0.03, 3e-4, visit=measure)
    radius = np.array(found)
    edge = problem.punch.flat_radius
    return {
        "depth_mm": path.depth * press.thickness_mm,
        "contact_radius_mm": np.minimum(radius, press.radius) * press.thickness_mm,
        "reaches_edge": radius >= edge,
    }

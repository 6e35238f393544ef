"""Force of a slab under a filleted punch, whatever holds its face: glue, friction or nothing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dummydesign.geometry.interface import FACES, Interface
from dummydesign.pad.slab.filleted import solve_filleted
from dummydesign.pad.slab.frictionless.filleted_punch import solve_sliding
from dummydesign.pad.slab.problem import PadCurve
from dummydesign.pad.slab.rubbing.filleted_punch import solve_rubbing


def solve_under_fillet(
    thickness_mm: float,
    radius_mm: float,
    fillet_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | np.ndarray,
    condition: str,
    **more: Any,
) -> PadCurve:
    """Static force of a slab under a round punch with a filleted edge.

    Parameters
    ----------
    thickness_mm, radius_mm, fillet_mm, young_MPa, depth_mm
        As for :func:`dummydesign.pad.slab.filleted.solve_filleted`.
    condition : str
        ``bonded``, ``frictionless`` or ``friction:MU``.
    **more
        Base, Poisson's ratio, extent, law and progress of that function.

    Raises
    ------
    InputError
        For a value outside its range.
    NoAnswerError
        When no depth could be solved.
    """
    face = Interface.parse(condition, "condition", FACES)
    args = (thickness_mm, radius_mm, fillet_mm, young_MPa, depth_mm)
    if face.bonded:
        return solve_filleted(*args, **more)
    return solve_rubbing(*args, face.friction, **more) if face.friction else solve_sliding(*args, **more)

"""How far off the centre of a crowned pad the punch may press before the force changes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.request import PAPER
from dummydesign.geometry.standard import PAD_EXTENT_MM

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.geometry.shapes import PadShape
    from dummydesign.pad.shaped.contact_radius import Touch

LOSS_PERCENT = 1.0
"""The largest loss of force of the crowns solved in space is 2 % at 1 mm off centre (docs/shapes.md)."""
DEPTH_SHARES = np.linspace(0.05, 1.0, 12)


@dataclass(frozen=True)
class CentringTolerance:
    """Contact radius at each steady force, and the way the punch may be moved until its side meets the contact.

    Attributes
    ----------
    force_N : tuple of float
    contact_radius_mm, margin_mm : tuple of float or None
        ``margin_mm`` is the half side of the punch less the contact radius, 0 when the contact is wider. Up to
        it nothing changes; beyond it the force falls. None where the force is out of reach.
    """

    force_N: tuple[float, ...]
    contact_radius_mm: tuple[float | None, ...]
    margin_mm: tuple[float | None, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists."""
        return {name: list(value) for name, value in asdict(self).items()}

    @property
    def text(self) -> str:
        """The margins as a sentence."""
        free = [f"{m:.1f} mm at {f:g} N" for f, m in zip(self.force_N, self.margin_mm) if m is not None and m >= 0.05]
        wide = [f"{f:g}" for f, m in zip(self.force_N, self.margin_mm) if m is not None and m < 0.05]
        parts = [f"nothing changes within {', '.join(free)}"] if free else []
        if wide:
            parts.append(
                f"at {', '.join(wide)} N the force falls by at most {LOSS_PERCENT:g} % per 0.5 mm, up to 1 mm off "
                "centre (crowns solved in space, docs/shapes.md)"
            )
        return f"placement on the crown: {'; '.join(parts)}"


def centring_tolerance(
    best: Candidate,
    shape: PadShape,
    radius_mm: float,
    half_side_mm: float,
    forces_N: tuple[float, ...] = (1.0, *PAPER.forces_N),
    extent_mm: float = PAD_EXTENT_MM,
    touch: Touch | None = None,
) -> CentringTolerance | None:
    """Solve the contact of a round crowned pad; None for flat tops, shapes that are not round, or a failed solve.

    Parameters
    ----------
    best : Candidate
        The design, with its curves.
    shape : PadShape
        Its shape.
    radius_mm, half_side_mm : float
        Radius of the circle of the punch's area, and half of the punch's shorter side. [mm]
    forces_N : tuple of float
        Forces at which a tolerance is wanted. [N]
    extent_mm : float
        Radius of the circle of the pad's area. [mm]
    touch : Touch, optional
        The contact, where it was solved already.

    Returns
    -------
    CentringTolerance or None
    """
    from dummydesign.pad.shaped.contact_radius import contact_radius

    if shape.flat_top or not shape.axisymmetric:
        return None
    slabs = best.evaluation.slabs.take(np.array([best.index]))
    depth = slabs.curves.depth_at(slabs.slab, np.array([forces_N]) / slabs.young_MPa[0])[0]
    if not np.isfinite(depth).any():
        return None
    try:
        if touch is None:
            wanted = np.nanmax(depth) * DEPTH_SHARES
            touch = contact_radius(shape, best.thickness_mm, radius_mm, wanted, extent_mm=extent_mm)
    except NoAnswerError:
        return None
    radius = touch.radius_at(depth)
    margin = np.maximum(half_side_mm - radius, 0.0)
    values = (tuple(float(v) if np.isfinite(v) else None for v in row) for row in (radius, margin))
    return CentringTolerance(forces_N, *values)

"""A force law of one's own: an open foam that carries under the punch alone, beside the polyurethane slab's table.

Equation: F = 20 E pi a^2 (d/h)^2 / (1 - d/h), springs under the punch that stiffen as the foam's cells close.
"""

import numpy as np

from dummydesign.pad.force_law import BaseForceLaw, curve_at
from dummydesign.pad.tables.slab import load_table


class Foam(BaseForceLaw):
    """Springs under the punch alone, to half the thickness, known to 2 %."""

    notes = ("the foam's law is of one batch",)

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        """Elastic force; zero above the surface. [N]"""
        share = np.maximum(np.asarray(depth_mm, float) / thickness_mm, 0.0)
        return 20.0 * np.asarray(young_MPa) * np.pi * np.square(radius_mm) * share**2 / (1.0 - share)

    def depth_limit_mm(self, thickness_mm, radius_mm):
        """Depth to which the law holds. [mm]"""
        return 0.5 * np.asarray(thickness_mm, float)

    def relative_error(self, depth_mm, thickness_mm, radius_mm):
        """Stated error of the force over the force."""
        return np.full(np.broadcast(depth_mm, thickness_mm, radius_mm).shape, 0.02)


depths = np.array([0.5, 1.0, 2.0])
for name, law in (("foam", Foam()), ("slab", load_table("bonded"))):
    pad = curve_at(law, thickness_mm=8.0, young_MPa=0.03, radius_mm=7.9)
    for depth, force, stiffness in zip(depths, pad.force(depths), pad.stiffness(depths)):
        error = 100.0 * float(pad.relative_error(np.array(depth)))
        print(f"{name} at {depth:g} mm: {force:.3f} N +- {error:.1f} %, {stiffness:.3f} N/mm")

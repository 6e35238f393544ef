"""A slab law from the layer solution and a small tissue, so that these tests stand on known formulas."""

import numpy as np

from dummydesign.core.quantity import Quantity
from dummydesign.tissue.model.maxwell_law import Parameters
from dummydesign.tissue.model.tissue import Subject, Tissue
from tests.support.exact_law import ExactLaw

# Stiffness factor of a frictionless flat punch on an incompressible layer bonded to a rigid base,
# Hayes et al. 1972, recomputed from the integral equation.
A_OVER_H = [0.2, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0]
KAPPA = [1.281, 1.684, 2.213, 2.860, 3.619, 6.003, 9.149, 18.157]


class LayerLaw(ExactLaw):
    """F = 8/3 E a d kappa(a/h) (1 + 1.5 (d/h)^2): the layer solution with growth at finite depth."""

    growth = 1.5

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        depth, thickness = np.asarray(depth_mm, float), np.asarray(thickness_mm, float)
        kappa = np.exp(np.interp(np.log(radius_mm / thickness), np.log(A_OVER_H), np.log(KAPPA)))
        stiffening = 1.0 + self.growth * (depth / thickness) ** 2
        return 8.0 / 3.0 * np.asarray(young_MPa, float) * radius_mm * depth * kappa * stiffening

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.6 * np.asarray(thickness_mm, float)


def make_tissue(gamma1=(0.8, 1.3, 2.2), law="consistent"):
    """Make three subjects with springs and dampers in fixed proportions to gamma1."""

    def quantity(value):
        return Quantity(value, 0.9 * value, 1.1 * value, "assumed", "test tissue")

    subjects = []
    for name, g in zip("abc", gamma1):
        numbers = {
            "gamma1_N_per_mm3": g,
            "gamma2_N_per_mm3": 0.2 * g,
            "gamma3_N_per_mm3": 0.5 * g,
            "c2_N_s_per_mm": {"10": 1.0 * g, "250": 0.5 * g},
            "c3_N_s_per_mm": {"10": 0.15 * g, "250": 0.03 * g},
        }
        held = {
            key: {speed: quantity(item) for speed, item in value.items()}
            if isinstance(value, dict)
            else quantity(value)
            for key, value in numbers.items()
        }
        subjects.append(Subject(name, Parameters.from_dict(law, numbers), held))
    return Tissue("test-finger", "test tissue", law, tuple(subjects), ("test",), (), "file")

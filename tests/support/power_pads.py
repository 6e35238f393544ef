"""Pads that follow a power of the depth, with two relaxing arms: of any stiffness side by side."""

import numpy as np

from dummydesign.design.scoring.press_simulation import PadBatch, make_curves
from tests.support.exact_law import ExactLaw


class Power(ExactLaw):
    """F = E d^n: pads that do not depend on their thickness."""

    def __init__(self, exponent):
        self.exponent = exponent

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        return np.asarray(young_MPa) * np.asarray(depth_mm) ** self.exponent * np.ones_like(np.asarray(thickness_mm))

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.6 * np.asarray(thickness_mm, float)


def pads(exponent, stiffness, beta, tau=(0.02, 0.6), thickness_mm=6.0):
    """Designs of one exponent with stiffnesses in N/mm^n and a relaxation over the long-term force."""
    count = len(stiffness)
    curves = make_curves(Power(exponent), [thickness_mm], 7.9, 0.6)
    return PadBatch(curves, np.zeros(count, int), np.asarray(stiffness, float), tau, np.tile(beta, (count, 1)))

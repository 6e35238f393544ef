"""The corrected pad for designing: force law and modulus of a calibration, without what belongs to the set-up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.loop.calibration import Calibration
from dummydesign.loop.law import SlabLaw
from dummydesign.pad.table import load_table


@dataclass(frozen=True)
class CorrectedLaw:
    """Static force of slabs with the pad effects of a calibration and its law error; offers what a table offers.

    Sensor and motion effects are left out: they are of the laboratory, not of the pad. Batch effects (softening,
    temperature, ageing) are at their reference: first press, 23 C, 7 days.
    """

    calibration: Calibration
    square: bool = True

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Static force; arguments broadcast, NaN beyond the table. [N]"""
        depth, thickness, young = np.broadcast_arrays(
            *(np.asarray(value, dtype=float) for value in (depth_mm, thickness_mm, young_MPa))
        )
        law = SlabLaw(load_table(self.calibration.pad["base"]), float(radius_mm), self.square)
        x, h = depth.reshape(-1, 1), thickness.reshape(-1, 1)
        limit = law.limit(h)
        acting = law
        for one in self.calibration.design_effects():
            acting = one.effect.law(None, acting, one.values)
        error = self.calibration.after.law_error(h[:, 0])
        unit = acting(x, h) * error.factor(np.clip(x, 0.0, limit) / h)
        unit = np.where(x > limit * (1.0 + 1e-9), np.nan, unit)
        return young * unit.reshape(depth.shape)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth to which the table holds. [mm]"""
        table = load_table(self.calibration.pad["base"])
        return table.depth_limit_mm(np.asarray(thickness_mm, dtype=float), radius_mm)


def young_factor(calibration: Calibration) -> float:
    """Long-term modulus found over the one that was expected (nominal, or the resin's at its ratio).

    A batch that came out softer than its recipe says is designed for by multiplying the resin's modulus by this.
    """
    return 1e3 * calibration.after.base.young_MPa / float(calibration.pad["young_kPa_expected"])

"""The corrected pad for designing: force law and modulus of a calibration, without what belongs to the laboratory."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.geometry.interface import BASES
from dummydesign.loop.calibration import Calibration
from dummydesign.loop.model.base_law import SlabLaw
from dummydesign.pad.force_law import BaseForceLaw
from dummydesign.pad.tables.slab import load_table


@dataclass(frozen=True)
class CorrectedLaw(BaseForceLaw):
    """Static force of slabs with a calibration's effects of the pad and its law error; offers what a table offers.

    Effects of the rig and the sensor are left out: they are of the laboratory. Effects that depend on a state of
    the pad are taken where they are absent, see ``Effect.designed_for`` and :attr:`notes`. What a campaign of
    pucks found wrong with the law of pucks says nothing of slabs and is left out too.
    """

    calibration: Calibration
    square: bool = True

    @property
    def base(self) -> str:
        """Base of the slabs that are designed: as in the campaign, glued when it pressed pucks or its base rubs."""
        base = self.calibration.pad["base"]
        return "bonded" if self.calibration.on_pucks() or base not in BASES else base

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the design must know of the effects in it."""
        said = [self.calibration.caution] if self.calibration.caution else []
        for one in self.calibration.design_effects():
            if one.effect.designed_for:
                said.append(f"the calibration holds {one.effect.name}: the design is for {one.effect.designed_for}")
            elif self.calibration.on_pucks() and not one.effect.adds_terms(one.values):
                said.append(
                    f"{one.effect.name} was found on pucks between plates and acts here at the same depth over "
                    "thickness, where the strain under a punch is another: press a slab to be sure"
                )
        return tuple(said)

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Static force, NaN beyond the table; see :class:`dummydesign.pad.force_law.ForceLaw`. [N]"""
        depth, thickness, young = np.broadcast_arrays(
            *(np.asarray(value, dtype=float) for value in (depth_mm, thickness_mm, young_MPa))
        )
        law = SlabLaw(load_table(self.base), float(radius_mm), self.square)
        x, h = depth.reshape(-1, 1), thickness.reshape(-1, 1)
        limit = law.limit(h)
        acting = law
        for one in self.calibration.design_effects():
            acting = one.effect.law(acting, one.values)
        unit = acting(x, h)
        if not self.calibration.on_pucks():
            unit = unit * self.calibration.after.law_error(h[:, 0]).factor(np.clip(x, 0.0, limit) / h)
        unit = np.where(x > limit * (1.0 + 1e-9), np.nan, unit)
        return young * unit.reshape(depth.shape)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth to which the table holds. [mm]"""
        return load_table(self.base).depth_limit_mm(np.asarray(thickness_mm, dtype=float), radius_mm)


def young_factor(calibration: Calibration) -> float:
    """Long-term modulus found over the one that was expected (nominal, or the resin's at its ratio).

    A batch that came out softer than its recipe says is designed for by multiplying the resin's modulus by this.
    """
    return 1e3 * calibration.after.base.young_MPa / float(calibration.pad["young_kPa_expected"])

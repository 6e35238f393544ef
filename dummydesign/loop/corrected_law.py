"""The corrected pad for designing: force law and modulus of a calibration, without what belongs to the laboratory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.geometry.dimensions import PUNCH
from dummydesign.loop.calibration import Calibration
from dummydesign.loop.effects.learned import Learned
from dummydesign.loop.model.effect import SETUP, UnitForce
from dummydesign.loop.model.forward_model import Active
from dummydesign.pad.force_law import BaseForceLaw, ForceLaw
from dummydesign.pad.tables.slab import load_compressibility, load_table, slab_table
from dummydesign.pad.tables.square import square_law

BULK = "bulk_that_gives"


@dataclass(frozen=True)
class Correction:
    """What a calibration changes of the force of pads that are designed: effects of the pad, and the law error.

    Effects of the rig and the sensor are left out: they are of the laboratory. What changes the arms with depth or
    speed acts in each press (``Effect.pressed_arms``). Effects that depend on a state of the pad are taken where they
    are absent, see ``Effect.designed_for`` and :meth:`notes`. The law error is that of pads of the same shape, base
    and contact; what a campaign of pucks found wrong with the law of pucks stays out.
    """

    calibration: Calibration
    base: str = "bonded"
    punch: str = PUNCH

    def effects(self, shaped: bool) -> tuple[Active, ...]:
        """Effects of the pad that have a value on slabs, or on pads with a shape."""
        return tuple(one for one in self.calibration.design_effects() if not self._unfit(one, shaped))

    def _unfit(self, one: Active, shaped: bool) -> str:
        """Why an effect has no value on pads that are designed; empty when it has."""
        effect = one.effect
        kind = "shaped" if shaped else "slab"
        if kind not in effect.shapes:
            return f"it is for {' and '.join(effect.shapes)} only"
        needs = [SETUP[name] for name in effect.needs if name in SETUP and name != BULK]
        return f"it needs {' and '.join(needs)}" if shaped and needs else ""

    def apply(
        self,
        law: UnitForce,
        depth_mm: NDArray,
        thickness_mm: NDArray,
        limit_mm: NDArray,
        shapes: Sequence[str] | None = None,
    ) -> NDArray:
        """F / E with all that was found of the pad. [mm2]"""
        acting = law
        for one in self.effects(shaped=shapes is not None):
            acting = one.effect.law(acting, one.values)
        unit = acting(depth_mm, thickness_mm)
        if not self.knows_the_law():
            return unit
        error = self.calibration.after.law_error(thickness_mm[:, 0], shapes or (), cast=True)
        return unit * error.factor(np.clip(depth_mm, 0.0, limit_mm) / thickness_mm)

    def knows_the_law(self) -> bool:
        """Whether the campaign pressed pads that lay and were pressed as those that are designed.

        Files of earlier versions name no punch: theirs is taken for the standard one.
        """
        pad = self.calibration.pad
        held = pad.get("base") == self.base and (pad.get("contact") or "bonded") == "bonded"
        return held and (pad.get("punch") or PUNCH) == self.punch and not self.calibration.on_pucks()

    def notes(self, shaped: bool) -> tuple[str, ...]:
        """What a reader of the design must know of the effects in it."""
        lines = [self.calibration.caution] if self.calibration.caution else []
        for one in self.calibration.design_effects():
            unfit = self._unfit(one, shaped)
            if unfit:
                lines.append(f"the calibration holds {one.effect.name}, which is not in this design: {unfit}")
            elif one.effect.designed_for:
                lines.append(f"the calibration holds {one.effect.name}: the design is for {one.effect.designed_for}")
            elif self.calibration.on_pucks() and not one.effect.adds_terms(one.values):
                lines.append(
                    f"{one.effect.name} was found on pucks between plates and acts here at the same depth over "
                    "thickness, where the strain under a punch is another: press a pad to be sure"
                )
            elif shaped and BULK in one.effect.needs:
                lines.append(f"{one.effect.name} acts on the shaped pad as on a slab as thick, at the same depth")
        for one in self.calibration.after.active:
            if isinstance(one.effect, Learned) and one.effect.belongs_to != "pad":
                lines.append(f"the calibration holds {one.effect.name}, an effect of the load cell: not in this design")
        return tuple(lines)


@dataclass(frozen=True)
class DesignedForce:
    """F / E of pads that are designed; a bulk that gives changes it as on slabs."""

    force: UnitForce
    radius_mm: float

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E. [mm2]"""
        return self.force(depth_mm, thickness_mm)

    def compressibility_coefficient(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """c of a compressible pad."""
        return load_compressibility().coefficient(depth_mm / thickness_mm, self.radius_mm / thickness_mm)


@dataclass(frozen=True)
class CorrectedLaw(BaseForceLaw):
    """Static force of slabs as a calibration corrects it (:class:`Correction`); offers what a table offers."""

    correction: Correction
    square: bool = True
    edge_radius_mm: float = 0.0

    @property
    def ratio_range(self) -> tuple[float, float]:  # type: ignore[override]
        """Smallest and largest punch radius over thickness: those of the table, with a fillet as without."""
        return load_table(self.correction.base).ratio_range

    @property
    def notes(self) -> tuple[str, ...]:  # type: ignore[override]
        """What a reader of the design must know of the effects in it."""
        return self.correction.notes(shaped=False)

    def force(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
        """Static force, NaN beyond the table; see :class:`dummydesign.pad.force_law.ForceLaw`. [N]"""
        depth, thickness, young = np.broadcast_arrays(
            *(np.asarray(value, dtype=float) for value in (depth_mm, thickness_mm, young_MPa))
        )
        radius = np.asarray(radius_mm, float).item()
        law = self._plain(radius)
        x, h = depth.reshape(-1, 1), thickness.reshape(-1, 1)
        plain = DesignedForce(lambda at_mm, h_mm: law.force(at_mm, h_mm, 1.0, radius), radius)
        return young * self.correction.apply(plain, x, h, law.depth_limit_mm(h, radius)).reshape(depth.shape)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Error of the table that is corrected; a calibration makes it no smaller, its own is the modulus's interval.

        See :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        return self._plain(np.max(radius_mm)).relative_error(depth_mm, thickness_mm, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Depth to which the table holds. [mm]"""
        return self._plain(np.max(radius_mm)).depth_limit_mm(thickness_mm, radius_mm)

    def _plain(self, radius_mm: float) -> ForceLaw:
        """The law that is corrected."""
        table = slab_table(self.correction.base, self.edge_radius_mm, float(radius_mm))
        return square_law(table, self.correction.base, self.edge_radius_mm > 0.0) if self.square else table

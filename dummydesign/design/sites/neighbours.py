"""How much neighbours and rim change the force on one crown: two round pads between which the real one lies.

A body with more material stores more elastic energy under the same punch: what is added can only hold it. So a crown
among others is at least as stiff as the same crown on a disc that fits between it and the pad's rim, which has less
material, and at most as stiff as the crown in the middle of a pad that has its full thickness all around from the
nearest foot of a neighbour on, which has more. Both are round and are solved by axisymmetric finite elements at
finite strain, on one grid with the pad that the design is made for. The bounds hold for the energy up to a depth
exactly (minimum of potential energy); compared is the force, which is its slope.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.pad_shape import Array, PadShape
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.shaped.paths import climb
from dummydesign.pad.shaped.problem import CELLS, RIMS, Press

FIRST_SHARE = 0.05
DEPTH_SHARES = np.array([0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0])
RAMP_MM = 1.0


@dataclass(frozen=True)
class Marked(PadShape):
    """A crown in the middle of a pad with one more line of the mesh, at which a ring of full thickness may begin.

    It is solved and never cast. Crown and ring are compared with the crown alone on the same cells, so that the
    difference is not that of two meshes. The wall of the ring leans inwards by :data:`RAMP_MM`, which adds material.

    Attributes
    ----------
    crown : PadShape
    line_mm : float
        Where the ring, or nothing, begins. [mm]
    ring : bool
    """

    name = "marked"
    crown: PadShape
    line_mm: float
    ring: bool = False

    @property
    def flat_top(self) -> bool:
        """The crown is touched first and gradually."""
        return False

    def drop_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Fall of the crown, and the ring's rise."""
        r = np.hypot(x_mm, y_mm)
        fall = self.crown.drop_mm(r, 0.0 * r)
        if not self.ring:
            return fall
        return np.minimum(fall, self.crown.relief_mm * np.clip((self.line_mm - r) / RAMP_MM, 0.0, 1.0))

    def __str__(self) -> str:
        return f"{self.crown} with {'a ring' if self.ring else 'a line'} from {self.line_mm:g} mm on"

    def lines_mm(self) -> tuple[float, ...]:
        """Foot of the crown, and of the ring's wall."""
        return (*self.crown.lines_mm(), self.line_mm - RAMP_MM, self.line_mm)


@dataclass(frozen=True)
class Alone:
    """One crown on the pad that its design was solved for.

    Attributes
    ----------
    crown : PadShape
        Round, with one place.
    thickness_mm, radius_mm : float
        Of the pad, and of the circle of the punch's area. [mm]
    depth_mm : float
        The deepest press. [mm]
    extent_mm : float
        Radius of the circle of the pad's area. [mm]
    base : str
    """

    crown: PadShape
    thickness_mm: float
    radius_mm: float
    depth_mm: float
    extent_mm: float = PAD_EXTENT_MM
    base: str = "bonded"

    def softer(self, rim_mm: float) -> float:
        """Largest relative change of the force when the pad ends ``rim_mm`` from the tip: below 0, a lower bound.

        Parameters
        ----------
        rim_mm : float
            From the tip to the nearest side of the pad. [mm]
        """
        line = Marked(self.crown, 0.5 * (float(self.crown.lines_mm()[0]) + rim_mm))
        return self._change(line, self.extent_mm, line, rim_mm)

    def stiffer(self, pitch_mm: float) -> float:
        """The same when the pad has its full thickness all around from the nearest neighbour's foot on: upper bound.

        Parameters
        ----------
        pitch_mm : float
            From tip to tip. [mm]
        """
        inner = pitch_mm - float(self.crown.lines_mm()[0])
        around = max(self.extent_mm, 2.0 * pitch_mm, PAD_EXTENT_MM)
        return self._change(Marked(self.crown, inner), max(self.extent_mm, 1.1 * inner),
                            Marked(self.crown, inner, True), around)  # fmt: skip

    def _change(self, one: Marked, extent_mm: float, other: Marked, its_extent_mm: float) -> float:
        alone, among = self._force(one, extent_mm), self._force(other, its_extent_mm)
        count = min(len(alone), len(among))
        if count < len(DEPTH_SHARES) - 1:
            raise NoAnswerError("no_convergence", f"{other} was solved to {count} of {len(DEPTH_SHARES)} depths")
        change = among[:count] / alone[:count] - 1.0
        return float(change[np.argmax(np.abs(change))])

    def _force(self, shape: Marked, extent_mm: float) -> Array:
        """Force at the shares of the depth that were reached, in moduli and thicknesses."""
        depth = self.depth_mm * DEPTH_SHARES
        inputs = {"shape": str(shape), "thickness": self.thickness_mm, "radius": self.radius_mm, "depth": depth,
                  "extent": extent_mm, "base": self.base}  # fmt: skip
        found = cached("site", inputs, lambda: self._solve(shape, depth, extent_mm))
        return np.asarray(found["force"], float)

    def _solve(self, shape: Marked, depth_mm: Array, extent_mm: float) -> dict[str, Array]:
        """With the larger fillet: contact at a sharper edge jumps from cell to cell by more than what is looked for."""
        h = self.thickness_mm
        press = Press(shape, h, self.radius_mm / h, extent_mm / h, self.base, first=FIRST_SHARE * self.depth_mm / h)
        press.check()
        return {"force": climb(press, Yeoh(1.0), depth_mm / h, CELLS // 2, RIMS[0]).force}

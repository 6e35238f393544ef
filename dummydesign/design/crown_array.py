"""Several crowns on one pad, each far enough from others to be pressed as if alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.scoring.verdict import TOLERANCE
from dummydesign.geometry.dimensions import PAD_EXTENT_MM, RIM_FREE_MM
from dummydesign.geometry.pad_shape import Array, PadShape

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import DesignCandidate, SearchSpace
    from dummydesign.geometry.punch import Punch

FIRST_SHARE = 0.05
DEPTH_SHARES = np.array([0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0])
RAMP_MM = 1.0


@dataclass(frozen=True)
class CrownWithRing(PadShape):
    """A crown at the centre of a pad with one more line of the mesh, at which a ring of full thickness may begin.

    It is solved and never cast. Crown and ring are compared with the crown alone on the same cells, so that the
    difference is not that of two meshes. The wall of the ring leans inwards by :data:`RAMP_MM`, which adds material.
    """

    name = "marked"
    flat_top = False
    crown: PadShape
    line_mm: float
    ring: bool = False

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
class IsolatedCrown:
    """One crown on the pad that its design was solved for."""

    crown: PadShape
    thickness_mm: float
    radius_mm: float
    depth_mm: float
    extent_mm: float = PAD_EXTENT_MM
    base: str = "bonded"

    def softer(self, rim_mm: float) -> float:
        """Largest relative change of the force when the pad ends ``rim_mm`` from the tip: below 0, a lower bound."""
        line = CrownWithRing(self.crown, 0.5 * (float(self.crown.lines_mm()[0]) + rim_mm))
        return self._change(line, self.extent_mm, line, rim_mm)

    def stiffer(self, pitch_mm: float) -> float:
        """The same when the pad has its full thickness all around from the nearest neighbour's foot on: upper bound."""
        inner = pitch_mm - float(self.crown.lines_mm()[0])
        around = max(self.extent_mm, 2.0 * pitch_mm, PAD_EXTENT_MM)
        return self._change(
            CrownWithRing(self.crown, inner),
            max(self.extent_mm, 1.1 * inner),
            CrownWithRing(self.crown, inner, True),
            around,
        )

    def _change(self, one: CrownWithRing, extent_mm: float, other: CrownWithRing, its_extent_mm: float) -> float:
        alone, among = self._force(one, extent_mm), self._force(other, its_extent_mm)
        count = min(len(alone), len(among))
        if count < len(DEPTH_SHARES) - 1:
            message = f"{other} was solved to {count} of {len(DEPTH_SHARES)} depths"
            raise NoAnswerError("no_convergence", message, quantity="sites")
        change = among[:count] / alone[:count] - 1.0
        return float(change[np.argmax(np.abs(change))])

    def _force(self, shape: CrownWithRing, extent_mm: float) -> Array:
        """Force at the shares of the depth that were reached, in moduli and thicknesses."""
        from dummydesign.core.cache import cached

        depth = self.depth_mm * DEPTH_SHARES
        inputs = {
            "shape": str(shape),
            "thickness": self.thickness_mm,
            "radius": self.radius_mm,
            "depth": depth,
            "extent": extent_mm,
            "base": self.base,
        }
        solved = cached("site", inputs, lambda: self._solve(shape, depth, extent_mm))
        return np.asarray(solved["force"], float)

    def _solve(self, shape: CrownWithRing, depth_mm: Array, extent_mm: float) -> dict[str, Array]:
        """With the larger fillet: contact at a sharper edge jumps from cell to cell by more than what is looked for."""
        from dummydesign.pad.axisymmetric.case import Case
        from dummydesign.pad.axisymmetric.shaped_problem import CELLS, RIMS, solve_path

        h, first = self.thickness_mm, FIRST_SHARE * self.depth_mm / self.thickness_mm
        case = Case(self.radius_mm / h, extent_mm / h, self.base, shape=shape, thickness_mm=h, first=first)
        case.check()
        return {"force": solve_path(case, depth_mm / h, CELLS // 2, RIMS[0]).force}


# Share of the force by which neighbours and rim may change it: how finely a steady force can be set.
INDEPENDENT = TOLERANCE
# How far beside a tip the punch may land; its placement is stated to 1 mm (docs/shapes.md).
PLACING_MM = 1.0
STEP_MM, FARTHEST_MM = 0.5, 60.0


@dataclass(frozen=True)
class Sites:
    """Crowns in a grid."""

    along: int
    across: int
    pitch_mm: tuple[float, float]
    rim_mm: float
    softer: float
    stiffer: float

    @property
    def text(self) -> str:
        """The grid and what its neighbours do, in words."""
        pitches = " x ".join(f"{pitch:g}" for pitch in self.pitch_mm if pitch)
        low, high = 100.0 * self.softer, 100.0 * self.stiffer
        return (
            f"{self.along} x {self.across} crowns, {pitches} mm apart, the outermost {self.rim_mm:g} mm from the rim: "
            f"solved, neighbours and rim change the force by {low:.2f} to {high:+.2f} %"
        )

    def on(self, shape: PadShape) -> PadShape:
        """The pad's shape with all its crowns."""
        grid: dict[str, Any] = {"sites_along": float(self.along), "sites_across": float(self.across)}
        return replace(shape, **grid, **dict(zip(("pitch_along_mm", "pitch_across_mm"), self.pitch_mm)))

    def to_dict(self, shape: PadShape) -> dict[str, Any]:
        """Return the grid with the places of the tips."""
        return {
            "along": self.along,
            "across": self.across,
            "pitch_mm": list(self.pitch_mm),
            "rim_mm": self.rim_mm,
            "places_mm": [list(position) for position in shape.places_mm],
            "force_change": {"low": self.softer, "high": self.stiffer},
            "text": self.text,
        }


def lay_out_sites(
    shape: PadShape, best: DesignCandidate, space: SearchSpace, punch: Punch, wanted: tuple[int, int]
) -> Sites:
    """Lay out the crowns of a design, checked at its deepest press."""
    depth = float(np.nanmax(best.depth_mm))
    alone = IsolatedCrown(shape, best.thickness_mm, space.radius_mm, depth, space.extent_mm, space.base)
    reach = float(np.hypot(*punch.sides_mm)) / 2.0 if punch.sides_mm else punch.radius_mm
    return lay_out(alone, wanted, space.pad_mm, reach)


def lay_out(alone: IsolatedCrown, wanted: tuple[int, int], pad_mm: tuple[float, float], reach_mm: float) -> Sites:
    """Crowns as far apart as the pad allows, checked by their two bounds.

    Every crown first has an even share of the pad; where that puts the outermost too near to the rim, they move in as
    far as independence asks for.
    """
    even = [(size / count, 0.5 * size / count) for size, count in zip(pad_mm, wanted)]
    several = [pitch for (pitch, _), count in zip(even, wanted) if count > 1]
    pitch, rim = min(several, default=FARTHEST_MM), min(side for _, side in even)
    # Pitch and rim that castability and the punch ask for, which must not touch a neighbour. [mm]
    foot = float(alone.crown.lines_mm()[0])
    least = foot + max(reach_mm + PLACING_MM, foot) + RAMP_MM, max(foot + RIM_FREE_MM, 1.5 * alone.radius_mm)
    if pitch >= least[0] and rim >= least[1]:
        sites = _sites(alone, wanted, pad_mm, rim)
        if max(-sites.softer, sites.stiffer) <= INDEPENDENT:
            return sites
    pitch, rim = _needed(alone.stiffer, least[0]), _needed(alone.softer, least[1])
    if all((count - 1) * pitch + 2.0 * rim <= size + 1e-9 for count, size in zip(wanted, pad_mm)):
        return _sites(alone, wanted, pad_mm, rim, pitch)
    raise InputError(_does_not_fit(wanted, pad_mm, pitch, rim), "cannot_be_made", "sites", wanted)


def _sites(
    alone: IsolatedCrown, wanted: tuple[int, int], pad_mm: tuple[float, float], rim_mm: float, pitch_mm: float = 0.0
) -> Sites:
    """The grid with a rim of at least ``rim_mm``, pitches in tenths of a millimetre, and its bounds.

    Even shares that are narrower than ``pitch_mm`` give way to crowns that are moved out to the rim.
    """
    pitches = []
    for count, size in zip(wanted, pad_mm):
        even = size / count
        shared = count == 1 or (0.5 * even >= rim_mm and even >= pitch_mm)
        widest = even if shared else (size - 2.0 * rim_mm) / (count - 1)
        pitches.append(floor(10.0 * widest + 1e-6) / 10.0 if count > 1 else 0.0)
    sides = [0.5 * (size - (count - 1) * pitch) for count, size, pitch in zip(wanted, pad_mm, pitches)]
    rim = floor(10.0 * min(sides) + 1e-6) / 10.0
    nearest = min((pitch for pitch in pitches if pitch), default=0.0)
    return Sites(
        *wanted,
        (pitches[0], pitches[1]),
        rim,
        min(alone.softer(rim), 0.0),
        max(alone.stiffer(nearest), 0.0) if nearest else 0.0,
    )


def _needed(change: Callable[[float], float], least_mm: float) -> float:
    """The smallest length, in steps of half a millimetre, at which a bound is within :data:`INDEPENDENT`. [mm]"""
    low, high = least_mm, least_mm
    step = 4.0
    while abs(change(high)) > INDEPENDENT:
        if high > FARTHEST_MM:
            message = f"crowns are not independent up to {FARTHEST_MM:g} mm apart"
            raise NoAnswerError("no_convergence", message, quantity="sites")
        low, high = high, high + step
    while high - low > STEP_MM:
        middle = low + STEP_MM * max(1, round(0.5 * (high - low) / STEP_MM))
        if middle >= high:
            break
        low, high = (low, middle) if abs(change(middle)) <= INDEPENDENT else (middle, high)
    return high


def _does_not_fit(wanted: tuple[int, int], pad_mm: tuple[float, float], pitch_mm: float, rim_mm: float) -> str:
    """What fits, in one line."""
    held = [
        min(count, floor((size - 2.0 * rim_mm) / pitch_mm + 1e-9) + 1) if size >= 2.0 * rim_mm else 0
        for count, size in zip(wanted, pad_mm)
    ]
    needed = "x".join(f"{ceil((count - 1) * pitch_mm + 2.0 * rim_mm):g}" for count in wanted)
    text = (
        f"sites = {wanted[0]}x{wanted[1]} do not fit a pad of {pad_mm[0]:g}x{pad_mm[1]:g} mm: this crown needs "
        f"{pitch_mm:.3g} mm to the next and {rim_mm:.3g} mm to the rim; "
    )
    fits = f"{held[0]}x{held[1]} fit it, and " if min(held) else ""
    return f"{text}{fits}{wanted[0]}x{wanted[1]} need {needed} mm (--pad)"


def pressed_alone(places: Sequence[int]) -> list[dict[str, str]]:
    """One warning for pads with several crowns each, or none.

    Examples
    --------
    >>> [item["code"] for item in pressed_alone([1, 12, 4])], pressed_alone([1])
    (['several_sites'], [])
    """
    several = sorted({count for count in places if count > 1})
    if not several:
        return []
    counts = " or ".join(f"{count}" for count in several)
    message = f"one of {counts} crowns is pressed as if it were alone; 'suggest --sites' solves what the others change"
    return [{"code": "several_sites", "message": message}]

"""Where the crowns of one pad stand: a grid in which each is pressed as if it were alone, or the nearest that works."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, floor
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.scoring.deviations import TOLERANCE
from dummydesign.design.sites.neighbours import RAMP_MM, Alone
from dummydesign.geometry.limits import RIM_FREE_MM

if TYPE_CHECKING:
    from dummydesign.geometry.shapes import PadShape

INDEPENDENT = TOLERANCE
"""Share of the force by which neighbours and rim may change it: how finely a steady force can be set."""
PLACING_MM = 1.0
"""How far beside a tip the punch may land; its placement is stated to 1 mm (docs/shapes.md)."""
STEP_MM, FARTHEST_MM = 0.5, 60.0


@dataclass(frozen=True)
class Sites:
    """Crowns in a grid.

    Attributes
    ----------
    along, across : int
        Crowns along the length and across the width.
    pitch_mm : (float, float)
        From tip to tip along and across; 0 where there is one. [mm]
    rim_mm : float
        From the outermost tips to the nearest side of the pad. [mm]
    softer, stiffer : float
        Bounds of the relative change of the force by rim and by neighbours.
    """

    along: int
    across: int
    pitch_mm: tuple[float, float]
    rim_mm: float
    softer: float
    stiffer: float

    @property
    def text(self) -> str:
        """The grid and what its neighbours do, in words."""
        apart = " x ".join(f"{pitch:g}" for pitch in self.pitch_mm if pitch)
        low, high = 100.0 * self.softer, 100.0 * self.stiffer
        return (
            f"{self.along} x {self.across} crowns, {apart} mm apart, the outermost {self.rim_mm:g} mm from the rim: "
            f"solved, neighbours and rim change the force by {low:.2f} to {high:+.2f} %"
        )

    def on(self, shape: PadShape) -> PadShape:
        """The pad's shape with all its crowns.

        Parameters
        ----------
        shape : PadShape
            One crown.
        """
        (dx, dy) = self.pitch_mm
        given = {"sites_along": float(self.along), "sites_across": float(self.across)}
        return replace(shape, **given, pitch_along_mm=dx, pitch_across_mm=dy)  # type: ignore[arg-type]

    def to_dict(self, shape: PadShape) -> dict[str, Any]:
        """Return the grid with the places of the tips.

        Parameters
        ----------
        shape : PadShape
            The pad's, with all its crowns.
        """
        return {
            "along": self.along, "across": self.across, "pitch_mm": list(self.pitch_mm), "rim_mm": self.rim_mm,
            "places_mm": [list(place) for place in shape.places_mm],
            "force_change": {"low": self.softer, "high": self.stiffer}, "text": self.text,
        }  # fmt: skip


def parse_sites(text: str | tuple[int, int] | None) -> tuple[int, int] | None:
    """Read ``NxM``, crowns along the length times across the width.

    Raises
    ------
    InputError
        For what is not two whole numbers from 1 to 20.
    """
    from dummydesign.geometry.shapes.crowned import MOST_SITES

    if text is None:
        return None
    parts = text.lower().split("x") if isinstance(text, str) else [str(value) for value in text]
    if len(parts) != 2 or not all(part.strip().isdigit() and 1 <= int(part) <= MOST_SITES for part in parts):
        shown = text if isinstance(text, str) else "x".join(parts)
        raise InputError(f"sites = {shown} is not NxM with 1 to {MOST_SITES} crowns each way, such as 4x3")
    return int(parts[0]), int(parts[1])


def lay_out(
    alone: Alone, wanted: tuple[int, int], pad_mm: tuple[float, float], reach_mm: float
) -> Sites:
    """Crowns as far apart as the pad allows, checked by their two bounds.

    Every crown first has an even share of the pad; where that puts the outermost too near to the rim, they move in as
    far as independence asks for.

    Parameters
    ----------
    alone : Alone
        The crown and the deepest press.
    wanted : (int, int)
        Crowns along the length and across the width.
    pad_mm : (float, float)
        Length and width. [mm]
    reach_mm : float
        From the middle of the punch to its farthest corner. [mm]

    Raises
    ------
    InputError
        Where they do not fit: with the grid that does, and the pad that the wanted one needs.
    NoAnswerError
        ``no_convergence`` when a bound could not be solved.
    """
    even = [(size / count, 0.5 * size / count) for size, count in zip(pad_mm, wanted)]
    several = [pitch for (pitch, _), count in zip(even, wanted) if count > 1]
    pitch, rim = min(several, default=FARTHEST_MM), min(side for _, side in even)
    least = _least(alone, reach_mm)
    if pitch >= least[0] and rim >= least[1]:
        sites = _sites(alone, wanted, pad_mm, rim)
        if max(-sites.softer, sites.stiffer) <= INDEPENDENT:
            return sites
    pitch, rim = _needed(alone.stiffer, least[0]), _needed(alone.softer, least[1])
    if all((count - 1) * pitch + 2.0 * rim <= size + 1e-9 for count, size in zip(wanted, pad_mm)):
        return _sites(alone, wanted, pad_mm, rim)
    raise InputError(_does_not_fit(wanted, pad_mm, pitch, rim))


def _least(alone: Alone, reach_mm: float) -> tuple[float, float]:
    """Pitch and rim that castability and the punch ask for, which must not touch a neighbour. [mm]"""
    foot = float(alone.crown.lines_mm()[0])
    pitch = foot + max(reach_mm + PLACING_MM, foot) + RAMP_MM
    return pitch, max(foot + RIM_FREE_MM, 1.5 * alone.radius_mm)


def _sites(alone: Alone, wanted: tuple[int, int], pad_mm: tuple[float, float], rim_mm: float) -> Sites:
    """The grid with a rim of at least ``rim_mm``, pitches in tenths of a millimetre, and its bounds."""
    pitches = []
    for count, size in zip(wanted, pad_mm):
        even = size / count
        widest = even if 0.5 * even >= rim_mm or count == 1 else (size - 2.0 * rim_mm) / (count - 1)
        pitches.append(floor(10.0 * widest + 1e-6) / 10.0 if count > 1 else 0.0)
    sides = [0.5 * (size - (count - 1) * pitch) for count, size, pitch in zip(wanted, pad_mm, pitches)]
    rim = floor(10.0 * min(sides) + 1e-6) / 10.0
    nearest = min((pitch for pitch in pitches if pitch), default=0.0)
    return Sites(*wanted, (pitches[0], pitches[1]), rim, min(alone.softer(rim), 0.0),
                 max(alone.stiffer(nearest), 0.0) if nearest else 0.0)  # fmt: skip


def _needed(change: Any, least_mm: float) -> float:
    """The smallest length, in steps of half a millimetre, at which a bound is within :data:`INDEPENDENT`. [mm]"""
    low, high = least_mm, least_mm
    step = 4.0
    while abs(change(high)) > INDEPENDENT:
        if high > FARTHEST_MM:
            raise NoAnswerError("no_convergence", f"crowns are not independent up to {FARTHEST_MM:g} mm apart")
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

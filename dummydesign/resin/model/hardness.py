"""Durometer hardness and modulus: Shore 00 and Shore A to Young's modulus and back, with the scatter of the laws.

References
----------
A. N. Gent, Rubber Chem. Technol. 31 (1958) 896; J. Kunz and M. Studer, Kunststoffe international 6 (2006) 92;
H. J. Qi, K. Joyce and M. C. Boyce, Rubber Chem. Technol. 76 (2003) 419; ASTM D2240. Numbers: materials/hardness.toml.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import out_of_range
from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import Serialised
from dummydesign.core.toml_schema import TomlTable, read_table
from dummydesign.core.user_library import data_folder, find
from dummydesign.resin.model.resin import Resin

SHORE_00, SHORE_A = "00", "A"
CHANGE_00 = 75.0
"""Shore 00 value from which on Shore A is read instead: the 00 scale is too coarse for it."""
STEPS = 50
ENDS = 0.0, 99.0
"""Readings between which a hardness is looked for."""


@dataclass(frozen=True)
class Hardness(Serialised):
    """A reading that is expected of a durometer, with its 95 % interval; ``scale`` is ``00`` or ``A``.

    Readings below 0 or above 99 count as these: the material is too soft or too hard for the scale.
    """

    scale: str
    value: float
    low: float
    high: float

    @property
    def text(self) -> str:
        """The reading in words: ``Shore 00 25 (95 %: 8 to 40)``."""
        if self.value < 0.5:
            return f"Shore {self.scale} 0 (95 %: at most {self.high:.0f})"
        return f"Shore {self.scale} {self.value:.0f} (95 %: {self.low:.0f} to {self.high:.0f})"


@dataclass(frozen=True)
class _ShoreA:
    """One published law; ``punch`` is E0 (1 + rise s) / (1 - s), ``exponential`` E0 exp(rise s), s = S / 100."""

    name: str
    punch: bool
    young_0_kPa: float
    rise: float

    def young_kPa(self, shore: ArrayLike) -> NDArray:
        share = np.asarray(shore, float) / 100.0
        if self.punch:
            return self.young_0_kPa * (1.0 + self.rise * share) / (1.0 - share)
        return self.young_0_kPa * np.exp(self.rise * share)


@dataclass(frozen=True)
class HardnessLaw:
    """The laws of both scales with their scatter, read from materials/hardness.toml."""

    ranges: dict[str, tuple[float, float]]
    ball_radius_mm: float
    travel_mm: float
    force_N: tuple[float, float]
    factor: dict[str, Quantity]
    laws_a: tuple[_ShoreA, ...]
    sure_from_a: float
    points: float
    known: dict[str, tuple[tuple[float, Quantity], ...]]

    @property
    def sure_to_a(self) -> float:
        """Hardest Shore A value that a measured product supports."""
        return max(shore for shore, _ in self.known[SHORE_A])

    def hertz_kPa(self, shore: ArrayLike) -> NDArray:
        """Modulus by Hertz contact of the Shore 00 ball: 9 F / (16 sqrt(R) d^1.5). [kPa]"""
        share = np.asarray(shore, float) / 100.0
        force = self.force_N[0] + self.force_N[1] * share
        return 1e3 * 9.0 * force / (16.0 * math.sqrt(self.ball_radius_mm) * (self.travel_mm * (1.0 - share)) ** 1.5)

    def young_kPa(self, shore: ArrayLike, scale: str) -> NDArray:
        """Modulus of a reading, central value. [kPa]

        Parameters
        ----------
        shore : array_like
            Readings, below 100.
        scale : str
            ``00`` or ``A``.

        Returns
        -------
        ndarray, of the shape of ``shore``
        """
        if scale == SHORE_00:
            return self.factor[scale].value * self.hertz_kPa(shore)
        return self.factor[scale].value * np.exp(np.mean([np.log(law.young_kPa(shore)) for law in self.laws_a], axis=0))

    def log_scatter(self, shore: float, scale: str) -> float:
        """Half-width of the 95 % interval of ln modulus at a reading that is known exactly."""
        half = 0.5 * math.log(self.factor[scale].high / self.factor[scale].low)
        if scale == SHORE_00:
            return half
        laws = [math.log(float(law.young_kPa(shore))) for law in self.laws_a]
        return math.hypot(half, max(abs(one - sum(laws) / len(laws)) for one in laws))

    def modulus(self, shore: float, scale: str) -> Quantity:
        """Modulus of a product of a stated hardness, with its 95 % interval. [kPa]

        The interval holds the scatter of the law and the tolerance of a supplier's value.

        Parameters
        ----------
        shore : float
            As the supplier states it.
        scale : str
            ``00`` or ``A``.

        Raises
        ------
        InputError
            Outside the range of the scale.
        """
        self.check(shore, scale)
        value = float(self.young_kPa(shore, scale))
        ends = self.young_kPa(np.array([shore - self.points, shore + self.points]), scale)
        scatter = self.log_scatter(shore, scale)
        low, high = (math.hypot(scatter, math.log(float(end) / value)) for end in ends)
        laws = (
            "Hertz contact of the ball, fitted to six products"
            if scale == SHORE_00
            else f"mean of {', '.join(law.name for law in self.laws_a)}, fitted to ten silicones"
        )
        source = f"{STATED}{scale} {shore:g} as stated, within {self.points:g} points; {laws} (materials/hardness.toml)"
        return Quantity(value, value * math.exp(-low), value * math.exp(high), "inferred", source)

    def check(self, shore: float, scale: str) -> None:
        """Refuse a reading outside the range of its scale (InputError)."""
        low, high = self.ranges[scale]
        if not low <= shore <= high:
            advice = {
                SHORE_00: "above it give --shore-a; below it press a puck (resins add-compression)",
                SHORE_A: "below it give --shore-00; above it is no material for a soft dummy",
            }[scale]
            quantity = f"shore_{scale.lower()}"
            raise out_of_range(f"Shore {scale}", f"{shore:g}", f"{low:g}", f"{high:g}", advice, quantity)

    def expected(self, young_kPa: Quantity, by_hardness: bool = False) -> Hardness:
        """Reading that a material of a modulus should give, with its 95 % interval.

        The interval joins that of the modulus and the scatter of the law, as independent. A modulus that is itself
        ``by_hardness`` has that scatter already: the reading is as sure as the hardness it is from, to its tolerance.

        Parameters
        ----------
        young_kPa : Quantity
            Long-term modulus. [kPa]
        by_hardness : bool
            Whether the modulus follows from a stated hardness.
        """
        scale, value = SHORE_00, self._reading(young_kPa.value, SHORE_00)
        if value > CHANGE_00:
            scale, value = SHORE_A, self._reading(young_kPa.value, SHORE_A)
        scatter = self.log_scatter(value, scale)
        below, above = (math.log(end / young_kPa.value) for end in (young_kPa.low, young_kPa.high))
        own = -(scatter**2) if by_hardness else scatter**2
        low, high = (
            self._reading(young_kPa.value * math.exp(way * math.sqrt(max(width**2 + own, 0.0))), scale)
            for way, width in ((-1.0, below), (1.0, above))
        )
        if by_hardness:
            low, high = max(min(low, value - self.points), ENDS[0]), min(max(high, value + self.points), ENDS[1])
        return Hardness(scale, value, low, high)

    def _reading(self, young_kPa: float, scale: str) -> float:
        """Reading of a modulus by halving; the laws rise with the reading."""
        low, high = ENDS
        for _ in range(STEPS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if float(self.young_kPa(middle, scale)) >= young_kPa else (middle, high)
        return 0.5 * (low + high)


STATED = "Shore "
"""How the source of a modulus begins that follows from a stated hardness."""


def expected_hardness(resin: Resin, ratio: float) -> Hardness:
    """Return the reading that a durometer should show on a resin at a ratio."""
    source = resin.numbers[resin.law.parameters[0]].source
    return hardness_law().expected(resin.modulus_kPa(ratio), by_hardness=source.startswith(STATED))


def hardness_law() -> HardnessLaw:
    """Read the laws: the user's own file where there is one, else the built-in one."""
    path = find("materials", "hardness", "hardness").path
    return _read(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=4)
def _read(path: Path, changed_ns: int) -> HardnessLaw:
    """Read again when the file has changed."""
    top = read_table(path, ("schema", "shore_00", "shore_a", "scatter"))
    ball, cone, scatter = (top.table(name) for name in ("shore_00", "shore_a", "scatter"))
    # copies of earlier versions have the laws of Shore A without what soft silicones say of them
    shipped = tomllib.loads((data_folder() / "materials/hardness.toml").read_text(encoding="utf-8"))
    cone = replace(cone, data={**shipped["shore_a"], **cone.data})
    numbers = ("ball_radius_mm", "travel_mm", "force_0_N", "force_rise_N", "factor")
    ball.only(("lowest", "highest", *numbers, "point"))
    cone.only(("lowest", "highest", "sure_from", "factor", "point", "law"))
    radius, travel, first, rise = (ball.quantity(name).value for name in numbers[:-1])
    scales = {SHORE_00: ball, SHORE_A: cone}
    return HardnessLaw(
        {key: (one.number("lowest", low=0.0, high=99.0), one.number("highest", low=0.0, high=99.0))
         for key, one in scales.items()},
        radius,
        travel,
        (first, rise),
        {key: one.quantity("factor") for key, one in scales.items()},
        tuple(map(_law, cone.tables("law"))),
        cone.number("sure_from"),
        scatter.quantity("points").value,
        {key: tuple((row.number("shore"), row.quantity("young_kPa")) for row in one.tables("point"))
         for key, one in scales.items()},
    )  # fmt: skip


def _law(table: TomlTable) -> _ShoreA:
    table.only(("name", "form", "young_0_kPa", "rise"))
    punch = table.string("form", choices=("punch", "exponential")) == "punch"
    return _ShoreA(table.string("name"), punch, table.quantity("young_0_kPa").value, table.quantity("rise").value)

"""What a workshop has: silicone, machines, the plastic it prints and how its prints come out."""

from __future__ import annotations

from dataclasses import dataclass

PLAIN_GAP_MM = 0.1
"""Gap per side of printed parts where the machines file says nothing of the fit (judgement). [mm]"""


@dataclass(frozen=True)
class Silicone:
    """The product the mould is cast from."""

    name: str
    density_g_per_cm3: float
    young_MPa: float
    shrinkage_percent: float
    expansion_per_K: float
    pot_life_min: float
    cure_time_h: float


@dataclass(frozen=True)
class PrintFit:
    """How a print comes out: gap that two printed parts need on each side, how far the first layer spreads, shrinkage.

    Print files of rigid parts are enlarged by the shrinkage; 0 leaves it to the slicer.
    """

    gap_per_side_mm: float
    elephant_foot_mm: float
    shrinkage_percent: float


@dataclass(frozen=True)
class Machines:
    """What the parts must fit, how finely can be weighed, the printer's layer (0 where not said) and its fit."""

    name: str
    balance_resolution_g: float
    bed_x_mm: float
    bed_y_mm: float
    printer_height_mm: float
    bed_margin_mm: float
    chamber_diameter_mm: float
    chamber_height_mm: float
    shelf_x_mm: float
    shelf_y_mm: float
    oven_height_mm: float
    layer_mm: float = 0.0
    fit: PrintFit | None = None

    @property
    def gap_mm(self) -> float:
        """Gap on each side between two printed parts that go together. [mm]"""
        return PLAIN_GAP_MM if self.fit is None else self.fit.gap_per_side_mm

    @property
    def elephant_foot_mm(self) -> float:
        """How far the first layer of a print spreads. [mm]"""
        return 0.0 if self.fit is None else self.fit.elephant_foot_mm

    @property
    def print_scale(self) -> float:
        """Size of a print file over that of the part: 1 / (1 - shrinkage of the print)."""
        return 1.0 if self.fit is None else 1.0 / (1.0 - self.fit.shrinkage_percent / 100)


@dataclass(frozen=True)
class Plastic:
    """What the printed parts are made of; expansion and modulus are needed where a pad is cast in it."""

    name: str
    service_temperature_C: float
    density_g_per_cm3: float
    expansion_per_K: float | None = None
    young_MPa: float | None = None

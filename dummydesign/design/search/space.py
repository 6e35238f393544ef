"""What a search runs over and is judged by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.presses import Sampling
from dummydesign.design.scoring.targets import Targets
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM

if TYPE_CHECKING:
    from dummydesign.design.search.shape_family import Family
    from dummydesign.resin.model.resin import Resin


@dataclass(frozen=True)
class SearchSpace:
    """Every combination of the steps of thickness and ratio, of one resin, for one set of targets.

    Attributes
    ----------
    resin : Resin
    targets : Targets
    thickness_mm, ratio : ndarray, shapes (T,) and (R,)
        Steps to combine. [mm, resin's ratio]
    radius_mm : float
        Radius of the circle of the punch's area. [mm]
    sampling : Sampling
        Of the fine presses.
    pad_mm : (float, float)
        Length and width of the pads. [mm]
    base : str
        What holds their base.
    correct : callable, optional
        Makes a family of shapes one that a calibration has corrected.
    """

    resin: Resin
    targets: Targets
    thickness_mm: NDArray
    ratio: NDArray
    radius_mm: float
    sampling: Sampling = field(default_factory=Sampling)
    pad_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM)
    base: str = "bonded"
    correct: Callable[[Family], Family] | None = None

    @property
    def extent_mm(self) -> float:
        """Radius of the circle of the pad's area. [mm]"""
        return float(np.sqrt(self.pad_mm[0] * self.pad_mm[1] / np.pi))

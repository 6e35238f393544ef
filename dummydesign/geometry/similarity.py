"""The dimensionless numbers of a kind of shape, for searches and response tables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Similarity:
    """Which dimensionless numbers the force of a kind of shape is a function of, for response tables.

    Attributes
    ----------
    names : tuple of str
        The numbers, in words; the first is thickness over punch radius.
    logarithms : tuple of bool
        Which of them enter a table by their logarithm.
    over : str
        What the force is divided by: ``tip``, Hertz's force of the highest tip, or ``slab``, the force of the slab
        of the upper resin.
    """

    names: tuple[str, ...]
    logarithms: tuple[bool, ...]
    over: str

    @property
    def over_tip(self) -> bool:
        """Whether the force is counted against Hertz's force of the highest tip."""
        return self.over == "tip"


def grid(*axes: Array) -> list[Array]:
    """All combinations of values, one flat array an axis."""
    return [axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")]

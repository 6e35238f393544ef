"""Choice between nested models: the corrected Akaike criterion, and the simplest model near the best.

References
----------
Hurvich and Tsai, Biometrika 76 (1989) 297 (AICc).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

PARSIMONY = 6.0
"""Gain in AICc that a richer model must bring: the time of a spurious relaxing arm is free to hunt for noise, which
earns it more than the two units a parameter is charged with."""

Size = TypeVar("Size", int, float)


def aicc(minus_two_log_likelihood: float, unknown: int, observed: int) -> float:
    """Corrected Akaike criterion of ``unknown`` parameters, those of the noise included, on ``observed`` numbers.

    Parameters
    ----------
    minus_two_log_likelihood : float
        Minus twice the logarithm of the largest likelihood.
    unknown : int
        Parameters that were fitted, those of the noise included.
    observed : int
        Numbers that were fitted to.

    Returns
    -------
    float
        The criterion; only differences between models of the same data mean something.

    References
    ----------
    Hurvich and Tsai, Biometrika 76 (1989) 297.
    """
    spare = max(observed - unknown - 1, 1)
    return minus_two_log_likelihood + 2 * unknown + 2 * unknown * (unknown + 1) / spare


def simplest(criterion: Mapping[Size, float], gain: float = PARSIMONY) -> Size:
    """Smallest size whose criterion is within ``gain`` of the lowest."""
    lowest = min(criterion.values())
    return min(size for size, value in criterion.items() if value <= lowest + gain)

"""Laws of the long-term modulus against the mixing ratio; plain functions, one line in :data:`LAWS` each.

A law has no numbers of its own: its parameters come as a mapping of name to value or to an array of draws, so that
one formula serves the central curve, the posterior and the update.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import out_of_range

Parameters = Mapping[str, ArrayLike]


@dataclass(frozen=True)
class ModulusLaw:
    """A law: its name, its parameters (unit in the name), and formulas that take these after their first argument.

    ``direction`` is +1 when the modulus grows with the ratio and -1 when it falls. ``modulus`` maps a ratio to kPa,
    ``inverse`` back; ``makes_sense`` tells where the parameters do from a lowest ratio upwards.
    """

    name: str
    parameters: tuple[str, ...]
    direction: int
    modulus: Callable[..., NDArray]
    inverse: Callable[..., NDArray]
    makes_sense: Callable[..., NDArray]

    @property
    def way(self) -> str:
        """What the modulus does with the ratio."""
        return "grow" if self.direction > 0 else "fall"

    def young_kPa(self, ratio: ArrayLike, parameters: Parameters) -> NDArray:
        """Long-term Young's modulus [kPa]; ``ratio`` and parameters broadcast."""
        return self.modulus(np.asarray(ratio, float), *self._values(parameters))

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """Ratio that gives a modulus, the inverse of :meth:`young_kPa`; NaN where none does."""
        return self.inverse(np.asarray(young_kPa, float), *self._values(parameters))

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """Tell where the parameters make sense from ``lowest_ratio`` upwards."""
        return self.makes_sense(lowest_ratio, *self._values(parameters))

    def _values(self, parameters: Parameters) -> list[NDArray]:
        return [np.asarray(parameters[name], float) for name in self.parameters]


def _gel_young(ratio: NDArray, young_ref: NDArray, ref: NDArray, share: NDArray, exponent: NDArray) -> NDArray:
    """Network below stoichiometry: E = E_ref ((r - r_c) / (r_ref - r_c))^t, zero at the gel point r_c and below.

    Exponent t is 3 in mean field and about 1.7 to 2.7 in percolation.

    References
    ----------
    Stauffer, Coniglio and Adam, Adv. Polym. Sci. 44 (1982) 103 (modulus near the gel point);
    Macosko and Miller, Macromolecules 9 (1976) 199 (ideal network, mean field).
    """
    gel = share * ref
    return young_ref * (np.maximum(ratio - gel, 0.0) / (ref - gel)) ** exponent


def _gel_ratio(young: NDArray, young_ref: NDArray, ref: NDArray, share: NDArray, exponent: NDArray) -> NDArray:
    gel = share * ref
    return gel + (ref - gel) * (young / young_ref) ** (1.0 / exponent)


def _fraction_young(ratio: NDArray, neat: NDArray, exponent: NDArray) -> NDArray:
    """Network thinned by an inert liquid: E = E_0 phi^n with phi = 100 / (100 + r), r parts of thinner.

    References
    ----------
    Obukhov, Rubinstein and Colby, Macromolecules 27 (1994) 3191 (modulus against polymer fraction).
    """
    return neat * (100.0 / (100.0 + ratio)) ** exponent


LAWS = {
    law.name: law
    for law in (
        ModulusLaw(
            "gel_point",
            ("young_ref_kPa", "ratio_ref", "gel_ratio_over_ref", "exponent"),
            1,
            _gel_young,
            _gel_ratio,
            # the gel point lies below the lowest ratio and below the reference
            lambda lowest, _, ref, share, power: (share * ref < lowest) & (share < 1.0) & (share > 0.0) & (power > 0),
        ),
        ModulusLaw(
            "polymer_fraction",
            ("young_neat_kPa", "exponent"),
            -1,
            _fraction_young,
            lambda young, neat, exponent: 100.0 * ((young / neat) ** (-1.0 / exponent) - 1.0),
            lambda _, neat, exponent: exponent > 0,
        ),
        # one mix with one modulus, for a product that is mixed at one ratio only
        ModulusLaw(
            "fixed",
            ("young_kPa",),
            1,
            lambda ratio, young: young + np.zeros(np.shape(ratio)),
            lambda other, young: np.full(np.shape(other), np.nan),
            lambda _, young: young > 0,
        ),
    )
}
"""Known laws by the name used in resin files."""


def check_young(young_kPa: float) -> None:
    """Refuse a modulus that is not positive and finite."""
    if not (np.isfinite(young_kPa) and young_kPa > 0):
        raise out_of_range("Young's modulus in kPa", young_kPa, "above 0", "any finite value")

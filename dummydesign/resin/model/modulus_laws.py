"""Laws of the long-term modulus against the mixing ratio; one class a law, one line in :data:`LAWS`.

A law is a frozen object without numbers of its own: its parameters come as a mapping of name to value or
to an array of draws, so that one formula serves the central curve, the posterior and the update.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import out_of_range

Parameters = Mapping[str, ArrayLike]


class ModulusLaw(Protocol):
    """What every law of the modulus offers.

    ``parameters`` names its numbers (unit in the name), ``direction`` is +1 when the modulus grows with
    the ratio and -1 when it falls.
    """

    name: str
    parameters: tuple[str, ...]
    direction: int

    def young_kPa(self, ratio: ArrayLike, parameters: Parameters) -> NDArray:
        """Long-term Young's modulus [kPa]; ``ratio`` and parameters broadcast."""
        ...

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """Ratio that gives a modulus, the inverse of :meth:`young_kPa`."""
        ...

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """Tell where the parameters make sense from ``lowest_ratio`` upwards."""
        ...


def _arrays(parameters: Parameters, names: tuple[str, ...]) -> list[NDArray]:
    return [np.asarray(parameters[name], float) for name in names]


class GelPoint:
    """Network below stoichiometry: E = E_ref ((r - r_c) / (r_ref - r_c))^t, zero at the gel point r_c.

    Exponent t is 3 in mean field and about 1.7 to 2.7 in percolation.

    References
    ----------
    Stauffer, Coniglio and Adam, Adv. Polym. Sci. 44 (1982) 103 (modulus near the gel point);
    Macosko and Miller, Macromolecules 9 (1976) 199 (ideal network, mean field).
    """

    name = "gel_point"
    parameters: tuple[str, ...] = ("young_ref_kPa", "ratio_ref", "gel_ratio_over_ref", "exponent")
    direction = 1

    def young_kPa(self, ratio: ArrayLike, parameters: Parameters) -> NDArray:
        """Return the modulus, which is zero below the gel point. [kPa]"""
        young_ref, ref, share, exponent = _arrays(parameters, self.parameters)
        gel = share * ref
        return young_ref * (np.maximum(np.asarray(ratio, float) - gel, 0.0) / (ref - gel)) ** exponent

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """Return the ratio of a modulus."""
        young_ref, ref, share, exponent = _arrays(parameters, self.parameters)
        gel = share * ref
        return gel + (ref - gel) * (np.asarray(young_kPa, float) / young_ref) ** (1.0 / exponent)

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """Tell where the gel point lies below the lowest ratio and below the reference."""
        ref, share, exponent = _arrays(parameters, self.parameters[1:])
        return (share * ref < lowest_ratio) & (share < 1.0) & (share > 0.0) & (exponent > 0)


class PolymerFraction:
    """Network thinned by an inert liquid: E = E_0 phi^n with phi = 100 / (100 + r), r parts of thinner.

    References
    ----------
    Obukhov, Rubinstein and Colby, Macromolecules 27 (1994) 3191 (modulus against polymer fraction).
    """

    name = "polymer_fraction"
    parameters: tuple[str, ...] = ("young_neat_kPa", "exponent")
    direction = -1

    def young_kPa(self, ratio: ArrayLike, parameters: Parameters) -> NDArray:
        """Return the modulus. [kPa]"""
        neat, exponent = _arrays(parameters, self.parameters)
        return neat * (100.0 / (100.0 + np.asarray(ratio, float))) ** exponent

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """Return the ratio of a modulus."""
        neat, exponent = _arrays(parameters, self.parameters)
        return 100.0 * ((np.asarray(young_kPa, float) / neat) ** (-1.0 / exponent) - 1.0)

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """Tell where the exponent is positive."""
        return np.asarray(parameters["exponent"], float) > 0


class Fixed:
    """One mix with one modulus, for a product that is mixed at one ratio only."""

    name = "fixed"
    parameters: tuple[str, ...] = ("young_kPa",)
    direction = 1

    def young_kPa(self, ratio: ArrayLike, parameters: Parameters) -> NDArray:
        """Return the modulus, the same at any ratio. [kPa]"""
        (young,) = _arrays(parameters, self.parameters)
        return young + np.zeros(np.shape(ratio))

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """Return NaN: no ratio gives another modulus."""
        return np.full(np.shape(young_kPa), np.nan)

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """Tell where the modulus is positive."""
        return np.asarray(parameters["young_kPa"], float) > 0


_ALL: tuple[ModulusLaw, ...] = (GelPoint(), PolymerFraction(), Fixed())
LAWS: dict[str, ModulusLaw] = {law.name: law for law in _ALL}
"""Known laws by the name used in resin files."""


def check_young(young_kPa: float) -> None:
    """Refuse a modulus that is not positive and finite."""
    if not (np.isfinite(young_kPa) and young_kPa > 0):
        raise out_of_range("Young's modulus in kPa", young_kPa, "above 0", "any finite value")

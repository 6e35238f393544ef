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


class Law(Protocol):
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
        """See :class:`Law`; below the gel point the modulus is zero."""
        ref = np.asarray(parameters["ratio_ref"], float)
        gel = np.asarray(parameters["gel_ratio_over_ref"], float) * ref
        reach = np.maximum(np.asarray(ratio, float) - gel, 0.0) / (ref - gel)
        return np.asarray(parameters["young_ref_kPa"], float) * reach ** np.asarray(parameters["exponent"], float)

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """See :class:`Law`."""
        ref = np.asarray(parameters["ratio_ref"], float)
        gel = np.asarray(parameters["gel_ratio_over_ref"], float) * ref
        relative = np.asarray(young_kPa, float) / np.asarray(parameters["young_ref_kPa"], float)
        return gel + (ref - gel) * relative ** (1.0 / np.asarray(parameters["exponent"], float))

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """See :class:`Law`: the gel point lies below the lowest ratio and below the reference."""
        share = np.asarray(parameters["gel_ratio_over_ref"], float)
        below = share * np.asarray(parameters["ratio_ref"], float) < lowest_ratio
        return below & (share < 1.0) & (share > 0.0) & (np.asarray(parameters["exponent"]) > 0)


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
        """See :class:`Law`."""
        fraction = 100.0 / (100.0 + np.asarray(ratio, float))
        return np.asarray(parameters["young_neat_kPa"], float) * fraction ** np.asarray(parameters["exponent"], float)

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """See :class:`Law`."""
        relative = np.asarray(young_kPa, float) / np.asarray(parameters["young_neat_kPa"], float)
        return 100.0 * (relative ** (-1.0 / np.asarray(parameters["exponent"], float)) - 1.0)

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """See :class:`Law`."""
        return np.asarray(parameters["exponent"], float) > 0


_ALL: tuple[Law, ...] = (GelPoint(), PolymerFraction())
LAWS: dict[str, Law] = {law.name: law for law in _ALL}
"""Known laws by the name used in resin files."""


def check_young(young_kPa: float) -> None:
    """Refuse a modulus that is not positive and finite."""
    if not (np.isfinite(young_kPa) and young_kPa > 0):
        raise out_of_range("Young's modulus in kPa", young_kPa, "above 0", "any finite value")

"""Hyperelastic laws by one contract: energy, first Piola stress and exact tangent of the deformation gradient.

A law sees the components of the deformation gradient F as the last axis of an array: five of them in
axisymmetry (rr, rz, zr, zz, tt) or nine in space (row by row). It gives the part of the energy that
does not depend on J = det F alone; what depends on J (the term that frees the reference state of
stress, the pressure) is added by the element, alike for all laws. Stresses are in units of the law's
own moduli, MPa unless scaled.

With the pressure term, all laws here are stress-free at F = 1 and have the small-strain shear modulus
``shear_MPa``; the incompressible long-term modulus is E = 3 ``shear_MPa``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from dummydesign.core.errors import InputError, unknown_name

Array = np.ndarray


class Law(Protocol):
    """What the elements need of a material law."""

    @property
    def shear_MPa(self) -> float:
        """Small-strain shear modulus, MPa."""

    @property
    def reference_stress_MPa(self) -> float:
        """Stress of the distortional part at F = 1, MPa; the element cancels it by -s0 ln J."""

    def energy(self, F: Array) -> Array:
        """Energy per reference volume, MPa, zero at F = 1; shape of F without its last axis."""

    def stress(self, F: Array) -> Array:
        """First Piola stress dW/dF, MPa; shape of F."""

    def tangent(self, F: Array) -> Array:
        """Second derivative of W, MPa; shape of F with the last axis doubled."""

    def scaled(self, factor: float) -> Law:
        """The same law with all moduli multiplied by ``factor``."""


def _first_invariant(F: Array) -> Array:
    return np.einsum("...c,...c->...", F, F)


@dataclass(frozen=True)
class Yeoh:
    """W = mu/2 (I1 - 3) + c2 (I1 - 3)^2 [1]; c2 = 0 is the neo-Hookean solid.

    Parameters
    ----------
    shear_MPa : float
        Small-strain shear modulus mu. [MPa]
    c2_MPa : float
        Stiffening modulus, >= 0. [MPa]

    References
    ----------
    .. [1] O. H. Yeoh, "Some forms of the strain energy function for rubber", Rubber Chem. Technol. 66
       (1993) 754, doi 10.5254/1.3538343.
    """

    shear_MPa: float
    c2_MPa: float = 0.0

    def __post_init__(self) -> None:
        if not self.shear_MPa > 0.0:
            raise InputError(f"shear modulus = {self.shear_MPa} MPa must be above 0")
        if not self.c2_MPa >= 0.0:
            raise InputError(f"Yeoh c2 = {self.c2_MPa} MPa must be at least 0, else the solid softens without bound")

    @property
    def reference_stress_MPa(self) -> float:
        """Stress of the distortional part at F = 1."""
        return self.shear_MPa

    def energy(self, F: Array) -> Array:
        """Energy per reference volume."""
        x = _first_invariant(F) - 3.0
        return 0.5 * self.shear_MPa * x + self.c2_MPa * x * x

    def stress(self, F: Array) -> Array:
        """First Piola stress (mu + 4 c2 (I1 - 3)) F."""
        return (self.shear_MPa + 4.0 * self.c2_MPa * (_first_invariant(F) - 3.0))[..., None] * F

    def tangent(self, F: Array) -> Array:
        """Second derivative (mu + 4 c2 (I1 - 3)) 1 + 8 c2 F x F."""
        slope = self.shear_MPa + 4.0 * self.c2_MPa * (_first_invariant(F) - 3.0)
        tangent = slope[..., None, None] * np.eye(F.shape[-1])
        if self.c2_MPa:
            tangent = tangent + 8.0 * self.c2_MPa * F[..., :, None] * F[..., None, :]
        return tangent

    def scaled(self, factor: float) -> Yeoh:
        """The same law with all moduli multiplied by ``factor``."""
        return Yeoh(self.shear_MPa * factor, self.c2_MPa * factor)


def neo_hookean(shear_MPa: float) -> Yeoh:
    """Return the neo-Hookean solid W = mu/2 (I1 - 3)."""
    return Yeoh(shear_MPa)


def read_law(text: str) -> Law:
    """Make a law from its name on the command line; only its shape counts, moduli are scaled later.

    Parameters
    ----------
    text : str
        ``neo-hookean``, ``yeoh:C2_OVER_MU`` or ``ogden:MU,ALPHA;MU,ALPHA`` with one to three pairs.

    Raises
    ------
    InputError
        For an unknown name, a wrong form or a law without a stable solid.
    """
    from dummydesign.pad.material.ogden import Ogden

    forms = {"neo-hookean": "neo-hookean", "yeoh": "yeoh:C2_OVER_MU", "ogden": "ogden:MU,ALPHA;MU,ALPHA"}
    name, colon, rest = text.partition(":")
    if name not in forms:
        raise unknown_name("law", name, forms)
    try:
        rows = [[float(number) for number in part.split(",")] for part in rest.split(";")] if colon else []
    except ValueError:
        rows = [[]]
    wanted = {"neo-hookean": 0, "yeoh": 1, "ogden": 2}[name]
    if bool(wanted) != bool(rows) or any(len(row) != wanted for row in rows) or (name == "yeoh" and len(rows) > 1):
        raise InputError(f"law '{text}' is not of the form {forms[name]}")
    if name == "ogden":
        return Ogden([row[0] for row in rows], [row[1] for row in rows])
    return Yeoh(1.0, rows[0][0] if rows else 0.0)

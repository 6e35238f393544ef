"""Hyperelastic laws by one contract: neo-Hooke, Yeoh, Ogden; the determinant of the deformation gradient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Protocol

import numpy as np

from dummydesign.core.errors import InputError, unknown_name

Array = np.ndarray


class HyperelasticLaw(Protocol):
    """What the elements need of a material law."""

    @property
    def shear_MPa(self) -> float:
        """Small-strain shear modulus, MPa."""

    @property
    def reference_stress_MPa(self) -> float:
        """Stress of the distortional part at F = 1, MPa; the element cancels it by -s0 ln J."""

    def stress(self, F: Array) -> Array:
        """First Piola stress dW/dF, MPa; shape of F."""

    def tangent(self, F: Array) -> Array:
        """Second derivative of W, MPa; shape of F with the last axis doubled."""

    def scaled(self, factor: float) -> HyperelasticLaw:
        """The same law with all moduli multiplied by ``factor``."""


def _first_invariant(F: Array) -> Array:
    return np.einsum("...c,...c->...", F, F)


@dataclass(frozen=True)
class Yeoh:
    """W = mu/2 (I1 - 3) + c2 (I1 - 3)^2 [1]; c2 = 0 is the neo-Hookean solid.

    References
    ----------
    .. [1] O. H. Yeoh, "Some forms of the strain energy function for rubber", Rubber Chem. Technol. 66
       (1993) 754, doi 10.5254/1.3538343.
    """

    shear_MPa: float
    c2_MPa: float = 0.0

    def __post_init__(self) -> None:
        if not self.shear_MPa > 0.0:
            message = f"shear modulus = {self.shear_MPa} MPa must be above 0"
            raise InputError(message, "out_of_range", "shear_MPa", self.shear_MPa)
        if not self.c2_MPa >= 0.0:
            message = f"Yeoh c2 = {self.c2_MPa} MPa must be at least 0, else the solid softens without bound"
            raise InputError(message, "out_of_range", "c2_MPa", self.c2_MPa)

    @property
    def reference_stress_MPa(self) -> float:
        """Stress of the distortional part at F = 1."""
        return self.shear_MPa

    def stress(self, F: Array) -> Array:
        """First Piola stress (mu + 4 c2 (I1 - 3)) F."""
        if not self.c2_MPa:
            return self.shear_MPa * F
        return (self.shear_MPa + 4.0 * self.c2_MPa * (_first_invariant(F) - 3.0))[..., None] * F

    def tangent(self, F: Array) -> Array:
        """Second derivative (mu + 4 c2 (I1 - 3)) 1 + 8 c2 F x F."""
        slope = self.shear_MPa + 4.0 * self.c2_MPa * (_first_invariant(F) - 3.0)
        return slope[..., None, None] * np.eye(F.shape[-1]) + 8.0 * self.c2_MPa * F[..., :, None] * F[..., None, :]

    def scaled(self, factor: float) -> Yeoh:
        """The same law with all moduli multiplied by ``factor``."""
        return Yeoh(self.shear_MPa * factor, self.c2_MPa * factor)


NEO_HOOKEAN = Yeoh(1.0)
"""The neo-Hookean solid with unit shear modulus."""


def read_law(text: str, young_MPa: float | None = None) -> HyperelasticLaw:
    """Make a law from its name on the command line; only its shape counts, moduli are scaled later.

    Terms in another convention than the named one are asked about where they make ``young_MPa`` there alone.
    """
    counts = {"neo-hookean": 0, "yeoh": 1, "ogden": 2, ABAQUS: 2}
    name, _, rest = text.partition(":")
    if name not in counts:
        raise unknown_name("law", name, counts)
    try:
        rows = [[float(number) for number in part.split(",")] for part in rest.split(";")] if ":" in text else []
    except ValueError:
        rows = [[]]
    wanted, form = counts[name], name + ("", ":C2_OVER_MU", ":MU,ALPHA;MU,ALPHA")[counts[name]]
    if bool(wanted) != bool(rows) or any(len(row) != wanted for row in rows) or (name == "yeoh" and len(rows) > 1):
        raise InputError(f"law '{text}' is not of the form {form}", "malformed", "law", text, form)
    if wanted < 2:
        return Yeoh(1.0, rows[0][0] if rows else 0.0)
    if name == ABAQUS:
        # W = sum 2 mu / alpha^2 (...); an alpha of 0 is refused below
        return Ogden([2.0 * mu / alpha if alpha else mu for mu, alpha in rows], [alpha for _, alpha in rows])
    law, other = Ogden(*map(list, zip(*rows))), sum(mu for mu, _ in rows)
    if young_MPa is not None and _makes(other, young_MPa) and not _makes(law.shear_MPa, young_MPa):
        raise InputError(
            f"law '{text}': 3 sum(mu) is the modulus, as in Abaqus, and 1.5 sum(mu alpha) is not: give "
            f"{ABAQUS}:{rest}, or multiply each mu by 10 if W = sum mu / alpha (...) is meant",
            "inconsistent",
            "law",
            text,
        )
    return law


ABAQUS = "ogden-abaqus"


def _makes(shear: float, young_MPa: float) -> bool:
    """Whether a shear modulus in MPa or kPa makes a Young's modulus, within 2 %."""
    return any(abs(3.0 * shear * size / young_MPa - 1.0) < 0.02 for size in (1.0, 1e-3))


MOST_TERMS = 3
_PAIRS_3 = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_PAIRS_2 = ((0, 0), (1, 1), (0, 1))


@dataclass(frozen=True)
class Ogden:
    """W = sum_p mu_p / alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3) [1].

    References
    ----------
    .. [1] R. W. Ogden, "Large deformation isotropic elasticity", Proc. R. Soc. Lond. A 326 (1972) 565,
       doi 10.1098/rspa.1972.0026; stability by mu_p alpha_p > 0: R. Hill, Adv. Appl. Mech. 18 (1978) 1.
    """

    mu_MPa: Sequence[float]
    alpha: Sequence[float]

    def __post_init__(self) -> None:
        for name in ("mu_MPa", "alpha"):
            object.__setattr__(self, name, tuple(map(float, getattr(self, name))))
        if not 1 <= len(self.mu_MPa) == len(self.alpha) <= MOST_TERMS:
            message = f"Ogden law with {len(self.mu_MPa)} mu and {len(self.alpha)} alpha; it takes one to three pairs"
            raise InputError(message, "malformed", "law")
        for mu, alpha_p in zip(self.mu_MPa, self.alpha):
            if not (np.isfinite(mu) and np.isfinite(alpha_p) and mu * alpha_p > 0.0):
                raise InputError(
                    f"Ogden term mu = {mu:g}, alpha = {alpha_p:g}: mu times alpha must be above 0, "
                    "else the solid softens without bound; mu of Abaqus, W = sum 2 mu / alpha^2 (...), "
                    f"is typed as {ABAQUS}:MU,ALPHA",
                    "out_of_range",
                    "law",
                )

    @property
    def shear_MPa(self) -> float:
        """Small-strain shear modulus, half the sum of mu_p alpha_p."""
        return 0.5 * sum(m * a for m, a in zip(self.mu_MPa, self.alpha))

    @property
    def reference_stress_MPa(self) -> float:
        """Stress of the distortional part at F = 1, the sum of mu_p."""
        return sum(self.mu_MPa)

    def _slope(self, c: Array) -> Array:
        """w'(c), c = l^2."""
        parts = (0.5 * m * c ** (0.5 * a - 1.0) for m, a in zip(self.mu_MPa, self.alpha))
        return sum(parts, np.zeros_like(c))

    def _divided(self, x: Array, y: Array) -> Array:
        """(w'(x) - w'(y)) / (x - y), w''(x) where they are equal."""
        ratio = (y - x) / x
        safe = np.where(ratio == 0.0, 1.0, ratio)
        total = np.zeros_like(x)
        for m, a in zip(self.mu_MPa, self.alpha):
            power = 0.5 * a - 1.0
            quotient = np.where(ratio == 0.0, power, np.expm1(power * np.log1p(safe)) / safe)
            total = total + 0.5 * m * x ** (power - 1.0) * quotient
        return total

    def stress(self, F: Array) -> Array:
        """First Piola stress F 2 w'(C)."""
        values, vectors, hoop = _eigen(F)
        pushed = parts(F)[0] @ vectors
        stress = (pushed * 2.0 * self._slope(values)[..., None, :]) @ np.swapaxes(vectors, -1, -2)
        return join([stress] if hoop is None else [stress, (2.0 * self._slope(hoop**2) * hoop)[..., None, None]])

    def tangent(self, F: Array) -> Array:
        """Second derivative: 1 x S + sum over pairs of w'[c_a, c_b] D_ab x D_ab, D_ab = f_a N_b + f_b N_a."""
        values, vectors, hoop = _eigen(F)
        size = vectors.shape[-1]
        pushed = parts(F)[0] @ vectors
        second_piola = (vectors * 2.0 * self._slope(values)[..., None, :]) @ np.swapaxes(vectors, -1, -2)
        modes, factors = [], []
        for a, b in _PAIRS_3 if size == 3 else _PAIRS_2:
            one = pushed[..., :, None, a] * vectors[..., None, :, b]
            other = pushed[..., :, None, b] * vectors[..., None, :, a]
            modes.append(join([one + other]))
            factors.append(self._divided(values[..., a], values[..., b]) * (1.0 if a == b else 2.0))
        D, factor = np.stack(modes, axis=-2), np.stack(factors, axis=-1)
        block = np.swapaxes(D, -1, -2) @ (factor[..., None] * D)
        for i in range(size):
            block[..., size * i : size * (i + 1), size * i : size * (i + 1)] += second_piola
        if hoop is None:
            return block
        out = np.zeros((*F.shape, 5))
        out[..., :4, :4] = block
        square = hoop**2
        out[..., 4, 4] = 2.0 * self._slope(square) + 4.0 * square * self._divided(square, square)
        return out

    def scaled(self, factor: float) -> Ogden:
        """The same law with all moduli multiplied by ``factor``."""
        return Ogden([m * factor for m in self.mu_MPa], self.alpha)


def parts(F: Array) -> list[Array]:
    """The matrices in the components of F: a 2 x 2 block and the hoop in axisymmetry, the 3 x 3 matrix in space."""
    if F.shape[-1] == 9:
        return [F.reshape(*F.shape[:-1], 3, 3)]
    return [F[..., :4].reshape(*F.shape[:-1], 2, 2), F[..., 4:, None]]


def join(matrices: Sequence[Array]) -> Array:
    """The components of F from its matrices."""
    return np.concatenate([part.reshape(*part.shape[:-2], -1) for part in matrices], axis=-1)


def _eigen(F: Array) -> tuple[Array, Array, Array | None]:
    """Eigenvalues and vectors of the block of C, and the hoop stretch in axisymmetry."""
    block = parts(F)[0]
    C = np.swapaxes(block, -1, -2) @ block
    if F.shape[-1] == 9:
        values, vectors = np.linalg.eigh(C)
        return values, vectors, None
    rr, rz, zz = C[..., 0, 0], C[..., 0, 1], C[..., 1, 1]
    angle = 0.5 * np.arctan2(2.0 * rz, rr - zz)
    cos, sin = np.cos(angle), np.sin(angle)
    large = cos**2 * rr + 2.0 * cos * sin * rz + sin**2 * zz
    # the smaller one from the determinant, which does not cancel at large stretches
    det = block[..., 0, 0] * block[..., 1, 1] - block[..., 0, 1] * block[..., 1, 0]
    values = np.stack([large, det**2 / large], axis=-1)
    vectors = np.stack([np.stack([cos, -sin], axis=-1), np.stack([sin, cos], axis=-1)], axis=-2)
    return values, vectors, F[..., 4]


class Axisymmetric:
    """Components (rr, rz, zr, zz, tt) of F; the hoop component is 1 + u_r / r."""

    identity = np.array([1.0, 0.0, 0.0, 1.0, 1.0])

    @staticmethod
    def determinant(F: Array) -> Array:
        """J = det F."""
        return (F[..., 0] * F[..., 3] - F[..., 1] * F[..., 2]) * F[..., 4]

    @staticmethod
    def cofactor(F: Array) -> Array:
        """dJ/dF, same shape as F."""
        rr, rz, zr, zz, tt = (F[..., k] for k in range(5))
        out = np.empty_like(F)
        out[..., 0], out[..., 1], out[..., 2], out[..., 3] = zz * tt, -zr * tt, -rz * tt, rr * tt
        out[..., 4] = rr * zz - rz * zr
        return out

    @staticmethod
    def add_second(A: Array, factor: Array, F: Array) -> None:
        """Add factor * d2J/dF2 to a tangent, in place."""
        rr, rz, zr, zz, tt = (F[..., k] for k in range(5))
        for i, j, value in ((0, 3, tt), (1, 2, -tt), (0, 4, zz), (3, 4, rr), (1, 4, -zr), (2, 4, -rz)):
            A[..., i, j] += factor * value
            A[..., j, i] += factor * value


class Spatial:
    """The nine components of F, row by row."""

    identity = np.eye(3).ravel()
    # Signs and places of the products that make up J.
    _terms = tuple((round(np.linalg.det(np.eye(3)[[*p]])), (p[0], 3 + p[1], 6 + p[2])) for p in permutations(range(3)))

    @classmethod
    def determinant(cls, F: Array) -> Array:
        """J = det F."""
        return sum(s * F[..., a] * F[..., b] * F[..., c] for s, (a, b, c) in cls._terms)

    @classmethod
    def cofactor(cls, F: Array) -> Array:
        """dJ/dF, same shape as F."""
        out = np.zeros_like(F)
        for s, (a, b, c) in cls._terms:
            out[..., a] += s * F[..., b] * F[..., c]
            out[..., b] += s * F[..., a] * F[..., c]
            out[..., c] += s * F[..., a] * F[..., b]
        return out

    @classmethod
    def add_second(cls, A: Array, factor: Array, F: Array) -> None:
        """Add factor * d2J/dF2 to a tangent, in place."""
        for s, (a, b, c) in cls._terms:
            for i, j, k in ((a, b, c), (a, c, b), (b, c, a)):
                value = s * factor * F[..., k]
                A[..., i, j] += value
                A[..., j, i] += value

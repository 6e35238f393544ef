"""Determinant of the deformation gradient with its first two derivatives, in axisymmetry and in space."""

from __future__ import annotations

from itertools import permutations

import numpy as np

Array = np.ndarray


class Axisymmetric:
    """Components (rr, rz, zr, zz, tt) of F; the hoop component is 1 + u_r / r."""

    components = 5
    identity = np.array([1.0, 0.0, 0.0, 1.0, 1.0])
    # Those of the first displacement alone, and where all stand among d/dr, d/dz and 1/r of (u_r, u_z), the two
    # displacements side by side.
    first = (0, 1, 4)
    place = np.array([0, 2, 1, 3, 4])

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


def _signed_permutations() -> list[tuple[int, tuple[int, int, int]]]:
    rows = []
    for order in permutations(range(3)):
        sign = int(np.round(np.linalg.det(np.eye(3)[list(order)])))
        rows.append((sign, (order[0], 3 + order[1], 6 + order[2])))
    return rows


class Spatial:
    """The nine components of F, row by row."""

    components = 9
    identity = np.eye(3).ravel()
    # Those of the first displacement alone, and where all stand among the slopes of (u_x, u_y, u_z) side by side.
    first = (0, 1, 2)
    place = np.array([0, 3, 6, 1, 4, 7, 2, 5, 8])
    _terms = tuple(_signed_permutations())

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

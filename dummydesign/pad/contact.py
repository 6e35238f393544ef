"""Unilateral contact of the pad's surface with a rigid punch, and a stiff film that glues them.

Contact is a penalty on the penetration g < 0, measured along the punch's outward normal n, at the
quadrature points of the surface sides: energy k/2 <-g>^2 per reference area. The film resists the
sliding of surface points against the punch: energy t/2 u_r^2. Both are functions of the present state
alone, so a solution does not depend on the path of loading.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

Array = np.ndarray

# A point this near counts as touching for the stiffness, so that the first step knows of the punch.
TOUCHING = 1e-12


class Punch(Protocol):
    """A rigid axisymmetric punch; lengths in the unit of the mesh."""

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """Gap, outward unit normal and curvature at ``points`` (last axis r, z) with the punch down by ``depth``."""


@dataclass(frozen=True)
class FlatPunch:
    """A flat punch of a given radius whose edge is a bead of radius ``rim``; the sides above recede.

    The pad may touch the bead all round but nothing behind it: the punch's sides never touch.
    """

    radius: float
    rim: float

    @property
    def flat_radius(self) -> float:
        """Radius at which the flat face ends and the bead begins."""
        return self.radius - self.rim

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """Gap to the face or the bead, with normal and curvature of the surface that is nearest."""
        v = points - np.array([self.flat_radius, self.rim - depth])
        distance = np.maximum(np.linalg.norm(v, axis=-1), 1e-300)
        flat = (v[..., 0] < 0.0) & (v[..., 1] < 0.0)
        gap = np.where(flat, -v[..., 1] - self.rim, distance - self.rim)
        normal = np.where(flat[..., None], np.array([0.0, -1.0]), v / distance[..., None])
        return gap, normal, np.where(flat, 0.0, 1.0 / distance)


class Surface:
    """Sides of the pad that may touch the punch.

    Parameters
    ----------
    nodes : ndarray, shape (2, n)
    sides : ndarray of int, shape (sides, 3)
        End, middle and end node of each side.
    stiffness : callable
        Contact stiffness per area as a function of the reference radius.
    film : callable
        Sliding stiffness per area as a function of the reference radius; zero where not glued.
    """

    def __init__(
        self, nodes: Array, sides: Array, stiffness: Callable[[Array], Array], film: Callable[[Array], Array]
    ) -> None:
        x, weight = np.polynomial.legendre.leggauss(5)
        shape = np.stack([x * (x - 1.0) / 2.0, 1.0 - x**2, x * (x + 1.0) / 2.0], axis=1)
        slope = np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=1)
        place = np.moveaxis(nodes[:, sides], 0, -1)
        r = place[..., 0] @ shape.T
        length = np.linalg.norm(np.einsum("qi,eic->eqc", slope, place), axis=-1)
        area = 2.0 * np.pi * r * length * weight
        self.dofs = np.stack([2 * sides, 2 * sides + 1], axis=-1).reshape(len(sides), 6)
        self._shape, self._place = shape, place
        self._stiffness = area * stiffness(r)
        self._film = np.zeros((len(sides), 3, 2, 3, 2))
        self._film[:, :, 0, :, 0] = np.einsum("qi,qj,eq->eij", shape, shape, area * film(r))
        self._film = self._film.reshape(len(sides), 6, 6)

    def forces(self, u: Array, punch: Punch, depth: float) -> tuple[Array, Array]:
        """Gradient (full length) and second derivative (per side) of the contact and film energy."""
        local = u[self.dofs]
        points = np.einsum("qi,eic->eqc", self._shape, self._place + local.reshape(self._place.shape))
        gap, normal, curvature = punch.gap(points, depth)
        push = self._stiffness * np.maximum(-gap, 0.0)
        on_side = np.einsum("qi,eqc->eic", self._shape, -push[..., None] * normal).reshape(local.shape)
        on_side = on_side + np.einsum("eij,ej->ei", self._film, local)
        across = normal[..., :, None] * normal[..., None, :]
        along = np.eye(2) - across
        second = np.where(gap <= TOUCHING, self._stiffness, 0.0)[..., None, None] * across
        second = second - (push * curvature)[..., None, None] * along
        matrix = np.einsum("qi,qj,eqab->eiajb", self._shape, self._shape, second, optimize=True)
        total = np.bincount(self.dofs.ravel(), on_side.ravel(), minlength=len(u))
        return total, matrix.reshape(len(local), 6, 6) + self._film

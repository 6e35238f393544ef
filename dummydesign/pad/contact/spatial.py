"""Unilateral contact in space: faces of 27-node hexahedra and a rigid flat punch with a fillet at its edge.

The same penalty and the same grip as of ``contact``, which is their axisymmetric form: energy k/2 <-g>^2 per
reference area at the quadrature points of the faces, g the gap; what touches a glued punch at the end of a
load step is held along its surface from there on, until it lifts off.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.pad.contact.axisymmetric import TOUCHING, Array, ContactSurface, RigidPunch

# Quadrature points of a face along each direction.
FACE_POINTS = 5


@dataclass(frozen=True)
class BeadedPunch:
    """A flat punch with a fillet of radius ``rim`` all round its edge; the sides above recede.

    The flat face is every point within ``corner`` of a rectangle of half sides ``core`` about ``centre``: a
    rectangle without ``corner``, a disc without ``core``. The punch reaches ``rim`` beyond its face.
    """

    core: tuple[float, float]
    corner: float
    rim: float
    centre: tuple[float, float] = (0.0, 0.0)

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """Distance to the face or the fillet, whichever is nearest, with its derivatives."""
        plan = points[..., :2] - np.array(self.centre)
        over = np.maximum(np.abs(plan) - np.array(self.core), 0.0)
        away = np.maximum(np.linalg.norm(over, axis=-1), 1e-300)
        out = over * np.sign(plan) / away[..., None]
        beyond = np.maximum(away - self.corner, 0.0)
        level = points[..., 2] - (self.rim - depth)
        # The face pushes back from any depth inside it, so that a step may overshoot.
        flat = beyond <= 0.0
        distance = np.where(flat, -level, np.maximum(np.hypot(beyond, level), 1e-300))
        normal = np.concatenate([beyond[..., None] * out, level[..., None]], axis=-1) / distance[..., None]
        normal = np.where(flat[..., None], np.array([0.0, 0.0, -1.0]), normal)
        bend = np.zeros((*flat.shape, 3, 3))
        outward = out[..., :, None] * out[..., None, :]
        across = (over > 0.0)[..., :, None] * np.eye(2) - outward
        bend[..., :2, :2] = outward + (beyond / away)[..., None, None] * across
        bend[..., 2, 2] = 1.0
        bend = (bend - normal[..., :, None] * normal[..., None, :]) / distance[..., None, None]
        return distance - self.rim, normal, np.where(flat[..., None, None], 0.0, bend)


class FaceContact(ContactSurface):
    """Faces of the pad that may touch the punch; takes the place of ``contact.Surface`` in space."""

    def __init__(
        self, nodes: Array, faces: Array, stiffness: Array, grip: Array, unknowns: Array | None = None
    ) -> None:
        x, weight = np.polynomial.legendre.leggauss(FACE_POINTS)
        line = np.stack([x * (x - 1.0) / 2.0, 1.0 - x**2, x * (x + 1.0) / 2.0], axis=1)
        slope = np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=1)
        shape, along, across = (
            np.einsum("pi,qj->pqij", one, other).reshape(len(x) ** 2, 9)
            for one, other in ((line, line), (slope, line), (line, slope))
        )
        corners = np.moveaxis(nodes[:, faces], 0, -1)
        normal = np.cross(np.einsum("qi,eic->eqc", along, corners), np.einsum("qi,eic->eqc", across, corners))
        area = np.linalg.norm(normal, axis=-1) * np.outer(weight, weight).ravel()
        dofs = (3 * faces[:, :, None] + np.arange(3)).reshape(len(faces), 27)
        self.dofs = dofs if unknowns is None else unknowns[dofs]
        self._shape, self._corners = shape, corners
        self._pairs = (shape[:, :, None] * shape[:, None, :]).reshape(len(shape), 81)
        self._stiffness = area * np.asarray(stiffness)[:, None]
        self._grip = area * np.asarray(grip)[:, None]
        self._held = np.zeros(area.shape, dtype=bool)
        self._spot = np.zeros((*area.shape, 3))
        self._plane = np.zeros((*area.shape, 3, 3))

    def _points(self, u: Array) -> Array:
        return np.einsum("qi,eic->eqc", self._shape, self._corners + u[self.dofs].reshape(self._corners.shape))

    def settle(self, u: Array, punch: RigidPunch, depth: float) -> None:
        """Let points that touch at the end of a load step stick where they are; free those that do not."""
        points = self._points(u)
        gap, normal, _ = punch.gap(points, depth)
        touching = gap <= TOUCHING
        new = touching & ~self._held
        self._spot[new] = (points + np.array([0.0, 0.0, depth]))[new]
        unit = normal / np.linalg.norm(normal, axis=-1)[..., None]
        self._plane[new] = (np.eye(3) - unit[..., :, None] * unit[..., None, :])[new]
        self._held = touching

    def forces(self, u: Array, punch: RigidPunch, depth: float) -> tuple[Array, Array]:
        """Gradient (full length) and second derivative (per face) of the contact and grip energy."""
        points = self._points(u)
        gap, normal, bend = punch.gap(points, depth)
        push = self._stiffness * np.maximum(-gap, 0.0)
        pressing = np.where(gap <= TOUCHING, self._stiffness, 0.0)
        second = pressing[..., None, None] * normal[..., :, None] * normal[..., None, :]
        second -= push[..., None, None] * bend
        hold = (self._grip * self._held)[..., None, None] * self._plane
        slip = points + np.array([0.0, 0.0, depth]) - self._spot
        pull = -push[..., None] * normal + np.einsum("eqab,eqb->eqa", hold, slip)
        on_face = np.einsum("qi,eqc->eic", self._shape, pull)
        faces = len(self.dofs)
        matrix = (self._pairs.T @ (second + hold).reshape(faces, len(self._shape), 9)).reshape(faces, 9, 9, 3, 3)
        total = np.bincount(self.dofs.ravel(), on_face.ravel(), minlength=len(u))
        return total, matrix.transpose(0, 1, 3, 2, 4).reshape(faces, 27, 27)

"""Unilateral contact of the pad's surface with a rigid punch, and a stiff film that glues them.

Contact is a penalty on the penetration g < 0, measured along the punch's outward normal n, at the
quadrature points of the surface sides: energy k/2 <-g>^2 per reference area. Under the flat face of a
glued punch a film resists sliding: energy t/2 u_r^2. A point outside the face that comes to touch a glued
punch sticks there until it lifts off, held along the surface by the same kind of film: where its gap closed
within the load step (``ties``), or where it is at the end of that step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from dummydesign.core.interpolation import true_runs

Array = np.ndarray


@dataclass(frozen=True)
class Penalty:
    """How hard faces are kept apart, and points that stick are held."""

    contact: float
    grip_share: float
    over: str
    reason: str


GLUED_SLAB = Penalty(3000.0, 0.1, "rim", "ten times either moves the sharp-edge limit by less than 0.1 %")
BEADED_SQUARE = Penalty(1000.0, 0.3, "bead", "not varied alone; what a bead leaves is fitted and stated")
SLIDING_EDGE = Penalty(300.0, 1.0, "cell", "an edge that slides does not converge with a stiffer one")
PROFILE_PUNCH = Penalty(2000.0, 1.0, "cell", "no edge; not varied alone, half the cells move forces by 0.2 % at most")
ROUND_SHAPED_PAD = Penalty(2000.0, 0.1, "cell", "four times as stiff: 0.1 to 0.4 %, past the punch's edge up to 1.4 %")
SHAPED_PAD_IN_SPACE = Penalty(1000.0, 0.3, "cell", "not varied alone; the mesh as a whole is in the stated error")
RESTING_BASE = Penalty(3e4, 1.0, "thickness", "twice as stiff moves the force by less than 0.1 %")
FILLETED_PUNCH = Penalty(750.0, 1.0, "fillet", "half of it on cells of twice the size: extrapolated with them")
RUBBING_PUNCH = Penalty(750.0, 0.4, "fillet", "that of the glued fillet; 2.5 times the grip moves the force by 0.2 %")
PUCK_PLATES = Penalty(1e5, 1.0, "height", "penetration stays 1e-5 heights times the pressure in shear moduli")


class ContactSurface:
    """What a problem needs of a surface that touches: its unknowns, its forces, and what it remembers.

    This one remembers nothing and ties nothing within a step.
    """

    dofs: Array
    # Changes of contact that a step of the linearised solid may meet before the next state.
    changes = 0

    def forces(self, u: Array, punch: Any, depth: float) -> tuple[Array, Array]:
        """Internal force (full length) and its derivative (per side)."""
        raise NotImplementedError

    def pressed(self, u: Array, punch: Any, depth: float) -> tuple[Array, Callable[[], Array]]:
        """Internal force, and what gives its derivative: most states are left before anybody asks for it."""
        force, matrix = self.forces(u, punch, depth)
        return force, lambda: matrix

    def settle(self, u: Array, punch: Any, depth: float) -> None:
        """Take the state at the end of a step as that from which the next one starts."""

    def begin(self) -> None:
        """Go back to what was tied at the last accepted step."""

    def tie(self, u: Array, punch: Any, depth: float) -> bool:
        """Tie what came to touch in this step; True when there is something new."""
        return False

    def memory(self) -> Any:
        """What is tied, for :meth:`restore`."""

    def restore(self, memory: Any) -> None:
        """Take back what was tied."""


def closure(r: Array, held: Array, touching: Array, room: Array, *, grown: float = 1.0) -> Array:
    """Share of a load step at which each point's gap closed; 1 where it did not.

    Where a contact grows on from points held before, its edge is taken to move evenly, and ``grown`` is a factor of the
    share; a contact of its own is taken to close as its gaps were.
    """
    share = np.ones(len(r))
    new = touching & ~held
    if not new.any():
        return share
    for first, after in true_runs(new):
        inside = slice(first, after)
        left = first > 0 and held[first - 1] and touching[first - 1]
        right = after < len(r) and held[after] and touching[after]
        start = 0.5 * (r[first] + r[first - 1]) if first > 0 else r[first]
        stop = 0.5 * (r[after - 1] + r[after]) if after < len(r) else r[after - 1]
        if left != right and stop > start:
            along = (r[inside] - start) / (stop - start)
            share[inside] = grown * (along if left else 1.0 - along)
        else:
            ends = [room[k] for k in (first - 1, after) if 0 <= k < len(r) and not touching[k]]
            widest = max([*ends, room[inside].max(), 1e-300])
            share[inside] = np.clip(room[inside] / widest, 0.0, 1.0)
    return share


# Of the way along the punch that a point goes in a step without sticking, up to when its gap closes, this share where a
# contact grows: ahead of an edge that sticks points move with the root of their distance, which shrinks to nothing on
# the way (the integral of a root is two thirds of it). With the whole of it a thin crown's force fell by up to 1.4 %
# when steps were four times as long, so by 0.2 %.
GROWN_SLIP = 2.0 / 3.0
# A point this near counts as touching for the stiffness, so that the first step knows of the punch.
TOUCHING = 1e-12


class RigidPunch(Protocol):
    """A rigid punch, round or in space; lengths in the unit of the mesh."""

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """Gap with its gradient and second derivative at ``points``, whose last axis is r, z or x, y, z.

        The punch is down by ``depth``; the gap is negative inside it.
        """


DOWN, OUTWARDS, UNIT = np.array([0.0, -1.0]), np.array([1.0, 0.0]), np.eye(2)


def _length(vectors: Array) -> Array:
    """Length of vectors in the plane, shape (..., 2)."""
    length: Array = np.sqrt(vectors[..., 0] ** 2 + vectors[..., 1] ** 2)
    return length


def _along_outline(normal: Array) -> Array:
    """Unit vectors along a punch's outline, from its normals."""
    return np.stack([-normal[..., 1], normal[..., 0]], axis=-1) / _length(normal)[..., None]


@dataclass(frozen=True)
class FlatPunch:
    """A flat punch of a given radius whose edge is a fillet of radius ``rim``; the sides above recede.

    The pad may touch the fillet all round but nothing behind it: the punch's sides never touch.
    """

    radius: float
    rim: float

    @property
    def flat_radius(self) -> float:
        """Radius at which the flat face ends and the fillet begins."""
        return self.radius - self.rim

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """Distance to face, fillet or side, whichever is nearest, with its derivatives."""
        v = points - np.array([self.flat_radius, self.rim - depth])
        distance = np.maximum(_length(v), 1e-300)
        face, wall = self._regions(v)
        gap = np.where(face, -v[..., 1] - self.rim, distance - self.rim)
        normal = v / distance[..., None]
        normal[face] = DOWN
        if wall is not None:
            gap = np.where(wall, v[..., 0] - self.rim, gap)
            normal[wall] = OUTWARDS
            face = face | wall
        bend = UNIT - normal[..., :, None] * normal[..., None, :]
        bend *= np.where(face, 0.0, 1.0 / distance)[..., None, None]
        return gap, normal, bend

    def _regions(self, v: Array) -> tuple[Array, Array | None]:
        """Which points, measured from where the fillet is centred, face and side push; the fillet pushes the others."""
        return (v[..., 0] < 0.0) & (v[..., 1] < 0.0), None


@dataclass(frozen=True)
class FilletedPunch(FlatPunch):
    """A flat punch whose edge is a fillet, with an upright side above it or none.

    Its face pushes back from any depth inside it, so that steps may be large.
    """

    sides: bool = True

    def _regions(self, v: Array) -> tuple[Array, Array | None]:
        face = v[..., 0] < 0.0
        return face, ~face & (v[..., 1] > 0.0) if self.sides else None

    def outline(self, points: Array, depth: float) -> Array:
        """Length of the outline from the axis to the place next to ``points``."""
        v = points - np.array([self.flat_radius, self.rim - depth])
        wall = (v[..., 1] > 0.0) & self.sides
        angle = np.where(wall, 0.5 * np.pi, np.arctan2(np.maximum(v[..., 0], 0.0), -v[..., 1]))
        beyond = self.flat_radius + self.rim * angle + np.where(wall, v[..., 1], 0.0)
        return np.where(v[..., 0] < 0.0, points[..., 0], beyond)


@dataclass(frozen=True)
class ProfilePunch:
    """A punch with a smooth profile: its surface stands ``height(r)`` above its lowest point.

    ``height`` gives the height and its first three derivatives at radii of any shape; profiles must not be
    vertical. The gap is that along the axis times the cosine of the slope: the distance to the surface where it is
    small, so that steep sides are no stiffer than the face and press along their normal.
    """

    height: Callable[[Array], tuple[Array, Array, Array, Array]]

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """Distance to the profile where it is small, with its derivatives."""
        value, slope, curve, third = self.height(points[..., 0])
        axial, cosine = value - depth - points[..., 1], 1.0 / np.sqrt(1.0 + slope**2)
        turn = -slope * curve * cosine**3
        gradient = np.stack([slope * cosine + axial * turn, -cosine], axis=-1)
        second = np.zeros((*slope.shape, 2, 2))
        turning = cosine**3 * (3.0 * (slope * cosine * curve) ** 2 - curve**2 - slope * third)
        second[..., 0, 0] = curve * cosine + 2.0 * slope * turn + axial * turning
        second[..., 0, 1] = second[..., 1, 0] = -turn
        return axial * cosine, gradient, second


class SideContact(ContactSurface):
    """Sides of the pad's cells with quadrature points along them."""

    def __init__(self, nodes: Array, sides: Array, points: int) -> None:
        x, self._weight = np.polynomial.legendre.leggauss(points)
        self._shape = np.stack([x * (x - 1.0) / 2.0, 1.0 - x**2, x * (x + 1.0) / 2.0], axis=1)
        self._slope = np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=1)
        self._corners = np.moveaxis(nodes[:, sides], 0, -1)
        length = np.linalg.norm(np.einsum("qi,eic->eqc", self._slope, self._corners), axis=-1)
        self._r = self._corners[..., 0] @ self._shape.T
        self._area = 2.0 * np.pi * self._r * length * self._weight
        self._pairs = np.einsum("qi,qj->ijq", self._shape, self._shape).reshape(9, -1)
        self.dofs = np.stack([2 * sides, 2 * sides + 1], axis=-1).reshape(len(sides), 6)

    def points(self, u: Array) -> Array:
        """Where the quadrature points are at displacements ``u``."""
        moved = self._corners + u[self.dofs].reshape(self._corners.shape)
        return np.einsum("qi,eic->eqc", self._shape, moved)

    def _assembled(self, u: Array, traction: Array, second: Array) -> tuple[Array, Array]:
        """Force on all unknowns and its derivative per side, of what acts on the points."""
        return self._force(u, traction), self._matrix(second)

    def _force(self, u: Array, traction: Array) -> Array:
        on_side = np.einsum("qi,eqc->eic", self._shape, traction)
        return np.bincount(self.dofs.ravel(), on_side.ravel(), minlength=len(u))

    def _matrix(self, second: Array) -> Array:
        matrix = (self._pairs @ second.reshape(*second.shape[:2], 4)).reshape(-1, 3, 3, 2, 2)
        return matrix.transpose(0, 1, 3, 2, 4).reshape(len(self.dofs), 6, 6)


class AxisymmetricSurface(SideContact):
    """Sides of the pad that may touch the punch; stiffness and film of the glued face by radius."""

    def __init__(
        self,
        nodes: Array,
        sides: Array,
        stiffness: float | Callable[[Array], Array],
        film: Callable[[Array], Array] | None = None,
        grip: float = 0.0,
        grip_from: float = np.inf,
        friction: float = 0.0,
        slip_scale: float = 1e-3,
        ties_within_step: bool = False,
        slip_share: float = 1.0,
        changes: int = 0,
    ) -> None:
        super().__init__(nodes, sides, 5)
        shape, r, area = self._shape, self._r, self._area
        self._stiffness = area * (stiffness(r) if callable(stiffness) else stiffness)
        self._film = np.zeros((len(sides), 6, 6))
        if film is not None:
            self._film[:, ::2, ::2] = np.einsum("qi,qj,eq->eij", shape, shape, area * film(r))
        self._grip = np.where(r >= grip_from, area * grip, 0.0)
        self._friction, self._slip_scale, self._slip_share = friction, slip_scale, slip_share
        self._held = np.zeros(area.shape, dtype=bool)
        self._spot = np.zeros((*area.shape, 2))
        self._along = np.zeros((*area.shape, 2))
        self._within = ties_within_step and (friction > 0.0 or bool(self._grip.any()))
        self._before = self._held.copy()
        self._last: tuple[Array, Array] | None = None
        self._order = np.argsort(r.ravel(), kind="stable")
        self.changes = changes

    def points(self, u: Array) -> Array:
        """Where the quadrature points are at displacements ``u``, by a faster product."""
        return self._shape @ (self._corners + u[self.dofs].reshape(self._corners.shape))

    def begin(self) -> None:
        """Forget what was tied in a step that has not been accepted."""
        self._held = self._before.copy()

    def memory(self) -> Any:
        """What is tied and where, for ``restore``."""
        return self._held.copy(), self._spot.copy(), self._along.copy()

    def restore(self, memory: Any) -> None:
        """Take back a ``memory``."""
        self._held, self._spot, self._along = (part.copy() for part in memory)

    def tie(self, u: Array, punch: RigidPunch, depth: float) -> bool:
        """Tie points that came to touch in this step where the gap closed; True when there are new ones."""
        if not self._within:
            return False
        points = self.points(u)
        gap, _, _ = punch.gap(points, depth)
        touching = gap <= 0.0
        new = touching & ~self._held
        if not new.any():
            return False
        if self._last is None:
            start = self.points(np.zeros(len(u)))
            self._last = (start, punch.gap(start, 0.0)[0])
        spot = self._where_closed(points, touching, depth, *self._last)
        self._spot[new], self._along[new] = spot[new], _along_outline(punch.gap(spot, 0.0)[1])[new]
        self._held = self._held | new
        return True

    def _where_closed(self, points: Array, touching: Array, depth: float, rest: Array, room: Array) -> Array:
        """Places at which gaps closed since the last step, in the frame of the punch."""
        share = closure(
            *(x.ravel()[self._order] for x in (self._r, self._before, touching, room)), grown=self._slip_share
        )
        part = np.empty(share.shape)
        part[self._order] = share
        part = part.reshape(room.shape)[..., None]
        return rest + part * (points + np.array([0.0, depth]) - rest)

    def settle(self, u: Array, punch: RigidPunch, depth: float) -> None:
        """Accept a step: free points that do not touch; without ties within the step, tie those that do."""
        points = self.points(u)
        gap, normal, _ = punch.gap(points, depth)
        places, new = points + np.array([0.0, depth]), (gap <= 0.0) & ~self._held
        self._spot[new], self._along[new] = places[new], _along_outline(normal)[new]
        self._held = gap <= 0.0
        self._before = self._held.copy()
        self._last = (places, gap)

    def forces(self, u: Array, punch: RigidPunch, depth: float) -> tuple[Array, Array]:
        """Gradient (full length) and second derivative (per side) of the contact and film energy."""
        force, matrix = self.pressed(u, punch, depth)
        return force, matrix()

    def pressed(self, u: Array, punch: RigidPunch, depth: float) -> tuple[Array, Callable[[], Array]]:
        """Gradient of the energy, and what gives its second derivative."""
        points = self.points(u)
        gap, normal, bend = punch.gap(points, depth)
        push = self._stiffness * np.maximum(-gap, 0.0)
        pull = -push[..., None] * normal
        along = self._along
        slip = ((points + np.array([0.0, depth]) - self._spot) * along).sum(axis=-1)
        hold = self._grip * self._held
        drag = hold * slip
        share = None
        if self._friction:
            root = np.sqrt(slip**2 + self._slip_scale**2)
            share = self._friction * slip / root * self._held
            drag = drag + share * push
            hold = hold + self._friction * push * self._held * self._slip_scale**2 / root**3
        pull += drag[..., None] * along

        def matrix() -> Array:
            pressing = np.where(gap <= TOUCHING, self._stiffness, 0.0)
            second = pressing[..., None, None] * normal[..., :, None] * normal[..., None, :]
            # Left out where contact grows: with it points predicted deep in a fillet have no positive definite tangent.
            if not self.changes:
                second -= push[..., None, None] * bend
            if share is not None:
                second -= (share * pressing)[..., None, None] * along[..., :, None] * normal[..., None, :]
            second += hold[..., None, None] * along[..., :, None] * along[..., None, :]
            return self._matrix(second)

        return self._force(u, pull), matrix

    def _force(self, u: Array, traction: Array) -> Array:
        local = u[self.dofs]
        on_side = (self._shape.T @ traction).reshape(local.shape) + (self._film @ local[:, :, None])[:, :, 0]
        return np.bincount(self.dofs.ravel(), on_side.ravel(), minlength=len(u))

    def _matrix(self, second: Array) -> Array:
        return super()._matrix(second) + self._film

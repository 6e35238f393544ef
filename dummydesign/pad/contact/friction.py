"""Coulomb friction with unilateral contact: at the base a pad rests on, and at the punch."""

from __future__ import annotations

from typing import Any

import numpy as np

from dummydesign.pad.contact.axisymmetric import (
    RESTING_BASE,
    TOUCHING,
    Array,
    AxisymmetricSurface,
    ContactSurface,
    RigidPunch,
    SideContact,
)
from dummydesign.pad.fem.mixed_solid import Discretisation

# Regularising slip (thicknesses), smoothing over the pressure of a free compression by the depth, plate over shear
# modulus. Half the first changes the force by at most 0.3 % from d/h 0.02 on (and by SLIP_SCALE h / 2 d before), half
# the second and twice the last by less than 0.1 % (friction 0.3, pads of 5 and 20 mm).
SLIP_SCALE = 1e-4
SOFT_SHARE = 0.01
# Friction is eased in: its slip scale is larger by this factor at first touch, and by 1/e less at each of these depths.
EASE, EASE_DEPTH = 100.0, 0.003
# Gels and silicones of the library have 970 to 1070 kg/m3; 5 % of it is at most 0.5 % of the force (5, 20 mm; 25 kPa).
DENSITY = 1030.0  # kg/m3
GRAVITY = 9.81  # m/s2


def weight_over_shear(thickness_mm: float, shear_MPa: float) -> float:
    """Pressure of a pad's weight on its base over its shear modulus, rho g h / mu."""
    return DENSITY * GRAVITY * thickness_mm * 1e-9 / shear_MPa


class RestingBase(SideContact):
    """The pad's bottom on a rigid plate at z = -1, and the pad's own weight; slip counts from the undeformed pad."""

    def __init__(self, mesh: Discretisation, sides: Array, shear: float, friction: float, weight: float) -> None:
        super().__init__(mesh.nodes, sides, 4)
        r = mesh.nodes[0][sides]
        area = 2.0 * np.pi * (r @ self._shape.T) * np.abs(r @ self._slope.T) * self._weight
        self._stiffness, self._friction = area * RESTING_BASE.contact * shear, friction
        self._pull, self._pressure = area * weight * shear, weight

    def forces(self, u: Array, punch: RigidPunch | None, depth: float) -> tuple[Array, Array]:
        """Force (full length) and its derivative (per side) of contact, friction and weight."""
        local = u[self.dofs].reshape(-1, 3, 2)
        slip, gap = (local[:, :, k] @ self._shape.T for k in (0, 1))
        scale = SLIP_SCALE * (1.0 + EASE * np.exp(-depth / EASE_DEPTH))
        soft = SOFT_SHARE * (3.0 * depth + self._pressure) / RESTING_BASE.contact
        # Shifted so that the undeformed pad presses on the plate by its weight alone.
        rest = self._pressure / RESTING_BASE.contact
        gap = gap - rest + soft**2 / max(4.0 * rest, 1e-12)
        bend = np.sqrt(gap**2 + soft**2)
        push = 0.5 * self._stiffness * (bend - gap)
        stiffness = push / bend
        root = np.sqrt(slip**2 + scale**2)
        second = np.zeros((*push.shape, 2, 2))
        second[..., 0, 0] = self._friction * push * scale**2 / root**3
        second[..., 0, 1] = -self._friction * slip / root * stiffness
        second[..., 1, 1] = stiffness
        both = np.stack([self._friction * push * slip / root, self._pull - push], axis=-1)
        return self._assembled(u, both, second)


class CombinedSurface(ContactSurface):
    """The face that the punch presses and the base that rests, in contact at once; only the face remembers."""

    def __init__(self, face: ContactSurface, base: RestingBase) -> None:
        self.face, self._base = face, base
        self.dofs = np.concatenate([face.dofs, base.dofs])

    def begin(self) -> None:
        """As of the face."""
        self.face.begin()

    def memory(self) -> Any:
        """As of the face."""
        return self.face.memory()

    def restore(self, memory: Any) -> None:
        """As of the face."""
        self.face.restore(memory)

    def tie(self, u: Array, punch: RigidPunch, depth: float) -> bool:
        """As of the face."""
        return self.face.tie(u, punch, depth)

    def settle(self, u: Array, punch: RigidPunch, depth: float) -> None:
        """As of the face."""
        self.face.settle(u, punch, depth)

    def forces(self, u: Array, punch: RigidPunch, depth: float) -> tuple[Array, Array]:
        """Sum of the forces, and all matrices in the order of ``dofs``."""
        parts = [part.forces(u, punch, depth) for part in (self.face, self._base)]
        return parts[0][0] + parts[1][0], np.concatenate([matrix for _, matrix in parts])


# Turns the outward normal of a punch into the direction in which its outline grows.
TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
# Pull of the spring over Coulomb's limit at which a point slips as a whole.
FULL = 1.5


def coulomb_drag(pull: Array, limit: Array) -> tuple[Array, Array, Array]:
    """Drag for the pull of a spring and Coulomb's limit, with its derivatives by either."""
    x = np.clip(pull / np.maximum(limit, 1e-300), -FULL, FULL)
    share, slope = x - 4.0 / 27.0 * x**3, 1.0 - 4.0 / 9.0 * x**2
    return limit * share, slope, share - x * slope


class RubbingSurface(AxisymmetricSurface):
    """Sides of the pad that may touch a punch and rub along its outline."""

    def __init__(self, nodes: Array, sides: Array, stiffness: float, spring_share: float, friction: float) -> None:
        super().__init__(nodes, sides, stiffness, friction=friction)
        self._spring = self._stiffness * spring_share
        self._anchor = np.zeros(self._held.shape)

    def memory(self) -> Any:
        """What touches and from where its springs pull, for ``restore``."""
        return self._held.copy(), self._anchor.copy()

    def restore(self, memory: Any) -> None:
        """Take back a ``memory``."""
        self._held, self._anchor = (part.copy() for part in memory)

    def tie(self, u: Array, punch: Any, depth: float) -> bool:
        """Let points that came to touch in this step rub from where their gap closed; True when there are new ones."""
        points = self.points(u)
        gap = punch.gap(points, depth)[0]
        touching = gap <= 0.0
        new = touching & ~self._held
        if not new.any() or self._last is None:
            return False
        spot = self._where_closed(points, touching, depth, *self._last)
        self._anchor[new] = punch.outline(spot, 0.0)[new]
        self._held = self._held | new
        return True

    def settle(self, u: Array, punch: Any, depth: float) -> None:
        """Accept a step: free what does not touch; what slipped sticks, if it does, from where it is now."""
        points = self.points(u)
        gap = punch.gap(points, depth)[0]
        way = punch.outline(points, depth)
        touching = gap <= 0.0
        reach = FULL * self._friction * self._stiffness / self._spring * np.maximum(-gap, 0.0)
        kept = np.clip(self._anchor, way - reach, way + reach)
        self._anchor = np.where(self._held, kept, way)
        self._held = touching
        self._before = touching.copy()
        self._last = (points + np.array([0.0, depth]), gap)

    pressed = ContactSurface.pressed

    def forces(self, u: Array, punch: Any, depth: float) -> tuple[Array, Array]:
        """Force (full length) of contact and friction, and its derivative (per side), which is not symmetric."""
        points = self.points(u)
        gap, normal, bend = punch.gap(points, depth)
        push = self._stiffness * np.maximum(-gap, 0.0)
        pressing = np.where(gap <= TOUCHING, self._stiffness, 0.0)
        along = normal @ TURN.T
        pull, limit = self._spring * (punch.outline(points, depth) - self._anchor), self._friction * push
        drag, slope, share = (self._held * part for part in coulomb_drag(pull, limit))
        # A point that touches without pressing sticks, so that the first step knows of friction.
        slope = np.where(push > 0.0, slope, self._held * (gap <= TOUCHING))
        traction = -push[..., None] * normal + drag[..., None] * along
        second = pressing[..., None, None] * normal[..., :, None] * normal[..., None, :]
        second -= push[..., None, None] * bend
        # A point inside a fillet is on a smaller circle than the outline.
        rate = 1.0 - gap * np.trace(bend, axis1=-2, axis2=-1)
        second += (self._spring * slope * rate)[..., None, None] * along[..., :, None] * along[..., None, :]
        share = self._friction * share * pressing
        second -= share[..., None, None] * along[..., :, None] * normal[..., None, :]
        second += drag[..., None, None] * (TURN @ bend)
        return self._assembled(u, traction, second)

"""The base of a pad as a plate it merely rests on: unilateral contact and Coulomb friction, and the pad's own weight.

Beside a punch the base of a glued pad pulls on its plate; a pad that only rests there lifts off. What holds it down
is its weight, a pressure w = rho g h at the base. The traction is that of a stiff plate that pulls up to w:

    N = k/2 (sqrt(g^2 + e_n^2) - g) (smoothed),   traction = N - w,   friction = mu N s / sqrt(s^2 + e^2)

for a gap g and a slip s since the start that does not turn back. In an incompressible pad this is the same as a body
force, but for the slump of its free sides, which is left out: depths are counted from the pad at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dummydesign.pad.contact.stiffness import RESTING_BASE
from dummydesign.pad.contact.surface_axisymmetric import Punch
from dummydesign.pad.contact.ties import Contact, NoTies
from dummydesign.pad.fem.mixed_solid import Discretisation

Array = np.ndarray

# Regularising slip (thicknesses), smoothing over the pressure of a free compression by the depth, plate over shear
# modulus. Half the first changes the force by at most 0.3 % from d/h 0.02 on (and by SLIP_SCALE h / 2 d before), half
# the second and twice the last by less than 0.1 % (friction 0.3, pads of 5 and 20 mm).
SLIP_SCALE = 1e-4
SOFT_SHARE = 0.01
CONTACT_STIFFNESS = RESTING_BASE.contact
# Friction is eased in: its slip scale is larger by this factor at first touch, and by 1/e less at each of these depths.
EASE, EASE_DEPTH = 100.0, 0.003
# Gels and silicones of the library have 970 to 1070 kg/m3; 5 % of it is at most 0.5 % of the force (5, 20 mm; 25 kPa).
DENSITY = 1030.0  # kg/m3
GRAVITY = 9.81  # m/s2


def weight_over_shear(thickness_mm: float, shear_MPa: float) -> float:
    """Pressure of a pad's weight on its base over its shear modulus, rho g h / mu."""
    return DENSITY * GRAVITY * thickness_mm * 1e-9 / shear_MPa


class RestingBase(NoTies):
    """The pad's bottom on a rigid plate at z = -1, and the pad's own weight; has the methods of ``contact.Surface``.

    Parameters
    ----------
    mesh : Discretisation
        A slab of unit thickness.
    sides : ndarray of int, shape (sides, 3)
        Its bottom.
    shear : float
        Shear modulus, the unit of the rest.
    friction : float
        Coulomb's coefficient.
    weight : float
        Pressure of the pad on the plate before it is pressed, in shear moduli.
    """

    def __init__(self, mesh: Discretisation, sides: Array, shear: float, friction: float, weight: float) -> None:
        x, part = np.polynomial.legendre.leggauss(4)
        self._shape = np.stack([x * (x - 1.0) / 2.0, 1.0 - x**2, x * (x + 1.0) / 2.0], axis=1)
        slope = np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=1)
        place = mesh.nodes[0][sides]
        area = 2.0 * np.pi * (place @ self._shape.T) * np.abs(place @ slope.T) * part
        self._stiffness, self._friction = area * CONTACT_STIFFNESS * shear, friction
        self.dofs = np.stack([2 * sides, 2 * sides + 1], axis=-1).reshape(len(sides), 6)
        self._pull, self._weight = area * weight * shear, weight

    def settle(self, u: Array, punch: Punch | None, depth: float) -> None:
        """Nothing to remember: slip is counted from the undeformed pad.

        See :class:`dummydesign.pad.contact.ties.Contact`.
        """

    def forces(self, u: Array, punch: Punch | None, depth: float) -> tuple[Array, Array]:
        """Force (full length) and its derivative (per side) of contact, friction and weight.

        See :class:`dummydesign.pad.contact.ties.Contact`.
        """
        local = u[self.dofs].reshape(-1, 3, 2)
        slip, gap = (local[:, :, k] @ self._shape.T for k in (0, 1))
        scale = SLIP_SCALE * (1.0 + EASE * np.exp(-depth / EASE_DEPTH))
        soft = SOFT_SHARE * (3.0 * depth + self._weight) / CONTACT_STIFFNESS
        # Shifted so that the undeformed pad presses on the plate by its weight alone.
        rest = self._weight / CONTACT_STIFFNESS
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
        on_side = np.einsum("qi,eqc->eic", self._shape, both).reshape(len(self.dofs), 6)
        matrix = np.einsum("qi,qj,eqab->eiajb", self._shape, self._shape, second, optimize=True)
        total = np.bincount(self.dofs.ravel(), on_side.ravel(), minlength=len(u))
        return total, matrix.reshape(len(self.dofs), 6, 6)


class Both:
    """Two surfaces in contact at once, such as face and base."""

    def __init__(self, one: Contact, other: RestingBase) -> None:
        self._parts: tuple[Contact, ...] = (one, other)
        self.dofs = np.concatenate([part.dofs for part in self._parts])

    @property
    def face(self) -> Contact:
        """The surface that the punch presses."""
        return self._parts[0]

    def begin(self) -> None:
        """As of each."""
        for part in self._parts:
            part.begin()

    def memory(self) -> Any:
        """As of each."""
        return [part.memory() for part in self._parts]

    def restore(self, memory: Any) -> None:
        """As of each."""
        for part, kept in zip(self._parts, memory):
            part.restore(kept)

    def tie(self, u: Array, punch: Punch, depth: float) -> bool:
        """As of each.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes, in the mesh's unit of length.
        punch : Punch
            What presses the upper face.
        depth : float
            How far it has come, in the same unit.
        """
        return any([part.tie(u, punch, depth) for part in self._parts])

    def settle(self, u: Array, punch: Punch, depth: float) -> None:
        """As of each.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes, in the mesh's unit of length.
        punch : Punch
            What presses the upper face.
        depth : float
            How far it has come, in the same unit.
        """
        for part in self._parts:
            part.settle(u, punch, depth)

    def forces(self, u: Array, punch: Punch, depth: float) -> tuple[Array, Array]:
        """Sum of the forces, and all matrices in the order of ``dofs``.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes, in the mesh's unit of length.
        punch : Punch
            What presses the upper face.
        depth : float
            How far it has come, in the same unit.
        """
        found = [part.forces(u, punch, depth) for part in self._parts]
        return found[0][0] + found[1][0], np.concatenate([matrix for _, matrix in found])

"""A face that rubs along a rigid punch: unilateral contact and Coulomb friction that remembers where it has slipped to.

Contact is the penalty of :mod:`dummydesign.pad.contact.surface_axisymmetric`. Friction is a spring along the punch's
outline from the place where a point sticks; at Coulomb's limit the point slips and takes that place with it:

    drag = mu p (x - 4 x^3 / 27),   x = k (s - a) / (mu p) within -3/2 and 3/2, at which the drag is -mu p and mu p

with the way s along the outline, the pressure p, and the place a, which is that of first touch at first and follows at
the end of each load step so that x stays within its ends. So |drag| <= mu p everywhere, slip may turn back or end, and
the derivative has no jump where slip begins.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from dummydesign.pad.contact.surface_axisymmetric import TOUCHING, Surface

Array = np.ndarray

# Turns the outward normal of a punch into the direction in which its outline grows.
TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
# Pull of the spring over Coulomb's limit at which a point slips as a whole.
FULL = 1.5


def coulomb_drag(pull: Array, limit: Array) -> tuple[Array, Array, Array]:
    """Drag for the pull of a spring and Coulomb's limit, with its derivatives by either.

    Parameters
    ----------
    pull, limit : ndarray of one shape
        Per area or not, in one unit; the limit is not negative.
    """
    x = np.clip(pull / np.maximum(limit, 1e-300), -FULL, FULL)
    share, slope = x - 4.0 / 27.0 * x**3, 1.0 - 4.0 / 9.0 * x**2
    return limit * share, slope, share - x * slope


class OutlinedPunch(Protocol):
    """A punch whose outline has a length."""

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """As of :class:`dummydesign.pad.contact.surface_axisymmetric.Punch`."""

    def outline(self, points: Array, depth: float) -> Array:
        """Length of the outline from the axis to the place next to ``points``."""


class RubbingSurface(Surface):
    """Sides of the pad that may touch a punch and rub along its outline.

    Parameters
    ----------
    nodes : ndarray, shape (2, n)
    sides : ndarray of int, shape (sides, 3)
        End, middle and end node of each side.
    stiffness : float
        Contact stiffness per area.
    spring_share : float
        Stiffness of the spring along the outline, over that of the contact.
    friction : float
        Coulomb's coefficient, above 0.
    """

    def __init__(self, nodes: Array, sides: Array, stiffness: float, spring_share: float, friction: float) -> None:
        super().__init__(nodes, sides, lambda at: np.full_like(at, stiffness), np.zeros_like, friction=friction)
        self._spring = self._stiffness * spring_share
        self._anchor = np.zeros(self._held.shape)

    def memory(self) -> Any:
        """What touches and from where its springs pull, for ``restore``."""
        return self._held.copy(), self._anchor.copy()

    def restore(self, memory: Any) -> None:
        """Take back a ``memory``."""
        self._held, self._anchor = (part.copy() for part in memory)

    def tie(self, u: Array, punch: Any, depth: float) -> bool:
        """Let points that came to touch in this step rub from where their gap closed; True when there are new ones.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes, in the mesh's unit of length.
        punch : OutlinedPunch
        depth : float
            How far the punch has come, in the same unit.
        """
        points = self._points(u)
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
        """Accept a step: free what does not touch; what slipped sticks, if it does, from where it is now.

        Parameters
        ----------
        u, punch, depth
            As for :meth:`tie`.
        """
        points = self._points(u)
        gap = punch.gap(points, depth)[0]
        way = punch.outline(points, depth)
        touching = gap <= 0.0
        reach = FULL * self._friction * self._stiffness / self._spring * np.maximum(-gap, 0.0)
        kept = np.clip(self._anchor, way - reach, way + reach)
        self._anchor = np.where(self._held, kept, way)
        self._held = touching
        self._before = touching.copy()
        self._last = (points + np.array([0.0, depth]), gap)

    def forces(self, u: Array, punch: Any, depth: float) -> tuple[Array, Array]:
        """Force (full length) of contact and friction, and its derivative (per side), which is not symmetric.

        Parameters
        ----------
        u, punch, depth
            As for :meth:`tie`.

        Returns
        -------
        force : ndarray, shape (displacements,)
        derivative : ndarray, shape (sides, dofs, dofs)
        """
        points = self._points(u)
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

    def tractions(self, u: Array, punch: Any, depth: float) -> tuple[Array, Array, Array]:
        """Way along the outline, rising, with pressure and drag at the quadrature points that touch, per rest area.

        Parameters
        ----------
        u, punch, depth
            As for :meth:`tie`.
        """
        points = self._points(u)
        gap = punch.gap(points, depth)[0]
        on = self._held & (gap < 0.0)
        way, push = punch.outline(points, depth), self._stiffness * np.maximum(-gap, 0.0)
        drag = coulomb_drag(self._spring * (way - self._anchor), self._friction * push)[0]
        order = np.argsort(way[on])
        return tuple((part[on])[order] for part in (way, push / self._area, drag / self._area))  # type: ignore[return-value]

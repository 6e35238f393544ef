"""The response surface of crowned pads: in pieces joined where the punch's edge comes into contact.

Until then the force does not know how large the punch is, so it is a function of the crown alone: c/h, b/h, s and
depth (thickness h; crown of height c, foot radius b and s = R c / b^2 with apex radius R). The depth of the edge is
itself a surface over all four numbers. What follows depends on the foot:

- a foot well inside the punch (b below ``NARROW`` punch radii): the flat around the crown is met at once, and the
  force rises many times over a few hundredths of h. It is counted from that depth e and the force F_e there,
  as ln((F / F_e - 1) / eta) over eta = (d - e) / h;
- a wider foot: the contact spreads to the edge, and the curve bends without a jump.

Beyond, all pads share one surface over d / h. Pieces fade into each other (3 t^2 - 2 t^3), so force and stiffness are
continuous in depth; between a narrow and a wide foot the force steps by what both are wrong by.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dummydesign.pad.tables.response_surface import Response

Array = np.ndarray

# Foot radius over punch radius below which the flat around the crown is met all at once.
NARROW = 0.7
# Depths over that of the edge between which the crown alone fades into what bends; over the edge's depth, where that
# begins to fade into what all pads share, and over how much more, at least so many thicknesses.
BEND, SHARED, LEAST_FADE = (0.85, 0.97), (1.15, 0.3), 0.05
# After a jump, eta between which it fades into what all pads share.
SETTLED = (0.07, 0.13)


def crown_inputs(inputs: Array) -> Array:
    """Coordinates (n, 3) that the crown alone has, from all four (ln h/a, c/h, ln b/a, ln s)."""
    return np.column_stack([inputs[:, 1], inputs[:, 2] - inputs[:, 0], inputs[:, 3]])


@dataclass(frozen=True)
class CrownResponse:
    """Surfaces of a crowned pad's force, each over ln h/a, c/h, ln b/a and ln s but the first.

    Attributes
    ----------
    before : Response
        y over the coordinates of :func:`crown_inputs` at levels of d / c; y = ln(F / (16/9 E sqrt(R) d^1.5)).
    narrow_edge, wide_edge : Response
        One level: ln of the depth at which the edge is reached, over c.
    jump : Response
        ln((F / F_e - 1) / eta) at levels of eta.
    bend : Response
        y of wide feet at levels of d / c.
    after : Response
        y of all pads at levels of d / h.
    """

    before: Response
    narrow_edge: Response
    wide_edge: Response
    jump: Response
    bend: Response
    after: Response

    def limit(self, inputs: Array) -> Array:
        """d / h to which inputs (n, 4) may be trusted; see :meth:`Response.limit`."""
        return self.after.limit(inputs)

    def edge(self, inputs: Array) -> Array:
        """d / h at which the contact reaches the punch's edge, of inputs (n, 4)."""
        found = np.empty(len(inputs))
        for which, surface in self._kinds(inputs, self.narrow_edge, self.wide_edge):
            found[which] = np.exp(surface.at_levels(inputs[which])[:, 0])
        return found * inputs[:, 1]

    @staticmethod
    def _kinds(inputs: Array, narrow: Response, wide: Response) -> list[tuple[Array, Response]]:
        """Places of pads with a narrow and a wide foot, with the surface of each."""
        few = inputs[:, 2] < np.log(NARROW)
        return [(np.nonzero(few)[0], narrow), (np.nonzero(~few)[0], wide)]

    def along(self, inputs: Array, place: Array, x: Array) -> tuple[Array, Array]:
        """y and dy / d(d / h).

        Parameters
        ----------
        inputs : ndarray, shape (n, 4)
            ln h/a, c/h, ln b/a and ln s.
        place : ndarray of int
            Which of them each depth belongs to; any shape.
        x : ndarray
            d / h of the same shape, >= 0.
        """
        at, depth = place.ravel(), np.maximum(x, 0.0).ravel()
        edge, height = self.edge(inputs), inputs[:, 1]
        deepest = np.zeros(len(inputs))
        np.maximum.at(deepest, at, depth)
        alone = self.before.at_levels(crown_inputs(inputs))
        shared = _levels(self.after, inputs, self._settled(inputs, deepest, edge))
        value, slope = np.empty(len(depth)), np.empty(len(depth))
        (few, jump), (many, bend) = self._kinds(inputs, self.jump, self.bend)
        own = np.empty(len(inputs), dtype=int)
        own[few], own[many] = np.arange(len(few)), np.arange(len(many))
        narrow = (inputs[:, 2] < np.log(NARROW))[at]
        for which, surface, wanted, piece in (
            (few, jump, np.nonzero(narrow)[0], self._narrow),
            (many, bend, np.nonzero(~narrow)[0], self._wide),
        ):
            i = at[wanted]
            rows = _levels(surface, inputs[which], deepest[which] > BEND[0] * edge[which])
            value[wanted], slope[wanted] = piece(
                alone, rows, shared, i, own[i], depth[wanted], edge[i], height[i]
            )
        return value.reshape(x.shape), slope.reshape(x.shape)

    def _settled(self, inputs: Array, deepest: Array, edge: Array) -> Array:
        """Which pads are pressed to where what all share has begun."""
        start = np.maximum(SHARED[0] * edge, self.after.levels[0])
        return np.where(inputs[:, 2] < np.log(NARROW), deepest - edge > SETTLED[0], deepest > start)

    def _narrow(
        self, alone: Array, rows: Array, shared: Array, i: Array, k: Array, x: Array, e: Array, c: Array
    ) -> tuple[Array, Array]:
        """The crown alone to its edge, the jump, what all pads share; rows ``i`` and, of the jump, ``k``."""
        value, slope = np.zeros(len(x)), np.zeros(len(x))
        far, steep = _fade(x - e, *SETTLED)
        on = np.nonzero(far < 1.0)[0]
        value[on], slope[on] = _on(self.before, alone, i[on], np.minimum(x, e)[on], c[on])
        on = on[x[on] > e[on]]
        eta = x[on] - e[on]
        rise, climb = self._risen(rows, k[on], eta)
        grown = np.exp(rise) * eta
        value[on] += np.log1p(grown) - 1.5 * np.log(x[on] / e[on])
        slope[on] = np.exp(rise) * (1.0 + eta * climb) / (1.0 + grown) - 1.5 / x[on]
        _mix(value, slope, far, steep, lambda one: _on(self.after, shared, i[one], x[one], 1.0))
        return value, slope

    def _risen(self, rows: Array, k: Array, eta: Array) -> tuple[Array, Array]:
        """The jump's surface and its slope, straight in sqrt(eta) below its first level."""
        first = self.jump.levels[0]
        value, slope = _on(self.jump, rows, k, np.maximum(eta, first), 1.0)
        steep = np.where(eta < first, slope * np.sqrt(first / np.maximum(eta, 1e-12)), slope)
        return value + 2.0 * np.sqrt(first) * slope * (np.sqrt(np.minimum(eta, first)) - np.sqrt(first)), steep

    def _wide(
        self, alone: Array, rows: Array, shared: Array, i: Array, k: Array, x: Array, e: Array, c: Array
    ) -> tuple[Array, Array]:
        """The crown alone, the bend at the edge, what all pads share; rows ``i`` and, of the bend, ``k``."""
        value, slope = np.zeros(len(x)), np.zeros(len(x))
        near, steep = _fade(x, BEND[0] * e, BEND[1] * e)
        # What all pads share begins at its first level.
        start = np.maximum(SHARED[0] * e, self.after.levels[0])
        far, steeper = _fade(x, start, start + np.maximum(SHARED[1] * e, LEAST_FADE))
        on = np.nonzero(near < 1.0)[0]
        value[on], slope[on] = _on(self.before, alone, i[on], x[on], c[on])
        on = np.where(far < 1.0, near, 0.0)
        _mix(value, slope, on, steep, lambda one: _on(self.bend, rows, k[one], x[one], c[one]))
        _mix(value, slope, far, steeper, lambda one: _on(self.after, shared, i[one], x[one], 1.0))
        return value, slope


def _levels(surface: Response, inputs: Array, wanted: Array) -> Array:
    """Values at all levels of those inputs that are asked for them; 0 of the others."""
    rows = np.zeros((len(inputs), len(surface.levels)))
    rows[wanted] = surface.at_levels(inputs[wanted])
    return rows


def _on(surface: Response, rows: Array, place: Array, x: Array, unit: Array | float) -> tuple[Array, Array]:
    """Value and slope over x of a surface whose levels count in ``unit``."""
    depth = x / unit
    value, slope = surface.along(rows, place, depth)
    return value, slope / (2.0 * np.sqrt(np.maximum(depth, 1e-12)) * unit)


def _fade(x: Array, start: Array | float, end: Array | float) -> tuple[Array, Array]:
    """Share from 0 at ``start`` to 1 at ``end``, and its derivative."""
    t = np.clip((x - start) / (end - start), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / (end - start)


def _mix(
    value: Array, slope: Array, share: Array, steep: Array, other: Callable[[Array], tuple[Array, Array]]
) -> None:
    """Fade ``value`` and ``slope`` in place into what ``other`` gives at the places where it has a share."""
    on = np.nonzero(share > 0.0)[0]
    there, tilt = other(on)
    slope[on] += share[on] * (tilt - slope[on]) + steep[on] * (there - value[on])
    value[on] += share[on] * (there - value[on])

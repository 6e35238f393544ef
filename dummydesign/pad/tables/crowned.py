"""The response surface of crowned pads: in pieces joined where the punch's edge comes into contact.

Until then the force does not know how large the punch is, so it is a function of the crown alone: c/h, b/h, s and
depth (thickness h; crown of height c, foot radius b and s = R c / b^2 with apex radius R). The depth of the edge is
itself a surface over all four numbers. What follows depends on the foot:

- a narrow foot, well inside the punch: the flat around the crown is met at once, and the
  force rises many times over a few hundredths of h. It is counted from that depth e and the force F_e there,
  as ln((F / F_e - 1) / eta) over eta = (d - e) / h;
- a wide foot: the contact spreads to the edge, and the curve bends without a jump.

Beyond, all pads share one surface over d / h. Pieces fade into each other (3 t^2 - 2 t^3), over depth and, between a
narrow and a wide foot, over ln(b / a) within ``JOIN``. So the force is continuous in all its numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

Array = np.ndarray
PORTION = 512
ROOT = 5.0**0.5


def quadratic(q: Array) -> Array:
    """Columns 1, q_i, q_i q_j of points (n, k)."""
    k = q.shape[1]
    columns = [np.ones(len(q)), *q.T, *(q[:, i] * q[:, j] for i in range(k) for j in range(i, k))]
    return np.stack(columns, axis=1)


def matern(first: Array, second: Array, lengths: Array) -> Array:
    """Matern kernel (nu = 5/2) between two sets of points of scaled inputs."""
    square = _squares(first * (ROOT / lengths), second * (ROOT / lengths))
    np.maximum(square, 0.0, out=square)
    distance = np.sqrt(square)
    square /= 3.0
    square += distance
    square += 1.0
    np.negative(distance, out=distance)
    np.exp(distance, out=distance)
    square *= distance
    return square


def _squares(a: Array, b: Array) -> Array:
    """Squared distances between points (n, k) and (m, k); a little below 0 by rounding where they agree."""
    one, other = np.ones((len(a), 1)), np.ones((len(b), 1))
    ahead = np.hstack([-2.0 * a, (a**2).sum(1)[:, None], one])
    return ahead @ np.hstack([b, other, (b**2).sum(1)[:, None]]).T


def _parts(count: int) -> list[slice]:
    """Rows in portions whose kernels stay in the processor's cache."""
    return [slice(start, start + PORTION) for start in range(0, count, PORTION)]


def fade(x: Array, start: Array | float, end: Array | float) -> tuple[Array, Array]:
    """Share from 0 at ``start`` to 1 at ``end``, and its derivative."""
    t = np.clip((x - start) / (end - start), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / (end - start)


@dataclass(frozen=True)
class Response:
    """A response surface over k inputs and depth."""

    low: Array
    high: Array
    lengths: Array
    centres: Array
    levels: Array
    trend: Array
    weights: Array
    reach: Array
    anchored: bool

    def scaled(self, inputs: Array) -> Array:
        """Inputs (n, k) on the scale from -1 to 1."""
        return 2.0 * (inputs - self.low) / (self.high - self.low) - 1.0

    def at_levels(self, inputs: Array) -> Array:
        """y of inputs (n, k) at all levels, shape (n, m)."""
        q, centres = self.scaled(inputs), self.scaled(self.centres)
        y = quadratic(q) @ self.trend.T
        for part in _parts(len(q)):
            y[part] += matern(q[part], centres, self.lengths) @ self.weights.T
        return y

    def limit(self, inputs: Array) -> Array:
        """d / h to which inputs (n, k) may be trusted: mean of the reach near by, weights inverse distance^4."""
        q, centres = self.scaled(inputs) / self.lengths, self.scaled(self.centres) / self.lengths
        limits = np.empty(len(q))
        for part in _parts(len(q)):
            weight = _squares(q[part], centres)
            np.maximum(weight, 0.0, out=weight)
            weight += 1e-6
            weight *= weight
            np.reciprocal(weight, out=weight)
            limits[part] = weight @ self.reach / weight.sum(1)
        return limits

    @cached_property
    def _knots(self) -> Array:
        return np.sqrt(np.concatenate([[0.0], self.levels]) if self.anchored else self.levels)

    @cached_property
    def _bend(self) -> Array:
        """Matrix from values at the knots to second derivatives of the natural cubic spline."""
        t = self._knots
        step = np.diff(t)
        left, right = np.eye(len(t)), np.zeros((len(t), len(t)))
        for i in range(1, len(t) - 1):
            left[i, i - 1 : i + 2] = step[i - 1], 2.0 * (step[i - 1] + step[i]), step[i]
            right[i, i - 1 : i + 2] = 6.0 / step[i - 1], -6.0 / step[i - 1] - 6.0 / step[i], 6.0 / step[i]
        return np.linalg.solve(left, right)

    def along(self, rows: Array, row: Array, depth: Array) -> tuple[Array, Array]:
        """Spline in sqrt(depth) through rows of values at the levels."""
        values = np.concatenate([np.zeros((len(rows), 1)), rows], axis=1) if self.anchored else rows
        bend = values @ self._bend.T
        t = self._knots
        at = np.clip(np.sqrt(np.maximum(depth, 0.0)), t[0], t[-1])
        i = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
        h = t[i + 1] - t[i]
        b = (at - t[i]) / h
        a = 1.0 - b
        y0, y1, m0, m1 = values[row, i], values[row, i + 1], bend[row, i], bend[row, i + 1]
        value = a * y0 + b * y1 + ((a**3 - a) * m0 + (b**3 - b) * m1) * h**2 / 6.0
        slope = (y1 - y0) / h + ((1.0 - 3.0 * a**2) * m0 + (3.0 * b**2 - 1.0) * m1) * h / 6.0
        # Held before the first knot and beyond the last.
        asked = np.sqrt(depth)
        return value, np.where((asked < t[0]) | (asked > t[-1]), 0.0, slope)


# Foot radii over the punch's between which a narrow foot fades into a wide one. Below, the depth of a wide foot's
# edge is not fitted; above, narrow surfaces are off by up to 14 % where the edge is reached late (d / h above 0.5).
JOIN = (0.65, 0.72)
# Depths over that of the edge between which the crown alone fades into what bends; over the edge's depth, where that
# begins to fade into what all pads share, and over how much more, at least so many thicknesses.
BEND, SHARED, LEAST_FADE = (0.85, 0.97), (1.15, 0.3), 0.05
# After a jump, eta between which it fades into what all pads share.
SETTLED = (0.07, 0.13)
# d / h below which a tip touches too few cells to be fitted. There ln of the force over the tip's is that of a ball on
# a bonded layer and what the crown falls from its tip's paraboloid, which begins with d.
FIRST = 0.035
# How far the depth of the edge is off, over it (95 % of 84 drawn crowns), and d / h before and after it between which
# that begins and ceases to count.
EDGE_DOUBT, BEFORE_EDGE, AFTER_EDGE = 0.015, (-0.06, -0.02), (0.08, 0.14)


def _on_a_layer(tip: Array, x: ArrayLike) -> tuple[Array, Array]:
    """ln of the force of a ball of radius ``tip`` h on a bonded layer over Hertz's, and its derivative by d / h.

    References
    ----------
    Dimitriadis et al., Biophys. J. 82 (2002) 2798, equation 13.
    """
    c = np.sqrt(tip * x)
    layer = 1.0 + c * (1.133 + c * (1.283 + c * (0.769 + 0.0975 * c)))
    bend = 1.133 + c * (2.566 + c * (2.307 + 0.39 * c))
    return np.log(layer), bend / layer * 0.5 * c / np.asarray(x)


def _before_first(tip: Array, x: Array, value: Array, slope: Array) -> Array:
    """y at d / h below ``FIRST``, from y and its derivative there."""
    share = np.clip(x / FIRST, 1e-12, 1.0)
    (theory, _), (end, tilt) = _on_a_layer(tip, FIRST * share), _on_a_layer(tip, FIRST)
    left, steep = value - end, FIRST * (slope - tilt)
    # the remainder begins with d; where it bends on the way to FIRST, as on a pointed tip, with the root of d
    with np.errstate(divide="ignore", invalid="ignore"):
        bent = np.nan_to_num(np.clip(steep / left, 0.0, 1.0), nan=1.0)
    begins, more = 2.0 * (1.0 - bent), left * bent - steep
    return theory + left * (begins * np.sqrt(share) + (1.0 - begins) * share) + more * share * (1.0 - share)


def crown_inputs(inputs: Array) -> Array:
    """Coordinates (n, 3) that the crown alone has, from all four (ln h/a, c/h, ln b/a, ln s)."""
    return np.column_stack([inputs[:, 1], inputs[:, 2] - inputs[:, 0], inputs[:, 3]])


@dataclass(frozen=True)
class CrownResponse:
    """Surfaces of a crowned pad's force, each over ln h/a, c/h, ln b/a and ln s but the first."""

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
        mean = np.zeros(len(inputs))
        for part, surface in zip(_shares(inputs), (self.narrow_edge, self.wide_edge)):
            which = np.nonzero(part)[0]
            mean[which] += part[which] * surface.at_levels(inputs[which])[:, 0]
        return np.exp(mean) * inputs[:, 1]

    def along(self, inputs: Array, row: Array, x: Array) -> Array:
        """y of rows of inputs at d / h."""
        x, row = np.asarray(x), np.asarray(row)
        value, slope = self._pressed(inputs, row, np.maximum(x, FIRST))
        if (shallow := x < FIRST).any():
            at = row[shallow]
            tip = np.exp(inputs[at, 3] + 2.0 * (inputs[at, 2] - inputs[at, 0])) / inputs[at, 1]
            value[shallow] = _before_first(tip, x[shallow], value[shallow], slope[shallow])
        return value

    def doubt(self, inputs: Array, row: Array, x: Array) -> Array:
        """Relative error of the force where the edge comes into contact a little sooner or later than it should."""
        edge = self.edge(inputs)[row]
        aside = EDGE_DOUBT * edge
        ends = self.along(inputs, np.stack([row, row]), np.stack([x - aside, x + aside]))
        begins, _ = fade(x - edge, *BEFORE_EDGE)
        ceases, _ = fade(x - edge, *AFTER_EDGE)
        return begins * (1.0 - ceases) * 0.5 * np.abs(ends[1] - ends[0])

    def _pressed(self, inputs: Array, row: Array, x: Array) -> tuple[Array, Array]:
        """y and dy / d(d / h) of depths that are fitted."""
        at, depth = row.ravel(), x.ravel()
        height, deepest = inputs[:, 1], np.zeros(len(inputs))
        np.maximum.at(deepest, at, depth)
        alone = self.before.at_levels(crown_inputs(inputs))
        narrow, wide = _shares(inputs)
        few, many = np.nonzero(narrow)[0], np.nonzero(wide)[0]
        met, grown = (
            np.exp(surface.at_levels(inputs[which])[:, 0]) * height[which]
            for which, surface in ((few, self.narrow_edge), (many, self.wide_edge))
        )
        # What all pads share is only worked out for those that are pressed to where it begins.
        settled = np.zeros(len(inputs), dtype=bool)
        settled[few] = deepest[few] - met > SETTLED[0]
        settled[many] |= deepest[many] > np.maximum(SHARED[0] * grown, self.after.levels[0])
        shared = _levels(self.after, inputs, settled)
        value, slope = np.zeros(len(depth)), np.zeros(len(depth))
        own = np.zeros(len(inputs), dtype=int)
        for part, which, edge, surface, piece in (
            (narrow, few, met, self.jump, self._narrow),
            (wide, many, grown, self.bend, self._wide),
        ):
            own[which] = np.arange(len(which))
            wanted = np.nonzero(part[at])[0]
            i = at[wanted]
            rows = _levels(surface, inputs[which], deepest[which] > BEND[0] * edge)
            there, tilt = piece(alone, rows, shared, i, own[i], depth[wanted], edge[own[i]], height[i])
            value[wanted] += part[i] * there
            slope[wanted] += part[i] * tilt
        return value.reshape(x.shape), slope.reshape(x.shape)

    def _narrow(
        self, alone: Array, rows: Array, shared: Array, i: Array, k: Array, x: Array, e: Array, c: Array
    ) -> tuple[Array, Array]:
        """The crown alone to its edge, the jump, what all pads share; rows ``i`` and, of the jump, ``k``."""
        value, slope = np.zeros(len(x)), np.zeros(len(x))
        far, steep = fade(x - e, *SETTLED)
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
        near, steep = fade(x, BEND[0] * e, BEND[1] * e)
        # What all pads share begins at its first level.
        start = np.maximum(SHARED[0] * e, self.after.levels[0])
        far, steeper = fade(x, start, start + np.maximum(SHARED[1] * e, LEAST_FADE))
        on = np.nonzero(near < 1.0)[0]
        value[on], slope[on] = _on(self.before, alone, i[on], x[on], c[on])
        on = np.where(far < 1.0, near, 0.0)
        _mix(value, slope, on, steep, lambda one: _on(self.bend, rows, k[one], x[one], c[one]))
        _mix(value, slope, far, steeper, lambda one: _on(self.after, shared, i[one], x[one], 1.0))
        return value, slope


def _shares(inputs: Array) -> tuple[Array, Array]:
    """Shares of a narrow and of a wide foot in the force of inputs (n, 4)."""
    wide, _ = fade(inputs[:, 2], *np.log(JOIN))
    return 1.0 - wide, wide


def _levels(surface: Response, inputs: Array, wanted: Array) -> Array:
    """Values at all levels of those inputs that need them; 0 of the others."""
    rows = np.zeros((len(inputs), len(surface.levels)))
    rows[wanted] = surface.at_levels(inputs[wanted])
    return rows


def _on(surface: Response, rows: Array, row: Array, x: Array, unit: Array | float) -> tuple[Array, Array]:
    """Value and slope over x of a surface whose levels count in ``unit``."""
    depth = x / unit
    value, slope = surface.along(rows, row, depth)
    return value, slope / (2.0 * np.sqrt(np.maximum(depth, 1e-12)) * unit)


def _mix(value: Array, slope: Array, share: Array, steep: Array, other: Callable[[Array], tuple[Array, Array]]) -> None:
    """Fade ``value`` and ``slope`` in place into what ``other`` gives at the places where it has a share."""
    on = np.nonzero(share > 0.0)[0]
    there, tilt = other(on)
    slope[on] += share[on] * (tilt - slope[on]) + steep[on] * (there - value[on])
    value[on] += share[on] * (there - value[on])

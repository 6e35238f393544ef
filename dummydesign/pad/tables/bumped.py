"""The response surface of fields of caps: ln of the force over what punch and caps overlap by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM, SMALLEST_HEIGHT_MM
from dummydesign.geometry.shapes.bumped import FOOT_OVER_PITCH, HEIGHT_OVER_FOOT
from dummydesign.pad.tables.response_surface import Response, fade

Array = np.ndarray

HEIGHT_OVER_PITCH = HEIGHT_OVER_FOOT * FOOT_OVER_PITCH
RADIUS_OVER_HEIGHT = 0.5 * (1.0 + HEIGHT_OVER_FOOT**-2)
HALF_SIDE = 0.5 * np.sqrt(np.pi)
# Fillet at the punch's edge over the smaller of half side and thickness, in the solves as well.
RIM = 0.1
# Lattice places of caps that reach under the punch, and how many there are of each.
PLACES = ((0, 0, 1), (1, 0, 4), (1, 1, 4), (2, 0, 4), (2, 1, 8), (2, 2, 4))
SMALLEST = SMALLEST_HEIGHT_MM / PUNCH_RADIUS_MM * (1.0 - 1e-6)


def overlap(inputs: Array, depth: Array, *hertz: float) -> list[tuple[Array, Array]]:
    """Sum over all caps and the flat, over the Hertz term of the middle tip, and its derivative by depth.

    A cap of radius R that is d deep counts its volume in the punch, pi d^2 (R - d/3), plus ``hertz`` pitch sqrt(R)
    d^1.5, which is its force by Hertz; at the punch's edge the share of it that is under the punch.
    """
    shape, depth, inputs = depth.shape, depth.ravel(), inputs.reshape(-1, 3)
    thickness, pitch, grade = np.exp(inputs[:, 0]), np.exp(inputs[:, 1]), inputs[:, 2]
    height = HEIGHT_OVER_PITCH * pitch
    radius = RADIUS_OVER_HEIGHT * height
    rim = RIM * np.minimum(thickness, HALF_SIDE)
    core = HALF_SIDE - rim
    volume, swelling, force, stiffness = (np.zeros(len(depth)) for _ in range(4))
    for i, j, count in PLACES:
        lower = grade * height * (i * i + j * j)
        own = height - lower
        here = np.flatnonzero((depth > lower) & (own >= SMALLEST) & ((i - 0.5) * pitch < HALF_SIDE))
        down, r, p = (depth - lower)[here], radius[here], pitch[here]
        # A cap that is pressed flat is counted whole; beyond, the flat counts.
        deep = np.minimum(down, own[here])
        foot, by_hertz = np.sqrt(deep * (2.0 * r - deep)), p * np.sqrt(r * deep)
        moves = down < own[here]
        widens = np.where(moves, (r - deep) / foot, 0.0)
        edge, shifts = _edge(core[here], rim[here], down)
        one, grows = _share(edge - i * p, shifts, foot, widens)
        other, rises = (one, grows) if i == j else _share(edge - j * p, shifts, foot, widens)
        share, gains = count * one * other, count * (one * rises + other * grows)
        whole, pressed = np.pi * deep * deep * (r - deep / 3.0), by_hertz * deep
        volume[here] += share * whole
        swelling[here] += share * np.where(moves, np.pi * foot * foot, 0.0) + gains * whole
        force[here] += share * pressed
        stiffness[here] += share * np.where(moves, 1.5 * by_hertz, 0.0) + gains * pressed
    flat = np.maximum(depth - height, 0.0)
    edge, shifts = _edge(core, rim, flat)
    volume += 4.0 * edge**2 * flat
    swelling += np.where(flat > 0.0, 4.0 * edge * (edge + 2.0 * shifts * flat), 0.0)
    tip, by = pitch * np.sqrt(radius * depth) * depth, 1.5 / depth
    ratios = [(force + volume / weight) / tip for weight in hertz]
    slopes = [(stiffness + swelling / weight) / tip for weight in hertz]
    return [(ratio.reshape(shape), (slope - by * ratio).reshape(shape)) for ratio, slope in zip(ratios, slopes)]


def _edge(core: Array, rim: Array, down: Array) -> tuple[Array, Array]:
    """Where the punch ends for what is touched ``down`` deep, its fillet as a parabola, and the derivative."""
    reach = np.sqrt(2.0 * rim * down)
    return core + np.minimum(reach, rim), np.where((reach < rim) & (down > 0.0), rim / np.maximum(reach, 1e-12), 0.0)


def _share(inside: Array, shifts: Array, foot: Array, widens: Array) -> tuple[Array, Array]:
    """Share of a cap that is under a punch which ends ``inside`` beyond the cap's middle, and its derivative."""
    t = 0.5 * inside / foot + 0.5
    bend = np.where((t > 0.0) & (t < 1.0), 0.5 * (shifts - inside * widens / foot) / foot, 0.0)
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) * bend


# Depths over the caps' height, but no less than over the thickness, between which each piece fades into the next.
CAPS_BEGIN = (0.3, 0.48)
PAD_BEGINS = (1.15, 0.15), (1.5, 0.21)
# What a sharp edge carries more than the fillet of the solves, by d / h: 9 % at 0.13, 14 % at 0.2, 10 % at 0.37 and 2 %
# at 0.58 on 9.3 mm (half the fillet, extrapolated), 12 to 17 % at the first touch of slabs. Not in the force.
EDGE_LEFT = (0.25, 0.6), (0.15, 0.03)
OUTLINE = np.linspace(0.0, 1.0, 25)
# How much of the overlap is Hertz's, of the first and of the later pieces.
FIRST, LATER = 3.0, 0.1
# Depth over the punch's radius below which the overlap is that of the middle tip.
NOTHING = 1e-9


def edge_left(depth: Array, fall: Array) -> Array:
    """What a sharp edge carries more than the fillet, over the force, at depths over the thickness.

    It begins where the face comes near, which is ``fall`` below the highest point along the edge.
    """
    near, _ = fade(depth, 0.5 * fall, fall + 1e-9)
    return near * np.interp(depth, *EDGE_LEFT)


def fall_at_edge(inputs: Array) -> Array:
    """Least fall of the face of inputs (n, 3) along the punch's edge, over the thickness."""
    thickness, pitch, grade = np.exp(inputs[:, 0]), np.exp(inputs[:, 1]), inputs[:, 2]
    height = HEIGHT_OVER_PITCH * pitch
    least = height
    for i, j, _ in PLACES:
        for x, y in {(i, j), (j, i)}:
            own = (HALF_SIDE - x * pitch[:, None]) ** 2 + (HALF_SIDE * OUTLINE - y * pitch[:, None]) ** 2
            fall = grade * height * (i * i + j * j) + own.min(axis=1) / (2.0 * RADIUS_OVER_HEIGHT * height)
            least = np.minimum(least, fall)
    return least / thickness


def field_inputs(inputs: Array) -> Array:
    """Coordinates (n, 3) of the pieces: ln of the gel below the caps over a, ln pitch/a and grade over height."""
    below = np.exp(inputs[:, 0]) - HEIGHT_OVER_PITCH * np.exp(inputs[:, 1])
    return np.column_stack([np.log(np.maximum(below, 1e-3)), inputs[:, 1:]])


@dataclass(frozen=True)
class FieldResponse:
    """Surfaces over the coordinates of :func:`field_inputs`."""

    touched: Response
    caps: Response
    pad: Response

    def limit(self, inputs: Array) -> Array:
        """d / h to which inputs (n, 3) may be trusted; see :meth:`Response.limit`."""
        return self.pad.limit(field_inputs(inputs))

    def doubt(self, inputs: Array, row: Array, x: Array) -> Array:
        """Relative error of the force by the fillet of the solves."""
        return edge_left(x, fall_at_edge(inputs)[row])

    def along(self, inputs: Array, row: Array, x: Array) -> tuple[Array, Array]:
        """ln(F / (16/9 E sqrt(R) d^1.5)) and its derivative by d / h."""
        shape, row, x = x.shape, row.ravel(), np.maximum(x, 0.0).ravel()
        coordinates, thick = field_inputs(inputs), np.exp(inputs[:, 0])[row]
        cap = HEIGHT_OVER_PITCH * np.exp(inputs[:, 1])[row] / thick
        first, later = overlap(inputs[row], np.maximum(x * thick, NOTHING), FIRST, LATER)
        caps, pad = (end * cap for end in CAPS_BEGIN), (np.maximum(c * cap, h) for c, h in PAD_BEGINS)
        nowhere, everywhere, one = np.full(len(x), -1.0), np.full(len(x), np.inf), np.ones(len(x))
        begins, ends = ((nowhere, *pair, everywhere) for pair in zip(caps, pad))
        value, slope = np.zeros(len(x)), np.zeros(len(x))
        for k, (surface, (ratio, steep), unit) in enumerate(
            ((self.touched, first, cap), (self.caps, later, cap), (self.pad, later, one))
        ):
            # Between where its own share begins and the next one's is whole.
            on = np.nonzero((x > begins[k]) & (x < ends[k + 1]))[0]
            at = x[on] / unit[on]
            y, climb = surface.along(surface.at_levels(coordinates), row[on], at)
            y = y + np.log(ratio[on])
            climb = climb / (2.0 * np.sqrt(np.maximum(at, 1e-12)) * unit[on]) + steep[on] / ratio[on] * thick[on]
            part, grows = fade(x[on], begins[k][on], ends[k][on]) if k else (1.0, 0.0)
            slope[on] += part * (climb - slope[on]) + grows * (y - value[on])
            value[on] += part * (y - value[on])
        return value.reshape(shape), slope.reshape(shape)

"""What a punch and an undeformed field of caps overlap by: what forces of fields are counted against.

It holds what makes the force of a field rise in steps: rings of caps come under the punch one after another, caps at
its edge with their share, and at last the flat between them. Lengths in radii of the circle of the punch's area.
"""

from __future__ import annotations

import numpy as np

from dummydesign.geometry.limits import SMALLEST_HEIGHT_MM
from dummydesign.geometry.shapes.bumped import FOOT_OVER_PITCH, HEIGHT_OVER_FOOT
from dummydesign.geometry.standard import PUNCH_RADIUS_MM

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

    Parameters
    ----------
    inputs : ndarray, shape (..., 3)
        ln h/a, ln pitch/a and grade over height of each field.
    depth : ndarray, shape (...)
        Over the punch's radius a, above 0.
    hertz : float
        Weights of the Hertz terms, above 0.

    Returns
    -------
    list of (ndarray, ndarray), shape (...)
        For each weight: ratio, 1 at first touch, and its derivative by ``depth``.
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

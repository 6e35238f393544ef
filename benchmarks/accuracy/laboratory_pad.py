"""Force of a pad under a flat round punch by finite elements of its own; the package takes no part.

Biquadratic displacement with linear pressure in each element (condensed), an energy in the first invariant (Yeoh; with
``yeoh`` = 0 neo-Hookean), bulk modulus 2000 shear moduli, base glued. The punch is a penalty at the points of the
face, sharp at its edge; what touches sticks.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

BULK, PENALTY_PER_MM = 2000.0, 1500.0
"""Over the shear modulus."""
ROUNDS, REACH_MM = 30, 45.0
STEEPER, TORN, LEAST_STEP, SHALLOW = 1.5, 3.0, 0.004, 0.1
"""Rise of the force over that of the step before from which a step is halved, and at which it is refused however small;
the small step and the depth up to which rises are not compared, over the thickness."""


class Curve(NamedTuple):
    """Depths that were reached and force over Young's modulus there. [mm, mm2]"""

    depth_mm: NDArray
    area_mm2: NDArray


def _lagrange(s: NDArray) -> tuple[NDArray, NDArray]:
    """Quadratic shape functions and slopes at points of [-1, 1]."""
    return np.stack([s * (s - 1) / 2, 1 - s**2, s * (s + 1) / 2]), np.stack([s - 0.5, -2 * s, s + 0.5])


def crown_drop(r: NDArray, crown: tuple[float, float, float] | None) -> NDArray:
    """How far a conic top (tip radius, height, foot) has fallen at a radius. [mm]"""
    if crown is None:
        return np.zeros_like(r)
    tip, height, foot = crown
    e = (2.0 * tip * height - foot**2) / height**2
    inside = np.minimum(r, foot)
    return np.minimum(inside**2 / (tip * (1.0 + np.sqrt(np.maximum(1.0 - e * inside**2 / tip**2, 0.0)))), height)


def _grid(radius: float, foot: float, cell: float) -> NDArray:
    """Corners of elements along the radius: one at the crown's foot and one at the punch's edge, then ever wider."""
    bends = sorted({0.0, foot, radius})
    bends.append(bends[-1] + 3.0 * cell)
    inner = [np.linspace(low, high, max(round((high - low) / cell), 1) + 1)[:-1] for low, high in pairwise(bends)]
    out = [bends[-1] - cell, bends[-1]]
    while out[-1] < REACH_MM:
        out.append(out[-1] + 1.35 * (out[-1] - out[-2]))
    return np.concatenate([*inner, out[1:]])


class _Mesh:
    """Elements of one pad: shape functions at Gauss points, and those of its face."""

    def __init__(self, h: float, radius: float, crown: tuple[float, float, float] | None, cell: float) -> None:
        corners = _grid(radius, crown[2] if crown else radius, cell)
        columns, rows = len(corners) - 1, max(round(h / (1.6 * cell)), 8)
        r = np.interp(np.arange(2 * columns + 1) / 2.0, np.arange(columns + 1), corners)
        # rows thinner towards the face
        z = 1.0 - (1.0 - np.arange(2 * rows + 1) / (2.0 * rows)) ** 1.4
        top = h - crown_drop(r, crown)
        self.place = np.stack([np.repeat(r[:, None], len(z), 1), top[:, None] * z[None, :]], -1).reshape(-1, 2)
        number = np.arange(len(self.place)).reshape(len(r), len(z))
        self.cells = np.array(
            [number[2 * i : 2 * i + 3, 2 * j : 2 * j + 3].ravel() for i in range(columns) for j in range(rows)]
        )
        self.base = number[:, 0]
        self.axis = number[0]
        gauss, weight = np.polynomial.legendre.leggauss(3)
        a, b = (one.ravel() for one in np.meshgrid(gauss, gauss, indexing="ij"))
        (na, da), (nb, db) = _lagrange(a), _lagrange(b)
        shape = np.einsum("ig,jg->gij", na, nb).reshape(9, 9)
        slope = np.stack([np.einsum("ig,jg->gij", da, nb), np.einsum("ig,jg->gij", na, db)], -1).reshape(9, 9, 2)
        x = self.place[self.cells]
        jacobian = np.einsum("gnk,eni->egik", slope, x)
        self.grad = np.einsum("gnk,egki->egni", slope, np.linalg.inv(jacobian))
        self.radius = np.einsum("gn,en->eg", shape, x[..., 0])
        self.hoop = shape[None] / self.radius[..., None]
        self.weight = np.outer(weight, weight).ravel() * np.linalg.det(jacobian) * 2.0 * np.pi * self.radius
        self.pressure = np.stack([np.ones(9), a, b], -1)
        self.moment = np.einsum("eg,ga,gb->eab", self.weight, self.pressure, self.pressure) / BULK
        # slope of the deformation gradient by the 18 unknowns of an element
        slope_F = np.zeros((*self.weight.shape, 9, 2, 3, 3))
        for i in range(2):
            slope_F[..., i, i, :2] = self.grad
        slope_F[..., 0, 2, 2] = self.hoop
        self.slope = slope_F.reshape(*self.weight.shape, 18, 9)
        # the face: three nodes of each column
        self.face = np.array([number[2 * i : 2 * i + 3, -1] for i in range(columns) if corners[i + 1] < radius + 1e-9])
        points, weights = np.polynomial.legendre.leggauss(4)
        self.on, along = _lagrange(points)
        r_face = self.place[self.face, 0]
        self.face_weight = weights * (r_face @ along) * 2.0 * np.pi * (r_face @ self.on)


def _inside(mesh: _Mesh, u: NDArray, q: NDArray, yeoh: float) -> tuple[NDArray, ...]:
    """Forces and stiffness of all elements with the pressure condensed, and what gives its change; shear modulus 1."""
    v = u[mesh.cells]
    f = np.zeros((*mesh.weight.shape, 3, 3))
    f[..., :2, :2] = np.einsum("eni,egnj->egij", v, mesh.grad) + np.eye(2)
    f[..., 2, 2] = 1.0 + np.einsum("en,egn->eg", v[..., 0], mesh.hoop)
    j, back, w = np.linalg.det(f), np.linalg.inv(f).swapaxes(-1, -2), mesh.weight
    pressed = (np.einsum("ga,ea->eg", mesh.pressure, q) * j)[..., None, None]
    stiff = (1.0 + 2.0 * yeoh * (np.einsum("egij,egij->eg", f, f) - 3.0))[..., None, None]
    stress = (stiff * f - back + pressed * back).reshape(*w.shape, 9)
    flat, g = f.reshape(*w.shape, 9), back.reshape(*w.shape, 9)
    swap = np.einsum("egil,egkj->egijkl", back, back).reshape(*w.shape, 9, 9)
    tangent = stiff * np.eye(9) + 4.0 * yeoh * flat[..., :, None] * flat[..., None, :]
    tangent = tangent + swap + pressed * (g[..., :, None] * g[..., None, :] - swap)
    b = mesh.slope
    force = np.einsum("egna,ega->en", b, w[..., None] * stress, optimize=True)
    right = (w[..., None, None] * b) @ tangent
    k = right.transpose(0, 2, 1, 3).reshape(len(w), 18, -1) @ b.transpose(0, 1, 3, 2).reshape(len(w), -1, 18)
    volume = np.einsum("eg,ega,egna->egn", w * j, g, b, optimize=True)
    c = np.einsum("egn,ga->ena", volume, mesh.pressure)
    missing = np.einsum("eg,ga->ea", w * (j - 1.0), mesh.pressure) - np.einsum("eab,eb->ea", mesh.moment, q)
    give, gap = np.linalg.solve(mesh.moment, c.swapaxes(-1, -2)), np.linalg.solve(mesh.moment, missing[..., None])
    return force + (c @ gap)[..., 0], k + c @ give, give, gap[..., 0]


def press(
    h: float,
    radius: float,
    crown: tuple[float, float, float] | None,
    depths: NDArray,
    yeoh: float = 0.0,
    cell: float = 0.3,
) -> Curve:
    """Force over Young's modulus of a pad (thickness at the tip) as the punch goes down, as deep as it came."""
    mesh = _Mesh(h, radius, crown, cell)
    u, q = np.zeros_like(mesh.place), np.zeros((len(mesh.cells), 3))
    dof = (2 * mesh.cells[..., None] + [0, 1]).reshape(len(mesh.cells), 18)
    rows, columns = np.repeat(dof, 18, 1).ravel(), np.tile(dof, (1, 18)).ravel()
    fixed = np.concatenate([2 * mesh.base, 2 * mesh.base + 1, 2 * mesh.axis])
    free = np.setdiff1d(np.arange(u.size), fixed)
    shape = (len(mesh.face), 4)
    # a flat pad is glued from the start; of a crown what touches
    tied, at_r = np.full(shape, crown is None), mesh.place[mesh.face, 0] @ mesh.on
    pairs = 2 * mesh.face
    fr, fc = np.repeat(pairs, 3, 1).ravel(), np.tile(pairs, (1, 3)).ravel()
    reached, forces, before, last = [0.0], [0.0], (u, q), 1.0
    wanted, depth, step, stiffness, lifted = list(depths), 0.0, float("inf"), float("inf"), 0.0
    while wanted:
        go = min(wanted[0], depth + step)
        start, face, ahead = (u, q), h - go, (go - depth) / last if depth > 0 else 0.0
        now, push = u + (u - before[0]) * ahead, q + (q - before[1]) * ahead
        good, under = False, ((mesh.place + u)[mesh.face][..., 0] @ mesh.on) <= radius
        with np.errstate(all="ignore"):
            for _ in range(ROUNDS):
                x = (mesh.place + now)[mesh.face]
                r, z = x[..., 0] @ mesh.on, x[..., 1] @ mesh.on
                over = np.where(tied, True, (z > face) & under) * mesh.face_weight * PENALTY_PER_MM
                side = np.where(tied, mesh.face_weight * PENALTY_PER_MM, 0.0)
                lift = over * (z - face)
                force, k, give, gap = _inside(mesh, now, push, yeoh)
                if not np.isfinite(k).all():
                    break
                out = np.bincount(dof.ravel(), force.ravel(), u.size)
                out += np.bincount((pairs + 1).ravel(), (lift @ mesh.on.T).ravel(), u.size)
                out += np.bincount(pairs.ravel(), ((side * (r - at_r)) @ mesh.on.T).ravel(), u.size)
                if np.abs(out[free]).max() < 1e-6 * max(radius * h, lift.sum()):
                    good = True
                    break
                up, along = (np.einsum("cg,ig,jg->cij", one, mesh.on, mesh.on).ravel() for one in (over, side))
                matrix = coo_matrix(
                    (
                        np.concatenate([k.ravel(), up, along]),
                        (np.concatenate([rows, fr + 1, fr]), np.concatenate([columns, fc + 1, fc])),
                    ),
                    (u.size, u.size),
                ).tocsc()[free][:, free]
                change = np.zeros(u.size)
                change[free] = splu(
                    matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=0.01
                ).solve(-out[free])
                largest = np.abs(change).max()
                part, change = min(1.0, 0.2 * h / max(largest, 1e-12)), change.reshape(u.shape)
                push = push + part * (gap + np.einsum("ean,en->ea", give, change[mesh.cells].reshape(-1, 18)))
                now = now + part * change
        # on the way to another equilibrium the force jumps however small the step, at a kink of the law it does not
        rise = (float(lift.sum()) - lifted) / (go - depth)
        steep = good and depth > SHALLOW * h and rise > STEEPER * stiffness
        jumps = steep and (rise > TORN * stiffness or go - depth > LEAST_STEP * h)
        if not good or jumps:
            step = 0.5 * (go - depth)
            if step < (0.25 * LEAST_STEP if jumps else 1e-4) * h:
                break
            continue
        before, last, depth, u, q = start, go - depth, go, now, push
        stiffness, lifted = max(rise, 0.0), float(lift.sum())
        x = (mesh.place + u)[mesh.face]
        r, z = x[..., 0] @ mesh.on, x[..., 1] @ mesh.on
        new = ~tied & (z > face) & under
        # what touched within the step slid for half of it
        r_before = (mesh.place + start[0])[mesh.face][..., 0] @ mesh.on
        tied, at_r = tied | new, np.where(new, 0.5 * (r + r_before), at_r)
        if depth >= wanted[0] - 1e-12:
            wanted.pop(0)
            reached.append(depth)
            forces.append(float(lift.sum()) / 3.0)
            step = float("inf")
    return Curve(np.array(reached), np.array(forces))

"""Own integration of a pad under a measured motion for the campaign generator; shares nothing with the loop."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import expm

CURVES = Path(__file__).parent / "force_curves.json"
CROWNED_CURVES = Path(__file__).parent / "crowned_curves.json"
CROWN_RADIUS_MM = 20.0
THICKNESSES = (5.0, 10.0, 15.0, 20.0)


@lru_cache(maxsize=4)
def _curves(base: str, poisson: float) -> tuple:
    """Interpolators of F / (E d) over d / h, one per thickness, from direct finite-element solves."""
    rows = {
        r["thickness_mm"]: r
        for r in json.loads(CURVES.read_text())
        if r["base"] == base and abs(r["poisson"] - poisson) < 1e-9
    }
    out = []
    for thickness in THICKNESSES:
        depth = np.array(rows[thickness]["depth_mm"])
        stiffness = np.array(rows[thickness]["force_over_young_mm2"]) / depth
        # a pad is smooth; what a quartic leaves (0.2 %) is the scatter of the solves
        out.append(np.polynomial.Polynomial.fit(depth / thickness, np.log(stiffness), 4, domain=[0.0, 0.5]))
    return tuple(out)


def _layer_force(depth: np.ndarray, thickness: np.ndarray, base: str, poisson: float) -> np.ndarray:
    """F / E of depths (T, ...) on pads (T,): cubic in ln h between the four solved thicknesses."""
    nodes = np.log(THICKNESSES)
    at = np.log(thickness)
    flat = np.maximum(depth, 0.0).reshape(len(thickness), -1)
    share = np.minimum(flat / thickness[:, None], 0.5)
    values = np.stack([curve(share) + np.log(t) for curve, t in zip(_curves(base, poisson), THICKNESSES)])
    total = np.zeros_like(flat)
    for i, node in enumerate(nodes):
        others = np.delete(nodes, i)
        weight = np.prod((at[:, None] - others) / (node - others), axis=1)
        total += weight[:, None] * values[i]
    # values hold ln(F / (E d) * h) so that they vary little with h at equal d / h
    return (np.exp(total) / thickness[:, None] * flat).reshape(depth.shape)


@lru_cache(maxsize=4)
def _crowns(base: str, poisson: float, edge_mm: float) -> list[tuple[float, CubicSpline]]:
    """Solved thicknesses and splines of ln F / (E d^1.5) over the root of the depth, from first touch."""
    rows = [
        r
        for r in json.loads(CROWNED_CURVES.read_text())
        if r["base"] == base and abs(r["poisson"] - poisson) < 1e-9 and r.get("edge_radius_mm", 0.0) == edge_mm
    ]
    out = []
    for row in sorted(rows, key=lambda r: r["thickness_mm"]):
        depth, area = np.array(row["depth_mm"]), np.array(row["force_over_young_mm2"])
        # Hertz at first touch: E* = E / (1 - nu^2)
        first = np.log(4.0 / 3.0 * np.sqrt(CROWN_RADIUS_MM) / (1.0 - poisson**2))
        value = np.r_[first, np.log(area / depth**1.5)]
        out.append((row["thickness_mm"], CubicSpline(np.sqrt(np.r_[0.0, depth]), value)))
    return out


def _crown_force(
    depth: np.ndarray, thickness: np.ndarray, base: str, poisson: float, edge_mm: float = 0.0
) -> np.ndarray:
    """F / E of depths (T, ...) on crowned pads (T,): linear in ln h at equal depth from the nearest solved."""
    solved = _crowns(base, poisson, edge_mm)
    nodes = np.log([h for h, _ in solved])
    flat = np.maximum(depth, 0.0).reshape(len(thickness), -1)
    out = np.zeros_like(flat)
    for row, h in enumerate(thickness):
        near = int(np.argmin(np.abs(nodes - np.log(h))))
        other = near + 1 if near + 1 < len(nodes) else near - 1
        part = (np.log(h) - nodes[near]) / (nodes[other] - nodes[near])
        own, next_to = (solved[i][1](np.sqrt(np.minimum(flat[row], 0.45 * solved[i][0]))) for i in (near, other))
        out[row] = np.exp((1.0 - part) * own + part * next_to) * flat[row] ** 1.5
    return out.reshape(depth.shape)


@dataclass
class Pad:
    """Elastic law of the generator per unit modulus, with its own error per pad and the effects that change it."""

    thickness: np.ndarray
    level: np.ndarray
    slope: np.ndarray
    square_fall: float = 0.5
    slip: float = 0.0
    poisson: float = 0.5
    thickness_error: float = 0.0
    stiffening: float = 0.0
    tilt_deg: float = 0.0
    bump: float = 0.0
    crown: bool = False
    edge_mm: float = 0.0

    def table(self, points: int = 6001) -> tuple[np.ndarray, np.ndarray]:
        """Depths (points,) over thickness from -0.3 to 0.5 and F / E (T, points) there. [mm2]"""
        share = np.linspace(-0.3, 0.5, points)
        depth = share * self.thickness[:, None]
        if not self.tilt_deg:
            return share, self._flat(depth)
        lever = np.tan(np.radians(self.tilt_deg)) * np.linspace(-6.9, 6.9, 70)
        return share, sum(self._flat(depth + u) for u in lever) / len(lever)

    def force(self, depth: np.ndarray) -> np.ndarray:
        """F / E of depths (T,) on a flat punch. [mm2]"""
        return self._flat(depth[:, None])[:, 0]

    def _flat(self, depth: np.ndarray) -> np.ndarray:
        h = self.thickness + self.thickness_error
        solved = partial(_crown_force, edge_mm=self.edge_mm) if self.crown else _layer_force
        bonded = solved(depth, h, "bonded", 0.5)
        if self.poisson < 0.5:
            # parabola through the compliances at 0.5, 0.48 and 0.46
            q = (0.5 - self.poisson) / 0.02
            soft = [solved(depth, h, "bonded", nu) for nu in (0.48, 0.46)]
            give = [np.ones_like(bonded), *(np.where(bonded > 0, bonded / np.maximum(s, 1e-12), 1.0) for s in soft)]
            ratio = give[0] + q * (-1.5 * give[0] + 2 * give[1] - 0.5 * give[2])
            bonded = bonded / (ratio + q**2 * (0.5 * give[0] - give[1] + 0.5 * give[2]))
        share = np.maximum(depth, 0.0) / self.thickness[:, None]
        if self.slip:
            sliding = solved(depth, h, "sliding", 0.5)
            let_go = self.slip * (1.0 - np.exp(-share / 0.03))
            bonded = bonded + let_go * (sliding - bonded)
        square = np.interp(self.thickness, [5.0, 10.0, 15.0, 20.0], [0.002, 0.028, 0.030, 0.030])[:, None]
        square = 0.0 * square if self.crown else square
        factor = (1.0 + square * (1.0 - self.square_fall * share)) * (1.0 + self.level[:, None])
        factor = factor * (1.0 + self.slope[:, None] * share / 0.4) * np.exp(self.stiffening * share**2)
        if self.bump:
            factor = factor * (1.0 + self.bump * np.exp(-(((np.maximum(depth, 0) - 1.2) / 0.25) ** 2)))
        return bonded * factor


@dataclass
class Physics:
    """All that acts while a trial runs; arrays over trials (T,)."""

    young: np.ndarray
    tau: np.ndarray
    beta: np.ndarray
    pad: Pad
    offset: np.ndarray
    compliance: float = 0.0
    beta_strain: float = 0.0
    pull_off: float = 0.0
    friction: float = 0.0
    soft_depth: list = field(default_factory=list)
    softening: float = 0.0


def pad_force(time: np.ndarray, x: np.ndarray, away: np.ndarray, physics: Physics) -> np.ndarray:
    """March the trials side by side through time (T, K): arms by the implicit midpoint rule.

    Parameters
    ----------
    time, x : ndarray, shape (T, K)
        [s, mm]
    away : ndarray of bool, shape (T, K)
        Whether the punch is on its way back.
    """
    count, steps = x.shape
    arms = np.zeros((physics.tau.shape[0], count))
    out = np.zeros((count, steps))
    last_elastic, last_strain, force = np.zeros(count), np.zeros(count), np.zeros(count)
    turn = np.ones(count)
    top = np.maximum.accumulate(x, axis=1)
    share, law = physics.pad.table()
    rows, grain = np.arange(count), share[1] - share[0]

    def elastic_force(depth: np.ndarray) -> np.ndarray:
        at = np.clip((depth / physics.pad.thickness - share[0]) / grain, 0.0, len(share) - 1.001)
        low = at.astype(int)
        return law[rows, low] + (at - low) * (law[rows, low + 1] - law[rows, low])

    for k in range(steps):
        dt = time[:, k] - time[:, k - 1] if k else np.ones(count)
        guess = force
        for _ in range(5 if physics.compliance else 1):
            give = physics.compliance * guess / (1.0 + np.maximum(guess, 0.0) / 120.0)
            depth = x[:, k] - physics.offset - give
            elastic = physics.young * elastic_force(depth)
            if physics.softening:
                n = sum((d + 0.04 >= depth) & (d > 0) for d in physics.soft_depth)
                elastic = elastic * (1.0 - physics.softening * 1.7 * n / (n + 0.7))
            strain = np.maximum(depth, 0.0) / physics.pad.thickness
            # at the middle of the step, as the rule: at its end the arms of a thin pad are several per cent too strong
            middle = 0.5 * (strain + last_strain)
            strength = physics.beta * np.exp(physics.beta_strain * (middle - 0.15))
            half = 0.5 * dt / physics.tau
            new = (arms * (1.0 - half) + strength * (elastic - last_elastic)) / (1.0 + half)
            guess = elastic + new.sum(axis=0)
        arms, last_elastic, last_strain, force = new, elastic, strain, guess
        if physics.pull_off:
            gap = np.maximum(0.0, -x[:, k])
            floor = np.where(away[:, k], -physics.pull_off * np.exp(-gap / 0.2) * (gap < 0.8), 0.0)
            shown = np.maximum(force, floor)
        else:
            shown = np.maximum(force, 0.0)
        if physics.friction:
            goal = np.where(away[:, k], 1.0 - 2.0 * np.tanh((top[:, k] - x[:, k]) / 0.04), 1.0)
            turn = goal
            shown = shown * (1.0 + physics.friction * turn)
        out[:, k] = shown
    return out


def butterworth(time: np.ndarray, force: np.ndarray, cutoff_hz: float, lag_s: float = 0.0) -> np.ndarray:
    """Second-order low-pass of curves (T, K) in state space, exact for ramps; then two poles of lag_s / 2."""
    w = 2.0 * np.pi * cutoff_hz
    systems = [(np.array([[0.0, 1.0], [-w * w, -np.sqrt(2.0) * w]]), np.array([0.0, w * w]))]
    if lag_s > 0:
        p = 2.0 / lag_s
        systems.append((np.array([[0.0, 1.0], [-p * p, -2.0 * p]]), np.array([0.0, p * p])))
    for a, b in systems:
        force = _run(time, force, a, b)
    return force


def _run(time: np.ndarray, force: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    steps, which = np.unique(np.round(np.diff(time, axis=1), 9), return_inverse=True)
    which = which.reshape(len(time), -1)
    made = []
    for dt in steps:
        # augmented matrix: state, input, slope of the input
        big = np.zeros((4, 4))
        big[:2, :2], big[:2, 2], big[2, 3] = a, b, 1.0
        made.append(expm(big * dt)[:2])
    made = np.array(made)
    state = np.stack([force[:, 0], np.zeros(len(force)), np.zeros(len(force)), np.zeros(len(force))], axis=1)
    out = np.empty_like(force)
    out[:, 0] = force[:, 0]
    slope = np.diff(force, axis=1) / np.diff(time, axis=1)
    for k in range(time.shape[1] - 1):
        state[:, 2], state[:, 3] = force[:, k], slope[:, k]
        state[:, :2] = np.einsum("tij,tj->ti", made[which[:, k]], state)
        out[:, k + 1] = state[:, 0]
    return out

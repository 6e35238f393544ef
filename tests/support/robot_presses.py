"""Presses of robots on pads and on people by equations and an integrator of their own (scipy's Radau), for tests.

Nothing here is taken from the package but the classes of traces and parameters.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid, solve_ivp

APPROACH_MM = 1.0


@dataclass(frozen=True)
class Body:
    """A body by its force and the rates of its inner variables: force(x, q), rates(x, speed, q)."""

    arms: int
    force: object
    rates: object


def linear_body(k):
    return Body(0, lambda x, q: k * max(x, 0.0), lambda x, v, q: np.zeros(0))


def gel_pad(k=9.0, power=1.35, beta=0.5, tau=0.15):
    """A pad: F = k (x^n + beta q), q' = (x^n)' - q / tau."""

    def force(x, q):
        return k * (max(x, 0.0) ** power + beta * q[0])

    def rates(x, v, q):
        return np.array([power * max(x, 0.0) ** (power - 1.0) * v - q[0] / tau])

    return Body(1, force, rates)


def skin(gamma1, gammas, dampers):
    """A person: F = gamma1 x^3 + sum gamma x^2 e, e' = x' - gamma x^2 e / c; skin does not pull."""
    gammas, dampers = np.array(gammas), np.array(dampers)

    def force(x, q):
        x = max(x, 0.0)
        return max(gamma1 * x**3 + x**2 * float(gammas @ q), 0.0)

    def rates(x, v, q):
        return (v if x > 0 else 0.0) - gammas * max(x, 0.0) ** 2 / dampers * q

    return Body(len(gammas), force, rates)


def skin_of(parameters, velocity):
    return skin(parameters.gamma1_N_per_mm3, parameters.gamma_N_per_mm3, parameters.dampers_at(velocity))


@dataclass(frozen=True)
class Run:
    t: np.ndarray
    x: np.ndarray
    f: np.ndarray

    @property
    def peak(self):
        return self.f.max()

    @property
    def depth(self):
        return self.x.max()

    @property
    def energy(self):
        """To the largest depth: an arm that rings takes energy back and forth afterwards."""
        return cumulative_trapezoid(self.f, np.maximum(self.x, 0.0), initial=0.0)[np.argmax(self.x)]


def command(velocity, depth, hold, ramp_s=0.004):
    """A path and its speed: even speed from contact, rounded within ``ramp_s``, then a hold."""
    stop = depth / velocity

    def path(t):
        u = (t - stop) / ramp_s
        return depth + velocity * ramp_s * (-np.logaddexp(0.0, -u))

    def speed(t):
        return velocity / (1.0 + np.exp(np.clip((t - stop) / ramp_s, -500, 500)))

    start = 0.0 - path(0.0) / velocity
    return (lambda t: path(t + start * 0.0)), speed, stop + hold


def braking_command(velocity, depth, hold, braking):
    """A path and its speed: even speed from contact, one braking to the depth, then a hold."""
    lasts = velocity / braking
    stop = depth / velocity + 0.5 * lasts

    def left(t):
        return float(np.clip(stop - t, 0.0, lasts))

    def path(t):
        return depth - 0.5 * braking * left(t) ** 2 - velocity * max(stop - lasts - t, 0.0)

    return path, lambda t: braking * left(t), depth / velocity + hold


def by_path(body, path, speed, end, begin, points=60001, max_step=0.01, method="Radau"):
    """Follow a path."""
    got = solve_ivp(
        lambda t, q: body.rates(path(t), speed(t), q),
        (begin, end),
        np.zeros(body.arms),
        method,
        dense_output=True,
        rtol=1e-8,
        atol=1e-10,
        max_step=max_step,
    )
    t = grid(begin, end, points)
    q = got.sol(t) if body.arms else np.zeros((0, len(t)))
    x = np.array([path(one) for one in t])
    return Run(t, x, np.array([body.force(a, b) for a, b in zip(x, q.T)]))


def by_robot(body, path, speed, end, begin, stiffness, mass_kg, points=60001, max_step=0.01, ratio=0.0, method="Radau"):
    """A mass on a spring, and a damper beside it, whose other end follows a path."""
    mass = 1e-3 * mass_kg
    damping = 2.0 * ratio * np.sqrt(stiffness * mass)

    def slope(t, y):
        x, v, q = y[0], y[1], y[2:]
        pulled = stiffness * (path(t) - x) + (damping * (speed(t) - v) if damping else 0.0)
        return np.r_[v, (pulled - body.force(x, q)) / mass, body.rates(x, v, q)]

    got = solve_ivp(
        slope,
        (begin, end),
        np.r_[path(begin), speed(begin), np.zeros(body.arms)],
        method,
        dense_output=True,
        rtol=1e-8,
        atol=1e-10,
        max_step=max_step,
    )
    t = grid(begin, end, points)
    y = got.sol(t)
    return Run(t, y[0], np.array([body.force(one[0], one[2:]) for one in y.T]))


def by_mass(body, velocity, mass_kg, points=20001, rebound=0.0):
    """A free mass, up to its stop, and a part of that time longer."""
    mass = 1e-3 * mass_kg

    def slope(t, y):
        return np.r_[y[1], -body.force(y[0], y[2:]) / mass, body.rates(y[0], y[1], y[2:])]

    def stopped(t, y):
        return y[1]

    stopped.terminal, stopped.direction = True, -1
    got = solve_ivp(
        slope,
        (0.0, 60.0),
        np.r_[0.0, velocity, np.zeros(body.arms)],
        "Radau",
        events=stopped,
        dense_output=True,
        rtol=1e-9,
        atol=1e-11,
    )
    t = np.linspace(0.0, got.t[-1], points)
    y = got.sol(t)
    if rebound:
        end = (1.0 + rebound) * got.t[-1]
        back = solve_ivp(slope, (got.t[-1], end), y[:, -1], "Radau", dense_output=True, rtol=1e-8, atol=1e-10)
        later = np.linspace(got.t[-1], end, points // 2)[1:]
        t, y = np.r_[t, later], np.hstack([y, back.sol(later)])
    return Run(t, y[0], np.array([body.force(one[0], one[2:]) for one in y.T]))


def skin_by_force(gamma1, gammas, dampers, force, force_rate, begin, end, points=40001, max_step=0.01):
    """A person under a force over time: the depth's own equation, from F' = (dF/dx) x' + sum x^2 gamma q'."""
    gammas, dampers = np.array(gammas), np.array(dampers)
    x0 = (force(begin) / (gamma1 + gammas.sum())) ** (1.0 / 3.0)

    def slope(t, y):
        x, q = y[0], y[1:]
        loss = gammas * x**2 / dampers * q
        tangent = 3.0 * gamma1 * x**2 + 2.0 * x * (gammas @ q) + x**2 * gammas.sum()
        v = (force_rate(t) + x**2 * (gammas @ loss)) / tangent
        return np.r_[v, v - loss]

    got = solve_ivp(
        slope,
        (begin, end),
        np.r_[x0, np.full(len(gammas), x0)],
        "Radau",
        dense_output=True,
        rtol=1e-8,
        atol=1e-11,
        max_step=max_step,
    )
    t = grid(begin, end, points)
    y = got.sol(t)
    return Run(t, y[0], np.array([force(one) for one in t]))


def grid(begin, end, points):
    """Times, finer at the start."""
    early = min(begin + 1.0, end)
    return np.unique(np.r_[np.linspace(begin, early, points // 2), np.linspace(early, end, points // 2)])


def sampled(run, rate_hz=1000.0, noise_N=0.0, noise_mm=0.0, seed=0, name="press.csv", lowpass=None):
    """A trace of a run, even in time."""
    from dummydesign.measurement.trace import Trace

    t = np.arange(run.t[0], run.t[-1], 1.0 / rate_hz)
    rng = np.random.default_rng(seed)
    f = run.f if lowpass is None else lowpass.apply(run.t, run.f)
    x = np.interp(t, run.t, run.x) + noise_mm * rng.standard_normal(len(t))
    return Trace(name, t - t[0], x, np.interp(t, run.t, f) + noise_N * rng.standard_normal(len(t)))

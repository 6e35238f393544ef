"""Energy of the rise, mean pressure, and a robot of finite mass: tissue against dummy.

The form is that of ISO/TS 15066:2016, annex A: force and pressure, each quasi-static and transient.

Peak pressure is not given: under a sharp-edged glued punch the contact pressure grows without bound towards
the edge as the mesh is refined, so a value would depend on the mesh. It needs the edge radius of the real part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import out_of_range
from dummydesign.design.scoring.presses import Sampling, Slabs, press_to_depth
from dummydesign.design.scoring.targets import subjects_press
from dummydesign.measurement.motion import work_mJ

if TYPE_CHECKING:
    from dummydesign.tissue.model.parameters import Parameters
    from dummydesign.tissue.model.ranges import ForceRange

QUASI_STATIC_AFTER_S = 0.5
"""ISO/TS 15066: contact below 0.5 s is transient, what lasts longer quasi-static (second-hand, docs/references.md)."""
STEPS, LONGEST_MM = 1000, 40.0


@dataclass(frozen=True)
class Contact:
    """What one contact does; arrays over bodies (subjects, or pads).

    ``energy_mJ`` is the integral of F dx from touch to stop, ``peak_force_N`` the largest force,
    ``held_force_N`` the largest force later than 0.5 s after touch (NaN when it is not followed that long),
    ``depth_mm`` the depth at the stop. NaN where the body's law ends before the stop.
    """

    depth_mm: NDArray
    energy_mJ: NDArray
    peak_force_N: NDArray
    held_force_N: NDArray
    stop_s: NDArray

    def to_dict(self) -> dict[str, Any]:
        """Return all arrays as lists, None where there is no number."""
        return {key: [v if v == v else None for v in value.tolist()] for key, value in asdict(self).items()}


def _of_press(time_s: NDArray, displacement_mm: NDArray, force_N: NDArray, stop_s: NDArray) -> Contact:
    """Contact of presses (bodies, n); nothing moves after the stop, so all samples may be summed."""
    energy = work_mJ(displacement_mm, force_N)
    late = np.where(time_s >= QUASI_STATIC_AFTER_S, force_N, -np.inf).max(axis=-1)
    late = np.where(np.isfinite(late), late, np.nan)
    return Contact(displacement_mm[:, -1], energy, force_N.max(axis=-1), late, stop_s)


def pad_press(slabs: Slabs, depth_mm: NDArray, velocity_mm_s: float, sampling: Sampling | None = None) -> Contact:
    """Ramp and hold on pads, each to its own depth (NaN for out of reach); see :class:`Contact`.

    Parameters
    ----------
    slabs : Slabs
        D designs.
    depth_mm : ndarray, shape (D,)
        Depth of each; NaN for out of reach. [mm]
    velocity_mm_s : float
        Speed of the ramp. [mm/s]
    sampling : Sampling, optional
        Hold and braking; those of the measurements by default.

    Returns
    -------
    Contact
        Arrays of shape (D,), NaN where out of reach.
    """
    sampling = sampling or Sampling()
    press = press_to_depth(slabs, depth_mm, velocity_mm_s, sampling)
    reached = np.isfinite(depth_mm)
    motion = sampling.motion(velocity_mm_s, np.where(reached, depth_mm, 1.0))
    found = _of_press(press.time_s, motion.displacement_mm, press.force_N, press.stop_s)
    return Contact(*(np.where(reached, value, np.nan) for value in found.__dict__.values()))


def tissue_press(band: ForceRange, law: str = "ode", sampling: Sampling | None = None) -> Contact:
    """Ramp and hold on the subjects of a force range, each to its own depth; see :class:`Contact`.

    Parameters
    ----------
    band : ForceRange
        From :func:`dummydesign.tissue.model.ranges.force_range` with the hold and braking of ``sampling``.
    law : str
        Law of the subjects. For one that knows an ideal ramp only the energy is that of the ideal
        ramp. A subject that is still moving when the range ends has NaN.
    sampling : Sampling, optional
        Hold and braking; those of the measurements by default.
    """
    found = _of_press(*subjects_press(band, law, sampling or Sampling()), band.stop_s)
    followed = band.stop_s <= band.time_s[-1]
    return Contact(*(np.where(followed, value, np.nan) for value in found.__dict__.values()))


@dataclass(frozen=True)
class Body:
    """Bodies of one kind with relaxing arms, for a mass that runs into them.

    Each arm obeys q' = gain(x) x' - decay(x) q.

    Attributes
    ----------
    count, arms : int
        Bodies, and arms of each.
    force : callable
        (x (count,), q (count, arms)) -> force (count,), NaN beyond the law. [N]
    rates : callable
        x (count,) -> gain and decay [1/s], each (count, arms).
    """

    count: int
    arms: int
    force: Callable[[NDArray, NDArray], NDArray]
    rates: Callable[[NDArray], tuple[NDArray, NDArray]]


def pad_body(slabs: Slabs) -> Body:
    """Pads: elastic curve with Prony arms, q' = A'(x) x' - q / tau, F = E (A(x) + sum beta q)."""
    tau = np.array(slabs.tau_s)

    def force(x: NDArray, q: NDArray) -> NDArray:
        inside = np.where(x <= slabs.curves.limit_mm[slabs.slab], x, np.nan)
        area = slabs.curves.area_at(slabs.slab, inside[:, None])[:, 0]
        return slabs.young_MPa * (area + (slabs.beta * q).sum(axis=-1))

    def rates(x: NDArray) -> tuple[NDArray, NDArray]:
        slope = slabs.curves.slope_at(slabs.slab, x[:, None])
        return np.broadcast_to(slope, (len(x), len(tau))), np.broadcast_to(1.0 / tau, (len(x), len(tau)))

    return Body(len(slabs.slab), len(tau), force, rates)


def tissue_body(subjects: Sequence[Parameters], velocity_mm_s: float) -> Body:
    """Subjects by the arms of their law, q' = gain x' - decay q, and F = gamma1 x^3 + sum gamma x^2 q.

    Raises
    ------
    InputError
        For a law that knows ideal ramps only.
    """
    from dummydesign.tissue.model.laws import law_named
    from dummydesign.tissue.model.subjects_law import stack

    law, gamma1, gamma, dampers = stack(tuple(subjects), velocity_mm_s)
    form = law_named(law)
    form.stretch_rates(np.zeros(len(gamma1)), gamma / dampers)  # says at once if the law does not

    def force(x: NDArray, q: NDArray) -> NDArray:
        return gamma1 * x**form.power + (gamma * q).sum(axis=-1) * x**2

    def rates(x: NDArray) -> tuple[NDArray, NDArray]:
        return form.stretch_rates(x, gamma / dampers)

    return Body(len(gamma1), gamma.shape[-1], force, rates)


def impact(body: Body, mass_kg: float, velocity_mm_s: float, longest_mm: float = LONGEST_MM) -> Contact:
    """A free mass runs into bodies that rest on a rigid support, until it stops.

    m x'' = -F, x(0) = 0, x'(0) = v, by the midpoint rule with the arms' decay integrated exactly, so that a
    fast arm needs no short step; about 1000 steps to the stop. The energy of the rise is that of the mass,
    m v^2 / 2, whatever the body; force and depth distinguish bodies.

    Parameters
    ----------
    body : Body
    mass_kg : float
        Effective mass of the robot, above 0. [kg]
    velocity_mm_s : float
        Speed at touch, above 0. [mm/s]
    longest_mm : float
        No stop within this depth counts as none. [mm]

    References
    ----------
    ISO/TS 15066:2016, annex A (effective mass of the robot); here the body does not give way.
    """
    for name, value in (("mass_kg", mass_kg), ("velocity_mm_s", velocity_mm_s)):
        if not (np.isfinite(value) and value > 0):
            raise out_of_range(name, value, "above 0", "any finite value")
    guess = stop = _elastic_stop_s(body, 1e-3 * mass_kg, velocity_mm_s, longest_mm)
    for _ in range(8):
        found = _run(body, 1e-3 * mass_kg, velocity_mm_s, stop / STEPS, longest_mm)
        # a mass that does not stop is followed at the pace of the elastic guess once more
        new = np.where(np.isfinite(found.stop_s), found.stop_s, guess)
        if np.all(np.abs(new / stop - 1.0) < 0.5):
            break
        stop = new
    return found


def _elastic_stop_s(body: Body, mass: float, velocity: float, longest: float) -> NDArray:
    """About when a mass stops if nothing relaxes: twice the way that takes its energy, at full speed. [s]"""
    depth = longest * np.geomspace(1e-7, 1.0, 240)
    rest = np.zeros((body.count, body.arms))
    force = np.stack([body.force(np.full(body.count, x), rest) for x in depth])
    taken = np.cumsum(np.diff(depth, prepend=0.0)[:, None] * force, axis=0)
    enough = ~(taken < 0.5 * mass * velocity**2)  # NaN, beyond the law, ends the way as well
    return 2.0 * np.where(enough.any(axis=0), depth[np.argmax(enough, axis=0)], longest) / velocity


def _run(body: Body, mass: float, velocity: float, step: NDArray, longest: float) -> Contact:
    """Run until every mass has stopped; the stop itself is where the speed passes zero within a step."""
    x, v, q = np.zeros(body.count), np.full(body.count, velocity), np.zeros((body.count, body.arms))
    time, peak, energy = np.zeros(body.count), np.zeros(body.count), np.zeros(body.count)
    depth, stop = np.full(body.count, np.nan), np.full(body.count, np.nan)

    def carried(q: NDArray, at: NDArray, speed: NDArray, h: NDArray) -> NDArray:
        gain, decay = body.rates(at)
        lost = decay * h[:, None]
        mean = np.where(lost > 1e-9, -np.expm1(-lost) / np.maximum(lost, 1e-9), 1.0)
        return q * np.exp(-lost) + gain * (speed * h)[:, None] * mean

    with np.errstate(invalid="ignore", over="ignore"):
        for _ in range(3 * STEPS):
            going = np.isnan(stop) & np.isfinite(v) & (x < longest)
            if not going.any():
                break
            half = x + 0.5 * step * v
            force = body.force(half, carried(q, x, v, 0.5 * step))
            new_v = v - step * force / mass
            share = np.where(new_v <= 0.0, v / np.maximum(v - new_v, 1e-300), 1.0)
            mean_v = 0.5 * (v + np.maximum(new_v, 0.0))
            new_x = x + share * step * mean_v
            q = np.where(going[:, None], carried(q, half, mean_v, share * step), q)
            halted = going & (new_v <= 0.0)
            depth, stop = np.where(halted, new_x, depth), np.where(halted, time + share * step, stop)
            energy = np.where(going, energy + force * (new_x - x), energy)
            peak = np.where(going, np.fmax(peak, np.fmax(force, body.force(new_x, q))), peak)
            x, v, time = np.where(going, new_x, x), np.where(going, new_v, v), np.where(going, time + step, time)
    known = np.isfinite(stop)
    none = np.full(body.count, np.nan)
    return Contact(depth, np.where(known, energy, np.nan), np.where(known, peak, np.nan), none, stop)

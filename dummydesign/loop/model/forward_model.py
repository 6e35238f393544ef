"""The forward model: motion, pad, relaxation, sensor; effects act at their hook."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Arm, Effect, SetupLaw, UnitForce, Values, wrap

SMOOTH_TERMS = 3  # level, slope and curvature in depth over thickness
WAVES, WAVES_END, WAVES_POWER = 32, 0.6, 2.0 / 3.0
"""Number of the hat functions whose heights are the waves of a law error, depth over thickness of the last one, and the
power of depth in which they are even: contact that grows cell by cell leaves the shorter waves the smaller it is."""
LAW_TERMS = SMOOTH_TERMS + WAVES
REFERENCE_DEPTH = 0.4
"""Depth over thickness at which the slope of a law error is counted."""


def base_names(arms: int) -> list[str]:
    """Names of the parameters of a base with so many arms: young_kPa, tau_1_s, beta_1, ..."""
    return ["young_kPa", *(name for at in range(1, arms + 1) for name in (f"tau_{at}_s", f"beta_{at}"))]


def parameter_names(arms: int, effects: Sequence[Effect]) -> list[str]:
    """Names of the parameters of base and effects in a posterior: ``log`` where that is kept; modulus in kPa."""
    own = [f"{'log ' if p.log else ''}{effect.name}.{p.name}" for effect in effects for p in effect.parameters]
    return [*(f"log {name}" for name in base_names(arms)), *own]


@dataclass(frozen=True)
class BaseParameters:
    """Long-term modulus [MPa] and relaxing arms (tau [s], beta relative to the long-term modulus), fast arm first."""

    young_MPa: float
    tau_s: tuple[float, ...]
    beta: tuple[float, ...]

    @classmethod
    def from_logs(cls, logs: NDArray) -> BaseParameters:
        """Build from the logarithms in the order of :func:`base_names` (modulus in MPa)."""
        young, *arms = np.exp(logs).tolist()
        return cls(young, tuple(arms[::2]), tuple(arms[1::2]))

    def to_logs(self) -> NDArray:
        """Return the logarithms in the order of :func:`base_names` (modulus in MPa)."""
        return np.log([self.young_MPa, *(value for arm in zip(self.tau_s, self.beta) for value in arm)])

    def to_dict(self) -> dict[str, Any]:
        """Return named values, modulus in kPa."""
        _, *arms = np.exp(self.to_logs()).tolist()
        return dict(zip(base_names(len(self.tau_s)), (1e3 * self.young_MPa, *arms)))


def relax(time_s: NDArray, elastic_N: NDArray, arms: Sequence[Arm]) -> NDArray:
    """Quasi-linear force of elastic forces, piecewise linear in time, with arms that may differ by trial.

    The same law as :func:`dummydesign.pad.material.relaxation.relaxed_force`, with an optional weight on what
    each arm is loaded with.
    """
    return loaded(elastic_N, arms, arm_forces(time_s, elastic_N[None], arms)[:, 0])


def arm_forces(time_s: NDArray, elastic_N: NDArray, arms: Sequence[Arm]) -> NDArray:
    """Force that each arm holds of several elastic forces, per unit strength, shape (arms, K, T, N). [N]"""
    step, rise = np.diff(time_s, axis=1), np.diff(elastic_N, axis=-1)
    times = [np.asarray(arm.tau_s) for arm in arms]
    times = [tau[:, 1:] if tau.ndim == 2 and tau.shape[1] > 1 else tau for tau in times]
    ratio = np.stack([np.broadcast_to(step / tau, step.shape) for tau in times])[:, None]
    lost = -np.expm1(-ratio)
    middle = [1.0 if arm.weight is None else 0.5 * (arm.weight[:, 1:] + arm.weight[:, :-1]) for arm in arms]
    fed = np.stack([rise * weight for weight in middle])
    first = np.stack([elastic_N[..., 0] * (1.0 if arm.weight is None else arm.weight[:, 0]) for arm in arms])
    state = linear_recurrence(1.0 - lost, fed * (lost / ratio), first)
    return np.concatenate([first[..., None], state], axis=-1)


def loaded(elastic_N: NDArray, arms: Sequence[Arm], held_N: NDArray) -> NDArray:
    """Elastic force (T, N) and what the arms add to it. [N]"""
    force = elastic_N.copy()
    for arm, held in zip(arms, held_N):
        force += arm.beta * held
    return force


FEEDBACK_TOLERANCE_MM = 3e-7
FEEDBACK_STEPS = 15


@dataclass(frozen=True)
class Active:
    """An effect with its parameter values."""

    effect: Effect
    values: Values

    @property
    def absent(self) -> bool:
        """Whether the size is at its null value."""
        size = self.effect.parameters[0]
        return self.values[size.name] == size.null


@dataclass(frozen=True)
class LawError:
    """Relative error of the force law per trial: level, slope and curvature at d/h = 0.4, and its waves, (terms, T)."""

    terms: NDArray
    reach: float = np.inf
    """Depth over thickness to which the error was seen; deeper it is held."""

    def factor(self, share: NDArray) -> NDArray:
        """:meth:`smooth` times :meth:`waved`, of relative depths (T, N)."""
        return self.smooth(share) * self.waved(share)

    def smooth(self, share: NDArray) -> NDArray:
        """1 + level + slope s + curve s^2, s = (d/h) / 0.4, of relative depths (T, N)."""
        s, (level, slope, curve) = np.minimum(share, self.reach) / REFERENCE_DEPTH, self.terms[:SMOOTH_TERMS, :, None]
        return 1.0 + level + s * (slope + s * curve)

    def waved(self, share: NDArray) -> NDArray:
        """1 + waves of relative depths (T, N): a factor of its own, so that no level makes waves cheaper."""
        waves = self.terms[SMOOTH_TERMS:].T
        if not waves.any():
            return np.ones_like(share)
        at = wave_number(np.minimum(share, self.reach))
        heights, left = np.concatenate([np.zeros((len(waves), 1)), waves], axis=1), np.nan_to_num(at).astype(int)
        place, rises = left + heights.shape[1] * np.arange(len(heights))[:, None], np.diff(heights, append=0.0)
        return 1.0 + (rises.take(place) * (at - left) + heights.take(place))


def wave_number(share: NDArray) -> NDArray:
    """Relative depths counted in knots of the waves, whose heights are linear between knots."""
    return WAVES * np.clip(share / WAVES_END, 0.0, 1.0) ** WAVES_POWER


def simulate(
    presses: Presses, law: SetupLaw, base: BaseParameters, active: Sequence[Active] = (), error: LawError | None = None
) -> NDArray:
    """Force before the declared sensor filter at the nodes.

    depth = displacement (- effects); F_inf = E law(depth) (x effects);
    F = F_inf + sum beta_i integral exp(-(t - s) / tau_i) dF_inf(s), not below zero; then the sensor.
    """
    return simulate_yielding(presses, law, base, active, error)[0]


def simulate_yielding(
    presses: Presses,
    law: SetupLaw,
    base: BaseParameters,
    active: Sequence[Active],
    error: LawError | None,
    offset_mm: NDArray | float = 0.0,
    near_mm: NDArray | None = None,
) -> tuple[NDArray, NDArray]:
    """Return the force of :func:`simulate` for a surface deeper by an offset, and how much the set-up gives way under
    it, both (T, N); ``near_mm`` is a guess of that. [N, mm]
    """
    acting = [one for one in active if not one.absent]
    thickness = presses.thickness_mm[:, None]
    unit, start = before_the_pad(presses, law, acting, offset_mm)
    loops = [one for one in acting if one.effect.feeds_back]

    def pressed(depth: NDArray) -> NDArray:
        elastic = base.young_MPa * unit(depth, thickness)
        if error is not None:
            elastic = elastic * error.factor(np.maximum(depth, 0.0) / thickness)
        for one in acting:
            elastic = elastic * one.effect.scale(presses, depth, one.values)
        force = relax(presses.time_s, elastic, arms_of(presses, base, acting, depth))
        return at_the_surface(presses, force, acting, depth)

    def yielded(force: NDArray) -> NDArray:
        return start - sum(one.effect.yielding(presses, force, one.values) for one in loops)

    if loops:
        depth, force = _balance(pressed, yielded, start if near_mm is None else start - near_mm)
    else:
        depth, force = start, pressed(start)
    return sensor_signal(presses, force, acting), start - depth


def before_the_pad(
    presses: Presses, law: SetupLaw, acting: Sequence[Active], offset_mm: NDArray | float = 0.0
) -> tuple[UnitForce, NDArray]:
    """Return the law with all that effects change of it, and the depth (T, N) before the set-up gives way. [mm]"""
    unit: UnitForce = presses.remembered(law)
    for one in acting:
        unit = one.effect.law(unit, one.values)
    plain, own = unit, presses.young_factor
    if own is not None:
        unit = wrap(plain, lambda *at: own[:, None] * plain(*at))
    start = presses.displacement_mm - np.broadcast_to(offset_mm, presses.thickness_mm.shape)[:, None]
    for one in acting:
        start = one.effect.depth(presses, start, one.values)
    return unit, start


def sensor_signal(presses: Presses, force_N: NDArray, acting: Sequence[Active]) -> NDArray:
    """The signal that a force on the punch (T, N) gives. [N]"""
    for one in acting:
        force_N = one.effect.sensor(presses, force_N, one.values)
    return force_N


def readings(presses: Presses, force_N: NDArray, acting: Sequence[Active]) -> NDArray:
    """What is read of a filtered force of any shape. [N]"""
    for one in acting:
        force_N = one.effect.reading(presses, force_N, one.values)
    return force_N


def _balance(pressed: Callable, yielded: Callable, depth: NDArray) -> tuple[NDArray, NDArray]:
    """Depth that agrees with the yielding under its force, and that force: fixed point, a secant jump per node after
    two steps."""
    for _ in range(FEEDBACK_STEPS):
        force = pressed(depth)
        first = yielded(force)
        change = first - depth
        if float(np.max(np.abs(change))) < FEEDBACK_TOLERANCE_MM:
            return depth, force
        second = yielded(pressed(first))
        again = second - first
        rate = np.clip(np.divide(again, change, out=np.zeros_like(change), where=np.abs(change) > 1e-9), -0.9, 0.5)
        depth = first + again / (1.0 - rate)
    return depth, pressed(depth)


def arms_of(presses: Presses, base: BaseParameters, acting: Sequence[Active], depth_mm: NDArray) -> tuple[Arm, ...]:
    """The relaxing arms of the base with all that effects change of them."""
    arms = tuple(Arm(tau, beta) for tau, beta in zip(base.tau_s, base.beta))
    for one in acting:
        arms = one.effect.arms(presses, arms, depth_mm, one.values)
    return arms


def at_the_surface(presses: Presses, force_N: NDArray, acting: Sequence[Active], depth_mm: NDArray) -> NDArray:
    """Force on the punch (T, N): the contact cannot pull, but for what effects change of it. [N]"""
    floor = np.zeros((1, 1))
    for one in acting:
        floor = one.effect.floor(presses, floor, one.values)
    force_N = np.maximum(force_N, floor)
    for one in acting:
        force_N = one.effect.surface(presses, depth_mm, force_N, one.values)
    return force_N


@dataclass(frozen=True)
class PadState:
    """What a pad does at a model: its depth, that over the thickness, the elastic force with the error of its law and
    with the waves of that alone (T, N), and its arms. [mm, 1, N, N]"""

    acting: Sequence[Active]
    depth: NDArray
    share: NDArray
    elastic: NDArray
    waved: NDArray
    arms: Sequence[Arm]


def pad_state(
    presses: Presses,
    law: SetupLaw,
    base: BaseParameters,
    active: Sequence[Active],
    error: LawError,
    yielded_mm: NDArray | float = 0.0,
) -> PadState:
    """The state where the set-up gives way so much."""
    acting = [one for one in active if not one.absent]
    own, start = before_the_pad(presses, law, acting)
    depth, thickness = start - yielded_mm, presses.thickness_mm[:, None]
    unit = own(depth, thickness)
    for one in acting:
        unit = unit * one.effect.scale(presses, depth, one.values)
    share = np.maximum(depth, 0.0) / thickness
    waved = base.young_MPa * unit * error.waved(share)
    return PadState(acting, depth, share, waved * error.smooth(share), waved, arms_of(presses, base, acting, depth))


def base_and_law_columns(presses: Presses, pad: PadState, logs: NDArray, step: float) -> tuple[NDArray, NDArray]:
    """Forward differences with respect to the base logarithms, and to the smooth law error of each trial's pad."""
    powers = [pad.waved * (pad.share / REFERENCE_DEPTH) ** power for power in range(SMOOTH_TERMS)]
    each = np.stack([pad.elastic, *powers])
    held = arm_forces(presses.time_s, each, pad.arms)
    force, *shapes = loaded(each, pad.arms, held)
    moved = [force, force * np.exp(step), *(force + step * one for one in shapes)]
    for index in range(1, len(logs)):
        other = logs.copy()
        other[index] += step
        changed = arms_of(presses, BaseParameters.from_logs(other), pad.acting, pad.depth)
        moved.append(_with_arms(presses, pad.elastic, pad.arms, held[:, 0], changed))
    shown = [sensor_signal(presses, at_the_surface(presses, one, pad.acting, pad.depth), pad.acting) for one in moved]
    bins = readings(presses, presses.operator @ np.stack(shown, axis=-1), pad.acting)
    change = (bins[..., 1:] - bins[..., :1]) / step
    after = 1 + SMOOTH_TERMS
    return np.concatenate([change[..., :1], change[..., after:]], axis=-1), change[..., 1:after]


def wave_columns(presses: Presses, pad: PadState) -> NDArray:
    """Change of the bins with each wave of the law of a trial's pad (T, B, waves), relaxation stepped from bin to bin.
    [N]"""
    at = wave_number(pad.share)
    left, nodes = at.astype(int), np.arange(at.size).reshape(at.shape)
    hats = np.zeros((*at.shape, int(left.max()) + 2))
    for knot in (left, left + 1):
        hats.put(nodes * hats.shape[-1] + knot, pad.elastic * (1.0 - np.abs(at - knot)))
    hats[..., 0] = pad.elastic
    if pad.acting:
        none = sensor_signal(presses, np.zeros_like(pad.elastic), pad.acting)
        for hat in np.moveaxis(hats, -1, 0):
            hat[...] = sensor_signal(presses, hat, pad.acting) - none
    bins, each = presses.bins, np.moveaxis((presses.operator @ hats)[..., : WAVES + 1], -1, 0)
    middle = np.maximum.accumulate(np.where(bins.used, 0.5 * (bins.start + bins.end), 0.0), axis=1)
    middle += 1e-6 * np.arange(middle.shape[1])  # the padding too goes on
    arms = [_at_bins(presses, arm) for arm in pad.arms]
    forces = loaded(each, arms, arm_forces(middle, each, arms))
    out = np.zeros((*forces.shape[1:], WAVES))
    out[..., : len(forces) - 1] = np.moveaxis(forces[1:] * (forces[0] > 0.0), 0, -1)
    return out


def _at_bins(presses: Presses, arm: Arm) -> Arm:
    """An arm whose time and weight, where they change along the nodes, are those of the bins."""
    own = {name: getattr(arm, name) for name in ("tau_s", "beta", "weight")}
    along = {name: value for name, value in own.items() if np.shape(value) == presses.time_s.shape}
    return arm.changed(**{name: np.where(presses.used, presses.measure(value), 1.0) for name, value in along.items()})


def _with_arms(
    presses: Presses, elastic_N: NDArray, arms: Sequence[Arm], held_N: NDArray, changed: Sequence[Arm]
) -> NDArray:
    """Force (T, N) with changed arms; those with an old time and weight keep their known forces (arms, T, N). [N]"""
    known = []
    for number, arm in enumerate(changed):
        old = arms[number] if number < len(arms) else None
        if old and all(np.array_equal(getattr(old, name), getattr(arm, name)) for name in ("tau_s", "weight")):
            known.append(held_N[number])
        else:
            known.append(arm_forces(presses.time_s, elastic_N[None], [arm])[0, 0])
    return loaded(elastic_N, changed, np.stack(known))

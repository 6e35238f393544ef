"""What a planned campaign will be able to see: effects that stay in the noise, and effects that look alike.

Every press is predicted with usual relaxation, and with each effect of the vocabulary at its usual size. What the base
model and the error of its force law could absorb is taken out of the change; the length of the rest, in standard
deviations of the noise, says whether the effect is seen, the angle between two of them whether they are told apart.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.threads import one_blas_thread
from dummydesign.inference.noise import Noise
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.effects import known_effects
from dummydesign.loop.fitting.fit import Fit, Problem, start_vector
from dummydesign.loop.fitting.noise import Sizes, Whitener
from dummydesign.loop.fitting.screening import Projection, project, starts_of
from dummydesign.loop.model.base_law import SlabLaw
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.effect import Effect
from dummydesign.measurement.campaign import Campaign, Trial
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.measurement.planning.plan import Planned
from dummydesign.measurement.trace import Trace

NOISE = Noise(0.03, 0.02, 1.0, 0.02)
"""White and slow noise of the force, its time, scatter of the contact: those of the blind study. [N, N, s, mm]"""
SEEN = 6.0
"""Standard deviations from which an effect of its usual size is called visible: evidence of about 36."""
ALIKE = 0.95
"""Cosine between two effects from which they are called alike."""
BACK_MM_S = 10.0


@dataclass(frozen=True)
class PlanPower:
    """Effects that are visible, hidden or not testable, and pairs that look alike.

    ``seen`` and ``hidden`` give the standard deviations at usual size, ``alike`` the cosines.
    """

    seen: dict[str, float]
    hidden: dict[str, float]
    untested: dict[str, str]
    alike: tuple[tuple[str, str, float], ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "seen": self.seen, "hidden": self.hidden, "untested": self.untested,
            "alike": [{"effects": [a, b], "cosine": cosine} for a, b, cosine in self.alike],
        }  # fmt: skip


@one_blas_thread()
def plan_power(plan: tuple[Planned, ...], campaign: Campaign, young_MPa: float, seed: int = 1) -> PlanPower:
    """Work out what a plan can see.

    Parameters
    ----------
    plan : tuple of Planned
        The presses, in their order.
    campaign : Campaign
        Its pad, punch and sensor; without trials.
    young_MPa : float
        Nominal modulus. [MPa]
    seed : int
        Of the temperatures, 20 to 27 degrees, that stand for those that will be written down.

    Raises
    ------
    InputError
        When the set-up has no fast force law.
    """
    law = law_of(campaign)
    trials = planned_trials(plan, law, young_MPa, np.random.default_rng(seed))
    presses = make_presses(replace(campaign, trials=trials))
    problem = Problem(presses, law)
    vector = start_vector(problem, young_MPa)
    forces = problem.predict(vector)
    usual = Sizes(NOISE, *(prior[0] for prior in law.error_priors))
    found = Fit(
        problem, vector, usual, np.zeros_like(forces), np.where(presses.used, problem.slope(vector, forces), 0.0),
        forces, problem.jacobian(vector, forces), np.zeros((len(vector),) * 2), 0.0, 0.0,
    )  # fmt: skip
    sizes: dict[str, float] = {}
    units: dict[str, NDArray] = {}
    untested: dict[str, str] = {}
    projection, whiten = project(found)
    for effect in known_effects():
        reason = effect.unavailable(presses, law)
        if reason:
            untested[effect.name] = reason
            continue
        change = _change(effect, found, projection, whiten)
        length = float(np.linalg.norm(change))
        sizes[effect.name] = length
        if length > 0:
            units[effect.name] = change / length
    seen = {name: size for name, size in sizes.items() if size >= SEEN}
    names = [name for name in seen if name in units]
    alike = tuple(
        (a, b, cosine)
        for place, a in enumerate(names)
        for b in names[place + 1 :]
        if (cosine := abs(float(units[a] @ units[b]))) >= ALIKE
    )
    hidden = {name: size for name, size in sizes.items() if size < SEEN}
    return PlanPower(seen, hidden, untested, alike)


def _change(effect: Effect, found: Fit, projection: Projection, whiten: Whitener) -> NDArray:
    """What an effect of usual size adds beyond base and law error, whitened."""
    problem = Problem(found.problem.presses, found.problem.law, (effect,))
    vector = np.insert(found.vector, found.problem.fixed, starts_of(effect)[0])
    change = np.where(problem.presses.used, problem.predict(vector) - found.forces, 0.0)
    return projection.remove(np.r_[whiten(change).ravel(), np.zeros(projection.rows)])


def planned_trials(
    plan: tuple[Planned, ...], law: SlabLaw, young_MPa: float, draw: np.random.Generator
) -> tuple[Trial, ...]:
    """Trials of a plan with the motion that is to be made and no force.

    Parameters
    ----------
    plan : tuple of Planned
        The presses, in their order.
    law : SlabLaw
        Elastic force per unit modulus, by which a target force becomes a depth.
    young_MPa : float
        Nominal modulus. [MPa]
    draw : numpy.random.Generator
        Of the temperatures.

    Returns
    -------
    tuple of Trial
    """
    trials = []
    for row in plan:
        depth = row.target if row.by_depth else depth_for(law, row.thickness_mm, row.target / young_MPa)
        press = ramp_and_hold(row.velocity_mm_s, depth, row.hold_s)
        stop = float(press.time_s[-1]) - row.hold_s
        lead = min(0.1, 20.0 / row.velocity_mm_s)
        fine = np.arange(-lead, stop + 0.4, max(1e-3, stop / 500.0))
        hold = np.arange(fine[-1] + 0.02, stop + row.hold_s, 0.02)
        end = float(hold[-1]) if len(hold) else float(fine[-1])
        away = np.arange(end + 4e-3, end + (depth + 2.0) / BACK_MM_S, 4e-3) if row.unload else np.zeros(0)
        time = np.r_[fine, hold, away]
        x = np.interp(time, press.time_s, press.displacement_mm)
        x = np.where(time < 0, row.velocity_mm_s * time, x)
        x = np.where(time > end, depth - BACK_MM_S * (time - end), x)
        trace = Trace(row.file, time, x, np.zeros_like(time))
        trials.append(
            Trial(row.file, row.thickness_mm, row.velocity_mm_s, row.hold_s, None if row.by_depth else row.target,
                  row.repeat, row.sequence, row.rest_s, float(draw.uniform(20.0, 27.0)), row.age_days, trace)
        )  # fmt: skip
    return tuple(trials)


def depth_for(law: SlabLaw, thickness_mm: float, force_over_young_mm2: float) -> float:
    """Depth at which a pad carries a force, at most what the force law knows. [mm]

    Parameters
    ----------
    law : SlabLaw
        Elastic force per unit modulus.
    thickness_mm : float
        Of the pad. [mm]
    force_over_young_mm2 : float
        The force over the modulus. [mm2]
    """
    deepest = float(np.min(law.limit(np.array([thickness_mm]))))
    depths = np.linspace(0.0, 0.98 * deepest, 200)
    force = law(depths[None, :], np.array([[thickness_mm]]))[0]
    return float(np.interp(force_over_young_mm2, force, depths))

"""What pucks tell apart in the scatter of their specimens; on one shape a force that follows depth has many causes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.candidates import EffectCandidate, Screened, first_fit, project, screen
from dummydesign.loop.fitting.fit import CampaignFit, fit
from dummydesign.loop.fitting.noise import NoiseSizes, contrasts
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.forward_model import LAW_TERMS
from dummydesign.loop.selection.residuals import hats
from dummydesign.loop.selection.verdict import EACH_PARAMETER, GAIN_FLOOR, IMITATED, at_bound

ONE_SHAPE = 1.1
"""Largest over smallest height up to which pucks are of one shape."""
FACES_MM = 0.05
"""Scatter of the contact of cast pucks, whose faces are not quite parallel. [mm]"""
LAW_SHARE, CORRELATED = 0.004, 0.05
"""Error of a force law over the largest force, and the share of a press over which it stays the same."""
KNOTS = 9
"""Knots of a free function of depth."""
FAMILY = 0.9
"""Share of an effect's signature that a function of depth must make for it to be in doubt."""
SOME = 0.5
"""Share of what a function of depth explains that an effect must explain. Laws are conventions: of drawn materials
that only stiffen plate friction explains up to 0.87, of drawn friction strain stiffening 0.57 to 0.75."""
EXCLUDED = 10.0
"""Evidence by which an explanation of pucks of several shapes must be behind the best to be excluded, or the share
``IMITATED`` of all evidence where that is more."""
ENOUGH = 1.0
"""Squares a bin, in units of the noise, up to which a function of depth leaves nothing."""


@dataclass(frozen=True)
class Explanation:
    """A model with one effect or two, and its evidence against the base."""

    effects: tuple[EffectCandidate, ...]
    fit: CampaignFit
    gain: float

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its effects."""
        return tuple(one.effect.name for one in self.effects)


@dataclass(frozen=True)
class Among:
    """What explains pucks in the scatter of their specimens, the best first; nothing where they show nothing beyond it.

    ``base`` is the model without effects, in the noise in which all are compared; ``differ_N`` is what presses of one
    condition differ by.
    """

    base: CampaignFit
    found: tuple[Explanation, ...]
    differ_N: float
    one_shape: bool

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all effects that may be the cause, the likeliest first."""
        return tuple(dict.fromkeys(name for one in self.found for name in one.names))


def one_shape(presses: Presses) -> bool:
    """Whether all presses are of pucks of one shape."""
    return bool(presses.thickness_mm.max() < ONE_SHAPE * presses.thickness_mm.min())


def repeat_difference_N(campaign_fit: CampaignFit) -> float:
    """Standard deviation of presses of one condition about each other, motion taken out; 0 without repeats. [N]"""
    parts, _ = contrasts(campaign_fit.problem.presses, campaign_fit.residual)
    if not parts:
        return 0.0
    squares = np.concatenate([part.force_N**2 for part in parts])
    return float(np.sqrt(np.average(squares, weights=np.concatenate([part.samples for part in parts]))))


def residual_N(campaign_fit: CampaignFit) -> float:
    """Root mean square of what a model leaves. [N]"""
    presses = campaign_fit.problem.presses
    return float(np.sqrt(np.average(campaign_fit.residual**2, weights=presses.samples * presses.used)))


def usual_sizes(campaign_fit: CampaignFit) -> NoiseSizes:
    """Noise in which explanations are compared: what presses of one condition differ by, and errors of the law."""
    presses, sizes = campaign_fit.problem.presses, campaign_fit.sizes
    differ, force = repeat_difference_N(campaign_fit), presses.force_N
    slow = float(np.hypot(differ, LAW_SHARE * force.max()))
    took = np.median([trial.trace.time_s[-1] - start for trial, start in zip(presses.trials, presses.contact_s)])
    noise = replace(sizes.noise, slow_N=slow, slow_time_s=CORRELATED * float(took), position_mm=FACES_MM)
    level, *rest = (median for median, _ in campaign_fit.problem.law.error_priors)
    return NoiseSizes(noise, (float(np.hypot(level, differ / np.sqrt(np.mean(force[presses.used] ** 2)))), *rest))


def functions_of_depth(campaign_fit: CampaignFit) -> list[NDArray]:
    """Columns (T, B) that span smooth factors of depth on the force, for each shape its own. [N]"""
    presses = campaign_fit.problem.presses
    depth = presses.measure(np.maximum(presses.displacement_mm, 0.0))
    knots = np.linspace(0.0, float(depth[presses.used].max()), KNOTS)
    own = [presses.used & (presses.pad == pad)[:, None] for pad in np.unique(presses.pad)]
    return [np.where(use, campaign_fit.forces * hat, 0.0) for use in own for hat in hats(depth, knots)]


def _scored(campaign_fit: CampaignFit) -> CampaignFit:
    """A fit whose score is its chi2: all are compared in one noise."""
    return replace(campaign_fit, score=campaign_fit.chi2)


def _fitted(plain: CampaignFit, one: Screened) -> CampaignFit:
    """An effect beside a model, from where it scored best and from its usual size: large sizes look otherwise."""
    first, at = first_fit(plain, one), plain.problem.fixed
    starts = first.vector, np.insert(plain.vector, at, one.start)
    return _scored(min((fit(first.problem, start, plain.sizes, 20) for start in starts), key=lambda own: own.chi2))


def explain(context: CampaignFit, available: tuple[Effect, ...], single: bool) -> Among | None:
    """Find what explains pucks beside what ``context`` holds; None where it is no function of depth on each shape.

    A free function of depth tells how much there is to explain. On a ``single`` shape an effect whose signature it
    can make is in doubt with all others of that kind, whatever their evidence. On several shapes one or two effects
    are compared by their evidence.
    """
    law = LAW_TERMS * len(context.problem.presses.pads)
    start = np.r_[context.vector[: len(context.vector) - law], np.zeros(law)]
    plain = _scored(fit(context.problem, start, usual_sizes(context), 20))
    projection = project(plain)
    columns = projection.remove(np.stack([projection.column(one) for one in functions_of_depth(plain)], axis=1))
    basis, singular, _ = np.linalg.svd(columns, full_matrices=False)
    basis = basis[:, singular > 1e-6 * singular[0]]
    won = float(np.sum((basis.T @ projection.remove(projection.residual)) ** 2))
    differ, enough = repeat_difference_N(context), ENOUGH * plain.problem.presses.used.sum()
    if won < GAIN_FLOOR:
        return Among(plain, (), differ, single) if differ > 0.0 and plain.chi2 < enough else None
    family = [one for one in screen(plain, available) if float(np.linalg.norm(basis.T @ one.signature)) >= FAMILY]
    found = [_explanation(plain, plain, (), one) for one in family]
    if not single:
        known = {one.names[0]: one for one in found}
        pairs = combinations([one.effect.name for one in family], 2)
        found += [_pair(plain, known[a], known[b]) for a, b in pairs]
    if not found or min(plain.chi2 - won, *(one.fit.chi2 for one in found)) > enough:
        return None
    found = sorted((one for one in found if not at_bound(one.fit)), key=lambda one: -one.gain)
    if single:
        found = [one for one in found if one.gain > (0.0 if one.effects[0].effect.by_convention else SOME * won)]
        return Among(plain, tuple(found), differ, single) if len(found) > 1 else None
    found = [one for one in found if one.gain > max(GAIN_FLOOR, found[0].gain - max(EXCLUDED, IMITATED * won))]
    return Among(plain, tuple(found), differ, single) if found and found[0].fit.chi2 < enough else None


def _pair(plain: CampaignFit, one: Explanation, other: Explanation) -> Explanation:
    """The likelier model with both effects, each joined to the other."""
    both = []
    for first, second in ((one, other), (other, one)):
        (joining,) = screen(first.fit, (second.effects[0].effect,)) or [second.effects[0].screened]
        both.append(_explanation(plain, first.fit, first.effects, joining))
    return max(both, key=lambda own: own.gain)


def _explanation(
    plain: CampaignFit, parent: CampaignFit, before: tuple[EffectCandidate, ...], one: Screened
) -> Explanation:
    own = _fitted(parent, one)
    effects = (*before, EffectCandidate(one.effect, own, parent.chi2 - own.chi2, one))
    return Explanation(effects, own, plain.chi2 - own.chi2 - EACH_PARAMETER * (len(effects) - 1))

"""Learn what no effect of the vocabulary explains as a smooth function, after the search or before it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.progress import Progress
from dummydesign.loop.effects.learned import BY_TRIAL, FOLLOWED, Learned, SmoothChange, followed, largest_change
from dummydesign.loop.fitting.candidates import EffectCandidate, modest, project
from dummydesign.loop.fitting.fit import CampaignFit, best_vector, budget_spent, fit_at, fit_with_noise
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.selection.cross_validation import AssessedModel, assess
from dummydesign.loop.selection.residuals import ResidualDiagnostics, diagnose
from dummydesign.loop.selection.search import named_parameters, search
from dummydesign.loop.selection.verdict import EACH_PARAMETER, AcceptedEffect, remainder

AS_GOOD = 0.1  # share of what a curve explains that a closed form may lose
LEVEL = 1e-2  # share of its largest value by which a shape must vary, to be more than a change of all forces alike
CAUSES = {
    "depth_mm": "the force law at this depth: a layer, a skin or a particle in the pad, or a bottom that is felt; "
    "press a pad of another thickness: a layer stays at its depth, a law goes with depth over thickness",
    "depth_share": "a material law that stiffens or softens otherwise; press a puck between plates, where the strain "
    "is uniform",
    "force_N": "a load cell that is not linear or saturates, or a set-up that gives way; press with another load cell",
    "reading_N": "an amplifier that is not linear or saturates; press with another load cell and amplifier",
    "since_stop_s": "a relaxation that two arms do not hold; hold longer",
    "temperature_C": "a modulus that changes otherwise with temperature; press the same pad cold and warm",
    "age_days": "cure that goes on, or drying; press the same pad again in a week",
}
"""What makes such a remainder as a rule, and the press that would tell."""


@dataclass(frozen=True)
class ClosedForm:
    """A closed form for a curve g(u)."""

    name: str
    text: str
    lost: float


def closed_form(knots: NDArray, values: NDArray, information: NDArray, follows: str) -> ClosedForm:
    """Find the simplest form that fits a curve as well as the data know it."""
    # any multiple of 1 + g is as good, but of what acts after the stop alone: a change of all forces is the modulus
    weights, alone = np.diag(information), follows == "since_stop_s"
    free = np.zeros((len(knots), 0)) if alone else 1.0 + values[:, None]
    total = _left_by(free, values, information)[1]
    best: tuple[float, str, str, float] | None = None
    for name, parameters, shapes in _forms(knots):
        for shape, text in shapes:
            middle = 0.0 if alone else float(np.average(shape, weights=weights))
            if np.ptp(shape) < LEVEL * np.abs(shape).max():
                continue
            (amount, *_), chi2 = _left_by(np.column_stack([shape - middle, free]), values, information)
            # said relative to the force at u = 0, or in the usual state where that is far off
            at_null = 1.0 - amount * middle * (follows not in BY_TRIAL)
            spare = max(len(knots) - parameters - 1, 1)
            score = chi2 + 2.0 * parameters + 2.0 * parameters * (parameters + 1) / spare
            if at_null > LEVEL and (best is None or score < best[0]):
                best = (score, name, text.format(amount / at_null), chi2)
    lost = best[3] / total if best is not None and total > 0.0 else 1.0
    if best is None or lost > AS_GOOD:
        # what the data know of a constant is next to nothing: the modulus has it
        flat = values if alone else values - np.average(values, weights=weights)
        most = int(np.argmax(np.abs(flat)))
        name, form = "curve", f"a curve of no simple form, {100 * flat[most]:+.1f} % at {knots[most]:.3g}"
    else:
        _, name, form, _ = best
    text = f"relative change of the force with u = {FOLLOWED[follows]}: {form}. Usual cause: {CAUSES[follows]}"
    return ClosedForm(name, text, lost)


def _left_by(columns: NDArray, values: NDArray, information: NDArray) -> tuple[NDArray, float]:
    """Weights of columns (k, c) that fit values (k,) best, and the square that they leave, both as the data know it."""
    known = columns.T @ information
    weights = np.linalg.lstsq(known @ columns, known @ values, rcond=1e-12)[0]
    left = values - columns @ weights
    return weights, float(left @ information @ left)


def _forms(knots: NDArray) -> list[tuple[str, int, list[tuple[NDArray, str]]]]:
    """Name, number of parameters and shapes of each form with their text, on a grid of what is not linear."""
    u, span = np.maximum(knots, 1e-12), float(np.ptp(knots))
    scales = span * np.geomspace(0.05, 3.0, 25)
    return [
        ("linear", 1, [(u, "{:.3g} u")]),
        ("power", 2, [(u**p, f"{{:.3g}} u^{p:.2g}") for p in np.arange(0.25, 6.01, 0.25) if p != 1.0]),
        ("exponential", 2, [(np.expm1(u / s), f"{{:.3g}} (exp(u / {s:.3g}) - 1)") for s in scales[8:]]),
        ("saturation", 2, [(-np.expm1(-u / s), f"{{:.3g}} (1 - exp(-u / {s:.3g}))") for s in scales]),
        (
            "bump",
            3,
            [
                (np.exp(-(((u - c) / w) ** 2)), f"{{:.3g}} exp(-((u - {c:.3g}) / {w:.3g})^2)")
                for c in np.linspace(u[0], u[-1], 4 * len(u))
                for w in span * np.geomspace(0.02, 0.5, 30)
            ],
        ),
        ("step", 2, [(1.0 * (u > s), f"{{:.3g}} beyond {s:.3g}") for s in 0.5 * (u[1:] + u[:-1])]),
    ]


KNOTS, MOST_BY_TRIAL = 30, 12
"""Knots of a quantity that varies in a press, and at most of one that belongs to a trial."""
PAIR_KNOTS, PAIR_BY_TRIAL = 8, 4
"""The same of one of a pair."""
SPARE = 0.35  # share of the largest force by which the knots of a curve of the force go on, straight, beyond it
PROMISING = 2  # quantities that pairs are made of, with all others: those that alone have most evidence
BY_TIME = "thickness_mm"
"""Followed together with the time since the stop only: what flows through a pad takes longer in a thicker one."""
LARGEST = 0.3  # prior standard deviation of the relative change
EVIDENCE = 60.0  # twice the log of the marginal likelihood that the best quantity must gain
HALVED = 0.7  # mean square of left-out conditions, over that without it, that a learned effect must reach
STEP, MOST_ROUNDS, ENDED, SHARES = 0.02, 12, 0.02, (1.0, 0.5, 0.2)
"""Step of the sensitivities; rounds at most, the share of the score below which a gain ends them, and shares of a
change of which the first that lowers the score is taken: what the modulus has imitated takes several rounds."""


@dataclass(frozen=True)
class NonparametricEffect:
    """A learned effect in its fit."""

    effect: Learned
    fit: CampaignFit
    evidence: float
    left_out: float
    form: ClosedForm
    cost: float = 0.0
    """Minus twice the log prior of the curve, with the volume that the data leave it: what it costs a model."""

    @property
    def text(self) -> str:
        """The finding in a sentence."""
        return (
            f"the residual follows {self.effect.shape.text} and was learned: {self.form.text}. The error "
            f"on left-out conditions falls to {100 * np.sqrt(self.left_out):.0f} % of what it was"
        )

    def to_dict(self) -> dict[str, Any]:
        """Return name, range, curve, closed form, evidence and the left-out error over that before."""
        shape = self.effect.shape
        return {
            "name": self.effect.name,
            "follows": shape.follows if len(shape.follows) > 1 else shape.name,
            **shape.to_dict(),
            "closed_form": self.form.name,
            "text": self.text,
            "evidence": self.evidence,
            "heldout_rmse_over_without": float(np.sqrt(self.left_out)),
        }


@dataclass(frozen=True)
class _Step:
    values: NDArray
    evidence: float
    information: NDArray
    precision: NDArray


def learn(campaign_fit: CampaignFit, among: tuple[str, ...] = tuple(FOLLOWED)) -> NonparametricEffect | None:
    """Learn what a model leaves, if it follows such quantities and predicts left-out conditions much better."""
    usual = modest(campaign_fit)
    quantities = {
        name: values
        for name, values in followed(campaign_fit.problem.presses, campaign_fit.forces).items()
        if name in among
    }
    alone = [_first(usual, quantities, name) for name in quantities if name != BY_TIME]
    if not alone:
        return None
    alone.sort(key=lambda one: -one[1].evidence)
    together = _pairs(usual, quantities, [shape.name for shape, _ in alone])
    for tried, least in ((together, max(alone[0][1].evidence, 0.0) + EVIDENCE), (alone, EVIDENCE)):
        best = max(tried, key=lambda one: one[1].evidence, default=None)
        learnt = _learnt(campaign_fit, usual, *best) if best is not None and best[1].evidence >= least else None
        if learnt is not None:
            return learnt
    return None


def _learnt(
    campaign_fit: CampaignFit, usual: CampaignFit, shape: SmoothChange, step: _Step
) -> NonparametricEffect | None:
    """The fit with an effect of this shape, when it predicts left-out conditions much better."""
    fit, score = usual, campaign_fit.score
    for turn in range(MOST_ROUNDS):
        if turn and budget_spent():
            break
        if turn:
            step = _step(fit, shape)
        new = _without_modulus(shape, step)
        for share in SHARES:
            tried = shape.with_flat(shape.flat + share * (new - shape.flat))
            problem, vector = _with(fit, tried)
            trial = fit_with_noise(problem, vector, replace(campaign_fit.sizes, noise=fit.sizes.noise), 2, 8)
            if trial.score < score:
                break
        else:
            break
        gained, shape, fit, score = score - trial.score, tried, trial, trial.score
        if gained < EVIDENCE + ENDED * abs(score):
            break
    if fit is usual:
        return None
    values = shape.flat
    volume = np.linalg.slogdet(np.eye(len(values)) + np.linalg.solve(step.precision, step.information))[1]
    cost = float(values @ step.precision @ values + volume)
    # scatter of presses that the base knows as such is not explained once more
    evidence = campaign_fit.score - fit.score - cost
    if evidence < EACH_PARAMETER:
        return None
    ratio = refitted_squares(fit) / refitted_squares(campaign_fit)
    if ratio > HALVED:
        return None
    if len(shape.follows) > 1:
        form = ClosedForm("surface", largest_change(shape, step.information), 0.0)
    else:
        form = closed_form(np.array(shape.knots[0]), values, step.information, shape.name)
    return NonparametricEffect(Learned(shape), fit, evidence, ratio, form, cost)


def can_be_learned(seen: ResidualDiagnostics) -> tuple[str, ...]:
    """Quantities of which a remainder may be a function: none of a line, a step, noise of its own or an oscillation.

    Where single trials differ most, only what is declared for each trial; left-out conditions tell it from scatter.
    """
    odd = ("oscillation after the stop", "before contact")
    if any(check.exceeded for check in seen.checks) or not seen.where or seen.where[0].factor in odd:
        return ()
    return BY_TRIAL if seen.where[0].factor == "single trials" else tuple(FOLLOWED)


def _first(fit: CampaignFit, quantities: dict[str, NDArray], *names: str) -> tuple[SmoothChange, _Step]:
    """The change over some quantities after one step from nothing."""
    knots = tuple(_knots(fit, name, quantities[name], KNOTS if len(names) == 1 else PAIR_KNOTS) for name in names)
    count = int(np.prod([len(one) for one in knots]))
    shape = SmoothChange(names, knots, ()).with_flat(np.zeros(count))
    return shape, _step(fit, shape)


def _pairs(fit: CampaignFit, quantities: dict[str, NDArray], best_first: list[str]) -> list[tuple[SmoothChange, _Step]]:
    """Changes over two quantities, one of them promising alone, with their first step."""
    places = range(min(PROMISING, len(best_first)))
    pairs = [(best_first[rank], second) for rank in places for second in best_first[rank + 1 :]]
    if {BY_TIME, "since_stop_s"} <= set(quantities):
        pairs.append((BY_TIME, "since_stop_s"))
    # in a press these go together: their plane is hardly seen
    alike = {"depth_mm", "depth_share", "force_N", "reading_N"}
    return [_first(fit, quantities, *pair) for pair in pairs if not (set(pair) <= alike or budget_spent())]


def _knots(fit: CampaignFit, name: str, values: NDArray, most: int) -> tuple[float, ...]:
    """Knots over the range of a quantity; of the time since the stop they are even in the logarithm."""
    by_trial = len(values) == len(fit.problem.presses.trials)
    count = min(MOST_BY_TRIAL if most == KNOTS else PAIR_BY_TRIAL, len(np.unique(values))) if by_trial else most
    # the modulus imitates a curve of the force: without it the force on the sensor may be larger
    ends = values.min(), values.max() * (1.0 + SPARE * (name in ("force_N", "reading_N")))
    return tuple((np.geomspace(*ends, count) if name == "since_stop_s" else np.linspace(*ends, count)).tolist())


def _with(fit: CampaignFit, shape: SmoothChange) -> tuple[CampaignProblem, NDArray]:
    """The model with this shape in place of any it has learned, at size one."""
    problem, vector = fit.problem, fit.vector
    for one in problem.effects:
        if isinstance(one, Learned):
            vector = np.delete(vector, problem.entries[one.name])
            problem = replace(problem, effects=tuple(other for other in problem.effects if other is not one))
    return problem.plus(Learned(shape)), np.insert(vector, problem.fixed, 1.0)


def _columns(fit: CampaignFit, shape: SmoothChange) -> NDArray:
    """Change of the bins with each value of a shape (T, B, knots). [N]"""
    out = []
    for more in STEP * np.eye(len(shape.flat)):
        problem, vector = _with(fit, shape.with_flat(shape.flat + more))
        out.append((problem.predict(vector) - fit.forces) / STEP)
    return np.where(fit.problem.presses.used[..., None], np.stack(out, axis=-1), 0.0)


def _step(fit: CampaignFit, shape: SmoothChange) -> _Step:
    """New values of a shape by one step of Gauss and Newton at a fit, with the likeliest penalty."""
    projection, old = project(fit), shape.flat
    columns = projection.whiten(_columns(fit, shape)).reshape(-1, len(old))
    columns = projection.remove(np.concatenate([columns, np.zeros((projection.rows, len(old)))]))
    target = projection.remove(projection.residual) + columns @ old
    information, pull = columns.T @ columns, columns.T @ target
    rough, eye = shape.roughness(), np.eye(len(old))
    steps = []
    for penalty in np.geomspace(1.0, 1e8, 33):
        precision = penalty * rough.T @ rough + eye / LARGEST**2
        values = np.linalg.solve(information + precision, pull)
        volume = np.linalg.slogdet(eye + np.linalg.solve(precision, information))[1]
        steps.append(_Step(values, float(pull @ values - volume), information, precision))
    return max(steps, key=lambda one: one.evidence)


FOLDS, REFITS = 4, 2
"""Parts of the conditions that are left out one after another, and rounds in which a curve is learned without one."""


def refitted_squares(campaign_fit: CampaignFit) -> float:
    """Squared error of left-out conditions, each part of them predicted by real fits to the rest. [N2]

    A linear step would run away along what nothing determines. Presses of one condition only are left out one by one.
    """
    presses = campaign_fit.problem.presses
    cells = np.unique(presses.cell, return_inverse=True)[1]
    part = (cells if cells.any() else np.arange(len(cells))) % FOLDS
    folds = [out for fold in range(FOLDS) if (out := part == fold).any() and not out.all()]
    return squares_without(campaign_fit, folds)[0] / float((presses.samples * presses.used).sum())


def squares_without(campaign_fit: CampaignFit, parts: Sequence[NDArray]) -> tuple[float, float]:
    """Weighted squares of presses, each part (T,) predicted by a fit without it, and the sum of the weights. [N2, 1]"""
    presses, squares, total = campaign_fit.problem.presses, 0.0, 0.0
    weight = presses.samples * presses.used
    for out in parts:
        residual = (presses.force_N - predicted_without(campaign_fit, out))[out]
        squares, total = squares + float((weight[out] * residual**2).sum()), total + float(weight[out].sum())
    return squares, total


def predicted_without(campaign_fit: CampaignFit, out: NDArray) -> NDArray:
    """Bins (T, B) of all presses by a fit to those that are not ``out`` (T,), a learned shape learned anew. [N]"""
    problem, presses, start = campaign_fit.problem, campaign_fit.problem.presses, campaign_fit.vector
    rest = replace(problem, presses=replace(presses, bins=presses.bins.without(out)))
    # no press knows of another's bins: what is known of all at the start is worked out once for every part
    rest.sensed[start.tobytes()] = problem.jacobian(start, problem.predict(start))
    rest.seen.update(problem.seen)
    vector = best_vector(rest, start, campaign_fit.sizes, 6)
    for _ in range(REFITS if any(isinstance(one, Learned) for one in rest.effects) else 0):
        rest, start = _learned_again(fit_at(rest, vector, campaign_fit.sizes))
        vector = best_vector(rest, start, campaign_fit.sizes, 4)
    return rest.predict(vector)


def _without_modulus(shape: SmoothChange, step: _Step) -> NDArray:
    """New values (k,) of a shape without their mean: a constant change is the modulus, which does not fade out.

    From the stop on it is not: without its mean the force would jump at the stop.
    """
    if "since_stop_s" in shape.follows:
        return step.values
    return step.values - np.average(step.values, weights=np.maximum(np.diag(step.information), 1e-12))


def _learned_again(campaign_fit: CampaignFit) -> tuple[CampaignProblem, NDArray]:
    """A model with the shape that its fit holds one step further."""
    shape = next(one.shape for one in campaign_fit.problem.effects if isinstance(one, Learned))
    return _with(campaign_fit, shape.with_flat(_without_modulus(shape, _step(campaign_fit, shape))))


@dataclass(frozen=True)
class LearnedFirst:
    """A learned function and the named effects that were found beside it."""

    learnt: NonparametricEffect
    after: AssessedModel
    effects: tuple[AcceptedEffect, ...]


def learned_alone(
    base: AssessedModel, seen: ResidualDiagnostics, ranking: list[EffectCandidate], progress: Progress
) -> LearnedFirst | None:
    """A function that leaves nothing but noise, where the best single effect leaves more and explains less.

    ``seen`` is what the base model leaves.
    """
    best = ranking[0].fit if ranking else base.fit
    among = can_be_learned(seen)
    if not among or not remainder(base, base, seen).reasons:
        return None
    if best is not base.fit and not _leaves(base, best):
        return None
    progress("learning from the base model")
    function = learn(base.fit, among)
    if function is None or _leaves(base, function.fit):
        return None
    after = assess(function.fit)
    if _cost(after, function) >= best.score + EACH_PARAMETER:
        return None
    return LearnedFirst(function, after, ())


def _leaves(base: AssessedModel, fit: CampaignFit) -> bool:
    """Whether a model leaves more than noise."""
    return bool(remainder(base, assess(fit), diagnose(fit)).reasons)


def learned_first(
    base: AssessedModel,
    seen: ResidualDiagnostics,
    named: AssessedModel,
    available: tuple[Effect, ...],
    progress: Progress,
) -> LearnedFirst | None:
    """Learn from the base, add named effects, and return that when it explains and predicts better than ``named``.

    ``seen`` is what the base model leaves. Explained is compared by the marginal likelihood of the curve and a cost of
    each named parameter; predicted by real refits without each part of the conditions.
    """
    among = can_be_learned(seen) if named.fit.problem.effects else ()
    if not among:
        return None
    progress("learning before the named effects")
    function = learn(base.fit, among)
    if function is None or budget_spent():
        return None
    # it takes the place of named effects: no more of them join it than stood without it
    selection = search(assess(function.fit), available, progress, most=len(named.fit.problem.effects))
    after = selection.after
    # named effects may have taken its place
    if not any(isinstance(one, Learned) for one in after.fit.problem.effects) or budget_spent():
        return None
    if _cost(after, function) >= _cost(named) or refitted_squares(after.fit) >= refitted_squares(named.fit):
        return None
    effects = tuple(one for one in selection.effects if not isinstance(one.candidate.effect, Learned))
    return LearnedFirst(replace(function, fit=after.fit), after, effects)


def _cost(model: AssessedModel, learnt: NonparametricEffect | None = None) -> float:
    """Minus twice the log likelihood, with what the curve and the named parameters cost."""
    return model.fit.score + (0.0 if learnt is None else learnt.cost) + EACH_PARAMETER * named_parameters(model.fit)

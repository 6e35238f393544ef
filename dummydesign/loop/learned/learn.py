"""Learn a smooth effect from the remainder of a model: penalised, its penalty by marginal likelihood, left-out tested.

It follows one quantity, or two together where that has more evidence by as much as one needs. The values c of a
piecewise-linear factor on knots are normal with second differences of variance 1/l; base, named
effects and law error are projected out of its columns A, so that with r the whitened remainder

    2 ln L(l) = b' (G + Q)^-1 b - ln det(1 + Q^-1 G),  b = A' r,  G = A' A,  Q = l D' D + 1 / LARGEST^2

which is largest at the penalty used. Steps of Gauss and Newton and joint refits of everything else alternate.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.candidates import modest
from dummydesign.loop.fitting.fit import Fit, prior_precision, settle
from dummydesign.loop.fitting.noise import make_whitener
from dummydesign.loop.fitting.problem import Problem
from dummydesign.loop.fitting.screening import project
from dummydesign.loop.judging.left_out import leave_out
from dummydesign.loop.judging.residual_checks import Check
from dummydesign.loop.judging.residual_dependence import Dependence
from dummydesign.loop.learned.closed_form import ClosedForm, closed_form
from dummydesign.loop.learned.effect import FOLLOWED, Learned, Shape, followed
from dummydesign.loop.learned.pair import Surface, said

KNOTS, MOST_BY_TRIAL, PAIR_KNOTS = 30, 4, 8
"""Knots of a quantity that varies in a press, of one that belongs to a trial, and of one of a pair in a press."""
PROMISING = 2
"""Quantities that pairs are made of, with all others: those that alone have most evidence."""
BY_TIME = "thickness_mm"
"""Followed together with the time since the stop only: what flows through a pad takes longer in a thicker one."""
LARGEST = 0.3
"""Prior standard deviation of the relative change."""
EVIDENCE = 60.0
"""Twice the log of the marginal likelihood that the best quantity must gain."""
HALVED = 0.7
"""Mean square of left-out conditions, over that without it, that a learned effect must reach."""
STEP, MOST_ROUNDS, ENDED, SHARES = 0.02, 12, 0.02, (1.0, 0.5, 0.2)
"""Step of the sensitivities; rounds at most, the share of the score below which a gain ends them, and shares of a
change of which the first that lowers the score is taken: what the modulus has imitated takes several rounds."""


@dataclass(frozen=True)
class Learnt:
    """A learned effect in its fit.

    Attributes
    ----------
    effect : Learned
    fit : Fit
        The model with it.
    evidence : float
        Twice the log of the marginal likelihood gained at the model without it.
    left_out : float
        Mean square error on left-out conditions over that without it, its values estimated anew each time.
    form : ClosedForm
        The simplest closed form that says the same.
    """

    effect: Learned
    fit: Fit
    evidence: float
    left_out: float
    form: ClosedForm

    @property
    def _followed(self) -> str:
        shape = self.effect.shape
        names = shape.follows if isinstance(shape, Surface) else (shape.follows,)
        return " and ".join(FOLLOWED[name] for name in names)

    @property
    def text(self) -> str:
        """The finding in a sentence."""
        return (
            f"what is left follows {self._followed} and was learned: {self.form.text}. The error "
            f"on left-out conditions falls to {100 * np.sqrt(self.left_out):.0f} % of what it was"
        )

    def to_dict(self) -> dict[str, Any]:
        """Return name, range, curve, closed form, evidence and the left-out error over that before."""
        shape = self.effect.shape
        return {
            "name": self.effect.name, "follows": shape.follows, **shape.to_dict(), "closed_form": self.form.name,
            "text": self.text,
            "evidence": self.evidence, "heldout_rmse_over_without": float(np.sqrt(self.left_out)),
        }  # fmt: skip


@dataclass(frozen=True)
class _Step:
    values: NDArray
    evidence: float
    information: NDArray
    precision: NDArray


def learn(found: Fit) -> Learnt | None:
    """Learn what a model leaves, if it follows one quantity and predicts left-out conditions much better.

    Parameters
    ----------
    found : Fit
        A model whose remainder is more than noise.
    """
    usual = modest(found)
    quantities = followed(found.problem.presses, found.forces)
    alone = [_first(usual, name, values) for name, values in quantities.items() if name != BY_TIME]
    if not alone:
        return None
    alone.sort(key=lambda one: -one[1].evidence)
    together = _pairs(usual, quantities, [shape.name for shape, _ in alone])
    for tried, least in ((together, max(alone[0][1].evidence, 0.0) + EVIDENCE), (alone, EVIDENCE)):
        best = max(tried, key=lambda one: one[1].evidence, default=None)
        learnt = _learnt(found, usual, *best) if best is not None and best[1].evidence >= least else None
        if learnt is not None:
            return learnt
    return None


def _learnt(found: Fit, usual: Fit, shape: Shape | Surface, step: _Step) -> Learnt | None:
    """The fit with an effect of this shape, when it predicts left-out conditions much better."""
    fit, evidence, score = usual, step.evidence, found.score
    for turn in range(MOST_ROUNDS):
        if turn:
            step = _step(fit, shape)
        # a constant change is the modulus, which does not fade out beyond the range seen
        new = step.values - np.average(step.values, weights=np.diag(step.information))
        for share in SHARES:
            tried = shape.with_flat(shape.flat + share * (new - shape.flat))
            trial = _refit(found, fit, tried.effect())
            if trial.score < score:
                break
        else:
            break
        gained, shape, fit, score = score - trial.score, tried, trial, trial.score
        if gained < EVIDENCE + ENDED * abs(score):
            break
    if fit is usual:
        return None
    effect = fit.problem.effects[-1]
    ratio = _left_out(found, fit, shape, step.precision)
    if ratio > HALVED:
        return None
    if isinstance(shape, Surface):
        form = ClosedForm("surface", said(shape, step.information), 0.0)
    else:
        form = closed_form(np.array(shape.knots), np.array(shape.values), step.information, shape.follows)
    return Learnt(effect, fit, evidence, ratio, form)


def can_be_learned(checks: list[Check], where: list[Dependence]) -> bool:
    """Whether a remainder may be a function of the state: no line, step or noise of its own, no single trials.

    Parameters
    ----------
    checks : list of Check
        Of the model whose remainder it is.
    where : list of Dependence
        What the remainder follows, strongest first.
    """
    odd = ("oscillation after the stop", "single trials", "before contact")
    return not any(check.exceeded for check in checks) and bool(where) and where[0].factor not in odd


def _first(fit: Fit, name: str, values: NDArray) -> tuple[Shape, _Step]:
    knots = _knots(fit, name, values, KNOTS)
    shape = Shape(name, knots, (0.0,) * len(knots))
    return shape, _step(fit, shape)


def _pairs(fit: Fit, quantities: dict[str, NDArray], best_first: list[str]) -> list[tuple[Surface, _Step]]:
    """Surfaces of two quantities, of which one is promising alone, with their first step."""
    places = range(min(PROMISING, len(best_first)))
    pairs = [(best_first[place], second) for place in places for second in best_first[place + 1 :]]
    if {BY_TIME, "since_stop_s"} <= set(quantities):
        pairs.append((BY_TIME, "since_stop_s"))
    out: list[tuple[Surface, _Step]] = []
    for first, second in pairs:
        if {first, second} <= {"depth_mm", "depth_share", "force_N"}:
            continue  # in a press these go together: their plane is hardly seen
        one, two = (_knots(fit, name, quantities[name], PAIR_KNOTS) for name in (first, second))
        shape = Surface((first, second), (one, two), ((0.0,) * len(two),) * len(one))
        out.append((shape, _step(fit, shape)))
    return out


def _knots(fit: Fit, name: str, values: NDArray, most: int) -> tuple[float, ...]:
    """Knots over the range of a quantity; of the time since the stop they are even in the logarithm."""
    by_trial = len(values) == len(fit.problem.presses.trials)
    count = min(MOST_BY_TRIAL, len(np.unique(values))) if by_trial else most
    ends = values.min(), values.max()
    return tuple((np.geomspace(*ends, count) if name == "since_stop_s" else np.linspace(*ends, count)).tolist())


def _with(fit: Fit, shape: Shape | Surface) -> tuple[Problem, NDArray]:
    """The model with this shape in place of any it has learned, at size one."""
    problem, vector = fit.problem, fit.vector
    if problem.effects and isinstance(problem.effects[-1], Learned):
        problem = Problem(problem.presses, problem.law, problem.effects[:-1])
        vector = np.delete(vector, problem.fixed)
    extended = Problem(problem.presses, problem.law, (*problem.effects, shape.effect()))
    return extended, np.insert(vector, problem.fixed, 1.0)


def _columns(fit: Fit, shape: Shape | Surface) -> NDArray:
    """Change of the bins with each value of a shape (T, B, knots). [N]"""
    out = []
    for more in STEP * np.eye(len(shape.flat)):
        problem, vector = _with(fit, shape.with_flat(shape.flat + more))
        out.append((problem.predict(vector) - fit.forces) / STEP)
    return np.where(fit.problem.presses.used[..., None], np.stack(out, axis=-1), 0.0)


def _step(fit: Fit, shape: Shape | Surface) -> _Step:
    """New values of a shape by one step of Gauss and Newton at a fit, with the likeliest penalty."""
    projection, whiten = project(fit)
    old = shape.flat
    columns = whiten(_columns(fit, shape)).reshape(-1, len(old))
    columns = np.concatenate([columns, np.zeros((projection.rows, len(old)))])
    columns = columns - projection.basis @ (projection.basis.T @ columns)
    target = projection.remove(projection.residual) + columns @ old
    information, pull = columns.T @ columns, columns.T @ target
    rough, eye = shape.roughness(), np.eye(len(old))
    best = None
    for penalty in np.geomspace(1.0, 1e8, 33):
        precision = penalty * rough.T @ rough + eye / LARGEST**2
        values = np.linalg.solve(information + precision, pull)
        volume = np.linalg.slogdet(eye + np.linalg.solve(precision, information))[1]
        evidence = float(pull @ values - volume)
        if best is None or evidence > best.evidence:
            best = _Step(values, evidence, information, precision)
    return best


def _refit(found: Fit, fit: Fit, effect: Learned) -> Fit:
    problem, vector = _with(fit, effect.shape)
    return settle(problem, vector, replace(found.sizes, noise=fit.sizes.noise), 2, 8)


def _left_out(before: Fit, after: Fit, shape: Shape | Surface, precision: NDArray) -> float:
    """Mean square error of left-out conditions with a learned effect over that without, all values estimated anew."""
    presses = before.problem.presses
    cells = presses.cell
    weight = presses.samples * presses.used
    plain = leave_out(before, cells)
    at = after.problem.fixed - 1
    jacobian = np.concatenate([np.delete(after.jacobian, at, axis=-1), _columns(after, shape)], axis=-1)
    own = np.delete(after.vector, at)
    prior = np.zeros((jacobian.shape[-1],) * 2)
    prior[: len(own), : len(own)] = np.diag(np.delete(prior_precision(after.problem, after.sizes), at) + 1e-9)
    prior[len(own) :, len(own) :] = precision
    whiten = make_whitener(presses, after.sizes.noise, after.slope, True)
    turned, white = whiten(jacobian), whiten(after.residual)
    normal, gradient = np.einsum("tbi,tbj->tij", turned, turned), np.einsum("tbi,tb->ti", turned, white)
    full, squares = normal.sum(axis=0) + prior, np.zeros(2)
    for cell, change in plain.items():
        out = cells == cell
        rest = full - normal[out].sum(axis=0)
        moved = -np.linalg.lstsq(rest, gradient[out].sum(axis=0), rcond=1e-12)[0]
        for place, (fit, columns, step) in enumerate(((before, before.jacobian, change), (after, jacobian, moved))):
            squares[place] += (weight[out] * (fit.residual[out] - columns[out] @ step) ** 2).sum()
    return float(squares[1] / squares[0]) if squares[0] > 0 else 1.0

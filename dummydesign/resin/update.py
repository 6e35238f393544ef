"""Update a resin by measured points (modulus, Bayes) and arms (relaxation), and keep it as a resin of the user.

Relaxation: the base's arms are carried to the puck's ratio, with what is not known of its law (draws). Then, arm by
arm:

- a measured arm takes the place of the base's nearest one within a factor of three in time where that is a guess
  (assumed or inferred): a guess has no weight beside a measurement. Where the base's is measured too, the posterior
  of ln beta is normal, with weights 1 / variance of both, and so is that of ln tau. Where the two miss each other by
  more than three of their joint standard deviation, both are widened until they agree (Birge ratio) and this is
  reported;
- a measured arm without a counterpart is taken as measured;
- an arm of the base inside the times that the presses show, without a counterpart, is not there: the measured
  arms stand for all of it;
- an arm of the base outside those times is kept as the base has it, with its own interval, and this is reported.

The interval is that of the batch that was poured. Another pour of the recipe is another batch.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import check_file
from dummydesign.core.quantity import HALF_WIDTH, Quantity, value_at
from dummydesign.core.user_library import Entry, make_room, read_toml
from dummydesign.resin.model.resin import (
    NEO_HOOKEAN,
    PUCK_SCATTER,
    SURPRISE,
    Interval,
    Point,
    Resin,
    ResinArm,
    log_spread,
)
from dummydesign.resin.model.resin_file import KIND, Numbers, load_resin, read_points, read_resin, save_resin

CHAINS, STEPS, SEED = 400, 150, 7


def update_resin(resin: Resin, points: Sequence[Point], name: str, seed: int = SEED) -> Resin:
    """Condition the law of a resin on measured points.

    The law's numbers get their intervals as prior, the points a normal error of ln E from their own
    95 % intervals. Joint draws are made by elliptical slice sampling in standard normal deviates of the
    prior. When the points disagree with the law by more than their intervals say, they are named in
    ``contradictions`` and all intervals of the points are widened by the factor that makes them agree
    (Birge ratio), instead of averaging them as if they were exact.

    References
    ----------
    Murray, Adams and MacKay, AISTATS 2010 (elliptical slice sampling);
    Birge, Phys. Rev. 40 (1932) 207 (widening of inconsistent data).
    """
    if not points:
        raise InputError("no points: give at least one [[point]] with ratio and young_kPa", "missing", "point")
    # an order of their own, whatever the one in which they came
    every = sorted(
        [*resin.points, *points],
        key=lambda one: (one.ratio, one.puck.sha256 if one.puck else "", one.young_kPa.value),
    )
    resin.check_ratio([point.ratio for point in every])
    prior = base_numbers(resin)
    names = [key for key, quantity in prior.items() if quantity.low < quantity.high]

    def numbers_at(z: NDArray) -> dict[str, NDArray]:
        drawn = {key: value_at(prior[key], z[:, index]) for index, key in enumerate(names)}
        return {key: drawn.get(key, np.full(len(z), q.value)) for key, q in prior.items()}

    def log_likelihood(z: NDArray) -> NDArray:
        numbers = numbers_at(z)
        valid = np.broadcast_to(resin.law.valid(resin.ratio_min, numbers), (len(z),))
        with np.errstate(divide="ignore", invalid="ignore"):
            total = -0.5 * np.sum((_misfit(resin, every, numbers) @ whiten.T / widening) ** 2, axis=-1)
        return np.where(valid & np.isfinite(total), total, -np.inf)

    whiten = np.linalg.inv(np.linalg.cholesky(correlation(every)))
    widening, best = 1.0, np.zeros(len(names))
    for _ in range(2):  # a second pass when the first shows that the points must be widened
        z = _sample(log_likelihood, len(names), seed)
        best = z[int(np.argmax(log_likelihood(z) - 0.5 * np.sum(z**2, axis=1)))]
        misfit = _misfit(resin, every, numbers_at(best[None, :]))
        if widening > 1.0 or not _too_far(whiten @ misfit):
            break
        widening = max(math.sqrt(float(np.mean((whiten @ misfit) ** 2))), 1.0)
    draws = numbers_at(z)
    central = {key: float(value[0]) for key, value in numbers_at(best[None, :]).items()}
    return replace(
        resin,
        name=name,
        title=f"{base_title(resin)}, updated by {len(every)} measured point{'s' if len(every) > 1 else ''}",
        origin="user",
        numbers=_summary(prior, draws, central, len(every)),
        posterior={key: draws[key] for key in prior},
        prior_numbers=prior,
        points=tuple(every),
        contradictions=tuple(contradictions(resin, every, misfit, best, names, widening)),
    )


def base_title(resin: Resin) -> str:
    """Title of a resin without the words of an earlier update."""
    return re.sub(r"(, updated by \d+ measured points?)+$", "", resin.title)


def base_numbers(resin: Resin) -> Numbers:
    """Return the law's numbers as they were before any point: of the base, when points updated it."""
    return dict(resin.prior_numbers or resin.numbers)


def _misfit(resin: Resin, points: Sequence[Point], numbers: dict[str, NDArray]) -> NDArray:
    """Misfit of each point in its own standard deviations, shape (n, points) (or (points,) for n = 1)."""
    columns = {key: np.asarray(value)[:, None] for key, value in numbers.items()}
    young = resin.law.young_kPa(np.array([p.ratio for p in points]), columns)
    with np.errstate(divide="ignore"):
        misfit = (np.log(young) - [p.log_young for p in points]) / [p.spread for p in points]
    return misfit[0] if len(misfit) == 1 else misfit


def correlation(points: Sequence[Point]) -> NDArray:
    """Correlation of the errors of ln E: pucks between plates declared alike share all but their own scatter."""
    shared = np.array(
        [math.sqrt(max(1.0 - (PUCK_SCATTER / one.spread) ** 2, 0.0)) if one.puck else 0.0 for one in points]
    )
    alike = [[bool(a.puck and b.puck and a.puck.plates == b.puck.plates) for a in points] for b in points]
    return np.outer(shared, shared) * alike + np.diag(1.0 - shared**2)


def spread_between(first: Point, second: Point) -> float:
    """Standard deviation of ln of the ratio of two moduli."""
    own = np.array([first.spread, -second.spread])
    return math.sqrt(own @ correlation([first, second]) @ own)


def _sample(log_likelihood: Callable[[NDArray], NDArray], size: int, seed: int) -> NDArray:
    """Draw from N(0, 1) times the likelihood by elliptical slice sampling, CHAINS chains side by side."""
    rng = np.random.default_rng(seed)
    pool = rng.standard_normal((40 * CHAINS, size))
    # start each chain at the best of forty prior draws
    score = log_likelihood(pool).reshape(CHAINS, 40)
    z = pool.reshape(CHAINS, 40, size)[np.arange(CHAINS), np.argmax(score, axis=1)]
    current = log_likelihood(z)
    for _ in range(STEPS):
        other = rng.standard_normal(z.shape)
        level = current + np.log(rng.random(CHAINS))
        angle = rng.uniform(0.0, 2 * np.pi, CHAINS)
        low, high = angle - 2 * np.pi, angle.copy()
        open_ = np.ones(CHAINS, dtype=bool)
        while open_.any():
            at = np.nonzero(open_)[0]
            tried = z[at] * np.cos(angle[at])[:, None] + other[at] * np.sin(angle[at])[:, None]
            value = log_likelihood(tried)
            # the bracket shrinks towards the present state, which is always acceptable
            taken = (value >= level[at]) | (np.abs(angle[at]) < 1e-12)
            done, shrink = at[taken], at[~taken]
            current[done] = np.where(np.isfinite(value[taken]), value[taken], current[done])
            low[shrink] = np.where(angle[shrink] < 0, angle[shrink], low[shrink])
            high[shrink] = np.where(angle[shrink] >= 0, angle[shrink], high[shrink])
            angle[shrink] = rng.uniform(low[shrink], high[shrink])
            open_[done] = False
            z[done] = tried[taken]
    return z


def _summary(prior: Numbers, draws: dict[str, NDArray], central: dict[str, float], count: int) -> Numbers:
    """Summarise the draws as quantities of kind ``fitted``; what was fixed stays as it was."""
    summary = dict(prior)
    for key, quantity in prior.items():
        if quantity.low < quantity.high:
            (low, high), value = np.percentile(draws[key], [2.5, 97.5]).tolist(), central[key]
            source = f"prior ({quantity.source}) updated by {count} measured point{'s' if count > 1 else ''}"
            summary[key] = Quantity(value, min(low, value), max(high, value), "fitted", source)
    return summary


def _too_far(misfit: NDArray) -> bool:
    """Tell whether the points miss their own best law by more than chance (1 %)."""
    from scipy.special import gammaincc

    return bool(gammaincc(0.5 * misfit.size, 0.5 * float(np.sum(misfit**2))) < 0.01)


def contradictions(
    resin: Resin, points: Sequence[Point], misfit: NDArray, deviates: NDArray, names: Sequence[str], widening: float
) -> list[str]:
    """Say which points contradict each other, the law, or what was believed before."""
    notices = []
    for first, second in combinations(sorted(points, key=lambda point: point.ratio), 2):
        deviations = (second.log_young - first.log_young) / spread_between(first, second)
        both = f"{_text(first)} and {_text(second)}"
        if resin.same_ratio(first, second) and abs(deviations) > SURPRISE:
            notices.append(f"{both} differ by more than their intervals allow")
        elif not resin.same_ratio(first, second) and deviations * resin.law.direction < -SURPRISE:
            notices.append(f"{both}: the modulus must {resin.law.way} with the ratio")
    notices += [
        f"{_text(point)} is {abs(off):.1f} standard deviations off the law {resin.law.name}"
        for point, off in zip(points, misfit)
        if abs(off) > SURPRISE
    ]
    notices += [
        f"the points ask for a {key} {abs(off):.1f} standard deviations from what resin {resin.name} states"
        for key, off in zip(names, deviates)
        if abs(off) > SURPRISE
    ]
    if widening > 1.0:
        notices.append(f"all intervals of the points were widened {widening:.1f} times so that they agree")
    return notices


def _text(point: Point) -> str:
    return f"{point.young_kPa.value:g} kPa at ratio {point.ratio:g}"


def rebuild(resin: Resin, points: Sequence[Point], name: str) -> tuple[Resin, dict[str, tuple[ArmUpdate, ...]]]:
    """Begin again from the base with these points; also what became of its arms by each puck's recordings.

    The order of the points does not matter: law, relaxation and elastic law are updated by rising ratio.
    """
    base = without_points(resin)
    changed = update_resin(base, points, name) if points else base
    pucks = [(point.puck, point.ratio) for point in changed.points if point.puck]
    changed, updates = replace(changed, ogden_alpha=pooled_alpha([puck.alpha for puck, _ in pucks if puck.alpha])), {}
    for puck, ratio in pucks:
        if puck.seen_s is not None:
            changed, updates[puck.sha256] = update_relaxation(changed, puck.arms, ratio, puck.seen_s)
    return changed, updates


def without_points(resin: Resin) -> Resin:
    """The base of a resin, as it was before any point."""
    arms, ratio_ref = resin.prior_relaxation or (resin.arms, resin.relaxation_ratio_ref)
    return replace(
        resin,
        title=base_title(resin),
        numbers=base_numbers(resin),
        posterior=None,
        prior_numbers=None,
        points=(),
        contradictions=(),
        arms=arms,
        relaxation_ratio_ref=ratio_ref,
        prior_relaxation=None,
        ogden_alpha=None,
        notes=tuple(note for note in resin.notes if not note.startswith(NOTE)),
    )


def pooled_alpha(alphas: Sequence[Quantity]) -> Quantity | None:
    """Exponent of the elastic law that pucks share; None where its interval holds neo-Hookean (2).

    Weighed by inverse variance, but no better known than by one puck: what its law misfits is common to all.
    """
    if not alphas:
        return None
    weights = np.array([(one.high - one.low) ** -2 for one in alphas])
    value = float(weights @ [one.value for one in alphas] / weights.sum())
    best = alphas[int(np.argmax(weights))]
    low, high = value + best.low - best.value, value + best.high - best.value
    source = "; ".join(sorted({one.source for one in alphas}))
    return None if low <= NEO_HOOKEAN <= high else Quantity(value, low, high, "fitted", source)


def known_puck(resin: Resin, sha256: str) -> Point | None:
    """The point of a resin that came from one of these recordings."""
    return next((point for point in resin.points if point.puck and point.puck.has(sha256)), None)


def without_puck(resin: Resin, sha256: str) -> Resin:
    """Begin again from the base and add every other point."""
    kept = (point for point in resin.points if point.puck is None or not point.puck.has(sha256))
    return rebuild(resin, list(kept), resin.name)[0]


def add_resin(file: str | Path, replace_own: bool = False) -> tuple[Resin, Path]:
    """Check a file and keep the resin it describes in the user's own folder.

    A file with ``[modulus]`` is a whole resin; one with ``[[point]]`` and without ``[modulus]`` updates
    its ``base`` (the paper's polyurethane when none is named).
    """
    path = Path(file)
    check_file("resin file", path, "resin_file")
    if path.suffix.lower() == ".csv":
        raise InputError(
            f"resin file '{file}' is a CSV, not TOML: give each point as [[point]] with ratio and "
            "young_kPa (value, low, high, kind, source); of a puck's trace 'dummydesign resins "
            "add-compression' makes the point",
            "file_unreadable",
            "resin_file",
            str(file),
        )
    content, _ = read_toml(path)
    if "modulus" in content or "point" not in content:
        resin = replace(read_resin(Entry(path.stem, path, "file")), origin="user")
    else:
        base, name, points = read_points(path)
        resin = update_resin(load_resin(base), points, name)
    make_room(KIND, "resin", resin.name, replace_own)
    return resin, save_resin(resin)


SAME_TIME = 3.0
GUESSES = ("assumed", "inferred")
DRAWS = 4000
NOTE = "relaxation: "
"""How the notes begin that an update adds to a resin."""


@dataclass(frozen=True)
class ArmUpdate:
    """What became of one arm: ``from`` is measured, both, base or gone; strengths are at the puck's ratio.

    ``arm`` is what the resin has now, None of one that is gone. ``notice`` says what a user should know of it, empty
    for what was to be expected.
    """

    tau_s: float
    came_from: str
    base_beta: Interval | None
    measured_beta: Interval | None
    arm: ResinArm | None
    notice: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; strengths as {value, low, high} or null."""
        beta = None if self.arm is None else _of(self.arm.beta)
        strengths = {"base_beta": self.base_beta, "measured_beta": self.measured_beta, "beta": beta}
        plain = {key: one and one._asdict() for key, one in strengths.items()}
        return {"tau_s": self.tau_s, "from": self.came_from, **plain}


def update_relaxation(
    resin: Resin, measured: Sequence[ResinArm], ratio: float, seen_s: tuple[float, float]
) -> tuple[Resin, tuple[ArmUpdate, ...]]:
    """Put measured arms into a resin; also what became of each arm."""
    left = {at: _carried(column) for at, column in enumerate(resin.draw(DRAWS).beta(ratio).T)}
    updates = []
    for arm in sorted(measured, key=lambda one: one.tau_s.value):
        distances = ((abs(math.log(resin.arms[at].tau_s.value / arm.tau_s.value)), at) for at in left)
        off, near = min(distances, default=(math.inf, 0))
        known = left[near] if off <= math.log(SAME_TIME) else None
        if known is not None:
            del left[near]
        updates.append(_measured(arm, resin.arms[near] if known else None, known))
    updates += [_of_base(resin.arms[at], known, ratio, seen_s) for at, known in left.items()]
    updates.sort(key=lambda one: one.tau_s)
    arms = sorted((one.arm for one in updates if one.arm is not None), key=lambda arm: arm.tau_s.value)
    notices = (NOTE + one.notice for one in updates if one.notice)
    return replace(
        resin,
        arms=tuple(arms),
        relaxation_ratio_ref=ratio,
        prior_relaxation=resin.prior_relaxation or (resin.arms, resin.relaxation_ratio_ref),
        notes=tuple(dict.fromkeys([*resin.notes, *notices])),
    ), tuple(updates)


def _measured(arm: ResinArm, base: ResinArm | None, known: Interval | None) -> ArmUpdate:
    """A measured arm, with the base's nearest one and its strength at this ratio where there is one."""
    tau, beta = arm.tau_s, arm.beta
    own, notice = _of(beta), ""
    if base is None or known is None or base.beta.kind in GUESSES:
        value = _interval(math.log(own.value), log_spread(own))
        return ArmUpdate(tau.value, "measured", known, own, replace(arm, beta=_with(beta, value)))
    value, widening = _combined(known, own)
    tau = _with(tau, _combined(_of(base.tau_s), _of(tau))[0])
    if widening > 1.0:
        notice = (
            f"the strength at {tau.value:.3g} s, {beta.value:.3g}, differs from the one measured before "
            f"({known.value:.3g}); both were widened {widening:.1f} times so that they agree"
        )
    beta = replace(beta, source=f"{beta.source}; before ({base.beta.source}) by inverse variance of ln beta")
    return ArmUpdate(tau.value, "both", known, own, ResinArm(tau, _with(beta, value)), notice)


def _of_base(arm: ResinArm, known: Interval | None, ratio: float, seen_s: tuple[float, float]) -> ArmUpdate:
    """An arm of the base that no measured one replaces, with its strength at this ratio."""
    time, value = arm.tau_s.value, known or Interval(0.0, 0.0, 0.0)
    if seen_s[0] <= time <= seen_s[1]:
        return ArmUpdate(
            time, "gone", known, None, None, f"the base's arm at {time:g} s is replaced by the measured ones"
        )
    notice = (
        f"the base's arm at {time:g} s, {value.value:.3g} ({value.low:.3g} to {value.high:.3g}), is kept: "
        f"the presses show {seen_s[0]:.2g} to {seen_s[1]:.3g} s"
    )
    carried = replace(arm.beta, source=f"{arm.beta.source}; carried to ratio {ratio:g}")
    return ArmUpdate(time, "base", known, None, replace(arm, beta=_with(carried, value)), notice)


def _of(one: Quantity) -> Interval:
    return Interval(one.value, one.low, one.high)


def _with(one: Quantity, ends: Interval) -> Quantity:
    return replace(one, **ends._asdict())


def _carried(draws: np.ndarray) -> Interval | None:
    """Median and 95 % interval of a strength; None for an arm without any."""
    low, value, high = np.percentile(draws, [2.5, 50.0, 97.5]).tolist()
    return Interval(value, low, high) if value > 0.0 else None


def _interval(log_value: float, spread: float) -> Interval:
    return Interval(*(math.exp(log_value + k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0)))


def _combined(base: Interval, own: Interval) -> tuple[Interval, float]:
    """Posterior of a strength and the factor by which both were widened."""
    first, second = log_spread(base), log_spread(own)
    misfit = abs(math.log(base.value / own.value)) / math.hypot(first, second)
    widening = misfit if misfit > SURPRISE else 1.0
    weights = first**-2, second**-2
    centre = (weights[0] * math.log(base.value) + weights[1] * math.log(own.value)) / sum(weights)
    return _interval(centre, widening / math.sqrt(sum(weights))), widening

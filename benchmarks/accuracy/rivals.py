"""Rivals of the loop on the same campaigns: ``python -m benchmarks.accuracy.rivals --seed N --campaigns N``.

One contract: a rival gets a campaign and presses of new pads without their forces, and returns names, sizes with 95 %
intervals, the modulus with its interval, and forces on the new pads. All start from the base fit, noise model and force
law of the loop, so that only the choice of effects differs. Campaigns are drawn from both generators of the blind
studies, alternating in blocks of four: of four, two have one effect, one has two, one has none.

- ``omp``, ``lasso``, ``ard``: columns are the whitened changes of the bins by each effect at its usual size and at each
  start of its form, with base and law error projected out, as the loop screens them. Orthogonal matching pursuit and
  the LARS path of the LASSO choose by BIC, the noise variance from all columns; automatic relevance determination (a
  relevance vector machine on these columns) keeps what is three posterior standard deviations from zero. What is chosen
  is refitted together without linearisation.
- ``one_at_a_time``: every effect is fitted beside the base, the lowest BIC wins; then each of those that score two
  standard deviations or more beside it, if BIC falls.
- ``gaussian_process``: Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425: the residual is a Gaussian process of
  depth, speed, time since the stop, thickness and cycle; the modulus by generalised least squares with its covariance.
  It names nothing.
- ``emcee`` (``--emcee N``): the joint posterior of base, effects and law error of the loop's model, sampled.

Rows go to ``--rows``, one JSON object a campaign; ``rivals_page`` makes the page.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy import loop_campaigns, loop_independent_generator
from benchmarks.rows import keep_row, read_rows, scratch
from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.loop.calibration import Model, calibration_of
from dummydesign.loop.data.trials import Presses, make_presses
from dummydesign.loop.effects.registry import known_effects
from dummydesign.loop.fitting.candidates import (
    Projection,
    Screened,
    change_by,
    first_fit,
    modest,
    project,
    screen,
    starts_of,
)
from dummydesign.loop.fitting.fit import NORMAL_95, CampaignFit, fit_base, fit_with_noise, prior_precision
from dummydesign.loop.model.campaign_law import law_of, within_reach
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.forward_model import LAW_TERMS, readings
from dummydesign.loop.model.material import material_of
from dummydesign.loop.run import close_loop
from dummydesign.loop.selection.cross_validation import assess, effect_intervals
from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator, independent_generator

ROWS = Path(__file__).resolve().parents[1] / "results" / "loop_rivals_2500000.jsonl"
KINDS = ("one", "two", "one", "none")
BLOCK = len(KINDS)
STRIDE = 7  # of single effects through the vocabulary, so that few are of every kind
STRONGER = (1.0, 2.0)
"""Range of the size of a single effect over the usual one."""
MOST_NAMES, CLEAR_SD, WORTH_A_TRY = 4, 3.0, 2.0
GP_POINTS = 400
WALKERS_PER_DIMENSION, STEPS, BURN = 2, 400, 100

Put = list[tuple[str, float]]
Interval = list[float]
"""Low, value and high."""


@dataclass(frozen=True)
class Finding:
    """What a rival returns: names, likeliest first, sizes and modulus with 95 % intervals, forces per press. [N]"""

    names: tuple[str, ...]
    sizes: dict[str, Interval]
    young_kPa: Interval
    forces_N: list[NDArray]
    more: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Prepared:
    """What all rivals start from: presses, base fit and effects that the campaign can show; and the new pads."""

    campaign: Campaign
    new: Campaign
    base: CampaignFit
    effects: tuple[Effect, ...]

    @cached_property
    def usual(self) -> CampaignFit:
        """The base fit with contact scatter and law error of usual size, at which the loop screens."""
        return modest(self.base)

    @cached_property
    def screened(self) -> dict[str, Screened]:
        """Scores of all effects, best first."""
        return {one.effect.name: one for one in screen(self.usual, self.effects)}

    @cached_property
    def columns(self) -> tuple[Projection, NDArray, NDArray, list[str]]:
        """Projection, columns (n, p) of unit mean square, target (n,) and the effect of each column."""
        projection = project(self.usual)
        columns, names = [], []
        for effect in self.effects:
            for start in starts_of(effect):
                column = projection.remove(projection.column(change_by(self.usual, effect, start)))
                length = float(np.linalg.norm(column))
                if np.isfinite(length) and length > 1e-6:
                    columns.append(column / length * np.sqrt(len(column)))
                    names.append(effect.name)
        return projection, np.stack(columns, axis=1), projection.remove(projection.residual), names

    @cached_property
    def new_presses(self) -> tuple[Presses, Any]:
        """Presses and force law of the new pads."""
        return make_presses(self.new), law_of(self.new)

    def model_of(self, fit: CampaignFit) -> Model:
        """A fit as a model of other pads."""
        law = np.stack(np.split(fit.vector[fit.problem.fixed :], LAW_TERMS))
        return Model(fit.base, fit.active, fit.problem.presses.pads, law)

    def forces_of(self, model: Model) -> list[NDArray]:
        """Readings at the samples of the new pads. [N]"""
        presses, law = self.new_presses
        return [readings(presses, one, model.active) for one in presses.at_samples(model.nodes(presses, law))]

    def finding_of(self, fit: CampaignFit, names: tuple[str, ...]) -> Finding:
        """A fitted model with the intervals of its covariance."""
        sizes = {}
        for name in names:
            at = fit.problem.entries[name][0]
            size = next(one for one in fit.problem.effects if one.name == name).parameters[0]
            ends = [fit.vector[at] + k * NORMAL_95 * np.sqrt(fit.covariance[at, at]) for k in (-1.0, 0.0, 1.0)]
            low, value, high = (size.to_value(float(one)) for one in ends)
            sizes[name] = [min(low, high), value, max(low, high)]
        return Finding(names, sizes, young_of(fit), self.forces_of(self.model_of(fit)))


def young_of(fit: CampaignFit) -> Interval:
    """Modulus with the 95 % interval of the fit's covariance. [kPa]"""
    half = NORMAL_95 * float(np.sqrt(fit.covariance[0, 0]))
    return [1e3 * float(np.exp(fit.vector[0] + k * half)) for k in (-1.0, 0.0, 1.0)]


def prepare(campaign: Campaign, new: Campaign) -> Prepared:
    """Fit the base and see which effects the campaign can show."""
    law = law_of(campaign)
    campaign, presses, _ = within_reach(campaign, make_presses(campaign), law)
    base = fit_base(presses, law, 1e-3 * material_of(campaign).young_kPa.value)
    usable = [one for one in known_effects() if not (one.unavailable(presses, law) or one.unseen(presses))]
    return Prepared(campaign, new, base, tuple(usable))


def refit(data: Prepared, names: list[str]) -> Finding:
    """The effects of these names fitted together, each from where it scores best."""
    fit = data.usual
    for name in names:
        fit = first_fit(fit, data.screened[name])
    fit = fit_with_noise(fit.problem, fit.vector, fit.sizes, 2, 8) if names else data.base
    return data.finding_of(fit, tuple(names))


def distinct(names: list[str]) -> list[str]:
    """Each name once, the first :data:`MOST_NAMES`."""
    return list(dict.fromkeys(names))[:MOST_NAMES]


def omp(data: Prepared) -> Finding:
    """Orthogonal matching pursuit; the number of columns by BIC."""
    from sklearn.linear_model import orthogonal_mp

    _, columns, target, names = data.columns
    rows, count = columns.shape
    full = target - columns @ np.linalg.lstsq(columns, target, rcond=None)[0]
    variance = float(full @ full) / (rows - count)
    best, chosen = float(target @ target) / variance, np.zeros(0, int)
    for size in range(1, MOST_NAMES + 1):
        weights = np.ravel(orthogonal_mp(columns, target, n_nonzero_coefs=size))
        left = target - columns @ weights
        bic = float(left @ left) / variance + size * np.log(rows)
        if bic < best:
            best, chosen = bic, np.argsort(-np.abs(weights))[:size]
    return refit(data, distinct([names[at] for at in chosen]))


def lasso(data: Prepared) -> Finding:
    """LASSO along the LARS path; the penalty by BIC."""
    from sklearn.linear_model import LassoLarsIC

    _, columns, target, names = data.columns
    weights = LassoLarsIC(criterion="bic", fit_intercept=False).fit(columns, target).coef_
    order = [at for at in np.argsort(-np.abs(weights)) if weights[at] != 0.0]
    return refit(data, distinct([names[at] for at in order]))


def ard(data: Prepared) -> Finding:
    """Automatic relevance determination; what is clear of zero, strongest first."""
    from sklearn.linear_model import ARDRegression

    _, columns, target, names = data.columns
    machine = ARDRegression(fit_intercept=False).fit(columns, target)
    kept = np.flatnonzero(machine.lambda_ < machine.threshold_lambda)
    spread = np.full(len(names), np.inf)
    spread[kept] = np.sqrt(np.diag(machine.sigma_))
    clear = np.abs(machine.coef_) / spread
    order = [at for at in np.argsort(-np.abs(machine.coef_)) if clear[at] >= CLEAR_SD]
    return refit(data, distinct([names[at] for at in order]))


def one_at_a_time(data: Prepared) -> Finding:
    """Every effect fitted alone, the best by BIC; then every other one beside it."""
    count = np.log(float(data.base.problem.presses.used.sum()))
    fit, best, names = data.base, data.base.score, []
    for _ in range(2):
        usual = modest(fit)
        rest = [one for one in data.effects if one.name not in names]
        scored = [one for one in screen(usual, tuple(rest)) if not names or abs(one.z) >= WORTH_A_TRY]
        tried = [(one.effect.name, first_fit(usual, one)) for one in scored]
        if not tried:
            break
        known = sum(len(one.parameters) for one in fit.problem.effects)
        bics = {name: one.score + count * (known + len(one.problem.effects[-1].parameters)) for name, one in tried}
        name = min(bics, key=lambda one: bics[one])
        if bics[name] >= best:
            break
        best, names = bics[name], [*names, name]
        found = dict(tried)[name]
        fit = fit_with_noise(found.problem, found.vector, found.sizes, 2, 8)
    return data.finding_of(fit, tuple(names))


def gaussian_process(data: Prepared) -> Finding:
    """The residual as a Gaussian process; the modulus by generalised least squares."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    fit, presses = data.base, data.base.problem.presses
    middle = 0.5 * (presses.bins.start + presses.bins.end)
    place = np.argwhere(presses.used & (presses.measure(presses.displacement_mm) > 0.0))
    chosen = place[np.sort(np.random.default_rng(0).permutation(len(place))[:GP_POINTS])].T
    rows, at = chosen
    inputs = _factors(presses, rows, presses.measure(presses.displacement_mm)[rows, at], middle[rows, at])
    shift, scale = inputs.mean(axis=0), inputs.std(axis=0) + 1e-9
    floor = fit.sizes.floor_N
    residual, inputs = fit.residual[rows, at] / floor, (inputs - shift) / scale
    kernel = ConstantKernel(1.0, (1e-3, 1e4)) * RBF(np.ones(inputs.shape[1]), (0.05, 1e3)) + WhiteKernel(1.0)
    process = GaussianProcessRegressor(kernel, random_state=0).fit(inputs, residual)
    joint = process.kernel_(inputs)
    # the base and the law error move with the process: those of a fit are not those of nature
    keep = np.r_[: fit.problem.base_count, fit.problem.fixed : len(fit.vector)]
    slopes = fit.jacobian[rows, at][:, keep] / floor
    prior = prior_precision(fit.problem, fit.sizes)[keep]
    turned = np.linalg.solve(joint, slopes)
    covariance = np.linalg.pinv(slopes.T @ turned + np.diag(prior), hermitian=True)
    low, high = (ends[keep] for ends in fit.problem.bounds())
    step = covariance @ (turned.T @ residual - prior * fit.vector[keep])
    # a clock that is late asks for arms that no fit would allow
    moved = np.clip(fit.vector[keep] + step, low, high) - fit.vector[keep]
    vector = fit.vector.copy()
    vector[keep] += moved
    half = NORMAL_95 * float(np.sqrt(covariance[0, 0]))
    young = [1e3 * float(np.exp(vector[0] + k * half)) for k in (-1.0, 0.0, 1.0)]
    model = Model(
        fit.problem.base_of(vector),
        (),
        presses.pads,
        np.stack(np.split(vector[fit.problem.fixed :], LAW_TERMS)),
    )
    weights = np.linalg.solve(joint, residual - slopes @ moved)
    smooth, (new, _) = process.kernel_.k1, data.new_presses
    forces = []
    for row, (trial, force) in enumerate(zip(new.trials, data.forces_of(model))):
        depth = trial.trace.displacement_mm
        here = _factors(new, np.full(len(depth), row), depth, trial.trace.time_s)
        more = smooth((here - shift) / scale, inputs) @ weights * floor
        forces.append(force + np.where(depth > 0.0, more, 0.0))
    return Finding((), {}, young, forces)


def _factors(presses: Presses, rows: NDArray, depth_mm: NDArray, time_s: NDArray) -> NDArray:
    """Depth, and the logarithms of speed, time since the stop and thickness, and cycles of the pad (n, 5)."""
    speed = np.array([trial.velocity_mm_s for trial in presses.trials])
    cycles = (presses.history.earlier_depth_mm > 0.0).sum(axis=1)
    since = np.clip(time_s - presses.stop_s[rows], 1e-3, None)
    return np.stack(
        [depth_mm, np.log(speed)[rows], np.log(since), np.log(presses.thickness_mm)[rows], cycles[rows]], axis=1
    )


def loop(data: Prepared) -> Finding:
    """The loop itself."""
    result = close_loop(data.campaign)
    calibration = calibration_of(result)
    assert calibration.posterior is not None
    sizes = {}
    for one in result.effects:
        size = next(iter(effect_intervals(result.after, one.candidate.effect).values()))
        sizes[one.candidate.effect.name] = [size["low"], size["value"], size["high"]]
    low, high = calibration.posterior.interval("log young_kPa")
    value = 1e3 * result.after.fit.base.young_MPa
    more = {
        "verdict": result.verdict,
        "learned": None if result.learnt is None else result.learnt.effect.shape.name,
        "warnings": [one["code"] for one in result.warnings],
    }
    return Finding(tuple(sizes), sizes, [low, value, high], data.forces_of(calibration.after), more)


RIVALS: dict[str, Callable[[Prepared], Finding]] = {
    "loop": loop,
    "omp": omp,
    "lasso": lasso,
    "ard": ard,
    "one_at_a_time": one_at_a_time,
    "gaussian_process": gaussian_process,
}


def draw(number: int, seed: int) -> tuple[str, str, Put]:
    """Kind, generator and what is put into a campaign; single effects take turns through the vocabulary."""
    block, place = divmod(number, BLOCK)
    kind, maker = KINDS[place], ("first", "other")[block % 2]
    if kind == "none":
        return kind, maker, []
    if kind == "two":
        put = loop_campaigns.draw(kind, 0, seed) if maker == "first" else loop_independent_generator.draw(kind, 0, seed)
        return kind, maker, list(put)
    sizes = campaign_generator.SIZES if maker == "first" else independent_generator.SIZES
    names = list(independent_generator.SIZES)
    name = names[STRIDE * (block * KINDS.count("one") + KINDS[:place].count("one")) % len(names)]
    if name not in sizes:
        maker, sizes = "other", independent_generator.SIZES
    return kind, maker, [(name, sizes[name] * float(np.random.default_rng([seed, 31]).uniform(*STRONGER)))]


def write(maker: str, put: Put, seed: int, folder: Path) -> tuple[float, float]:
    """Write a campaign and one on new pads; return the noise floor [N] and the modulus [kPa]."""
    if maker == "first":
        first, more = (put[0], tuple(put[1:])) if put else (("none", 0.0), ())
        campaign_generator.write_campaign(folder / "b", *first, seed, held_out=True, more=more)
        truth = campaign_generator.write_campaign(folder / "a", *first, seed, more=more)
        return truth.floor_N, truth.young_kPa
    independent_generator.write_campaign(folder / "b", tuple(put), seed, held_out=True)
    other = independent_generator.write_campaign(folder / "a", tuple(put), seed)
    return other.floor_N, other.young_kPa


@one_blas_thread()
def run_one(number: int, seed: int, folder: Path) -> dict[str, Any]:
    """One campaign with all rivals."""
    kind, maker, put = draw(number, seed)
    floor, young = write(maker, put, seed, folder)
    campaign, new = read_campaign(folder / "a"), read_campaign(folder / "b")
    measured = [trial.trace.force_N for trial in new.trials]
    data = prepare(campaign, new)
    base = assess(data.base)
    row: dict[str, Any] = {
        "seed": seed,
        "kind": kind,
        "generator": maker,
        "put": put,
        "floor_N": floor,
        "young_kPa": young,
        "base_heldout_N": base.errors.heldout_N,
        "base_rmse_N": rmse(data.forces_of(data.model_of(data.base)), measured),
        "rivals": {},
    }
    for name, rival in RIVALS.items():
        began = time.process_time()
        found = rival(data)
        row["rivals"][name] = {
            "names": list(found.names),
            "sizes": found.sizes,
            "young_kPa": found.young_kPa,
            "rmse_N": rmse(found.forces_N, measured),
            "cpu_s": round(time.process_time() - began, 1),
            **found.more,
        }
    return row


def rmse(modelled: list[NDArray], measured: list[NDArray]) -> float:
    """Root mean square error over all samples. [N]"""
    return float(np.sqrt(np.mean(np.concatenate([(a - b) ** 2 for a, b in zip(modelled, measured)]))))


@one_blas_thread()
def sample_posterior(number: int, seed: int, folder: Path) -> dict[str, Any]:
    """Half widths of modulus and first size by emcee, and those that the loop states, of one campaign."""
    import emcee

    kind, maker, put = draw(number, seed)
    _, young = write(maker, put, seed, folder)
    result = close_loop(read_campaign(folder / "a"))
    posterior = calibration_of(result).posterior
    assert posterior is not None
    fit = result.after.fit
    problem, used = fit.problem, fit.problem.presses.used
    whiten = fit.whitener
    prior = prior_precision(problem, fit.sizes)
    low, high = problem.bounds()

    def log_probability(vector: NDArray) -> float:
        if np.any(vector < low) or np.any(vector > high):
            return -np.inf
        error = whiten(np.where(used, problem.predict(vector) - problem.presses.force_N, 0.0))
        value = -0.5 * float((error**2).sum() + (prior * vector**2).sum())
        return value if np.isfinite(value) else -np.inf

    began, rng, count = time.process_time(), np.random.default_rng(seed), len(fit.vector)
    root = np.linalg.cholesky(fit.covariance + 1e-12 * np.eye(count))
    walkers = WALKERS_PER_DIMENSION * count + 2
    start = np.clip(fit.vector + 0.5 * rng.standard_normal((walkers, count)) @ root.T, low + 1e-6, high - 1e-6)
    sampler = emcee.EnsembleSampler(walkers, count, log_probability)
    sampler.random_state = np.random.RandomState(seed % 2**31).get_state()
    sampler.run_mcmc(start, STEPS)
    chain = sampler.get_chain(discard=BURN, flat=True)
    ends = np.exp(np.quantile(chain[:, 0], [0.025, 0.5, 0.975])) * 1e3
    steps = float(sampler.get_autocorr_time(quiet=True, tol=0)[0])
    return {
        "seed": seed,
        "kind": kind,
        "put": put,
        "named": [one.candidate.effect.name for one in result.effects],
        "young_kPa": young,
        "emcee_kPa": ends.tolist(),
        "fit_kPa": young_of(fit),
        "loop_kPa": list(posterior.interval("log young_kPa")),
        "autocorrelation_steps": steps,
        "steps": STEPS,
        "cpu_s": round(time.process_time() - began, 1),
    }


def main() -> None:
    """Run what is missing."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=2500000)
    parser.add_argument("--campaigns", type=int, default=48)
    parser.add_argument("--part", type=int, nargs=2, default=(0, 1), metavar=("K", "N"), help="each N-th from K")
    parser.add_argument("--emcee", type=int, default=0, metavar="N", help="sample the first N campaigns with effects")
    parser.add_argument("--rows", type=Path, default=ROWS)
    options = parser.parse_args()
    known = {(row["seed"], "emcee_kPa" in row) for row in read_rows(options.rows)}
    numbers = list(range(options.campaigns))
    if options.emcee:
        numbers = [one for one in numbers if KINDS[one % BLOCK] != "none"][: options.emcee]
    for number in numbers[options.part[0] :: options.part[1]]:
        seed = options.seed + number
        if (seed, bool(options.emcee)) in known:
            continue
        with scratch("rivals-") as folder:
            row = (sample_posterior if options.emcee else run_one)(number, seed, folder)
        keep_row(options.rows, row)
        shown = {
            name: [one["names"], round(one["rmse_N"] / row["floor_N"], 2), one["cpu_s"]]
            for name, one in row.get("rivals", {}).items()
        }
        print(seed, row["put"], json.dumps(shown or row), file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()

"""Campaigns of the loop's blind study: what is put into each, one run of the loop, and what is kept of it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.inference.noise import Noise
from dummydesign.loop.calibration import Calibration, calibration_of
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.noise import make_whitener
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.result import LoopResult
from dummydesign.loop.run import (
    close_loop,
    replay,
)
from dummydesign.loop.selection.cross_validation import effect_intervals
from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator as generator

ROOT = Path(__file__).resolve().parents[2]

Put = list[tuple[str, float]]

FLOORS = {
    "contact_offset": 9.8,
    "punch_tilt": 4.4,
    "rate_dependent_viscosity": 2.3,
    "fast_relaxation_mode": 1.8,
    "strain_dependent_relaxation": 1.2,
    "softening_with_cycles": 4.4,
    "incomplete_recovery": 2.2,
    "temperature": 4.5,
    "ageing": 3.8,
    "inertia": 3.6,
    "friction_hysteresis": 1.1,
    "force_bias": 1.2,
    "adhesion": 1.0,
    "sensor_lag": 39.0,
    "time_skew": 31.0,
}
"""Noise floors that each effect of its usual size leaves to the base model beyond noise on left-out conditions (median
of three sizes). Left out are those that the force law's own error takes up: their size would leave the range in which
they are small (compliance, slip, compressibility, thickness, stiffening, slow mode, drift)."""
LEAST, MOST = 3.0, 8.0
STRENGTHS = (1.0, 2.0, 0.5)
"""Sizes of single effects over the usual one."""
COUNTS = {"none": 0, "one": 1, "two": 2, "three": 3}
KINDS = (*COUNTS, "unnamed")
VISIBLE = "visible"
"""Kind of a study of its own: one effect of 3 to 8 noise floors, of those of :data:`FLOORS` in turn."""
REFUSED = "refused"
"""Kind of a campaign that the reader refuses: it counts in no rate and is listed."""
ROUND = (
    "two one none unnamed three two one none two unnamed one none two "
    "three one none unnamed two one none two three one none unnamed"
).split()
"""Kinds of campaign in the order they are run, as 6 none : 6 one : 6 two : 3 three : 4 unnamed: wherever the study is
stopped, what was run is a fair sample."""
PADS, POSITION_MM, USUAL = (0.007, 0.01, 0.005), 0.004, 2.5
"""Level, slope and curvature by which newly cast pads of the generator differ, its contact scatter (standard
deviations), and how many of them count as usual."""


def kind_of(number: int) -> tuple[str, int]:
    """Kind of a campaign of the study, and how many of the kind come before it."""
    kind = ROUND[number % len(ROUND)]
    before = ROUND[: number % len(ROUND)].count(kind) + number // len(ROUND) * ROUND.count(kind)
    return kind, before


def draw(kind: str, before: int, seed: int) -> Put:
    """Names and sizes of what is put into a campaign.

    Single effects take turns through the whole vocabulary, at the usual size, doubled and halved; unnamed ones take
    turns at the usual size and doubled. Two and three are drawn from :data:`FLOORS`, each of a size that alone would
    leave 3 to 8 noise floors.
    """
    rng = np.random.default_rng([seed, 77])
    if kind in ("two", "three"):
        names = rng.choice(sorted(FLOORS), COUNTS[kind], replace=False)
        return [(str(n), generator.SIZES[n] * float(rng.uniform(LEAST, MOST)) / FLOORS[n]) for n in names]
    if kind == "none":
        return []
    if kind == VISIBLE:
        name = sorted(FLOORS)[before % len(FLOORS)]
        return [(name, generator.SIZES[name] * float(rng.uniform(LEAST, MOST)) / FLOORS[name])]
    usual = generator.SIZES if kind == "one" else generator.UNKNOWN
    strengths = STRENGTHS if kind == "one" else STRENGTHS[:2]
    name = list(usual)[before % len(usual)]
    return [(name, usual[name] * strengths[before // len(usual) % len(strengths)])]


def run_one(kind: str, before: int, seed: int, folder: Path) -> dict:
    """Make a campaign and one on new pads, run the loop, predict the second; one that is refused is kept as that."""
    put_in = draw(kind, before, seed)
    try:
        return {"seed": seed, "kind": kind, **learned(put_in, seed, folder)}
    except InputError as problem:
        message = str(problem).partition("; ")[0]
        return {
            "seed": seed,
            "kind": REFUSED,
            "effects": [n for n, _ in put_in],
            "sizes": [s for _, s in put_in],
            "verdict": REFUSED,
            "found": [],
            "cpu_seconds": 0.0,
            "iterations": 0,
            "message": message,
        }


def learned(
    put_in: Put, seed: int, folder: Path, crowned: bool = False, edge_mm: float = 0.0, declared: bool = True
) -> dict:
    """Write a campaign with these effects and one on new pads, run the loop, predict the second.

    With ``crowned`` the generator's pads are crowned; their punch may have a fillet, declared or not.
    """
    first, more = (put_in[0], tuple(put_in[1:])) if put_in else (("none", 0.0), ())
    own: dict[str, Any] = {"more": more, "crowned": crowned, "edge_mm": edge_mm, "declared": declared}
    truth = generator.write_campaign(folder / "a", *first, seed, **own)
    generator.write_campaign(folder / "b", *first, seed, held_out=True, **own)
    campaign, started = read_campaign(folder / "a"), time.process_time()
    result = close_loop(campaign)
    row = row_of(put_in, truth, result, time.process_time() - started)
    other, calibration = read_campaign(folder / "b"), calibration_of(result)
    assert calibration.posterior is not None
    predicted = replay(other, calibration)
    beyond = beyond_pads_N(other, calibration, predicted.total_rmse_N, result.after.fit.sizes.noise)
    return {
        **row,
        "replay": [predicted.total_base_rmse_N, predicted.total_rmse_N, beyond],
        "young": [truth.young_kPa, *calibration.posterior.interval("log young_kPa")],
    }


def row_of(put_in: Put, truth: generator.Truth, result: LoopResult, seconds: float) -> dict:
    """What is kept of one campaign."""
    names = [accepted.candidate.effect.name for accepted in result.effects]
    intervals = {}
    for accepted in result.effects:
        size = next(iter(effect_intervals(result.after, accepted.candidate.effect).values()))
        intervals[accepted.candidate.effect.name] = [size["low"], size["value"], size["high"]]
    return {
        "effects": [name for name, _ in put_in],
        "sizes": [size for _, size in put_in],
        "floor": truth.floor_N,
        "verdict": result.verdict,
        "found": names,
        "intervals": intervals,
        "confounded": [list(accepted.confounded_with) for accepted in result.effects],
        "evidence": [round(accepted.candidate.gain, 1) for accepted in result.effects],
        "ranking": [c.effect.name for c in result.selection.ranking[:5]],
        "heldout": [result.base.errors.heldout_N, result.after.errors.heldout_N],
        "expected": result.remainder.expected,
        "lack": [result.after.lack.ratio, result.after.lack.p],
        "where": [(one.factor, round(one.excess, 1)) for one in result.seen.where[:3]],
        "reasons": list(result.remainder.reasons),
        "cpu_seconds": round(seconds, 1),
        "iterations": result.budget.iterations,
    }


def beyond_pads_N(campaign: Campaign, calibration: Calibration, total_N: float, noise: Noise) -> float:
    """Error of a prediction on new pads without what those pads' own law error and the contact scatter make. [N]

    Each pad's level, slope and curvature, and each trial's shift, are fitted to the residual with priors of the
    sizes that the generator draws from, and count up to :data:`USUAL` of them: more is not of the pads.
    """
    presses, model = make_presses(campaign), calibration.after
    problem = CampaignProblem(presses, law_of(campaign), tuple(one.effect for one in model.active))
    sizes = [p.to_coordinate(one.values[p.name]) for one in model.active for p in one.effect.parameters]
    error = model.law_error(np.array([thickness for _, thickness in presses.pads]))
    vector = np.r_[model.base.to_logs(), sizes, error.terms.ravel()]
    forces = problem.predict(vector)
    residual = np.where(presses.used, presses.force_N - forces, 0.0)
    smooth = slice(problem.fixed, problem.law_entries(len(PADS)).start)
    pads = problem.spread(problem.jacobian(vector, forces))[..., smooth] * presses.used[..., None]
    slope = np.where(presses.used, problem.slope(vector, forces), 0.0)
    scattered = Noise(noise.white_N, noise.slow_N, noise.slow_time_s, POSITION_MM)
    whiten = make_whitener(presses, scattered, (slope,), (POSITION_MM,))
    columns, white = whiten(pads).reshape(-1, pads.shape[-1]), whiten(residual).ravel()
    prior = np.diag(np.repeat(np.array(PADS) ** -2.0, len(presses.pads)))
    own = np.linalg.solve(columns.T @ columns + prior, columns.T @ white)
    reach = USUAL * np.repeat(np.array(PADS), len(presses.pads))
    left = residual - pads @ np.clip(own, -reach, reach)
    whiten = make_whitener(presses, scattered)
    steep, white = whiten(slope), whiten(left)
    shift = (steep * white).sum(axis=1) / ((steep**2).sum(axis=1) + POSITION_MM**-2)
    shift = np.clip(shift, -USUAL * POSITION_MM, USUAL * POSITION_MM)
    left = left - shift[:, None] * slope
    removed = np.average(residual**2 - left**2, weights=presses.samples * presses.used)
    return float(np.sqrt(max(total_N**2 - removed, 0.0)))

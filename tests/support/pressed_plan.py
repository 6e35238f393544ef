"""Press what ``campaign new`` planned: simulated traces under the planned names, seeded.

``python -m tests.support.pressed_plan DIR [--seed N] [--coarse]`` fills a campaign folder; force by the base law with
two arms and a slow noise, recorded from above the surface as a robot would. ``--coarse`` saves fewer samples.
"""

from __future__ import annotations

import argparse
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np

from dummydesign.api.campaigns import _empty_campaign
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import start_vector
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.campaign_law import law_without_solve, pad_of
from dummydesign.loop.planning import planned_trials
from dummydesign.measurement.campaign_file import SetUp
from dummydesign.measurement.campaign_plan import Planned
from dummydesign.measurement.sensor import parse_lowpass


def press_campaign(folder: Path, seed: int = 1, young_kPa: float | None = None, coarse: bool = False) -> None:
    """Write the traces of a planned campaign; a temperature is written down for each press."""
    path = folder / "campaign.toml"
    text = path.read_text(encoding="utf-8")
    data = tomllib.loads(text)
    pad, sensor = data["pad"], data["sensor"]
    lowpass = f"{sensor['lowpass_hz']:g}" if "lowpass_hz" in sensor else None
    young, ratio = pad.get("young_kPa_nominal", 25.0), pad.get("ratio")
    set_up = SetUp(data["name"], young, ratio=ratio, lowpass=parse_lowpass(lowpass))
    plan = tuple(
        Planned(
            t["file"],
            t["thickness_mm"],
            t["velocity_mm_s"],
            t.get("target_force_N", t.get("target_depth_mm")),
            "target_depth_mm" in t,
            t["repeat"],
            t["sequence"],
            t["age_days"],
            t["rest_s"],
            t["hold_s"],
            t["unload"],
        )
        for t in data["trial"]
    )
    young = 1e-3 * (young_kPa or set_up.young_kPa)
    draw = np.random.default_rng([seed, 77])
    campaign = _empty_campaign(set_up, set_up.tables())
    heights = sorted({row.thickness_mm for row in plan})
    law = law_without_solve(pad_of(campaign, h, 1.0, campaign.pad.geometry) for h in heights)
    trials = planned_trials(plan, law, young, draw)
    if coarse:
        trials = tuple(replace(t, trace=_thinned(t)) for t in trials)
    presses = make_presses(replace(campaign, trials=trials))
    problem = CampaignProblem(presses, law)
    nodes = problem.nodes(start_vector(problem, young))
    for trial, force in zip(trials, presses.at_samples(nodes)):
        trace = trial.trace
        time = trace.time_s[: len(force)] if len(force) < len(trace.time_s) else trace.time_s
        x = np.interp(time, trace.time_s, trace.displacement_mm)
        slow = 0.01 * np.interp(time, np.linspace(time[0], time[-1], 12), draw.normal(size=12))
        noisy = force + slow + draw.normal(0.0, 0.02, len(time))
        rows = np.column_stack([time - time[0], x, noisy])
        np.savetxt(folder / trial.file, rows, "%.4f", ",", header="time_s,displacement_mm,force_N", comments="")
    for trial in trials:
        head, found, tail = text.partition(f'file = "{trial.file}"')
        text = head + found + tail.replace("# temperature_C =", f"temperature_C = {trial.temperature_C:.1f}", 1)
    path.write_text(text, encoding="utf-8")


def _thinned(trial):
    trace = trial.trace
    keep = np.ones(len(trace.time_s), bool)
    late = trace.time_s > trace.time_s[np.argmax(trace.displacement_mm > 0.99 * trace.displacement_mm.max())] + 0.05
    keep[late] = np.arange(int(late.sum())) % 3 == 0
    keep[-1] = True
    return replace(
        trace, time_s=trace.time_s[keep], displacement_mm=trace.displacement_mm[keep], force_N=trace.force_N[keep]
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--young", type=float)
    parser.add_argument("--coarse", action="store_true")
    options = parser.parse_args()
    press_campaign(options.folder, options.seed, options.young, options.coarse)

"""Blind check of the verdict: ``python benchmarks/verdict_blind.py``. Simulated castings only; some 5 s each.

Pads of designs for the built-in tissues are cast with errors of weighing, thickness and what is not known of the
resin, and pressed by the generator of tests/support (direct finite-element curves and an integrator of its own, which
share nothing with the design). The truth is the verdict on the generator's exact presses at 5, 10 and 15 N;
``compare`` sees six noisy traces. Rows are kept in ``--rows`` (one JSON object a line), so that a study can be stopped
and resumed; the table goes to ``--out``.

A casting is *near a border* when its true level is another one with all its forces 1 % larger or smaller, which is how
finely a steady force is set. ``compare`` *agrees* when its level is the true one, or when it leaves the casting
unsettled and the casting is near a border.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from dummydesign.design.scoring.standing import ranges_of  # noqa: E402

from benchmarks.rows import keep_row, read_rows  # noqa: E402
from dummydesign.design.assessment.pour_yield import Tolerances, draw_pours  # noqa: E402
from dummydesign.design.assessment.verdict_of_traces import verdict_of_traces  # noqa: E402
from dummydesign.design.inputs import resolve  # noqa: E402
from dummydesign.design.request import Request  # noqa: E402
from dummydesign.design.scoring.verdict import Readings, levels  # noqa: E402
from dummydesign.design.suggest import suggest  # noqa: E402
from dummydesign.measurement.trace import Trace  # noqa: E402
from dummydesign.tissue.comparison.compare import compare_traces  # noqa: E402
from tests.support.campaign_press import Pad, Physics, pad_force  # noqa: E402

TISSUES = ("forefinger", "palm", "thenar")
CROWN = "crowned:radius=20,height=3,foot=11"
FORCES_N, VELOCITIES_MM_S = np.array([5.0, 10.0, 15.0]), np.array([10.0, 250.0])
HOLD_S, BRAKING_MM_S2 = 10.0, 30_000.0
NOISE_N, REPEATS_MM, ZERO_MM, LEVEL = 0.02, 0.01, 0.005, 0.005
"""Standard deviations: noise of a sample, where the robot stops, where depth begins, and the pad's own level."""
BORDER = 0.01
DRAWN, ATTEMPTS = 4000, 12


def motion(velocity: float, depth: float, zero: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Ramp at constant speed, constant braking, hold; 150 samples in the rise, then ever coarser. [s, mm]"""
    brake = min(velocity / BRAKING_MM_S2, 2.0 * depth / velocity)
    stop = (depth + 0.5 * velocity * brake) / velocity
    step = stop / 150.0
    lead = np.arange(-20, 0) * step
    rise = np.arange(150) * step
    hold = stop + np.r_[np.arange(20) * step, np.geomspace(20.0 * step, HOLD_S, 100)]
    when = np.r_[lead, rise, hold[hold > rise[-1]]]
    left = np.maximum(stop - when, 0.0)
    x = np.where(when < stop - brake, velocity * when, depth - 0.5 * velocity / brake * left**2)
    return when - lead[0], x + zero


def press(casting: dict, velocity: np.ndarray, depth: np.ndarray, zero: float = 0.0) -> list[tuple]:
    """Times, depths and exact forces of presses, side by side in the generator."""
    moves = [motion(v, d, 0.0) for v, d in zip(velocity, depth)]
    longest, count = max(len(move[0]) for move in moves), len(moves)
    times, x = np.empty((count, longest)), np.empty((count, longest))
    for row, (when, place) in enumerate(moves):
        extra = longest - len(when)
        times[row] = np.r_[when, when[-1] + 1e-3 * np.arange(1, extra + 1)]
        x[row] = np.r_[place, np.full(extra, place[-1])]
    one = np.ones(count)
    pad = Pad(casting["thickness_mm"] * one, casting["pad_level"] * one, 0.0 * one, crown=casting["crown"])
    tau, beta = (np.repeat(np.array(casting[name])[:, None], count, 1) for name in ("tau_s", "beta"))
    physics = Physics(casting["young_MPa"] * one, tau, beta, pad, zero * one)
    force = pad_force(times, x, np.zeros(x.shape, bool), physics)
    return [(when, place, force[row, : len(when)]) for row, (when, place) in enumerate(moves)]


def depth_for(casting: dict, wanted: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Depths at which presses end at the wanted forces; NaN beyond 0.45 of the thickness, where curves end. [mm]"""
    limit = 0.45 * casting["thickness_mm"]
    tried = np.linspace(0.04, 1.0, 14) * limit
    found = np.full(len(wanted), np.nan)
    for speed in np.unique(velocity):
        ends = np.array([force[-1] for *_, force in press(casting, np.full(len(tried), speed), tried)])
        here = velocity == speed
        found[here] = np.exp(np.interp(np.log(wanted[here]), np.log(ends), np.log(tried), left=np.nan, right=np.nan))
    return found


def truth_of(casting: dict, targets) -> tuple[Readings, np.ndarray]:
    """Exact readings of a casting, and the depths of its six presses."""
    force, velocity = np.tile(FORCES_N, 2), np.repeat(VELOCITIES_MM_S, 3)
    depth = depth_for(casting, force, velocity)
    peak, energy = np.full(6, np.nan), np.full(6, np.nan)
    known = np.isfinite(depth)
    if known.any():
        for at, (_, x, pressed) in zip(np.nonzero(known)[0], press(casting, velocity[known], depth[known])):
            peak[at] = pressed.max()
            energy[at] = float((0.5 * (pressed[1:] + pressed[:-1]) * np.diff(x)).sum())
    grid = targets.protocol.steady_grid_N
    return Readings(peak, energy, depth_for(casting, grid, np.full(len(grid), VELOCITIES_MM_S[0]))), depth


def traces_of(casting: dict, depth: np.ndarray, rng: np.random.Generator) -> list[Trace]:
    """What a laboratory saves of the six presses."""
    velocity = np.repeat(VELOCITIES_MM_S, 3)
    reached = depth + REPEATS_MM * rng.standard_normal(len(depth))
    zero = ZERO_MM * rng.standard_normal()
    traces = []
    for number, (when, x, force) in enumerate(press(casting, velocity, reached, zero)):
        traces.append(Trace(f"press-{number}", when, x, force + NOISE_N * rng.standard_normal(len(when))))
    return traces


def designs() -> list[tuple]:
    """Slabs and pads of one crown, designed for each tissue: tissue, shape, thickness, ratio, resin."""
    found = []
    for tissue in TISSUES:
        for shape in ("slab", CROWN):
            if shape == CROWN and tissue == "forefinger":
                continue  # as high as this crown is, no pad of it is thin enough for a forefinger
            answer = suggest(Request(tissue, shape=shape, verify=False))
            for design in (answer.recommended, *answer.alternatives):
                thickness = design.candidate.thickness_mm
                if 5.0 <= thickness <= 20.0 and (shape == "slab" or 6.8 <= thickness <= 14.2):
                    found.append((tissue, shape, thickness, design.candidate.ratio, answer.resin))
    return found


def cast(number: int, attempt: int, design: tuple, seed: int) -> dict:
    """One casting of a design."""
    tissue, shape, thickness, ratio, resin = design
    pours, _ = draw_pours(resin, thickness, ratio, Tolerances(110.0), DRAWN, seed)
    rng = np.random.default_rng((seed, number, attempt))
    at = int(rng.integers(DRAWN))
    return {
        "number": number, "attempt": attempt, "tissue": tissue, "shape": shape, "crown": shape == CROWN, "ratio": ratio,
        "thickness_mm": float(pours.thickness_mm[at]), "young_MPa": float(pours.young_MPa[at]),
        "tau_s": [arm.tau_s.value for arm in resin.arms], "beta": pours.beta[at].tolist(),
        "pad_level": LEVEL * float(rng.standard_normal()),
    }  # fmt: skip


def pressable(number: int, known: list[tuple], targets: dict, seed: int) -> tuple[dict, Readings, np.ndarray]:
    """The first casting of a design, or of the next design, that reaches all forces within the generator's curves."""
    for attempt in range(ATTEMPTS * len(known)):
        casting = cast(number, attempt, known[(number + attempt // ATTEMPTS) % len(known)], seed)
        readings, depth = truth_of(casting, targets[casting["tissue"]])
        if np.isfinite(depth).all():
            return casting, readings, depth
    raise SystemExit("no casting of any design can be pressed")


def run_one(casting: dict, readings: Readings, depth: np.ndarray, targets, seed: int) -> dict:
    """Truth and answer of one casting."""
    started = time.process_time()
    ranges = ranges_of(targets)
    true = levels(ranges, readings)[0]
    near = {
        levels(ranges, Readings(readings.peak_N * (1 + s), readings.energy_mJ * (1 + s),
                                readings.depth_mm * (1 + s) ** (-1 / 3)))[0] for s in (-BORDER, BORDER)
    }  # fmt: skip
    rng = np.random.default_rng((seed, 7, casting["number"]))
    found = verdict_of_traces(compare_traces(traces_of(casting, depth, rng), targets.tissue), targets.tissue)
    unsettled = found.level == "mixed" and not found.low
    agrees = found.level == true or (unsettled and near != {true})
    row = {**casting, "true": true, "near_border": near != {true}, "level": found.level, "light": found.light,
           "unsettled": unsettled, "agrees": agrees, "text": found.text}  # fmt: skip
    return {**row, "cpu_seconds": round(time.process_time() - started, 2)}


def table(rows: list[dict]) -> str:
    """The study in Markdown."""
    pressed = rows
    same = sum(row["level"] == row["true"] for row in pressed)
    agree = sum(row["agrees"] for row in pressed)
    low = [row for row in pressed if row["true"] == "reads_low" or (row["true"] == "mixed")]
    wrong = sum(row["level"] == "inside" and row["true"] in ("reads_low", "mixed") for row in pressed)
    passed = sum(row["light"] != "red" and row["true"] == "reads_low" for row in pressed)
    lines = [
        "# Blind check of the verdict",
        "",
        "Written by `python benchmarks/verdict_blind.py`: " + (__doc__ or "").split("\n\n", 1)[1].replace("\n", " "),
        "",
        f"{len(rows)} castings; those that do not reach 15 N within 0.45 of their thickness, to where the generator's "
        "curves go, were drawn again.",
        "",
        f"- `compare` agrees with the truth in {agree} of {len(pressed)}; the level is the same in {same}.",
        f"- Of {len(low)} castings that read low or are mixed, {wrong} are called inside.",
        f"- Of {sum(row['true'] == 'reads_low' for row in pressed)} that read low, {passed} are not called red.",
        "",
        "| truth | " + " | ".join(LEVELS) + " |",
        "|---|" + "---|" * len(LEVELS),
    ]
    for true in LEVELS:
        count = Counter(row["level"] for row in pressed if row["true"] == true)
        lines.append(f"| {true} | " + " | ".join(str(count[level]) for level in LEVELS) + " |")
    others = [row for row in pressed if row["level"] != row["true"]]
    if others:
        lines += ["", "Those with another level than the true one:", ""]
        for row in others:
            border = "near a border" if row["near_border"] else "not near a border"
            what = f"{row['tissue']} {row['shape']}, truly {row['true']} ({border})"
            lines.append(f"- {row['number']}: {what}: {row['text']}")
    seconds = np.mean([row["cpu_seconds"] for row in rows]) if rows else 0.0
    return "\n".join([*lines, "", f"Processor time {seconds:.1f} s a casting."]) + "\n"


LEVELS = ("inside", "reads_low", "reads_high", "mixed", "poor")


def main() -> None:
    """Run what is missing of the study and write the table."""
    parser = argparse.ArgumentParser(description="Blind check of the verdict.")
    parser.add_argument("--castings", type=int, default=100)
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "verdict_blind.jsonl")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "verdict-blind.md")
    options = parser.parse_args()
    rows = read_rows(options.rows)
    known = {row["number"] for row in rows}
    targets = {name: resolve(Request(name, shape="slab", verify=False)).space.targets for name in TISSUES}
    known_designs = designs()
    for number in range(options.castings):
        if number in known:
            continue
        casting, readings, depth = pressable(number, known_designs, targets, options.seed)
        row = run_one(casting, readings, depth, targets[casting["tissue"]], options.seed)
        rows.append(row)
        keep_row(options.rows, row)
        print(row["number"], row["tissue"], row["true"], row.get("level"), row["near_border"], row["cpu_seconds"],
              file=sys.stderr, flush=True)  # fmt: skip
    options.out.write_text(table(sorted(rows, key=lambda row: row["number"])))


if __name__ == "__main__":
    main()

"""Blind study of the loop: ``python benchmarks/loop_blind.py``. Simulated campaigns only; about 15 s each.

Campaigns come from tests/support/campaign_generator.py, which shares no code with the effect classes. Every run is
kept in ``--rows`` (one JSON object a line), so that a study can be stopped and resumed; the table goes to ``--out``.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from dummydesign.loop.calibration import calibration_of  # noqa: E402
from dummydesign.loop.replay import replay  # noqa: E402
from dummydesign.loop.result import LoopResult  # noqa: E402
from dummydesign.loop.run import close_loop  # noqa: E402
from dummydesign.measurement.campaign_file import read_campaign  # noqa: E402
from tests.support import campaign_generator as generator  # noqa: E402

STRENGTHS = (1.0, 2.0, 0.5)
"""Usual size first, then doubled, then halved."""
WEAK = 0.25
"""Effects outside the vocabulary are also tried at a quarter of their usual size."""


def plan(options: argparse.Namespace) -> Iterator[tuple[str, float, int]]:
    """Effect, strength and seed of every campaign; kinds are interleaved so that a part is a fair sample."""
    seed = options.seed
    rounds = max(options.rounds, 1)
    nulls = 0
    for number in range(rounds):
        for strength in STRENGTHS:
            for effect in generator.SIZES:
                seed += 1
                yield effect, strength, seed
                if nulls < options.nulls and seed % 2 == 0:
                    nulls += 1
                    seed += 1
                    yield "none", 0.0, seed
            if strength == STRENGTHS[0]:
                for effect in generator.UNKNOWN:
                    for unknown_strength in (1.0, 2.0):
                        seed += 1
                        yield effect, unknown_strength, seed
        while number == rounds - 1 and nulls < options.nulls:
            nulls += 1
            seed += 1
            yield "none", 0.0, seed
        for effect in generator.UNKNOWN:
            seed += 1
            yield effect, WEAK, seed


def row_of(effect: str, strength: float, truth: generator.Truth, result: LoopResult, seconds: float) -> dict:
    """What is kept of one campaign."""
    first = result.effects[0] if result.effects else None
    names = [c.effect.name for c in result.ranking]
    parameters = {}
    if first is not None:
        one = next(a for a in result.after.fit.active if a.effect.name == first.candidate.effect.name)
        parameters = dict(one.values)
    return {
        "effect": effect, "strength": strength, "size": truth.size, "verdict": result.verdict,
        "found": [f.candidate.effect.name for f in result.effects],
        "named": [] if first is None else [first.candidate.effect.name, *first.confounded_with],
        "family": [] if first is None else list(first.family),
        "ranking": names[:5], "gains": [round(c.gain, 1) for c in result.ranking[:5]], "parameters": parameters,
        "heldout": [result.base.errors.heldout_N, result.after.errors.heldout_N], "floor": truth.floor_N,
        "lack": [result.base.lack.ratio, result.base.lack.p, result.after.lack.ratio, result.after.lack.p],
        "where": [(w.factor, round(w.excess, 1)) for w in result.where_after[:3]],
        "reasons": list(result.remainder.reasons), "seconds": round(seconds, 1),
        "sizes": result.after.fit.sizes.to_dict(),
    }  # fmt: skip


def run_one(effect: str, strength: float, seed: int, folder: Path) -> dict:
    """Make a campaign and its held-out partner, run the loop, predict the partner."""
    usual = {**generator.SIZES, **generator.UNKNOWN}.get(effect, 0.0)
    size = usual * strength
    truth = generator.write_campaign(folder / "a", effect, size, seed)
    generator.write_campaign(folder / "b", effect, size, seed, held_out=True)
    started = time.perf_counter()
    result = close_loop(read_campaign(folder / "a"))
    row = row_of(effect, strength, truth, result, time.perf_counter() - started)
    replayed = replay(read_campaign(folder / "b"), calibration_of(result))
    return {"seed": seed, **row, "replay": [replayed.total_base_rmse_N, replayed.total_rmse_N]}


def main() -> None:
    """Run what is missing of the study and write the table."""
    parser = argparse.ArgumentParser(description="Blind study of the loop.")
    parser.add_argument("--seed", type=int, default=20000, help="seeds count up from here")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--nulls", type=int, default=60)
    parser.add_argument("--limit", type=int, default=10**6, help="stop after this many campaigns")
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "loop_blind.jsonl")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "loop-blind.md")
    parser.add_argument("--only", nargs="*", help="effects to run")
    parser.add_argument("--table-only", action="store_true")
    options = parser.parse_args()
    done = [json.loads(line) for line in options.rows.read_text().splitlines()] if options.rows.exists() else []
    known = {row["seed"] for row in done}
    for number, (effect, strength, seed) in enumerate(plan(options)):
        if options.table_only or number >= options.limit:
            break
        if seed in known or (options.only and effect not in options.only):
            continue
        folder = Path(tempfile.mkdtemp(prefix="blind-"))
        try:
            row = run_one(effect, strength, seed, folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        done.append(row)
        with options.rows.open("a") as stream:
            stream.write(json.dumps(row) + "\n")
        print(effect, strength, seed, row["verdict"], row["found"], row["seconds"], file=sys.stderr, flush=True)
    options.out.write_text(table(done, generator.SIZES, generator.UNKNOWN))
    print(f"{len(done)} campaigns, table in {options.out}", file=sys.stderr)


def table(rows: list[dict], known: dict, unknown: dict) -> str:
    """The published table."""
    lines = ["# Blind study of the loop", ""]
    lines += ["Simulated campaigns only (tests/support/campaign_generator.py)."]
    lines += ["Made by `python benchmarks/loop_blind.py`;"]
    lines += ["one row per campaign is kept in benchmarks/loop_blind.jsonl.", ""]

    def share(count: int, total: int) -> str:
        return f"{count} / {total} ({100 * count / total:.0f} %)" if total else "-"

    inside = [r for r in rows if r["effect"] in known]
    nulls = [r for r in rows if r["effect"] == "none"]
    strange = [r for r in rows if r["effect"] in unknown]
    lines += ["| measure | all sizes | usual and doubled | halved | wanted |", "|---|---|---|---|---|"]
    big, half = [r for r in inside if r["strength"] >= 1], [r for r in inside if r["strength"] < 1]

    def measure(name: str, good, wanted: str) -> None:
        cells = [share(sum(map(good, group)), len(group)) for group in (inside, big, half)]
        lines.append(f"| {name} | {' | '.join(cells)} | {wanted} |")

    measure("right first, of all campaigns with an effect", lambda r: r["found"][:1] == [r["effect"]], ">= 80 %")
    measure("in the named set (first and at most two rivals)", lambda r: r["effect"] in r["named"], ">= 92 %")
    measure("best joint fit is the truth, whether or not accepted", lambda r: r["ranking"][:1] == [r["effect"]], "")
    measure("truth within the best three joint fits", lambda r: r["effect"] in r["ranking"][:3], "")
    measure("wrong effect first", lambda r: r["found"] != [] and r["found"][0] != r["effect"], "")
    measure("missed (nothing accepted)", lambda r: r["found"] == [] and r["verdict"] == "none", "")
    measure("called unexplained", lambda r: r["verdict"] == "unexplained", "")
    measure("right first, a second effect added", lambda r: r["found"][:1] == [r["effect"]] and len(r["found"]) > 1, "")
    false = sum(r["verdict"] != "none" for r in nulls)
    lines += ["", f"- false alarms (campaigns without an effect): {share(false, len(nulls))}; wanted <= 5 %"]
    for what, some in (("usual and doubled", [r for r in strange if r["strength"] >= 1]),
                       ("a quarter of the usual size", [r for r in strange if r["strength"] < 1])):  # fmt: skip
        flagged = sum(r["verdict"] == "unexplained" for r in some)
        lines.append(f"- unknown effects called unexplained, {what}: {share(flagged, len(some))}; wanted >= 75 %")
    right = [r for r in inside if r["found"][:1] == [r["effect"]]]
    lines += _errors("all campaigns with an effect of the vocabulary", inside)
    lines += _errors("those with the right effect first", right)
    lines += _errors("campaigns without an effect", nulls)
    lines += ["", "| effect | usual | doubled | halved | parameter error, median | read as, when wrong |",
              "|---|---|---|---|---|---|"]  # fmt: skip
    for name in known:
        own = [r for r in inside if r["effect"] == name]
        cells = []
        for strength in STRENGTHS:
            some = [r for r in own if r["strength"] == strength]
            cells.append(f"{sum(r['found'][:1] == [name] for r in some)} / {len(some)}")
        off = [_parameter_error(r) for r in own if r["found"][:1] == [name]]
        missed = [r for r in own if r["found"][:1] != [name]]
        wrong = sorted({r["found"][0] if r["found"] else f"({r['verdict']})" for r in missed})
        middle = f"{100 * np.median(off):.0f} %" if off else "-"
        lines.append(f"| {name} | {' | '.join(cells)} | {middle} | {', '.join(wrong)} |")
    lines += ["", "| outside the vocabulary | unexplained | otherwise read as | reasons given |", "|---|---|---|---|"]
    for name in unknown:
        own = [r for r in strange if r["effect"] == name]
        seen = sum(r["verdict"] == "unexplained" for r in own)
        other = sorted({(r["found"] or ["none"])[0] for r in own if r["verdict"] != "unexplained"})
        short = [reason.split(":")[0].split(" (")[0] for r in own for reason in r["reasons"]]
        why = sorted({"lack of fit" if reason.startswith("lack of fit") else reason for reason in short})
        lines.append(f"| {name} | {share(seen, len(own))} | {', '.join(other)} | {'; '.join(why)} |")
    if rows:
        lines += ["", f"Seconds per campaign: median {np.median([r['seconds'] for r in rows]):.1f}, "
                  f"largest {max(r['seconds'] for r in rows):.1f} (one process, shared machine)."]  # fmt: skip
    return "\n".join(lines) + "\n"


def _errors(what: str, rows: list[dict]) -> list[str]:
    """Errors over the noise floor, before and after."""
    if not rows:
        return []
    parts = []
    for label, key in (("left-out conditions", "heldout"), ("second campaign, new pads", "replay")):
        pairs = np.array([[r[key][0], r[key][1]] for r in rows], float) / np.array([[r["floor"]] for r in rows])
        before, after = np.median(pairs, axis=0)
        high = np.quantile(pairs[:, 1], 0.9)
        parts.append(f"{label} {before:.2f} before, {after:.2f} after (90 %: {high:.2f})")
    return [f"- median error over the noise floor, {what}: " + "; ".join(parts)]


def _parameter_error(row: dict) -> float:
    value = next(iter(row["parameters"].values()))
    null = 0.5 if row["effect"] == "compressibility" else 0.0
    return abs((value - null) / (row["size"] - null) - 1.0)


if __name__ == "__main__":
    main()

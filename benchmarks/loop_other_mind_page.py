"""The part of docs/loop-blind.md on the other generator: rates, sizes from which effects are found."""

from __future__ import annotations

from pathlib import Path

from benchmarks import loop_detection, loop_other_mind
from benchmarks.rows import read_rows

HERE = Path(__file__).resolve().parent
EARLIER, ROWS = HERE / "loop_other_mind_1040000.jsonl", HERE / "loop_other_mind_1050000.jsonl"
SIZES = HERE / "loop_detection.jsonl"

SECTION = """
## A generator of another mind

`tests/support/other_mind.py` has other laws: force curves by GetFEM, pairs of times for every arm, other exponents and
orders, another plan. Single effects have sizes over two decades, others one to three times the usual size.

{count} campaigns, run once: `python -m benchmarks.loop_other_mind --seed 1050000 --campaigns {count}
--rows benchmarks/loop_other_mind_1050000.jsonl`. The interval is that of a binomial rate.

{rates}

- Sizes are compared for effects whose law is the same in both: {same}.
- More than two floors: beyond what campaigns without an effect leave on other pads, which is the pads' own part. In
  five of the seven the right effects alone are named: their law is another one at the conditions of the other pads.
- The moduli outside their interval are all of campaigns with a slow relaxation mode, or with compressibility.
- Worse on new pads: among them are right effects of 1.5 to 2.1 floors, where the new pads' own part decides.
{more}

{earlier} earlier campaigns (seed 1040000, `benchmarks/loop_other_mind_1040000.jsonl`) showed two faults, mended
before the study above. A clipped sensor was not named: its fit now starts from usual arms too. The base model was kept
too often: whole pads left out are now compared as well. In them:

{before}

## From which size an effect is found

One effect a campaign, of the other generator: `python -m benchmarks.loop_detection --seed 1030000 --rounds 6 --beside
benchmarks/loop_other_mind_1040000.jsonl` ({runs} campaigns). The single effects of the study and the further campaigns
above are counted too. An effect is found when it is named first.

{sizes}

- The curve is logistic in the logarithm of the size. All effects share its steepness.
- The last columns are the size in noise floors that the effect alone leaves to the base model on left-out
  conditions. "Below 1": the law's own error takes the effect up, or it is seen long before it matters.
- "Above": the curve does not reach 9 of 10 within the sizes that were tried.
- Sizes lie over two decades in the first rounds and near the middle of each curve in later ones.
- `punch_edge` is missing: its curves exist for one size only. See [loop.md](loop.md).
- The same table is `docs/data/loop-detection.csv`.

![Chance to be named first over the size of the effect, one panel for each effect](images/loop-detection.svg)
"""
MORE = (("sensor_clipping", 1042000), ("adhesion", 1044000))
"""Effects of which the study has too few, and the seeds of further campaigns with them alone."""
SHORT = ("none: something", "one, 3 floors or more: right", "two: both", "three: all", "modulus inside its")


def section() -> str:
    """The text with its tables."""
    rows, earlier = read_rows(ROWS), read_rows(EARLIER)
    tables = [loop_other_mind.table(some).partition("\n| effect |")[0].strip() for some in (rows, earlier)]
    head = tables[1].splitlines()[:2]
    short = [line for line in tables[1].splitlines() if line.startswith(tuple(f"| {start}" for start in SHORT))]
    more: list[str] = []
    further: list[dict] = []
    for name, seed in MORE:
        own = read_rows(HERE / f"loop_other_mind_{seed}.jsonl")
        further += own
        missed = sorted(row["put"][0][1] for row in own if row["named"][:1] != [name])
        sizes = f" Missed at {' and '.join(f'{size:.2g}' for size in missed)}." if missed else ""
        more.append(f"- `{name}` alone (`--seed {seed} --campaigns {len(own)} --effect {name}`): right first in"
                    f"\n  {len(own) - len(missed)} of {len(own)} further campaigns.{sizes}")  # fmt: skip
    known = [*read_rows(SIZES), *loop_detection.singles([*rows, *further])]
    limits = loop_detection.detection(known)
    return SECTION.format(
        count=len(rows), rates=tables[0], same=", ".join(loop_other_mind.SAME_LAW), earlier=len(earlier),
        more="\n".join(more),
        before="\n".join([*head, *short]), sizes=loop_detection.table(limits).strip(),
        runs=len(read_rows(SIZES)),
    )  # fmt: skip

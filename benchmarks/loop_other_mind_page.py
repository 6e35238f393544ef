"""The part of docs/loop-blind.md on the other generator: rates, sizes from which effects are found."""

from __future__ import annotations

from pathlib import Path

from benchmarks import loop_detection, loop_other_mind
from benchmarks.rows import read_rows

HERE = Path(__file__).resolve().parent
FIRST, EARLIER, ROWS = (HERE / f"loop_other_mind_{seed}.jsonl" for seed in (1040000, 1050000, 1300000))
SIZES = HERE / "loop_detection.jsonl"

SECTION = """
## A generator of another mind

`tests/support/other_mind.py` has other laws: force curves by GetFEM, pairs of times for every arm, other exponents and
orders, another plan. Single effects have sizes over two decades, others one to three times the usual size.

{count} campaigns, run once: `python -m benchmarks.loop_other_mind --seed 1300000 --campaigns {count}
--rows benchmarks/loop_other_mind_1300000.jsonl`. At seed 1300073 the loop stopped with an error; it was mended and six
campaigns were run after that. The interval is that of a binomial rate. The last column is of {earlier} campaigns of an
earlier loop (seed 1050000).

{rates}

- Sizes are compared for effects whose law is the same in both: {same}.
- More than two floors: beyond what campaigns without an effect leave on other pads, which is the pads' own part. It
  differs between campaigns. "Without a factor of their own": the same conditions on pads that all follow the law.
{silent}
- The functions that are not learned are of depth over thickness (`bottom_felt`). They are named `strain_stiffening`,
  with 1.3 and 1.6 floors left on pads without a factor of their own.
{wrong}{more}

Earlier campaigns showed faults, mended since:

- {first} campaigns (seed 1040000): a clipped sensor was not named, and the base model was kept too often.
- {earlier} campaigns (seed 1050000): a function of the time since the stop was learned with a jump at the stop, and
  lost to named effects. One of temperature was not tried where single trials differ most, and had four knots only.

## From which size an effect is found

One effect a campaign, of the other generator: `python -m benchmarks.loop_detection --seed 1030000 --rounds 6 --beside
benchmarks/loop_other_mind_1040000.jsonl` ({runs} campaigns). The single effects of seed 1050000 and the further
campaigns above are counted too. An effect is found when it is named first.

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


def beside(rates: str, before: str) -> str:
    """The table of a study with the rate of an earlier one as last column, and the lines below it."""
    known = {cells[0]: cells[1] for line in before.splitlines() if len(cells := line.split(" | ")) > 1}
    head, rule, *lines = rates.splitlines()
    rows = [f"{line} {known.get(line.split(' | ')[0], '')} |" if line.startswith("| ") else line for line in lines]
    return "\n".join([f"{head} earlier |", f"{rule}---|", *rows])


def listed(rows: list[dict]) -> str:
    """What was put into some campaigns, in words."""
    put = [" and ".join(f"{name} {abs(size):.2g}" for name, size in row["put"]) for row in rows]
    return "; ".join(one or "one without an effect" for one in put)


def section() -> str:
    """The text with its tables."""
    rows, earlier = read_rows(ROWS), read_rows(EARLIER)
    tables = [loop_other_mind.table(some).partition("\n| effect |")[0].strip() for some in (rows, earlier)]
    silent = [row for row in rows if loop_other_mind.silent_on_usual_pads(row)]
    wrong = [row for row in rows if row["kind"] == "one" and not set(row["named"]) <= {name for name, _ in row["put"]}]
    more: list[str] = []
    further: list[dict] = []
    for name, seed in MORE:
        own = read_rows(HERE / f"loop_other_mind_{seed}.jsonl")
        further += own
        missed = sorted(row["put"][0][1] for row in own if row["named"][:1] != [name])
        sizes = f" Missed at {' and '.join(f'{size:.2g}' for size in missed)}." if missed else ""
        more.append(f"- `{name}` alone (`--seed {seed} --campaigns {len(own)} --effect {name}`): right first in"
                    f"\n  {len(own) - len(missed)} of {len(own)} further campaigns.{sizes}")  # fmt: skip
    known = [*read_rows(SIZES), *loop_detection.singles([*earlier, *further])]
    found = loop_detection.detection(known)
    return SECTION.format(
        count=len(rows), rates=beside(*tables), same=", ".join(loop_other_mind.SAME_LAW), earlier=len(earlier),
        more="\n".join(more), first=len(read_rows(FIRST)),
        silent=f"  These are {listed(silent)}." if silent else "",
        wrong=f"- Single effects with a wrong name: {listed(wrong)}.\n" if wrong else "",
        sizes=loop_detection.table(found).strip(), runs=len(read_rows(SIZES)),
    )  # fmt: skip

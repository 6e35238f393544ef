"""End to end: a batch is drawn, one puck of it pressed and read, the ratio chosen for a mould that is kept, a pad cast.

``python -m benchmarks.accuracy.batches_blind [--batches 200] [--seed N] [--rows FILE]``. A batch is drawn from the
stated intervals of the paper's polyurethane by code of ``benchmarks/accuracy/castings_blind.py``. Its puck is weighed
with errors and pressed at 10 and 50 mm/s between lubricated or bonded plates, with friction, gauge, contact and noise
of its own (``benchmarks/accuracy/puck_batches.py``); ``resins add-compression`` reads it with the plates declared. The
ratio is then chosen for a pad of given shape and thickness. A pad is cast at this ratio of the same batch, with errors
of weighing and thickness, and pressed by curves that were solved 0.2 mm below and above its thickness, with a smooth
error of the force law. Counted is how often the pad is usable where the answer calls it usable, and whether the stated
share of usable castings is the counted one. It is also counted what the same batch gives as poured, without the puck.
"""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy.castings_blind import GEOMETRIES, Cast, classes_of, drawn, needs
from benchmarks.accuracy.puck_batches import HEIGHT_MM, Batch, neo_hookean_curves, written
from benchmarks.rows import resume, scratch
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.suggest import design
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import Resin
from dummydesign.resin.puck_test.add_compression import add_compression
from dummydesign.resin.puck_test.plates import LUBRICATED

PADS = GEOMETRIES[:3]
"""What ``suggest`` recommends; curves are solved (``results/castings_blind_curves.json``). [mm]"""
DIAMETER_MM, PUCK_BATCH_G = 50.0, 150.0
WEIGHING_G, THICKNESS_MM = 0.1, 0.2


@dataclass(frozen=True)
class Drawn:
    """What is true of one batch of a resin."""

    young_ref_kPa: float
    gel_ratio: float
    exponent: float
    beta: NDArray
    softness: float
    reference: float
    relaxation_ratio: float

    def young_kPa(self, ratio: NDArray | float) -> NDArray:
        """Long-term modulus at ratios."""
        gel = self.gel_ratio * self.reference
        above = np.maximum(np.asarray(ratio) - gel, 1e-3) / (self.reference - gel)
        return np.asarray(self.young_ref_kPa * above**self.exponent)

    def strengths(self, ratio: float) -> NDArray:
        """Strengths of the arms at a ratio."""
        growth = (self.young_kPa(self.relaxation_ratio) / self.young_kPa(ratio)) ** self.softness
        return np.asarray(self.beta * growth)


def draw_batch(resin: Resin, rng: np.random.Generator) -> Drawn:
    """Draw a batch from the stated intervals; a gel point above the leanest mix is no such resin."""
    names, reference = ("young_ref_kPa", "gel_ratio_over_ref", "exponent"), resin.numbers["ratio_ref"].value
    while True:
        young, gel, exponent = (float(drawn(resin.numbers[name], rng.standard_normal())) for name in names)
        if gel * reference < resin.ratio_min:
            break
    beta = np.array([float(drawn(arm.beta, rng.standard_normal())) for arm in resin.arms])
    softness = float(drawn(resin.softness_exponent, rng.standard_normal()))
    return Drawn(young, gel, exponent, beta, softness, reference, resin.relaxation_ratio_ref)


def weighed(ratio: float, total_g: float, rng: np.random.Generator) -> float:
    """Ratio that is in the cup when both liquids are weighed with errors even within 0.1 g."""
    polyol, isocyanate = (
        total_g * part / (100.0 + ratio) + rng.uniform(-WEIGHING_G, WEIGHING_G) for part in (100.0, ratio)
    )
    return 100.0 * isocyanate / polyol


def puck_curve(plates: str, rng: np.random.Generator):
    """Force of a neo-Hookean puck of 1 kPa over compression, with a friction of its own between lubricated plates."""
    pool = neo_hookean_curves(plates)
    return pool[rng.integers(len(pool))]


def puck_files(batch: Drawn, resin: Resin, ratio: float, plates: str, folder: Path, rng: np.random.Generator):
    """Press a puck of the batch; return its files and what the gauge says of its size."""
    mixed = weighed(ratio, PUCK_BATCH_G, rng)
    arms = tuple(zip(resin.tau_s, batch.strengths(mixed).tolist()))
    gauge = float(0.1 * rng.standard_normal()), float(0.05 * rng.standard_normal())
    one = Batch(
        ratio,
        float(batch.young_kPa(mixed)),
        arms,
        puck_curve(plates, rng),
        float(rng.uniform(-0.1, 0.3)),
        float(rng.uniform(0.01, 0.05)),
        gauge,
    )
    return written(one, folder, rng), (DIAMETER_MM + gauge[0], HEIGHT_MM + gauge[1])


@dataclass(frozen=True)
class Row:
    """One batch: what was stated with and without the puck, and what the pads were."""

    number: int
    seed: int
    tissue: str
    plates: str
    level: str
    stated: float
    ratio: float
    kind: int
    poured_level: str
    poured_stated: float
    poured_kind: int
    after_stated: float
    seconds: float


def cast(batch: Drawn, answer, ratio: float, thickness_mm: float, rng: np.random.Generator) -> int:
    """Cast one pad of the batch and press it; return its class."""
    mixed = weighed(ratio, answer.castings.tolerances.pour_g, rng)
    thickness = thickness_mm + rng.uniform(-THICKNESS_MM, THICKNESS_MM)
    young, beta = 1e-3 * float(batch.young_kPa(mixed)), batch.strengths(mixed)
    one = Cast(np.array([thickness]), np.array([young]), beta[None], rng.standard_normal((1, 2)))
    found = needs(one, answer, str(answer.shape), thickness_mm)
    return int(classes_of(*found, answer.targets.limits)[0])


def run(number: int, seed: int) -> Row:
    """One batch from the cup to the pressed pad."""
    rng, began = np.random.default_rng([seed, number]), time.process_time()
    tissue, shape, thickness = PADS[number % len(PADS)]
    plates = (LUBRICATED, "bonded")[number // len(PADS) % 2]
    resin = load_resin()
    batch = draw_batch(resin, rng)
    asked = {"shape": shape, "thickness_mm": (thickness, thickness)}
    before = _designed(tissue, "polyurethane-nagoya", **asked)
    poured = cast(batch, before, before.best.ratio, thickness, rng)
    with scratch("batch-") as folder:
        os.environ["DUMMYDESIGN_HOME"] = str(folder)
        files, size = puck_files(batch, resin, before.best.ratio, plates, folder, rng)
        diameter_mm, height_mm = size
        add_compression(
            files, diameter_mm, height_mm, "batch", before.best.ratio, "polyurethane-nagoya", friction=plates
        )
        answer = _designed(tissue, "batch", **asked)
        kind = cast(batch, answer, answer.best.ratio, thickness, rng)
    usable = answer.verdict.usable_share
    return Row(
        number,
        seed,
        tissue,
        plates,
        answer.verdict.level,
        float(usable or 0.0),
        answer.best.ratio,
        kind,
        before.verdict.level,
        float(before.verdict.usable_share or 0.0),
        poured,
        before.shares.after_puck.usable,
        time.process_time() - began,
    )


_KEPT: dict[tuple[str, str], object] = {}


def _designed(tissue: str, resin: str, **asked):
    """The answer for one pad; that of the resin as stated is the same for every batch."""
    key = tissue, resin
    if resin == "batch" or key not in _KEPT:
        _KEPT[key] = design(read_problem(Request(tissue, resin=resin, **asked)))
    return _KEPT[key]


def table(rows: list[Row]) -> list[str]:
    """Stated and counted shares, by tissue and level."""
    lines = [
        "pads | batches | as poured: stated, counted % | after one puck: stated before, counted % | "
        "called usable | of these usable %"
    ]
    for name in ("all", *dict.fromkeys(row.tissue for row in rows)):
        own = [row for row in rows if name in ("all", row.tissue)]
        called = [row for row in own if row.level in ("stands_for", "usable_with_correction")]
        good = np.mean([row.kind <= 1 for row in called]) if called else np.nan
        numbers = [
            100 * np.mean(shares)
            for shares in (
                [row.poured_stated for row in own],
                [row.poured_kind <= 1 for row in own],
                [row.after_stated for row in own],
                [row.kind <= 1 for row in own],
            )
        ]
        lines.append(
            f"{name} | {len(own)} | {numbers[0]:.1f}, {numbers[1]:.1f} | {numbers[2]:.1f}, {numbers[3]:.1f} | "
            f"{len(called)} | {100 * good:.1f}"
        )
    levels = {level: [row for row in rows if row.level == level] for level in dict.fromkeys(row.level for row in rows)}
    lines += [
        f"{level}: {len(own)} batches, stated {100 * np.mean([row.stated for row in own]):.1f} %, counted "
        f"{100 * np.mean([row.kind <= 1 for row in own]):.1f} %"
        for level, own in levels.items()
    ]
    return lines


def main() -> None:
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--batches", type=int, default=200)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--rows", type=Path, default=Path("batches_blind.jsonl"))
    options = parser.parse_args()
    rows = resume(options.rows, options.seed, options.batches, Row, run)
    print(f"{len(rows)} batches, seed {options.seed}")
    print("\n".join(table(rows)))


if __name__ == "__main__":
    main()

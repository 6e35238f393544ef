"""What one puck says of its batch: drawn batches, pressed by a forward model, read by ``resins add-compression``.

``python -m benchmarks.accuracy.puck_batches [--batches 100] [--first 0] [--seed N] [--csv FILE]`` draws modulus, arms
and ratio of a batch from the paper's polyurethane (times of the arms are drawn too), an elastic law, a contact offset
and gauge errors of the puck. It is pressed at 10 and 50 mm/s and held for 10 s between lubricated plates (friction
drawn) or bonded ones. The elastic force is solved by finite elements; relaxation is stepped in time by code of its own;
noise of 0.01 to 0.05 N is added. The plates are declared as they are; of every fifth pair also left open and declared
wrongly.

``--friction 100`` presses that many pucks slowly without a hold instead, each with its own friction from the prior of
lubricated plates (and as many with friction exactly 0 and 0.1), and reads them as lubricated. Elastic forces are solved
by finite elements at five frictions for each of a few drawn laws and interpolated here; the prior, the scatter of 2 %
between pucks and the solver are the product's, its friction table and its elastic law are not.

It counts how often 95 % intervals of the resin that results hold the batch's modulus and the sum of its strengths
between 10 ms and 10 s, and how wide they are.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.signal import lfilter

from benchmarks.rows import scratch, write_csv
from dummydesign.core.quantity import value_at
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import HyperelasticLaw, Ogden, Yeoh
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.tables.puck import table_for
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import PUCK_SCATTER
from dummydesign.resin.puck_test.add_compression import add_compression, steps
from dummydesign.resin.puck_test.loading_fit import LoadingCurve, fit_pucks
from dummydesign.resin.puck_test.plates import LUBRICATED, read_plates

DIAMETER_MM, HEIGHT_MM = 50.0, 30.0
SHARE, HOLD_S, RATE_HZ = 0.3, 10.0, 1000.0
SPEEDS_MM_S = (10.0, 50.0)
COUNTED_S = (0.01, 10.0)
AT = np.r_[0.002, 0.01, 0.03, np.arange(0.06, SHARE + 0.035, 0.03)]
POOL = 12
"""Elastic curves that are solved for each kind of plates."""


@dataclass(frozen=True)
class Batch:
    """A batch and how its puck is pressed."""

    ratio: float
    young_kPa: float
    arms: tuple[tuple[float, float], ...]
    curve: PchipInterpolator
    offset_mm: float
    noise_N: float
    gauge_mm: tuple[float, float]

    @property
    def strength(self) -> float:
        """Sum of the strengths that count."""
        return sum(beta for tau, beta in self.arms if COUNTED_S[0] <= tau <= COUNTED_S[1])


def drawn_law(rng: np.random.Generator) -> HyperelasticLaw:
    """Neo-Hookean, Ogden of one or two terms, or Yeoh.

    Stiffening as of 19 silicones between plates (alpha 1 to 2.4, ``materials/measured/ecoflex-moduli.csv``) and more.
    """
    kind = rng.integers(4)
    if kind == 0:
        return Ogden([1.0], [2.0])
    if kind == 1:
        alpha = float(rng.uniform(1.1, 3.2))
        return Ogden([2.0 / alpha], [alpha])
    if kind == 2:
        share, first, second = float(rng.uniform(0.7, 0.95)), float(rng.uniform(1.1, 2.0)), float(rng.uniform(3.0, 6.0))
        return Ogden([2.0 * share / first, 2.0 * (1.0 - share) / second], [first, second])
    return Yeoh(1.0, float(rng.uniform(0.0, 0.03)))


@cache
def neo_hookean_curves(plates: str) -> tuple[PchipInterpolator, ...]:
    """Force of neo-Hookean pucks of 1 kPa over compression, lubricated ones each with its own friction. [N]"""
    count = 1 if plates == "bonded" else POOL
    return _curves(plates, np.random.default_rng(77), lambda rng: Ogden([1.0], [2.0]), count)


@cache
def curves(plates: str, seed: int) -> tuple[PchipInterpolator, ...]:
    """Force of pucks of 1 kPa over compression, each with its own law and, lubricated, its own friction. [N]"""
    return _curves(plates, np.random.default_rng(seed), drawn_law, POOL)


def _curves(
    plates: str, rng: np.random.Generator, law_of: Callable[[np.random.Generator], HyperelasticLaw], count: int
) -> tuple[PchipInterpolator, ...]:
    made: list[PchipInterpolator] = []
    while len(made) < count:
        friction = plates
        if plates == LUBRICATED:
            declared = read_plates(LUBRICATED).friction
            assert declared is not None
            mu = float(value_at(replace(declared, kind="inferred"), rng.standard_normal()))
            friction = f"friction:{mu:.4f}"
        puck = Puck(HEIGHT_MM, 1e-3, DIAMETER_MM, plates=friction, law=law_of(rng))
        solved = solve_puck(puck, HEIGHT_MM * AT)
        if len(solved.depth_mm) == len(AT):
            made.append(PchipInterpolator(np.r_[0.0, solved.depth_mm], np.r_[0.0, solved.force_N]))
    return tuple(made)


FRICTIONS = (0.0, 0.025, 0.06, 0.12, 0.25)
LAWS = 6


@cache
def over_friction(law: HyperelasticLaw) -> PchipInterpolator:
    """Ln of the force of a puck of 1 kPa at :data:`AT` over the friction of its plates, by finite elements."""
    forces = []
    for friction in FRICTIONS:
        plates = f"friction:{friction}" if friction else "frictionless"
        forces.append(solve_puck(Puck(HEIGHT_MM, 1e-3, DIAMETER_MM, plates=plates, law=law), HEIGHT_MM * AT).force_N)
    return PchipInterpolator(FRICTIONS, np.log(forces), extrapolate=True)


def slow_pucks(count: int, seed: int, friction: float | None = None) -> NDArray:
    """Drawn pucks between lubricated plates: read over true modulus, whether its interval holds it, Yeoh, (n, 3)."""
    rng = np.random.default_rng(seed)
    laws: list[Any] = [Ogden([1.0], [2.0]), *(drawn_law(rng) for _ in range(LAWS - 1))]
    plates, rows = read_plates(LUBRICATED), []
    assert plates.friction is not None
    for _ in range(count):
        away, mu = rng.standard_normal(2), friction
        if mu is None:
            mu = float(value_at(replace(plates.friction, kind="inferred"), away[0]))
        law = laws[rng.integers(LAWS)]
        curve = PchipInterpolator(np.r_[0.0, AT], np.r_[0.0, np.exp(over_friction(law)(mu))])
        x = np.linspace(-0.2, SHARE * HEIGHT_MM, 4000)
        scale = 30.0 * math.exp(PUCK_SCATTER * away[1])
        force = scale * curve(np.maximum(x - rng.uniform(-0.1, 0.3), 0.0) / HEIGHT_MM)
        noisy = force + rng.uniform(0.01, 0.05) * rng.standard_normal(len(x))
        size = DIAMETER_MM + 0.1 * rng.standard_normal(), HEIGHT_MM + 0.05 * rng.standard_normal()
        window = 0.03 * size[1], SHARE * HEIGHT_MM
        press = LoadingCurve("press", "puck", *steps(x, noisy, window))
        young = fit_pucks([press], *size, table_for(*size), window, plates).known.young_kPa
        rows.append((young.value / 30.0, young.low <= 30.0 <= young.high, isinstance(law, Yeoh)))
    return np.array(rows)


def drawn_batch(rng: np.random.Generator, plates: str, seed: int) -> Batch:
    """A batch of the paper's polyurethane as its resin file draws it, its arms at times of their own."""
    resin = load_resin()
    while True:
        ratio = float(np.round(rng.uniform(14.8, 16.5), 1))
        draws = resin.draw(1, rng)
        young_kPa = 1e3 * float(draws.young_MPa(ratio)[0])
        if 8.0 <= young_kPa <= 150.0:
            break
    times = np.array(resin.tau_s) * np.exp(rng.uniform(-0.7, 0.7, len(resin.tau_s)))
    arms = tuple(zip(times.tolist(), draws.beta(ratio)[0].tolist()))
    pool = curves(plates, seed)
    return Batch(
        ratio,
        young_kPa,
        arms,
        pool[rng.integers(len(pool))],
        float(rng.uniform(-0.1, 0.3)),
        float(rng.uniform(0.01, 0.05)),
        (float(0.1 * rng.standard_normal()), float(0.05 * rng.standard_normal())),
    )


def pressed(batch: Batch, speed_mm_s: float, rng: np.random.Generator) -> tuple[NDArray, NDArray, NDArray]:
    """Time, displacement and force of one press: each arm relaxes over the steps of a fine grid, exact for a step."""
    fine = 4
    depth = SHARE * HEIGHT_MM
    end = 0.2 + depth / speed_mm_s + HOLD_S
    t = np.arange(0.0, end, 1.0 / (fine * RATE_HZ))
    x = np.clip((t - 0.2) * speed_mm_s, -0.2, depth)
    elastic = batch.young_kPa * batch.curve(np.maximum(x - batch.offset_mm, 0.0))
    rise, step = np.diff(elastic, prepend=0.0), 1.0 / (fine * RATE_HZ)
    force = elastic.copy()
    for tau, beta in batch.arms:
        # what rises within a step relaxes for half of it
        force += beta * lfilter([math.exp(-0.5 * step / tau)], [1.0, -math.exp(-step / tau)], rise)
    rows = slice(0, len(t), fine)
    noisy = force[rows] + batch.noise_N * rng.standard_normal(len(t[rows]))
    return t[rows], x[rows], noisy


def written(batch: Batch, folder: Path, rng: np.random.Generator) -> list[Path]:
    """Trace files of a puck's presses."""
    files = []
    for speed in SPEEDS_MM_S:
        files.append(folder / f"v{speed:g}.csv")
        np.savetxt(
            files[-1],
            np.column_stack(pressed(batch, speed, rng)),
            fmt="%.6g",
            delimiter=",",
            header="time_s,displacement_mm,force_N",
            comments="",
        )
    return files


@dataclass(frozen=True)
class Row:
    """One puck, read with one declaration: whether intervals hold the truth, and their half widths."""

    plates: str
    declared: str
    young_kPa: float
    young_holds: bool
    young_half: float
    puck_holds: bool
    puck_half: float
    strength_holds: bool
    strength_half: float
    arms_hold: float
    doubted: bool
    seconds: float


def read(batch: Batch, plates: str, declared: str, files: Sequence[Path]) -> Row:
    """Add the puck to the paper's resin and compare what results with the batch."""
    began = time.process_time()
    size = DIAMETER_MM + batch.gauge_mm[0], HEIGHT_MM + batch.gauge_mm[1]
    done = add_compression(
        files, *size, "batch", batch.ratio, "polyurethane-nagoya", replace_own=True, friction=declared or None
    )
    resin = load_resin("batch")
    spent = time.process_time() - began
    young = resin.modulus_kPa(batch.ratio)
    counted = np.array([COUNTED_S[0] <= tau <= COUNTED_S[1] for tau in resin.tau_s])
    sums = resin.draw(4000, 3).beta(batch.ratio)[:, counted].sum(axis=1)
    low, high = np.percentile(sums, [2.5, 97.5])
    truth = np.array(batch.arms)
    arms = (
        [
            abs(math.log(arm.tau_s.value / t)) < 0.4 and arm.beta.low <= beta <= arm.beta.high
            for arm, (t, beta) in zip(resin.arms, truth)
        ]
        if len(resin.arms) == len(truth)
        else [False]
    )
    own = done["young_kPa"]
    return Row(
        plates,
        declared,
        batch.young_kPa,
        young.low <= batch.young_kPa <= young.high,
        0.5 * math.log(young.high / young.low),
        own["low"] <= batch.young_kPa <= own["high"],
        0.5 * math.log(own["high"] / own["low"]),
        bool(low <= batch.strength <= high),
        0.5 * math.log(high / low),
        float(np.mean(arms)),
        any(one["code"] == "plates_doubted" for one in done["warnings"]),
        spent,
    )


def study(batches: int, seed: int, others: int = 5, first: int = 0) -> Iterator[Row]:
    """Rows of drawn batches; every ``others``-th is also read with open and with wrongly declared plates."""
    for number in range(first, first + batches):
        rng = np.random.default_rng([seed, number])
        plates = (LUBRICATED, "bonded")[number % 2]
        batch = drawn_batch(rng, plates, seed)
        with scratch("puck-batch-") as folder:
            os.environ["DUMMYDESIGN_HOME"] = str(folder)
            files = written(batch, folder, rng)
            wrong = "bonded" if plates == LUBRICATED else LUBRICATED
            for declared in (plates, "", wrong)[: 3 if number // 2 % others == 0 else 1]:
                yield read(batch, plates, declared, files)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--batches", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--friction", type=int, default=0, metavar="N", help="N slow pucks with friction by the prior")
    options = parser.parse_args()
    if options.friction:
        print(
            "friction | law | pucks | median error, % | error of half, % | intervals that hold the modulus, %; "
            f"seed {options.seed}"
        )
        for mu in (None, 0.0, 0.1):
            name, found = "by the prior" if mu is None else f"{mu:g}", slow_pucks(options.friction, options.seed, mu)
            yeoh = found[:, 2] > 0.0
            for law, rows_of in (("all", found), ("Yeoh", found[yeoh]), ("others", found[~yeoh])):
                off, covered = 100.0 * (rows_of[:, 0] - 1.0), 100.0 * rows_of[:, 1].mean()
                half = np.median(np.abs(off))
                print(f"{name} | {law} | {len(off)} | {np.median(off):+.1f} | {half:.1f} | {covered:.0f}", flush=True)
        return
    rows = []
    for row in study(options.batches, options.seed, first=options.first):
        rows.append(row)
        print(row, flush=True)
    print(f"{options.batches} batches, seed {options.seed}, {sum(row.seconds for row in rows):.0f} s of processor time")
    head = (
        "plates",
        "declared",
        "pucks",
        "modulus_covered",
        "modulus_half_percent",
        "puck_covered",
        "puck_half_percent",
        "strengths_covered",
        "strengths_half_percent",
        "arms_covered",
        "doubted",
    )
    table = []
    for kind in dict.fromkeys((row.plates, row.declared) for row in rows):
        own = [row for row in rows if (row.plates, row.declared) == kind]
        shares = [
            f"{np.mean([getattr(row, name) for row in own]):.3f}"
            if "half" not in name
            else f"{100 * np.median([getattr(row, name) for row in own]):.1f}"
            for name in (
                "young_holds",
                "young_half",
                "puck_holds",
                "puck_half",
                "strength_holds",
                "strength_half",
                "arms_hold",
                "doubted",
            )
        ]
        table.append((kind[0], kind[1] or "not", len(own), *shares))
    print(" | ".join(head))
    for line in table:
        print(" | ".join(map(str, line)))
    if options.csv:
        write_csv(options.csv, head, table)


if __name__ == "__main__":
    main()

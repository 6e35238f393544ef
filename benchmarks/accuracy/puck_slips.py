"""What ``resins add-compression`` says of a set of two pucks in which one thing is wrong.

``python -m benchmarks.accuracy.puck_slips --sets 300 --seed N --rows FILE`` draws batches and presses as
:mod:`benchmarks.accuracy.puck_batches` does (elastic force by the product's finite elements, laws, arms and noise of
its own). Two pucks of a batch are read one after the other, their masses weighed, in each set with one wrong of
:data:`WRONGS`, in three of ten with none. Each set is read twice, with ``--mass`` and without. Told is what ends in an
error or has a contradiction, an exponent at its bound or plates in doubt. Sets without a wrong are read in both orders
too: by how much the modulus differs then.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.accuracy.puck_batches import DIAMETER_MM, HEIGHT_MM, Batch, drawn_batch, written
from benchmarks.rows import resume, scratch
from dummydesign.core.errors import DummydesignError
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import PUCK_SCATTER
from dummydesign.resin.puck_test.add_compression import add_compression
from dummydesign.resin.puck_test.plates import LUBRICATED

LBF, KGF = 4.4482, 9.80665
WRONGS = ("", "radius", "diameter", "", "height low", "height high", "force in lbf", "", "force in kgf", "mixed press")
"""In turn: radius typed for the diameter, a size 10 % off, units of the force, one press of a puck of another mix."""
MIXED = (0.7, 0.85, 1.2, 1.4)
"""Modulus of the other mix over this one's."""
TOLD = {"contradiction", "exponent_at_bound", "plates_doubted"}


@dataclass(frozen=True)
class Row:
    """One set: what was wrong and by how much, what told it with a mass and without, and of a right one the order."""

    seed: int
    number: int
    wrong: str
    size: float
    with_mass: list[str]
    without: list[str]
    off: float
    by_order: float


def puck(batch: Batch, folder: Path, rng: np.random.Generator) -> tuple[list[Path], tuple[float, float], float]:
    """Files of one more puck of a batch, its gauged sizes, and its weighed mass. [mm, g]"""
    folder.mkdir()
    gauge = float(0.1 * rng.standard_normal()), float(0.05 * rng.standard_normal())
    own = replace(batch, young_kPa=batch.young_kPa * math.exp(PUCK_SCATTER * rng.standard_normal()), gauge_mm=gauge)
    resin = load_resin()
    density = resin.property("density_g_per_cm3", batch.ratio).value * math.exp(0.01 * rng.standard_normal())
    mass_g = density * 0.25e-3 * math.pi * DIAMETER_MM**2 * HEIGHT_MM * math.exp(0.003 * rng.standard_normal())
    return written(own, folder, rng), (DIAMETER_MM + gauge[0], HEIGHT_MM + gauge[1]), round(mass_g, 1)


def scaled(file: Path, by: float) -> None:
    """Write the forces of a file in another unit."""
    rows = np.loadtxt(file, delimiter=",", skiprows=1)
    rows[:, 2] *= by
    np.savetxt(file, rows, fmt="%.6g", delimiter=",", header="time_s,displacement_mm,force_N", comments="")


def spoiled(
    wrong: str, batch: Batch, files: list[Path], size: tuple[float, float], folder: Path, rng: np.random.Generator
) -> tuple[float, tuple[float, float]]:
    """Make one thing of a puck wrong: by how much, and the sizes that are typed."""
    diameter, height = size
    if wrong.startswith("force"):
        by = 1.0 / (LBF if "lbf" in wrong else KGF)
        for file in files:
            scaled(file, by)
        return by, size
    if wrong == "mixed press":
        by = float(rng.choice(MIXED))
        other, *_ = puck(replace(batch, young_kPa=by * batch.young_kPa), folder / "other", rng)
        files[1].write_bytes(other[1].read_bytes())
        return by, size
    off = float(rng.choice([0.9, 1.1]))
    typed: dict[str, Callable[[], tuple[float, tuple[float, float]]]] = {
        "radius": lambda: (0.5, (0.5 * diameter, height)),
        "diameter": lambda: (off, (off * diameter, height)),
        "height low": lambda: (0.9, (diameter, 0.9 * height)),
        "height high": lambda: (1.1, (diameter, 1.1 * height)),
        "": lambda: (1.0, size),
    }
    return typed[wrong]()


def run(number: int, seed: int) -> Row:
    """One set."""
    rng = np.random.default_rng([seed, number])
    wrong = WRONGS[number % len(WRONGS)]
    batch = drawn_batch(rng, LUBRICATED, seed)
    with scratch("puck-slips-") as folder:
        pucks = [puck(batch, folder / name, rng) for name in ("first", "second")]
        (first, own, mass), (files, size, second_mass) = pucks
        by, typed = spoiled(wrong, batch, files, size, folder, rng)
        told: list[list[str]] = []
        moduli: list[float] = []
        orders = [((first, own, mass), (files, typed, second_mass))]
        for weighed, order in ((True, orders[0]), (False, orders[0]), (True, orders[0][::-1])):
            if len(told) == 2 and wrong:
                break
            os.environ["DUMMYDESIGN_HOME"] = str(folder / f"home{len(told)}")
            codes: set[str] = set()
            base: str | None = "polyurethane-nagoya"
            for paths, sizes, grams in order:
                try:
                    done = add_compression(
                        paths,
                        *sizes,
                        "batch",
                        batch.ratio,
                        base,
                        friction=LUBRICATED,
                        mass_g=grams if weighed else None,
                    )
                except DummydesignError as problem:
                    codes.add(problem.code)
                    break
                base = None
                codes |= {one["code"] for one in done["warnings"]} & TOLD
            told.append(sorted(codes))
            moduli.append(load_resin("batch").modulus_kPa(batch.ratio).value if base is None else math.nan)
    by_order = abs(moduli[-1] / moduli[0] - 1.0) if not wrong else 0.0
    return Row(seed, number, wrong, by, told[0], told[1], moduli[1] / batch.young_kPa - 1.0, by_order)


def main() -> None:
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=300)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--rows", type=Path, required=True)
    options = parser.parse_args()
    rows = resume(options.rows, options.seed, options.sets, Row, run)
    print("wrong | sets | told with --mass | told without | largest change of the modulus without a word, %")
    for wrong in dict.fromkeys(WRONGS):
        of = [row for row in rows if row.wrong == wrong]
        quiet = [100.0 * abs(row.off) for row in of if not row.without]
        counts = [sum(bool(getattr(row, name)) for row in of) for name in ("with_mass", "without")]
        print(f"{wrong or 'nothing'} | {len(of)} | {counts[0]} | {counts[1]} | {max(quiet, default=0.0):.0f}")
    print(f"by the order of two right pucks: at most {max((r.by_order for r in rows if not r.wrong), default=0.0):.1e}")


if __name__ == "__main__":
    main()

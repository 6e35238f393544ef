"""One pad whose force law is bent within its stated error: ``python -m benchmarks.accuracy.bent_law --seed S``.

Even campaigns have nothing undeclared, odd ones an effect; each declares the published resin, or a batch of which a
puck was pressed. Shared with the loop: the force law before it is bent, quasi-linear superposition, the resin's arms
and the outline of a crown. Motion, relaxation, effects, noise and puck are those of
:mod:`benchmarks.accuracy.laboratory_press`; the plan, the puck and the loop are asked by the command line.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy.laboratories import PUNCH_MM, ROOT, Lab
from benchmarks.accuracy.laboratory_draws import DECLARED, EFFECTS, SIGNED
from benchmarks.accuracy.laboratory_pad import Curve
from benchmarks.accuracy.laboratory_press import DEEPEST, Batch, Pad
from benchmarks.rows import keep_row, read_rows, scratch

PADS = ((8.0, "slab"), (10.5, "crowned:3.6,4.6,9.4"), (15.0, "slab"), (7.0, "crowned:20,2.5,11"))
BENT, RATIO, POINTS = (0.003, 0.01, 0.02), 15.6, 60
NAMED = ("contact_offset", "machine_compliance", "strain_stiffening", "thickness_error")
WITH_PUCK = NAMED[2:]


def stated_curve(thickness_mm: float, shape: str) -> tuple[Curve, NDArray]:
    """F / E as ``predict`` states it, and its relative error."""
    from dummydesign.geometry.shape_registry import read_shape
    from dummydesign.pad.force_source import curve_without_solve, solved_curve
    from dummydesign.pad.pad_under_punch import Pad as Pressed

    pad = Pressed(thickness_mm, 1.0, 0.5 * PUNCH_MM, geometry=read_shape(shape))
    depth = thickness_mm * DEEPEST * np.linspace(0.0, 1.0, POINTS)[1:] ** 1.5
    curve = curve_without_solve(pad) or solved_curve(pad, depth)
    depth = depth[depth <= curve.limit_mm]
    return Curve(np.r_[0.0, depth], np.r_[0.0, curve.force(depth)]), np.r_[0.0, curve.relative_error(depth)]


def bend(share: NDArray, rng: np.random.Generator) -> NDArray:
    """A smooth function of depth over thickness, at most 1: waves of half the depth and longer."""
    phase, count = rng.uniform(0.0, 2.0 * np.pi, 3), rng.uniform(0.3, 2.0, 3)
    waves = rng.normal(size=3) @ np.cos(2.0 * np.pi * count[:, None] * share / DEEPEST + phase[:, None])
    return np.asarray(waves / np.abs(waves).max())


def drawn(number: int, rng: np.random.Generator) -> tuple[str, float, bool]:
    """The undeclared effect with its size, empty for none, and whether a puck was pressed."""
    turn = number // 2
    if number % 2 == 0:
        return "", 0.0, turn % 2 == 1
    name = NAMED[turn % len(NAMED)]
    sign = float(rng.choice([-1.0, 1.0])) if name in SIGNED else 1.0
    return name, sign * float(rng.uniform(*EFFECTS[name])), name in WITH_PUCK


def run(seed: int, number: int, folder: Path) -> dict[str, Any]:
    """Make a batch, its puck and its pad; plan, press and correct a campaign."""
    lab, rng = Lab(seed, number, folder), np.random.default_rng([seed, number, 61])
    name, size, puck = drawn(number, rng)
    arms = [(tau, beta * float(np.exp(rng.normal(0.0, 0.1)))) for tau, beta in DECLARED]
    lab.batch = Batch(25.0 * float(np.exp(rng.normal(0.0, 0.15))), 0.86, 2.5, 0.5, arms, 0.0)
    lab.put, row = {name: size} if name else {}, lab.row
    thickness, shape = PADS[(number // 2 + number // 8) % len(PADS)]
    curve, stated = stated_curve(thickness, shape)
    amount = float(BENT[number // 2 % len(BENT)])
    # smoothly held inside the stated error
    bent = bend(curve.depth_mm / thickness, rng) * amount * stated / np.hypot(amount, stated)
    curve = Curve(curve.depth_mm, curve.area_mm2 * (1.0 + bent))
    young = lab.batch.young_MPa(RATIO)
    pad, resin = Pad(curve, thickness, young, lab.batch.arms_at(RATIO), lab.put), "polyurethane-nagoya"
    if puck:
        line = "resins add-compression puck50x30-v10.csv puck50x30-v50.csv --diameter 50 --height 30 --friction "
        line += f"lubricated --ratio {RATIO} --name my-batch --resin {resin}"
        own, lab.put, resin = lab.put, {}, "my-batch"
        lab.press_puck(line)
        lab.type(line)
        lab.put = own
    gauged = thickness - lab.put.get("thickness_error", 0.0)
    plan = f"campaign new my-dummy --resin {resin} --ratio {RATIO} --pads {thickness} --shape {shape}"
    lab.type(f"{plan} --punch round:{PUNCH_MM:g} --no-power")
    row["change_N"] = lab.press_campaign("my-dummy", pad, gauged)
    found = lab.of_loop(lab.type("loop my-dummy"), pad)
    for key in ("arms", "site", "people", "own_law", "yeoh", "commands", "broken", "lost_presses", "put"):
        row.pop(key, None)
    own_size = found.pop("size", None)
    return {
        **row,
        **{"put": name, "size": size, "puck": puck, "pad": f"{thickness:g} mm {shape}", "bent": amount},
        **{"bent_most": float(np.abs(bent).max()), "stated": float(stated.max()), **found, "found": own_size},
    }


def figures(rows: list[dict[str, Any]]) -> str:
    """The counts, as text."""
    quiet, put = ([row for row in rows if bool(row["put"]) is given] for given in (False, True))
    none = sum(row["verdict"] == "none" for row in quiet)
    off = [abs(row["young"][0] / row["young"][3] - 1.0) for row in quiet]
    within, inside = sum(one <= row["stated"] for one, row in zip(off, quiet)), sum(row["inside"] for row in quiet)
    lines = [
        f"nothing undeclared: none {none} of {len(quiet)}; modulus within the law's error {within}, interval {inside}"
    ]
    for name in NAMED:
        own = [row for row in put if row["put"] == name]
        first = [row for row in own if row["names"][:1] == [name]]
        rival = [row for row in own if row not in first and name in (row["confounded"] or [[]])[0][:1]]
        sized = sum(row["found"]["low"] <= row["size"] <= row["found"]["high"] for row in first)
        lines.append(f"{name}: first {len(first)} of {len(own)}, second of two {len(rival)}, size inside {sized}")
    return "\n".join(lines)


def main() -> None:
    """Run what is missing and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=5920)
    parser.add_argument("--count", type=int, default=120)
    parser.add_argument("--rows", type=Path)
    options = parser.parse_args()
    path = options.rows or ROOT / "benchmarks" / "results" / f"bent_law_{options.seed}.jsonl"
    known = {row["number"] for row in read_rows(path) if row["seed"] == options.seed}
    with scratch("bent-cache-") as kept:
        os.environ.setdefault("DUMMYDESIGN_CACHE", str(kept))
        for number in range(options.count):
            if number not in known:
                with scratch("bent-") as folder:
                    keep_row(path, run(options.seed, number, folder))
    print(figures([row for row in read_rows(path) if row["seed"] == options.seed]))


if __name__ == "__main__":
    main()

"""Make the response tables from axisymmetric finite elements: ``python -m studies.tables.slab``.

Eight rims per a / h, at Chebyshev nodes in ln(a / h), to d / h = 0.6 or as far as the elements stay sound;
one regression over all values (see ``pad.slab.edge_extrapolation``) gives the series and its stated error.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.user_library import data_folder
from dummydesign.geometry.dimensions import EXTENT_OVER_RADIUS
from dummydesign.pad.axisymmetric.case import Case, first_stiffness
from dummydesign.pad.axisymmetric.sharp_edge import Limit, Samples, fit_limit, solve_rims
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from studies.tables.common import Build, write_table

FIELDS = ("depth", "ratio", "rim", "stiffness")
RATIO_RANGE = (0.25, 2.7)
DEPTHS = np.concatenate([[0.01, 0.02, 0.03, 0.04], np.arange(0.05, 0.6001, 0.025)])
# Outer over punch radius: the 150 x 120 mm slab and the 14 mm square punch, each as the circle of equal area.
TERMS = (10, 9)
# a / h above which a depth counts as reached when two fillets got there.
THIN = 2.2
# Growth of the exponent d ln F / d ln d over d / h beyond which a series is taken to run away; pads reach 3.
STEEPEST = 6.0
RIMS = tuple(0.2 * 0.5**k for k in range(8))


def solve_rung(task: tuple[float, str, float]) -> tuple[float, float, Samples]:
    """Solve one rim of one curve; return a / h, the stiffness at first touch and the values."""
    ratio, base, rim = task
    slab = Case(ratio, EXTENT_OVER_RADIUS * ratio, base)
    samples, _ = solve_rims(slab, DEPTHS, [rim], Resolution())
    return ratio, first_stiffness(slab), samples


def nodes(count: int) -> np.ndarray:
    """Chebyshev nodes in ln(a / h), ends included, in increasing order."""
    low, high = np.log(RATIO_RANGE)
    return np.exp(low + (high - low) * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2.0)


def content(answers: list[tuple[float, float, Samples]], base: str) -> dict[str, Any]:
    """Fit the series to all values and state its errors; return what goes into the file."""
    samples = Samples(*(np.concatenate([getattr(s, name) for _, _, s in answers]) for name in FIELDS))
    first = {ratio: value for ratio, value, _ in answers}
    ratios = np.array(sorted(first))
    limit = fit_limit(
        samples, ratios, np.array([first[r] for r in ratios]), (0.0, float(DEPTHS[-1])), RATIO_RANGE, TERMS
    )
    depths = np.concatenate([[0.0], np.arange(0.05, 0.6001, 0.05)])
    reach = [_reach(samples.depth[samples.ratio == ratio], float(ratio)) for ratio in ratios]
    reach = [min(deep, _smooth_to(limit, float(ratio))) for deep, ratio in zip(reach, ratios)]
    residual = limit.residual
    return {
        "base": base,
        "meaning": "ln(F / (E a d)) = Chebyshev series in d/h and ln(a/h); E long-term, a punch radius, glued punch",
        "coefficients": [[_short(c, 9) for c in row] for row in limit.coefficients],
        "correction": [_short(c, 9) for c in limit.correction],
        "ratio_range": list(RATIO_RANGE),
        "depth_range": [0.0, float(DEPTHS[-1])],
        "limit_ratio": [_short(r) for r in ratios],
        "limit_depth": [_short(r) for r in reach],
        "error_ratio": [_short(r) for r in ratios],
        "error_depth": [_short(d) for d in depths],
        "error": [[_short(e, 3) for e in limit.error(depths, ratio)] for ratio in ratios],
        "provenance": {
            "law": "neo-Hookean, incompressible",
            "punch": "round, flat, glued, sharp edge as the limit of a small rim",
            "extent_over_radius": EXTENT_OVER_RADIUS,
            "curves": len(ratios),
            "values": len(residual),
            "rms_residual": _short(np.sqrt(np.mean(residual**2)), 3),
            "rms_residual_to_depth_0.3": _short(np.sqrt(np.mean(residual[limit.samples.depth < 0.31] ** 2)), 3),
        },
        "first_touch": [_short(first[r], 9) for r in ratios],
        "values": {name: [_short(v, 7) for v in getattr(samples, name)] for name in FIELDS},
    }


def _reach(depth: np.ndarray, ratio: float) -> float:
    """Largest depth in a table: the deepest of all fillets; on thin pads the deepest that two of them reached.

    Above a / h of 2.2 a single fillet leaves a series at its end free: at d/h 0.57 its exponent was 9.6 once.
    """
    depths, count = np.unique(np.round(depth, 9), return_counts=True)
    return float(depths[count >= (2 if ratio > THIN else 1)].max())


def _smooth_to(limit: Limit, ratio: float) -> float:
    """Depth to which the exponent d ln F / d ln d of the series grows no faster than a pad's does."""
    depth = np.linspace(*limit.depth_range, 241)[1:]
    value = limit.log_stiffness(depth, np.array(ratio))
    exponent = 1.0 + depth * np.gradient(value, depth)
    wild = np.nonzero(np.abs(np.gradient(exponent, depth)) > STEEPEST)[0]
    return float(depth[wild[0] - 1]) if len(wild) else float(depth[-1])


def stored(path: Path) -> list[tuple[float, float, Samples]]:
    """Read the values of a table file back, one entry per a / h."""
    data = json.loads(path.read_text(encoding="utf-8"))
    values = Samples(*(np.array(data["values"][name]) for name in FIELDS))
    answers = []
    for ratio, first in zip(nodes(len(data["first_touch"])), data["first_touch"]):
        own = values.take(np.abs(values.ratio / ratio - 1.0) < 1e-4)
        own = Samples(own.depth, np.full(len(own.depth), ratio), own.rim, own.stiffness)
        answers.append((float(ratio), first, own))
    return answers


def _short(number: float, digits: int = 6) -> float:
    return float(f"{number:.{digits}g}")


def main(arguments: list[str] | None = None) -> None:
    """Build the tables named on the command line (both by default)."""
    parser = argparse.ArgumentParser(description="Make the response tables by finite elements.")
    parser.add_argument("--base", choices=("bonded", "sliding"), action="append")
    parser.add_argument("--count", type=int, default=14, help="curves, one per a / h")
    parser.add_argument("--refit", action="store_true", help="fit again the values of the shipped files, solve nothing")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=data_folder() / "materials" / "tables")
    options = parser.parse_args(arguments)
    build = Build.begin("studies.tables.slab", arguments)
    for base in options.base or ["bonded", "sliding"]:
        if options.refit:
            answers = stored(options.out / f"slab-{base}.json")
            write_table(options.out / f"slab-{base}.json", content(answers, base), build)
            continue
        tasks = [(float(ratio), base, rim) for ratio in nodes(options.count) for rim in RIMS]
        answers = []
        with ProcessPoolExecutor(options.workers) as pool:
            for (ratio, _, rim), answer in zip(tasks, pool.map(solve_rung, tasks)):
                answers.append(answer)
                print(f"{base} a/h = {ratio:.3f} rim {rim:.4f}: {len(answer[2].depth)} depths", file=sys.stderr)
        table = content(answers, base)
        write_table(options.out / f"slab-{base}.json", table, build)
        print(f"slab-{base}.json: {table['provenance']}")


if __name__ == "__main__":
    main()

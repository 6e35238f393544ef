"""Processor time of commands as users run them, over that with one thread for linear algebra.

    python -m benchmarks.speed.threads [CAMPAIGN_DIR]

Each command runs as a process of its own with the cache off: once with no thread variable in its environment, once
with one thread named in it. Each row gives wall and processor seconds (user + system) of both, the ratio of the
processor seconds, and whether both printed the same digits. With a folder of a campaign ``loop`` is timed too. The
last row calls a solve from Python, where numpy is loaded with all its threads before this package is.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

PREDICT = ["-m", "dummydesign", "predict", "--young", "25", "--thickness", "10", "--json"]
LIBRARY = """
import json
import numpy, scipy.linalg
from dummydesign.pad.spatial.square_punch import CornerCells, SquareProblem, solve_ratios
found = solve_ratios(SquareProblem((0.7, 0.7), (7.5, 6.0)), numpy.array([0.1]), CornerCells(0.14))
print(json.dumps({"ratio": found.ratio.tolist()}))
"""
COMMANDS = {
    "predict 3d, 3 depths": [*PREDICT, "--depth", "1,2,3", "--fidelity", "3d"],
    "predict axisymmetric, 12 depths": [
        *PREDICT,
        "--depth",
        ",".join(f"{0.3 * step:.1f}" for step in range(1, 13)),
        "--fidelity",
        "axisymmetric",
    ],
    "suggest --shape auto": [
        "-m",
        "dummydesign",
        "suggest",
        "--tissue",
        "forefinger",
        "--shape",
        "auto",
        "--no-cad",
        "--json",
    ],
    "loop": ["-m", "dummydesign", "loop", "{campaign}", "--out", "loop", "--json"],
    "from Python, one solve in space": ["-c", LIBRARY],
}
VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")


def measure(arguments: list[str], threads: str | None) -> tuple[float, float, Any]:
    """Run Python with arguments: wall seconds, processor seconds, and what it printed without its times."""
    root = str(Path(__file__).resolve().parents[2])
    environment = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    environment |= {} if threads is None else dict.fromkeys(VARIABLES, threads)
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, (root, os.environ.get("PYTHONPATH"))))
    environment["DUMMYDESIGN_CACHE"] = "off"
    with tempfile.TemporaryDirectory() as folder:
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run(
            [sys.executable, *arguments], env=environment, cwd=folder, stdout=subprocess.PIPE, check=True
        )
        wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return wall, spent, timeless(json.loads(done.stdout))


def timeless(value: Any) -> Any:
    """The answer without the seconds it took."""
    if isinstance(value, dict):
        return {name: timeless(one) for name, one in value.items() if "seconds" not in name}
    return [timeless(one) for one in value] if isinstance(value, list) else value


def main() -> None:
    """Measure all commands and print a table."""
    campaign = str(Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else None
    print(f"{os.cpu_count()} processor cores; seconds: wall / processor")
    print(f"{'command':<32} {'plain shell':>16} {'one thread':>16} {'ratio':>6}  same digits")
    for name, arguments in COMMANDS.items():
        if "{campaign}" in arguments and campaign is None:
            continue
        arguments = [part.replace("{campaign}", campaign or "") for part in arguments]
        plain, one = measure(arguments, None), measure(arguments, "1")
        times = [f"{wall:.1f} / {spent:.1f}" for wall, spent, _ in (plain, one)]
        same = "yes" if plain[2] == one[2] else "no"
        print(f"{name:<32} {times[0]:>16} {times[1]:>16} {plain[1] / one[1]:>6.2f}  {same}", flush=True)


if __name__ == "__main__":
    main()

"""Counts and processor time of finite-element paths of pads: a crown, three searches, presses to several forces.

    python -m benchmarks.speed.pad_paths [--beside CHECKOUT] [--out benchmarks/results/speed_pad_paths.json] [NAME ...]

Every case runs in a process of its own with the cache off. Processor seconds depend on the machine and on what else
it does: with ``--beside`` the same cases run alternately in another checkout, and the ratio of both is written. Counts
depend on neither.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from dummydesign.core.blas_threads import ONE_THREAD

ROOT = Path(__file__).resolve().parents[2]
CROWN = ["--thickness", "11", "--shape", "crowned:2.4,3.5,7.8", "--fidelity", "axisymmetric", "--punch", "round:15.798"]
COMMANDS = {
    "one crown": ["predict", *CROWN, "--young", "30", "--depth", "1,2,3,4,5,5.5"],
    **{f"suggest {name}": ["suggest", "--tissue", name, "--no-cad"] for name in ("palm", "thenar", "forefinger")},
    "suggest palm, slab": ["suggest", "--tissue", "palm", "--shape", "slab", "--no-cad", "--no-verify"],
    "three forces on a crown": [
        "predict",
        *CROWN,
        "--resin",
        "polyurethane-nagoya",
        "--ratio",
        "16",
        "--force",
        "0.5,1,2",
        "--velocity",
        "10",
    ],
}
COUNTED = {
    "states": ("pad.fem.mixed_solid", "Solid", "state"),
    "tangents": ("pad.fem.mixed_solid", "Solid", "linearise"),
    "factorisations": ("pad.solve.sparse", "Pattern", "solve"),
    "further_solves": ("pad.solve.sparse", "Pattern", "again"),
}
PATHS = ("pad.axisymmetric.shaped_problem", "follow")


def measure(name: str) -> dict[str, Any]:
    """Run one command in this process and count."""
    import importlib
    from contextlib import redirect_stdout

    from dummydesign.cli.entry import run

    counts, seconds = dict.fromkeys((*COUNTED, "paths"), 0), dict.fromkeys((*COUNTED, "paths"), 0.0)

    def counted(owner: Any, attribute: str, key: str) -> None:
        whole = getattr(owner, attribute)

        def call(*args: Any, **more: Any) -> Any:
            counts[key] += 1
            start = time.process_time()
            answer = whole(*args, **more)
            seconds[key] += time.process_time() - start
            return answer

        setattr(owner, attribute, call)

    for key, (module, owner, attribute) in COUNTED.items():
        counted(getattr(importlib.import_module(f"dummydesign.{module}"), owner), attribute, key)
    counted(importlib.import_module(f"dummydesign.{PATHS[0]}"), PATHS[1], "paths")
    began = time.process_time()
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere):
        status = run(COMMANDS[name])
    spent = time.process_time() - began
    # a further solve is also counted within the factorisation that it belongs to
    counts["further_solves"] -= counts["factorisations"]
    took = {"processor_s": round(spent, 2), "paths_s": round(seconds["paths"], 2)}
    return {"case": name, "status": status or 0} | took | counts


def main() -> None:
    """Measure all or some cases; print a line a case, and write them all."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", default=[])
    parser.add_argument("--beside", type=Path)
    parser.add_argument("--repeats", type=int, default=2)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--one", action="store_true")
    asked = parser.parse_args()
    if asked.one:
        print(json.dumps(measure(asked.names[0])), flush=True)
        return
    trees = {"here": ROOT} | ({"beside": asked.beside.resolve()} if asked.beside else {})
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        for name in asked.names or COMMANDS:
            runs: dict[str, list[dict[str, Any]]] = {tree: [] for tree in trees}
            for tree in [*trees] * asked.repeats:
                # as the command line sets them for itself: a second BLAS thread only waits, which counts as time
                own = os.environ | ONE_THREAD | {"DUMMYDESIGN_CACHE": "off", "PYTHONPATH": str(trees[tree])}
                command = [sys.executable, __file__, "--one", name]
                text = subprocess.run(command, capture_output=True, text=True, check=True, cwd=folder, env=own)
                runs[tree].append(json.loads(text.stdout.splitlines()[-1]))
            best = {tree: min(made, key=lambda one: float(one["processor_s"])) for tree, made in runs.items()}
            row = {**best["here"]}
            if "beside" in best:
                row |= {"beside": best["beside"], "ratio": round(row["processor_s"] / best["beside"]["processor_s"], 3)}
            rows.append(row)
            print(row, flush=True)
    if asked.out:
        command_line = "python -m benchmarks.speed.pad_paths --beside CHECKOUT --out FILE"
        asked.out.write_text(json.dumps({"command": command_line, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

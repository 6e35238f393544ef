"""The answers of every command, recorded and compared to the last digit.

``python -m tests.answers record FILE`` runs a fixed set of command lines with the package of the checkout this
file stands in and writes what they answered; ``python -m tests.answers compare FILE`` runs them again and tells
each value that differs (exit 1 if any). For changes that should change nothing: moved files, shorter functions.
The inputs are made without the package (``tests/support/answer_inputs.py``). Seconds, version and folders are left out.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.support.answer_inputs import make_inputs

ROOT = Path(__file__).resolve().parents[1]
VOLATILE = {"seconds", "version"}


@dataclass(frozen=True)
class Case:
    """One command line, asked with ``--json`` unless it is bad input."""

    name: str
    words: str
    json: bool = True


SUGGEST = "--no-cad --no-verify --out out"
PRESSES = " ".join(f"../in/press_{k}.csv" for k in range(4))
CASES = [
    Case("resins list", "resins list"),
    Case("resins show", "resins show ecoflex-00-30"),
    Case("tissues list", "tissues list"),
    Case("tissues show", "tissues show palm"),
    Case("predict table", "predict --young 25 --thickness 7 --depth 0,0.5,1,2,3.5"),
    Case("predict resin", "predict --resin ecoflex-00-30 --ratio 20 --thickness 12 --depth 1,4 --base sliding"),
    Case("predict motion", "predict --resin ecoflex-00-30 --ratio 15.5 --thickness 10 --motion ../in/press_1.csv"),
    Case("predict hold", "predict --young 25 --thickness 5 --force 12 --velocity 250 --hold 2 --prony 0.08:0.4,2:0.2"),
    Case("predict round", "predict --young 30 --thickness 9 --depth 0.5,3 --punch round:12"),
    Case("predict poisson", "predict --young 30 --thickness 9 --depth 0.3 --poisson 0.48 --fidelity axisymmetric"),
    Case(
        "predict frictionless",
        "predict --young 30 --thickness 9 --depth 0.3 --punch round:12 --condition frictionless"
        " --fidelity axisymmetric",
    ),
    Case("predict axisymmetric", "predict --young 25 --thickness 10 --depth 0.4,0.8 --fidelity axisymmetric"),
    Case(
        "predict yeoh",
        "predict --young 25 --thickness 10 --depth 0.5 --fidelity axisymmetric --law yeoh:0.2 --base sliding",
    ),
    Case(
        "predict ball",
        "predict --young 25 --thickness 10 --depth 0.5,1 --punch profile:../in/ball.csv --condition frictionless"
        " --fidelity axisymmetric",
    ),
    Case(
        "predict puck",
        "predict --young 25 --thickness 30 --depth 2,5 --punch plate --pad cylinder:50 --condition friction:0.3"
        " --fidelity axisymmetric",
    ),
    Case("predict shaped", "predict --young 25 --thickness 10 --depth 0.5,2,4 --shape crowned:10,2"),
    Case(
        "predict shaped axisymmetric",
        "predict --young 25 --thickness 12 --depth 0.5,1 --shape crowned:10,2 --fidelity axisymmetric",
    ),
    Case("predict mass", "predict --ratio 15.4 --thickness 8 --drive mass:0.3 --velocity 150 --out hit.csv"),
    Case("predict bottoms", "predict --ratio 15.4 --thickness 8 --drive mass:5 --velocity 250"),
    Case("gone option", "suggest --tissue palm --robot-mass 2", json=False),
    Case("predict layered", "predict --young 25 --thickness 10 --depth 0.5,2 --shape layered:3,0.4"),
    Case("fit", f"fit {PRESSES} --out tissue.toml"),
    Case("fit by speed", "fit ../in/press_0.csv ../in/press_3.csv --elements 3 --mode per-speed"),
    Case("compare", f"compare {PRESSES} --tissue forefinger --out out"),
    Case("suggest slab", f"suggest --tissue forefinger --shape slab {SUGGEST}"),
    Case("suggest verified", "suggest --tissue forefinger --shape slab --thickness 6:9 --no-cad --out out"),
    Case("suggest crowned", f"suggest --tissue forefinger --shape crowned {SUGGEST}"),
    Case("suggest palm", f"suggest --tissue palm --shape slab {SUGGEST}"),
    Case("suggest safe", f"suggest --tissue thenar --aim safe-side --resin ecoflex-00-10 --shape slab {SUGGEST}"),
    Case("whatif table", "whatif --thickness 4:20:4 --ratio 14,15.5,17 --out out"),
    Case(
        "whatif lists",
        "whatif --thickness 5,12 --punch square:14,round:16 --base bonded,sliding --velocity 10,50,250 --force 2,8"
        " --resin ecoflex-00-30 --ratio 10 --out out",
    ),
    Case("whatif tissue", "whatif --thickness 6,9,12 --ratio 15,16 --tissue palm --aim safe-side --out out"),
    Case("mold open", "mold --thickness 6 --length 40 --width 30 --out out"),
    Case("mold lidded", "mold --thickness 6 --length 60 --width 50 --preset lidded --ratio 16 --out out"),
    Case("loop", "loop ../in/campaign --out out"),
    Case("replay", "replay ../in/campaign --calibration ../loop/out/calibration.json"),
    Case(
        "suggest calibrated",
        f"suggest --tissue palm --calibration ../loop/out/calibration.json --shape slab {SUGGEST}",
    ),
    Case("tissues add", f"tissues add mine {PRESSES}"),
    Case("tissues add-points", "tissues add-points palm ../in/points.csv"),
    Case("tissues show mine", "tissues show mine"),
    Case("resins add", "resins add ../in/batch.toml"),
    Case(
        "resins add-compression",
        "resins add-compression ../in/puck.csv --diameter 50 --height 30 --name pucks --ratio 15",
    ),
    Case("resins show batch", "resins show batch --out out"),
    Case("resins list again", "resins list"),
    Case("bad command", "sugest", json=False),
    Case("bad tissue", "suggest --tissue forefingr", json=False),
    Case("bad aim", "suggest --tissue palm --aim best", json=False),
    Case("bad shape", "suggest --tissue palm --shape crownd --no-cad --no-verify", json=False),
    Case("no design", f"suggest --tissue forefinger --shape slab --thickness 28:30 --ratio 14:14.2 {SUGGEST}"),
    Case("bad ratio", "predict --resin polyurethane-nagoya --ratio 40 --thickness 5 --depth 1", json=False),
    Case("poisson off the table", "predict --young 30 --thickness 9 --depth 0.5 --poisson 0.48", json=False),
    Case("shape off the table", "predict --young 25 --thickness 12 --depth 1 --shape crowned:10,2", json=False),
    Case("too deep", "predict --young 25 --thickness 5 --depth 4", json=False),
    Case("negative thickness", "predict --young 25 --thickness -5 --depth 1", json=False),
    Case("out of reach", "predict --young 25 --thickness 5 --force 500 --velocity 10"),
    Case("bad law", "predict --young 25 --thickness 5 --depth 1 --law mooney", json=False),
    Case("too many", "whatif --thickness 3:30:0.001 --ratio 14:17:0.001", json=False),
    Case("bad range", "whatif --thickness 3:30", json=False),
    Case("bad trace", "fit ../in/broken.csv", json=False),
    Case("bad elements", "fit ../in/press_0.csv --elements 4", json=False),
    Case("thin mould", "mold --thickness 2", json=False),
    Case("bad preset", "mold --thickness 6 --preset opne", json=False),
    Case("no campaign", "loop nowhere", json=False),
    Case("no calibration", "replay ../in/campaign --calibration nowhere.json", json=False),
    Case("bad points", "tissues add-points palm ../in/press_0.csv", json=False),
    Case("bad resin", "resins show polyurethan", json=False),
]


def steady(value: Any, places: dict[str, str]) -> Any:
    """The value without what changes from run to run."""
    if isinstance(value, dict):
        return {key: steady(item, places) for key, item in value.items() if key not in VOLATILE}
    if isinstance(value, list):
        return [steady(item, places) for item in value]
    if isinstance(value, str):
        for place, name in places.items():
            value = value.replace(place, name)
    return value


def made_files(folder: Path) -> dict[str, str]:
    """Names of all files written; of tables and solids a digest of their bytes."""
    found = {}
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        digest = path.suffix in (".csv", ".step", ".3mf")
        found[path.relative_to(folder).as_posix()] = hashlib.sha256(path.read_bytes()).hexdigest() if digest else ""
    return found


def ask(case: Case, top: Path) -> dict[str, Any]:
    """Run one command line in its own folder; answer, exit status and files."""
    folder = top / case.name.replace(" ", "_")
    folder.mkdir()
    threads = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
    env = {
        **os.environ,
        **threads,
        "PYTHONPATH": str(ROOT),
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONHASHSEED": "0",
        "DUMMYDESIGN_CACHE": "off",
        "DUMMYDESIGN_HOME": str(top / "home"),
    }
    env.pop("DUMMYDESIGN_DEBUG", None)
    words = [*case.words.split(), *(["--json"] if case.json else [])]
    done = subprocess.run(
        [sys.executable, "-m", "dummydesign", *words], cwd=folder, env=env, capture_output=True, text=True
    )
    places = {str(top): "<top>", str(ROOT): "<checkout>"}
    found: dict[str, Any] = {"command": " ".join(words), "exit": done.returncode}
    found["stderr"] = steady(re.sub(r"\d+(\.\d+)? s\b", "<seconds> s", done.stderr.strip()), places)
    if case.json:
        try:
            found["answer"] = steady(json.loads(done.stdout), places)
        except json.JSONDecodeError:
            found["stdout"] = done.stdout[-2000:]
    found["files"] = made_files(folder)
    return found


def all_answers(only: str | None) -> dict[str, Any]:
    """Run every case whose name holds ``only``, in order: later ones read what earlier ones wrote."""
    found = {}
    with tempfile.TemporaryDirectory(prefix="answers-") as place:
        top = Path(place).resolve()
        (top / "home").mkdir()
        make_inputs(top / "in")
        for case in CASES:
            if only is None or only in case.name:
                begun = time.perf_counter()
                found[case.name] = ask(case, top)
                spent = time.perf_counter() - begun
                print(f"{spent:6.1f} s  exit {found[case.name]['exit']}  {case.name}", file=sys.stderr, flush=True)
    return found


def differences(before: Any, after: Any, where: str = "") -> list[str]:
    """Each value that is not the same, with where it stands."""
    if isinstance(before, dict) and isinstance(after, dict):
        lines = [f"{where}/{key}: gone" for key in before if key not in after]
        lines += [f"{where}/{key}: new" for key in after if key not in before]
        return lines + [
            line for key in before if key in after for line in differences(before[key], after[key], f"{where}/{key}")
        ]
    if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        return [line for k, pair in enumerate(zip(before, after)) for line in differences(*pair, f"{where}[{k}]")]
    same = type(before) is type(after) and (before == after or repr(before) == repr(after))
    return [] if same else [f"{where}: {_short(before)} -> {_short(after)}"]


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 200 else text[:197] + "..."


def main() -> int:
    """Record the answers, or compare with recorded ones."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=["record", "compare"])
    parser.add_argument("file", type=Path)
    parser.add_argument("--only", metavar="WORD", help="the cases whose name holds it")
    options = parser.parse_args()
    before = json.loads(options.file.read_text(encoding="utf-8")) if options.action == "compare" else None
    found = all_answers(options.only)
    if before is None:
        options.file.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        print(f"{len(found)} answers written to {options.file}")
        return 0
    if options.only is not None:
        before = {name: answer for name, answer in before.items() if options.only in name}
    lines = differences(before, found)
    print("\n".join(lines) if lines else f"{len(found)} answers are the same")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())

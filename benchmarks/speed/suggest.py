"""Time and memory of ``suggest`` and ``whatif`` as whole processes, beside a bare interpreter start.

    python -m benchmarks.speed.suggest [REPEATS]

Prints the fastest of REPEATS warm runs (default 7), its ratio to a bare interpreter, the processor time, and
the largest memory, and the machine's load then. Processor time is what to compare on a machine that does other work.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

COMMANDS = {
    "bare interpreter": ["-c", "pass"],
    "--help": ["-m", "dummydesign", "--help"],
    "resins list": ["-m", "dummydesign", "resins", "list"],
    **{
        f"suggest {name}": ["-m", "dummydesign", "suggest", "--tissue", name, "--no-cad", "--no-verify"]
        for name in ("forefinger", "palm", "thenar")
    },
    "search alone, forefinger": [
        "-c",
        "from dummydesign import suggest; suggest('forefinger').to_dict()",
    ],
    "whatif, 1000 designs": [
        "-m",
        "dummydesign",
        "whatif",
        "--thickness",
        "3:22.5:0.5",
        "--ratio",
        "14:20:0.25",
        "--out",
        "{out}",
    ],
}
CHILD = """
import os, resource, subprocess, sys, time
start = time.perf_counter()
status = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
seconds = time.perf_counter() - start
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(status, seconds, used.ru_utime + used.ru_stime, used.ru_maxrss)
"""


def measure(arguments: list[str], folder: str) -> tuple[float, float, float]:
    """Run one command in a child of a child, so that its memory is its own: seconds, processor seconds, MB."""
    command = [sys.executable, "-c", CHILD, sys.executable, *arguments]
    text = subprocess.run(command, capture_output=True, text=True, check=True, cwd=folder).stdout.split()
    if int(text[0]) != 0:
        raise SystemExit(f"{' '.join(arguments)} ended with status {text[0]}")
    per_MB = 1024.0 if sys.platform != "darwin" else 1024.0**2
    return float(text[1]), float(text[2]), float(text[3]) / per_MB


def main() -> None:
    """Measure all commands and print a table."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    os.environ["DUMMYDESIGN_CACHE"] = "off"
    # run from this repository when it is not installed, and leave the reports in a folder of their own
    root = str(Path(__file__).resolve().parents[2])
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (root, os.environ.get("PYTHONPATH"))))
    bare = 0.0
    print(f"{'command':<24} {'wall s':>8} {'of bare':>8} {'processor s':>12} {'memory MB':>10} {'load':>5}")
    with tempfile.TemporaryDirectory() as out:
        for name, arguments in COMMANDS.items():
            arguments = [part.format(out=out) for part in arguments]
            measure(arguments, out)
            runs = [measure(arguments, out) for _ in range(repeats)]
            wall, processor, memory = (f(column) for f, column in zip((min, min, max), zip(*runs)))
            bare, load = bare or wall, os.getloadavg()[0]
            print(f"{name:<24} {wall:>8.3f} {wall / bare:>8.1f} {processor:>12.3f} {memory:>10.0f} {load:>5.1f}")


if __name__ == "__main__":
    main()

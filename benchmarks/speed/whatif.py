"""Time of what-if studies: the 1000-design map, its report, and how a sweep scales from one worker to two.

    python -m benchmarks.speed.whatif [REPEATS]

Prints the fastest of REPEATS runs (default 5). Wall times want an idle machine; the load is printed beside them.
The scaling sweep takes score and presses of 40,000 designs, so that starting a process does not hide the work.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from dummydesign.design.sweep.rows import settings_of, write_rows
from dummydesign.design.sweep.run import open_executor, targets_of, tasks_of, whatif
from dummydesign.design.sweep.spec import Study, parse_shapes
from dummydesign.report.whatif import write_whatif
from dummydesign.resin import load_resin

SQUARE = (("square:14", 14.0 / np.sqrt(np.pi)),)
THOUSAND = Study(tuple(np.linspace(3.0, 30.0, 40)), tuple(np.linspace(14.0, 20.0, 25)), SQUARE)
SHAPED = Study(
    tuple(np.linspace(4.0, 8.0, 5)),
    tuple(np.linspace(15.0, 16.0, 10)),
    SQUARE,
    tissue="forefinger",
    shapes=parse_shapes("crowned:radius=12:22:2.5,height=1.5:3:0.5,foot=9.4"),
)
SOLVED = Study(
    tuple(np.linspace(5.0, 9.0, 5)),
    tuple(np.linspace(14.6, 16.4, 10)),
    SQUARE,
    fidelity="axisymmetric",
    shapes=parse_shapes("crowned:radius=12:22:2,height=1.5,foot=9.4"),
)
MANY = Study(tuple(np.linspace(3.0, 30.0, 200)), tuple(np.linspace(14.0, 20.0, 200)), SQUARE, tissue="palm")


def fastest(repeats: int, action: Callable[[], object]) -> float:
    """Shortest of some wall times. [s]"""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    """Measure and print."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    resin = load_resin()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    print(f"1000 designs, table: {fastest(repeats, lambda: whatif(THOUSAND)):.3f} s")
    rows = whatif(THOUSAND)["rows"]
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)

        def filed() -> None:
            write_rows(home, THOUSAND, settings_of(THOUSAND, resin, None), whatif(THOUSAND)["rows"])

        print(f"the same with its file: {fastest(repeats, filed):.3f} s")
        report = fastest(repeats, lambda: write_whatif(home, THOUSAND, rows, resin, None, []))
        print(f"its report: {report:.3f} s")
    print(f"{SHAPED.size} shaped designs, table, scored: {fastest(repeats, lambda: whatif(SHAPED)):.3f} s")
    tasks = len(list(tasks_of(MANY, resin, targets_of(MANY))))
    one = fastest(1, lambda: whatif(MANY))
    print(f"{MANY.size} scored designs in {tasks} tasks, this process: {one:.1f} s")
    with open_executor(2) as pool:
        # started and warm before the clock runs
        whatif(THOUSAND, executor=pool)
        two = fastest(1, lambda: whatif(MANY, executor=pool))
        print(f"the same in 2 processes: {two:.1f} s, {one / two:.2f} times as fast")
        os.environ["DUMMYDESIGN_CACHE"] = "off"
        one = fastest(1, lambda: whatif(SOLVED))
        two = fastest(1, lambda: whatif(SOLVED, executor=pool))
        print(
            f"{SOLVED.size} solved designs of {len(list(tasks_of(SOLVED, resin, None)))} pads: {one:.1f} s here, "
            f"{two:.1f} s in 2 processes, {one / two:.2f} times as fast"
        )


if __name__ == "__main__":
    main()

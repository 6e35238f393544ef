"""Time and memory of making a mould as a whole process: ``python -m benchmarks.speed.mold_build``.

Prints wall seconds, CPU seconds of the command with its children, their ratio to a bare
``import cadquery`` (which makes machines comparable) and the peak memory of the CAD child.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CASES = (
    ("open", 4.5, "crowned:21.2,2,9.4"),
    ("open", 5.0, "slab"),
    ("open", 20.0, "slab"),
    ("lidded", 5.0, "slab"),
    ("lidded", 20.0, "slab"),
)
LIMIT_S = {"open": 8.0, "lidded": 12.0}
"""What a mould with all its files may take of the processor on an idle machine. [s]"""
LIMIT_IMPORTS = {"open": 5.0, "lidded": 7.0}
"""The same over a bare import of CadQuery, which a busy machine slows down alike."""
LIMIT_MB = 700.0


def timed(command: list[str]) -> tuple[float, float]:
    """Run a command; return wall and CPU seconds, children included."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def child_memory_MB(preset: str, thickness_mm: float, shape: str) -> float:
    """Peak memory of the CAD child, as it reports itself."""
    from dummydesign.geometry.shape_registry import read_shape
    from dummydesign.mold.client import make_mold
    from dummydesign.mold.model.preset import mould_spec

    with tempfile.TemporaryDirectory() as folder:
        made = read_shape(shape)
        spec = mould_spec(thickness_mm, preset=preset, kind=made.name, parameters=made.parameters)
        return make_mold(spec, Path(folder)).memory_MB


def main() -> None:
    """Print the table."""
    timed([sys.executable, "-c", "import cadquery"])
    bare_wall, bare_cpu = timed([sys.executable, "-c", "import cadquery"])
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    print(f"bare import of CadQuery: {bare_wall:.1f} s wall, {bare_cpu:.1f} s CPU; load {load:.1f}")
    short = []
    print(f"{'mould':<26} {'t mm':>5} {'wall s':>7} {'CPU s':>6} {'CPU / import':>12} {'child MB':>9} {'limit s':>8}")
    for preset, thickness, shape in CASES:
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "dummydesign", "mold", "--thickness", f"{thickness:g}"]
            wall, cpu = timed([*command, "--shape", shape, "--preset", preset, "--out", folder])
        memory = child_memory_MB(preset, thickness, shape)
        ratio, name = cpu / bare_cpu, f"{preset} {shape}"
        print(f"{name:<26} {thickness:5g} {wall:7.1f} {cpu:6.1f} {ratio:12.1f} {memory:9.0f} {LIMIT_S[preset]:8g}")
        limits = (cpu, LIMIT_S[preset], "s"), (ratio, LIMIT_IMPORTS[preset], "imports"), (memory, LIMIT_MB, "MB")
        for value, limit, unit in limits:
            if value > limit:
                short.append(f"{name}, {thickness:g} mm: {value:.1f} {unit} against {limit:g} {unit}")
    print("falls short: " + ("; ".join(short) or "nothing"))


if __name__ == "__main__":
    main()

"""How ``dummydesign import`` does on drawn files: share read right, error of contact, speed and memory.

``python -m benchmarks.accuracy.import_files [--sets 0:96,7000:7240] [--fast 9000:9240] [--skip-speed]`` draws files of
test machines (``tests/support/machine_files.py``), imports each and holds what comes out against the truth
(``tests/support/import_rates.py``); ``--contact 0.1:0.03`` is a stricter tolerance of the contact [mm, share of the
depth]. The blind series is ``--sets 61000:61240 --contact 0.1:0.03``, seeds that were written here before they were
drawn for the first time. A set is a range of seeds; the files of ``--fast`` are pressed at 50 or 250 mm/s in
coordinates whose zero is not at contact. Times are processor seconds of the command, start included.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from dummydesign.measurement.importing.contact import find_contact
from dummydesign.measurement.importing.sign_convention import find_presses
from tests.support.import_rates import CONTACT_MM, CONTACT_SHARE, judge
from tests.support.machine_files import machine_file
from tests.support.machine_presses import recording


def rates(seeds: range, fast: bool, folder: Path, contact: tuple[float, float]) -> Counter:
    """Verdicts over a set; each file that is not right in a line of its own."""
    counts: Counter = Counter()
    for seed in seeds:
        made = machine_file(seed, fast)
        outcome = judge(made, folder, *contact)
        silent = outcome.verdict == "wrong" and not outcome.warned
        counts["wrong without a word" if silent else outcome.verdict] += 1
        if outcome.verdict != "right" and not fast:
            print(f"  {seed} {made.facts['dialect']}: {outcome.verdict}, {outcome.text[:90]}")
    return counts


def contact_errors(law: str, seeds: range) -> tuple[float, float]:
    """Root mean square error of the contact of single presses at 2 and 10 mm/s, and coverage of the intervals."""
    off, inside = [], []
    for seed in seeds:
        record = recording(seed, velocity_mm_s=(2.0, 10.0)[seed % 2], filtered=False)
        if record.law != law:
            continue
        load = record.force_N - np.median(record.force_N[:5])
        span = find_presses("drawn", record.displacement_mm, load, True)[0]
        contact = find_contact(record.time_s, record.displacement_mm, load, span)
        off.append(contact.position_mm)
        inside.append(contact.low_mm <= 0.0 <= contact.high_mm)
    return float(np.sqrt(np.mean(np.square(off)))), float(np.mean(inside))


def long_file(path: Path, separator: str, decimal: str, head: str) -> None:
    """600,000 samples of one press."""
    time = np.arange(600_000) * 1e-4
    x = np.interp(time, [0, 1, 1.6, 30, 31, 60], [-1, -1, 5, 5, -1, -1])
    relaxed = 0.8 + 0.2 * np.exp(-np.maximum(time - 1.6, 0) / 2)
    rng = np.random.default_rng(1)
    force = 2 * np.maximum(x, 0) ** 1.5 * relaxed + rng.normal(0, 0.01, len(time))
    rows = np.stack([time, x + rng.normal(0, 0.0005, len(time)), force], axis=1).ravel().tolist()
    body = (separator.join(["%.4f"] * 3) + "\n") * len(time) % tuple(rows)
    path.write_text(head + "\n" + (body if decimal == "." else body.replace(".", decimal)), encoding="utf-8")


def timed(words: list[str]) -> str:
    """Run the command and say what it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = (
        "import sys\nfrom dummydesign.cli.entry import run\n"
        f"status = run({words!r})\n"
        "peak = next(line for line in open('/proc/self/status') if line.startswith('VmHWM'))\n"
        "print(peak.split()[1], file=sys.stderr)\nsys.exit(status)"
    )
    environment = {**os.environ, "DUMMYDESIGN_CACHE": "off"}
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        environment.pop(name, None)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return f"{used:.1f} s, {int(done.stderr.split()[-1]) / 1024:.0f} MB"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", default="0:96,7000:7240,20000:20240,30000:30240")
    parser.add_argument("--fast", default="9000:9240")
    parser.add_argument("--contact", default=f"{CONTACT_MM:g}:{CONTACT_SHARE:g}")
    parser.add_argument("--skip-speed", action="store_true")
    options = parser.parse_args()
    low, high = map(float, options.contact.split(":"))
    contact = low, high
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for fast, text in ((False, options.sets), (True, options.fast)):
            for part in filter(None, text.split(",")):
                first, last = map(int, part.split(":"))
                seeds = range(first, last)
                kind = "fast, zero not at contact" if fast else "files"
                print(f"{kind} {part}: {dict(rates(seeds, fast, folder, contact))}")
        for law in ("tissue", "pad", "hertz"):
            error, held = contact_errors(law, range(40000, 40300))
            print(f"contact, {law}: rms {error:.3f} mm, intervals hold the truth {held:.2f}")
        if options.skip_speed:
            return
        long_file(folder / "dot.csv", ",", ".", "time_s,displacement_mm,force_N")
        long_file(folder / "comma.csv", ";", ",", "Zeit [s];Weg [mm];Kraft [N]")
        for file in ("dot.csv", "comma.csv"):
            print(f"600,000 samples, {file}: {timed(['import', str(folder / file), '--out', str(folder / 'out')])}")
        many = folder / "many"
        many.mkdir()
        drawn = (machine_file(seed) for seed in range(1000))
        for made, _ in zip((file for file in drawn if file.facts["zero"] == "own"), range(36)):
            (many / made.name).write_bytes(made.data)
        print(f"36 files: {timed(['import', str(many), '--out', str(folder / 'all')])}")


if __name__ == "__main__":
    main()

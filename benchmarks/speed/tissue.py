"""Time of a fit and of a tissue's ranges: ``python -m benchmarks.speed.tissue``, in processor seconds of one core.

Eighteen traces of 10 s at 1 kHz are fitted with the number of elements chosen; then the six force variation ranges
of a shipped tissue (three steady forces, two speeds), nothing kept from before.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import replace

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", DUMMYDESIGN_CACHE="off")

import numpy as np

from benchmarks.accuracy.fit_coverage import GAMMA1, press
from dummydesign.tissue.fitting.fit import fit_traces
from dummydesign.tissue.model.tissue_file import load_tissue

REPEATS = 3


def fastest(work: Callable[[], object]) -> float:
    """Fewest processor seconds of a few runs."""
    spent = []
    for _ in range(REPEATS):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return min(spent)


def main() -> None:
    """Measure both and print them."""
    rng = np.random.default_rng(1)
    traces = []
    for repeat in range(3):
        for velocity in (10.0, 250.0):
            for steady in (5.0, 10.0, 15.0):
                clean = press(velocity, np.cbrt(steady / GAMMA1))
                noise = rng.normal(0.0, 0.03, len(clean.time_s))
                traces.append(replace(clean, name=f"{repeat}_{clean.name}", force_N=clean.force_N + noise))
    print(f"fit of {len(traces)} traces: {fastest(lambda: fit_traces(traces)):.2f} s")

    def ranges() -> None:
        tissue = load_tissue("palm")
        for steady in (5.0, 10.0, 15.0):
            for velocity in (10.0, 250.0):
                tissue.force_range(steady, velocity)

    print(f"six force variation ranges of the palm: {fastest(ranges):.3f} s")


if __name__ == "__main__":
    main()

"""A reader of one's own machine: a file that `import` cannot know becomes traces, and is checked like any other.

The machine of this example writes .npy: rows of microseconds, encoder counts (2000 a millimetre) and millinewton.
"""

import tempfile
from pathlib import Path

import numpy as np

import dummydesign

COUNTS_PER_MM = 2000.0


def write_csv(path: Path, folder: Path) -> Path:
    """Write one file of the machine as CSV with a name and a unit for each column."""
    time_us, counts, force_mN = np.load(path).T
    rows = np.column_stack([1e-6 * time_us, counts / COUNTS_PER_MM, 1e-3 * force_mN])
    target = folder / f"{path.stem}.csv"
    np.savetxt(target, rows, delimiter=",", header="Time (s),Displacement (mm),Force (N)", comments="", fmt="%.7g")
    return target


def make_press(path: Path) -> None:
    """Write a press as the machine would: approach, contact at 1 mm, stop at 4 mm, hold; a foam of 0.1 N/mm2."""
    time_s = np.arange(0.0, 4.0, 0.002)
    depth_mm = np.minimum(2.0 * time_s, 4.0)
    force_N = 0.1 * np.maximum(depth_mm - 1.0, 0.0) ** 2 + np.random.default_rng(1).normal(0.0, 0.001, len(time_s))
    np.save(path, np.column_stack([1e6 * time_s, np.round(COUNTS_PER_MM * depth_mm), 1e3 * force_N]))


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    make_press(folder / "press1.npy")
    read = dummydesign.import_traces([write_csv(folder / "press1.npy", folder)], out=folder / "traces")
    for trace in read.to_dict()["files"][0]["traces"]:
        print(f"{trace['file']}: {trace['samples']} samples at {trace['velocity_mm_s']:.3g} mm/s")
        print(f"depth {trace['depth_mm']:.3g} mm, steady force {trace['steady_force_N']:.3f} N (0.9 N was made)")
    print(f"warnings: {[warning['code'] for warning in read.to_dict()['warnings']]}")

"""Processor time of ``on-person``, ten seconds at 1 kHz: ``python -m benchmarks.speed.on_person_time``."""

from __future__ import annotations

import time

from dummydesign.person.drives import read_drive
from dummydesign.person.on_person import on_person
from tests.person.test_on_person import TISSUE, press

DRIVES = ("position", "steady", "force", "mass:2", "spring:1000,3", "spring:100,3", "spring:1000,3,0.05")


def main() -> None:
    """Print seconds a subject of each drive."""
    trace = press(250.0, 1.4, 10.0, noise_N=0.02, noise_mm=0.001)
    on_person([trace], TISSUE, read_drive("position"))  # modules are loaded
    for drive in DRIVES:
        begun = time.process_time()
        on_person([trace], TISSUE, read_drive(drive))
        print(f"{drive:<20} {(time.process_time() - begun) / len(TISSUE.subjects):.2f} s a subject")


if __name__ == "__main__":
    main()

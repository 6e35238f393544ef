"""Do balls and profile punches state their error? About three minutes.

    python -m benchmarks.accuracy.profile_punches

Seven punches press slabs of 4 to 20 mm to d/h 0.5, without friction, with friction 0.3 and where what touches sticks;
printed is what cells of half the size change, beside what is stated. The ledge has a step narrower than a cell,
before which its curve ends. Then the processor time of the five slabs that ``suggest --punch ball:12`` solves.
"""

from __future__ import annotations

import os
import time

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.pad.axisymmetric.profile_punch import CELLS, profile, solve_profile
from dummydesign.pad.pad_under_punch import Pad
from tests.support.ball_punch import sphere

SHARES = np.array([0.03, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5])
AT = np.linspace(0.0, 8.0, 33)
CASES = (
    ("ball of radius 6 mm", sphere(6.0), 10.0, 5.88),
    ("ball of radius 15 mm", sphere(15.0), 10.0, 14.7),
    ("ball of radius 20 mm", sphere(20.0), 4.0, 14.0),
    ("ball of radius 8 mm", sphere(8.0), 20.0, 7.84),
    ("blunt cone", profile(AT, np.where(AT < 1.0, 0.5 * AT**2, AT - 0.5)), 10.0, 8.0),
    ("quartic", profile(np.linspace(0.0, 5.0, 26), 0.05 * np.linspace(0.0, 5.0, 26) ** 4), 10.0, 5.0),
    ("ledge", profile([0.0, 3.0, 3.5, 4.0, 4.2, 6.0], [0.0, 0.0, 0.1, 1.0, 3.0, 3.2]), 10.0, 6.0),
)


def main() -> None:
    """Print a row for each punch and contact."""
    os.environ["DUMMYDESIGN_CACHE"] = "off"
    outside = count = 0
    for name, punch, thickness, reach in CASES:
        for condition in ("frictionless", "friction:0.3", "bonded"):
            depth = thickness * SHARES
            try:
                fine, own = (
                    solve_profile(Pad(thickness, 0.04, reach, condition=condition), depth, punch, cells=n)
                    for n in (2 * CELLS, CELLS)
                )
            except NoAnswerError as reason:
                print(f"{name}, {condition}: {reason}")
                continue
            both = min(len(fine.force_N), len(own.force_N))
            change = 100.0 * np.log(own.force_N[:both] / fine.force_N[:both])
            stated = 100.0 * (own.error_N / own.force_N)[:both]
            outside, count = outside + int((np.abs(change) > stated).sum()), count + both
            print(f"{name}, {thickness:g} mm, {condition}: {np.round(change, 2)} %, stated {np.round(stated, 2)} %")
    print(f"{outside} of {count} values change by more than is stated")
    began = time.process_time()
    for thickness in np.geomspace(3.0, 23.5, 5):
        solve_profile(
            Pad(thickness, 1.0, 5.88, condition="frictionless"), thickness * np.linspace(0.06, 0.54, 9), sphere(6.0)
        )
    print(f"five slabs of 3 to 23.5 mm under a ball of 12 mm: {time.process_time() - began:.1f} s")


if __name__ == "__main__":
    main()

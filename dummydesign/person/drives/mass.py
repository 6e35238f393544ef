"""A free body that hits with the speed of the trace at contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import work_mJ
from dummydesign.person.drives.drive import FASTER, MASS, MASSES, Drive
from dummydesign.person.integrate import TOLERANCE, Response, run_robot
from dummydesign.person.people import People
from dummydesign.person.press import Press
from dummydesign.person.ringing import Arm
from dummydesign.person.signs import TraceSigns

LONGEST_S, AFTER_STOP = 60.0, 1.0
CURVE_STEPS = 400
SAME_MASS = 1.3
"""Factor within which a mass agrees with the one that the trace shows."""


class Mass(Drive):
    """M x'' = -F from the speed at contact on; the press ends where the body stops."""

    name, form = "mass", "mass:KG"
    numbers = ((MASS, MASSES),)
    words = "a free mass that hits at the speed of the trace and is stopped by the person alone"

    def contradicted(self, signs: TraceSigns) -> str:
        """Where the punch was held, or another mass explains the path."""
        if signs.creep_mm is not None:
            return f"the punch was held {signs.held_s:.2g} s under load; a free mass bounces back at once"
        if signs.mass_kg is None:
            return "the force on the pad does not explain the loss of speed of any free mass"
        if not 1.0 / SAME_MASS < self.values[0] / signs.mass_kg < SAME_MASS:
            return f"the path on the pad is that of a free mass of {signs.mass_kg:.3g} kg"
        return ""

    def respond(self, press: Press, people: People, keep: bool = True) -> Response:
        """Integrate until every body has stopped; with curves, as long again for the rebound."""
        mass, speed = self.values[0], press.contact_mm_s * np.ones(len(people))
        scale = people.depth_taking(float(0.5e-3 * mass * np.max(speed) ** 2))
        rise = 4.0 * float(np.max(scale / speed))

        def longest(time: float) -> float:
            return rise / CURVE_STEPS

        given = speed, scale, longest
        looser = TOLERANCE * (1.0 if keep else FASTER)
        run = run_robot(people, Arm(0.0, mass), _nothing, LONGEST_S, *given, until_stop=True, keep=False,
                        tolerance=looser)  # fmt: skip
        if not keep:
            return run
        end = (1.0 + AFTER_STOP) * float(np.max(run.stop_s))
        curve = run_robot(people, Arm(0.0, mass), _nothing, end, *given)
        names = ("time_s", "depth_curve_mm", "force_curve_N")
        return replace(run, **{name: getattr(curve, name) for name in names})

    def on_pad(self, press: Press) -> dict[str, NDArray | None]:
        """The pad's numbers up to its stop."""
        upto = slice(0, press.stopped + 1)
        energy = work_mJ(press.x_mm[..., upto], press.force_N[..., upto])
        return {"peak_N": press.peak_N, "steady_N": None, "depth_mm": press.depth_mm, "energy_mJ": energy}


def _nothing(time: float) -> tuple[float, float]:
    return 0.0, 0.0

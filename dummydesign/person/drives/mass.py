"""A free body that hits with the speed of the trace at contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.person.drives.drive import FASTER, MASS, MASSES, RobotDrive, TraceSigns
from dummydesign.person.free_mass import stop_mass
from dummydesign.person.integrate import TOLERANCE, PersonResponse
from dummydesign.person.people import People
from dummydesign.person.press import Press

SENSOR_SHARE, SURE = 0.01, 3.0
"""Relative standard deviation of the energy by the calibration of a force sensor and by smoothing, and multiple of the
errors from which on two speeds differ."""
SAME_MASS = 1.3
"""Factor within which a mass agrees with the one that the trace shows."""


class Mass(RobotDrive):
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

    def with_own_speed(self, press: Press) -> Press:
        """Take the speed at contact from the energy balance where the approach is not recorded."""
        if press.approached:
            return press
        speed, error = self.speed_of_energy(press)
        return replace(press, contact_mm_s=np.asarray(speed), contact_sd_mm_s=error)

    def speed_of_energy(self, press: Press) -> tuple[float, float]:
        """Speed at contact and its error, from the energy that the pad took: M v^2 / 2 = integral of F dx. [mm/s]

        The errors are those of the curves, of the zero of depth and of a force sensor.
        """
        mass, energy = 1e-3 * self.values[0], float(press.energy_mJ)
        upto = slice(0, press.stopped + 1)
        steps = np.gradient(press.x_mm[upto])
        noise = float(np.linalg.norm(press.force_factor[upto].T @ steps))
        share = np.hypot(noise / energy, SENSOR_SHARE)
        return float(np.sqrt(2.0 * energy / mass)), float(0.5 * share * np.sqrt(2.0 * energy / mass))

    def speed_doubt(self, press: Press) -> str:
        """Where the path at contact and the energy that the pad took give two speeds."""
        speed, error = self.speed_of_energy(press)
        path = float(press.contact_mm_s)
        if abs(speed - path) <= SURE * float(np.hypot(error, press.contact_sd_mm_s)):
            return ""
        energy, needed = float(press.energy_mJ), 0.5e-3 * self.values[0] * path**2
        return (
            f"the pad took {energy:.3g} mJ up to the stop; {self.values[0]:g} kg at {path:.3g} mm/s have "
            f"{needed:.3g} mJ"
        )

    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Integrate until every body has stopped; with curves, as long again for the rebound."""
        speed = press.contact_mm_s * np.ones(len(people))
        return stop_mass(people, self.values[0], speed, keep, TOLERANCE * (1.0 if keep else FASTER))

    def on_pad(self, press: Press) -> dict[str, NDArray | None]:
        """The pad's numbers; a body that bounces has no steady force."""
        return {**super().on_pad(press), "steady_N": None}

"""The arm follows its path whatever it meets."""

from __future__ import annotations

import numpy as np

from dummydesign.measurement.motion import work_to_deepest_mJ
from dummydesign.person.drive_diagnostics import TraceSigns
from dummydesign.person.drives.drive import RobotDrive, not_kept
from dummydesign.person.integrate import PersonResponse, late_mean
from dummydesign.person.people import People
from dummydesign.person.press import Press


class Position(RobotDrive):
    """x(t) on people is x(t) on the pad, from contact on."""

    name = form = "position"
    words = "a stiff arm that presses people to the pad's depth at each time"

    def contradicted(self, signs: TraceSigns) -> str:
        """Where the path was not kept."""
        return not_kept(signs)

    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Force of the law along the path."""
        time, force = press.time_s, people.force(press.time_s, press.x_mm)
        depth, steady = np.broadcast_to(press.x_mm, force.shape), late_mean(time, force, press.late_from_s)
        energy = work_to_deepest_mJ(np.maximum(depth, 0.0), force)
        return PersonResponse.of_curves(time, depth, force, steady, energy)

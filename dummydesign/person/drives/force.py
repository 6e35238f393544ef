"""A clamp that controls its force."""

from __future__ import annotations

from dummydesign.person.drive_diagnostics import TraceSigns
from dummydesign.person.drives.drive import RobotDrive, not_kept
from dummydesign.person.integrate import PersonResponse, follow_force
from dummydesign.person.people import People
from dummydesign.person.press import Press
from dummydesign.person.validity_range import short_number


class Force(RobotDrive):
    """F(t) on people is F(t) on the pad; depth follows."""

    name = form = "force"
    words = "a clamp that controls its force and gives people the pad's force at each time"

    def contradicted(self, signs: TraceSigns) -> str:
        """Where the path was kept instead, or the pad took the speed."""
        if signs.looks_like == "position":
            return f"the force fell by {short_number(signs.relaxed_N or 0.0, 2)} N in the hold while the depth was kept"
        return not_kept(signs) if signs.looks_like == "mass" else ""

    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Solve the law for the depth."""
        given = people, press.time_s, press.force_N, press.late_from_s
        return follow_force(*given) if keep else follow_force(*given, substeps=1, tolerance=1e-5)

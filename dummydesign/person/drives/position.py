"""The arm follows its path whatever it meets."""

from __future__ import annotations

from dummydesign.person.drives.drive import Drive, Response, of_curves
from dummydesign.person.people import People
from dummydesign.person.press import Press


class Position(Drive):
    """x(t) on people is x(t) on the pad, from contact on."""

    name = form = "position"
    words = "the arm follows its path whatever it meets: people are pressed by the same displacement from contact on"

    def respond(self, press: Press, people: People, keep: bool = True) -> Response:
        """Force of the law along the path."""
        return of_curves(press, press.time_s, press.x_mm, people.force(press.time_s, press.x_mm))

"""The arm follows its path whatever it meets."""

from __future__ import annotations

from dummydesign.person.drives.drive import Drive, Response, not_kept, of_curves
from dummydesign.person.people import People
from dummydesign.person.press import Press
from dummydesign.person.signs import TraceSigns


class Position(Drive):
    """x(t) on people is x(t) on the pad, from contact on."""

    name = form = "position"
    words = "a stiff arm that presses people to the pad's depth at each time"

    def contradicted(self, signs: TraceSigns) -> str:
        """Where the path was not kept."""
        return not_kept(signs)

    def respond(self, press: Press, people: People, keep: bool = True) -> Response:
        """Force of the law along the path."""
        return of_curves(press, press.time_s, press.x_mm, people.force(press.time_s, press.x_mm))

"""Where the next step of a project is done, and what is chosen there."""

from __future__ import annotations

import shlex
from itertools import pairwise

from dummydesign.project.status import Status
from dummydesign.studio.state import State, design_state, is_design

PAGES = {
    "tissues": "/tissue", "import": "/measured", "fit": "/tissue", "suggest": "/design", "mold": "/mould",
    "campaign": "/campaign", "loop": "/learn", "status": "/design",
}  # fmt: skip
"""Page that a command belongs to."""
_NUMBERS = {"thickness": "thickness_mm", "ratio": "ratio"}


def next_page(status: Status) -> str:
    """The page on which the next step is done."""
    return PAGES.get(shlex.split(status.next_command)[1], "/design")


def next_state(status: Status, state: State) -> State:
    """What the next step is about: its campaign, calibration, tissue and design.

    Parameters
    ----------
    status : Status
        Of the project; its next command names what the step is about.
    state : State
        What is chosen now; what the step does not name stays.
    """
    words = shlex.split(status.next_command)[1:]
    command = words[0] if words else ""
    new: dict[str, object] = {}
    designs = [one for one in status.found["designs"] if is_design(one) and one.command == "suggest"]
    if designs and (command in ("mold", "status") or words[:2] == ["campaign", "new"]):
        new |= design_state(status.project.root, designs[-1].folder)
    for name, value in pairwise(words):
        option = name.removeprefix("--")
        if name.startswith("--") and option in ("tissue", "calibration", "resin", "shape", "ratio", "thickness"):
            if command == "suggest" and option in ("shape", "ratio", "thickness"):
                continue  # what is searched, not a pad
            new[_NUMBERS.get(option, option)] = float(value) if option in _NUMBERS else value
    campaigns = {one.folder for one in status.found["campaigns"]}
    named = next((word.rstrip("/") for word in words if word.rstrip("/") in campaigns), None)
    if named:
        new["campaign"] = named
    return state.changed(**new) if new else state

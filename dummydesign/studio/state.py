"""The state of all pages: it is in the page's address; links and addresses."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlencode

from dummydesign.core.errors import InputError, accepts
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.geometry.dimensions import PUNCH
from dummydesign.geometry.punch import PROFILE, Punch, read_punch
from dummydesign.project.folder import Project
from dummydesign.project.status import STANDARD_RESIN, ProjectStatus, finished_manifest, things_in
from dummydesign.studio import file_transfer, select_options
from dummydesign.studio.markup import Markup, filled, page_path

PAD_FIELDS = ("shape", "thickness_mm", "ratio")
NO_TISSUE = "No tissue is chosen yet. Choose the one that the pad imitates."
QUESTION_FIELDS = ("tissue", "aim", "resin", "calibration", "punch")
"""What a search is asked; the pad under the sliders is judged by the same."""
SEPARATOR = "\n"
"""Between the names of files in an address; no file name has one."""


@dataclass(frozen=True)
class State:
    """What the pages show."""

    tissue: str
    aim: str = "average"
    resin: str = STANDARD_RESIN
    punch: str = PUNCH
    calibration: str = ""
    shape: str = "slab"
    thickness_mm: float = 6.0
    ratio: float = 15.0
    design: str = ""
    campaign: str = ""
    missing: tuple[str, ...] = ()

    def query(self) -> str:
        """Return the state as the query of an address."""
        return urlencode(
            {
                name: f"{value:g}" if isinstance(value, float) else value
                for name, value in vars(self).items()
                if name != "missing" and (value != "" or name == "calibration")
            }
        )

    def changed(self, **new: Any) -> State:
        """Return the state with other values; a pad that is no longer the design's forgets it."""
        after = replace(self, **new)
        kept = all(getattr(after, name) == getattr(self, name) for name in (*PAD_FIELDS, *QUESTION_FIELDS))
        return after if kept or "design" in new else replace(after, design="")

    @property
    def kind(self) -> str:
        """The kind of the shape, without its lengths."""
        return self.shape.partition(":")[0].lower()

    @property
    def question(self) -> dict[str, Any]:
        """What a search is asked, without the pad."""
        return {name: getattr(self, name) for name in QUESTION_FIELDS}

    @property
    def label(self) -> str:
        """The pad and what it is compared with, in one line."""
        taught = f", calibration {Path(self.calibration).parent.name}" if self.calibration else ""
        aim = "" if self.aim == "average" else f" ({self.aim})"
        return (
            f"{self.shape}, {self.thickness_mm:g} mm, ratio {self.ratio:g}, {self.resin}; "
            f"{self.tissue}{aim}, {self.punch}{taught}"
        )


def read_state(project: Project, query: Mapping[str, str]) -> State:
    """Read the state of an address in a project.

    The address wins; then the design that it names; then ``project.toml``, with the newest design for its tissue.
    """
    # no calibration is a choice too: without it the one of project.toml would come back
    given = {
        name: text
        for name, text in query.items()
        if (text.strip() or name == "calibration") and _in_project(project.root, name, text)
    }
    designs = designs_of(project.root)
    own, tissue = of_project(project), given.get("tissue") or project.tissue or ""
    # what was edited by hand since wins over an older design
    chosen = {name: text for name, text in own.items() if name in QUESTION_FIELDS} | {"tissue": tissue or None}
    newest = [one for one in designs.values() if chosen.items() <= one.given.items()]
    # nothing was chosen at all: the newest design says what one worked on
    newest = newest or ([] if tissue else [*designs.values()])
    base: dict[str, Any] = {**own, "tissue": tissue}
    if given.get("design") in designs:
        base |= designs[given["design"]].given
    elif newest and "shape" not in given:
        base |= newest[-1].given | {"design": given.get("design", newest[-1].folder)}
    before = State(**base)
    # where the address changes what the design was made for, the pad is no longer that design
    state = before.changed(
        **{
            one.name: _number(given[one.name], getattr(before, one.name), one.type == "float")
            for one in fields(State)
            if one.name in given and one.name not in ("design", "missing")
        }
    )
    campaigns = list(select_options.campaigns(project.root))
    state = replace(
        state,
        design=state.design if state.design in designs else "",
        campaign=state.campaign or next(reversed(campaigns), ""),
    )
    return replace(state, missing=_missing(project.root, state, campaigns, designs, given))


def _in_project(root: Path, name: str, text: str) -> bool:
    """Whether a path of the address stays in the project; names of the library are no paths."""
    path = name in ("design", "calibration", "campaign") or text.endswith(".toml") or text.startswith(PROFILE)
    if path or (name in ("tissue", "resin") and "/" in text):
        return accepts(file_transfer.inside, root, text.removeprefix(PROFILE))
    return True


def punch_of(root: Path, text: str) -> Punch:
    """Read the punch of a state; the file of a profile lies in the project."""
    if text.startswith(PROFILE):
        text = f"{PROFILE}{file_transfer.inside(root, text.removeprefix(PROFILE))}"
    return read_punch(text)


@dataclass(frozen=True)
class Design:
    """A pad that was designed: what it gives to a state, the level of its verdict, and the verdict's sentence."""

    folder: str
    command: str
    given: dict[str, Any]
    level: str
    text: str

    def answers(self, state: State) -> bool:
        """Whether it was made for the tissue, aim, resin, calibration and punch that are chosen."""
        return self.given.items() >= state.question.items()


def designs_of(root: Path) -> dict[str, Design]:
    """Read the designs of a project by folder, the newest last; those that cannot be read are left out."""
    designs = {}
    for one in things_in(root, "designs"):
        with suppress(ValueError, KeyError, TypeError, AttributeError):
            inputs, pad = (finished_manifest(root / one.folder / MANIFEST) or {})["inputs"], one.summary or {}
            given = {
                "shape": str(pad["shape"]),
                "thickness_mm": float(pad["thickness_mm"]),
                "ratio": float(pad["ratio"]),
                "resin": str(pad["resin"]),
                "tissue": _inside(root, str(inputs["tissue"])),
                "aim": str(inputs.get("aim", "average")),
                "punch": str(inputs.get("punch") or PUNCH),
                "calibration": _inside(root, inputs.get("calibration")),
                "design": one.folder,
            }
            level, text = str(pad.get("verdict", "")), str(pad.get("text", ""))
            designs[one.folder] = Design(one.folder, one.command, given, level, text)
    return designs


def _inside(root: Path, path: object) -> str:
    """A path from the project folder on; names of the library and paths elsewhere as they are."""
    text = str(path or "")
    return Path(text).relative_to(root).as_posix() if Path(text).is_relative_to(root) else text


def of_project(project: Project) -> dict[str, Any]:
    """What ``project.toml`` says of a state; a shape only with its lengths, for a kind alone is to be searched."""
    own = {name: value for name, value in project.given().items() if name in ("shape", *QUESTION_FIELDS[1:])}
    return {"tissue": project.tissue or ""} | {k: v for k, v in own.items() if k != "shape" or ":" in v}


def _number(text: str, before: Any, is_number: bool) -> Any:
    if not is_number:
        return text.strip()
    try:
        value = float(text)
    except ValueError:
        return before
    return value if 0.0 < value < 1e6 else before


def _missing(
    root: Path,
    state: State,
    campaigns: list[str],
    designs: Mapping[str, Design],
    given: Mapping[str, str],
) -> tuple[str, ...]:
    """What is chosen and not there."""
    there = (
        ("tissue", state.tissue, ["", *select_options.tissues(root)], "Choose another, or bring its file back."),
        ("calibration", state.calibration, [""], "Choose another, or none."),
        ("resin", state.resin, select_options.resins(), "Choose another."),
        ("campaign", state.campaign, ["", *campaigns], "Choose another."),
        ("design", given.get("design", ""), ["", *designs], "The pad comes from the address."),
    )
    problems = tuple(
        f"The {what} '{name}' is not there. {advice}"
        for what, name, names, advice in there
        if name not in names and not (root / name).is_file()
    )
    if not state.tissue:
        return (NO_TISSUE,)
    try:
        if not problems and state.aim not in select_options.aims(absolute(root, state.tissue)):
            return (f"The tissue '{state.tissue}' has no aim '{state.aim}'. Choose another aim.",)
    except InputError as problem:
        return (str(problem),)
    return problems


def absolute(root: Path, name: str) -> str:
    """A name of the library as it is; a file of the project with its whole path."""
    return str(root / name) if name.endswith(".toml") else name


def address(path: str, **query: object) -> str:
    """Return the address of a page or file for a link of a page, quoted.

    The address is relative. The studio lies under a path that changes at each start, and every page is one step below.
    """
    given = urlencode(query, quote_via=quote, errors="surrogateescape")
    return "./" + quote(path.lstrip("/"), safe="/", errors="surrogateescape") + (f"?{given}" if given else "")


def page_link(
    path: str,
    words: str,
    state: State | None = None,
    test: str = "",
    current: bool = False,
    kind: str = "",
    more: str = "",
) -> Markup:
    """Return HTML of a link to a page in a state, else in what is chosen on this page when the link is used.

    ``more`` is a part of the query that the page itself keeps, such as its tab.
    """
    marks = Markup("" if state else " data-state") + Markup(" aria-current=page" if current else "")
    query = "&".join(filter(None, (more, state.query() if state else "")))
    to = f"{address(path)}{'?' * bool(query)}{query}"
    return filled('<a data-test="{}" class="{}"{} href="{}">{}</a>', test, kind, marks, to, words)


def options_of(words: Sequence[str]) -> dict[str, str]:
    """Options of a command line that have a value, by their names."""
    return {name.removeprefix("--"): value for name, value in pairwise(words) if name.startswith("--")}


_NUMBERS = {"thickness": "thickness_mm", "ratio": "ratio"}


def next_page(status: ProjectStatus) -> str:
    """The page on which the next step is done."""
    return page_path(shlex.split(status.next_command)[1:]) or "/design"


def next_state(status: ProjectStatus, state: State) -> State:
    """What the next step is about: its campaign, calibration, tissue and design."""
    words = shlex.split(status.next_command)[1:]
    new: dict[str, object] = {}
    designs = [one for one in designs_of(status.project.root).values() if one.command == "suggest"]
    if designs and (words[0] in ("mold", "status") or words[:2] == ["campaign", "new"]):
        new |= designs[-1].given
    # shape, thickness and ratio of a search are what is searched, not a pad
    pad = () if words[0] == "suggest" else ("shape", "ratio", "thickness")
    for option, value in options_of(words).items():
        if option in ("tissue", "calibration", "resin", *pad):
            new[_NUMBERS.get(option, option)] = float(value) if option in _NUMBERS else value
    campaigns = {one.folder for one in status.files["campaigns"]}
    named = [word.rstrip("/") for word in words if word.rstrip("/") in campaigns]
    return state.changed(**new, campaign=[state.campaign, *named][-1])

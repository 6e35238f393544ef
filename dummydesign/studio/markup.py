"""HTML whose values are escaped and in the words of the pages, unless they are HTML themselves."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

from markupsafe import Markup, escape

STEPS = {
    "/": "Overview",
    "/measured": "1 Measured",
    "/tissue": "2 Tissue",
    "/design": "3 Design",
    "/resin": "4 Puck",
    "/mould": "5 Mould",
    "/cast": "6 Cast pad",
    "/campaign": "7 Campaign",
    "/learn": "8 Learn",
}
"""Pages by their addresses, as their links name them."""
PAGES = {
    "import": "/measured",
    "fit": "/tissue",
    "tissues": "/tissue",
    "suggest": "/design",
    "predict": "/design",
    "status": "/design",
    "resins": "/resin",
    "mold": "/mould",
    "compare": "/cast",
    "on-person": "/cast",
    "replay": "/cast",
    "campaign": "/campaign",
    "loop": "/learn",
    "mold --puck": "/resin",
    "mold record": "/cast",
    "tissues add-points": "",
    "resins list": "/design",
    "resins add-hardness": "",
    "suggest --sites": "",
    "whatif": "",
    "history": "",
    "doctor": "",
}
"""Page of a command, by its first word or two; empty for one that no page runs."""


def page_path(words: Sequence[str]) -> str:
    """Return the address of the page that a command belongs to; empty where there is none."""
    return PAGES.get(" ".join(words[:2]), PAGES.get(words[0], ""))


def _page_of(command: re.Match[str]) -> str:
    path = page_path(command[command.lastindex or 0].split())
    return f"the page '{STEPS[path]}'" if path else "the command line"


_NAMES = "|".join(sorted({command.partition(" ")[0] for command in PAGES}))
WORDS: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = (
    # a command: in quotes, with what is typed behind it to the end of its sentence, or alone between brackets
    (
        re.compile(
            rf"'(?:dummydesign )?((?:{_NAMES})(?: [^']*)?)'"
            rf"|\bdummydesign ((?:{_NAMES})\b.*?)(?=[.)]*$|[;,.)]+ )"
            r"|(?<=\()((?:tissues|resins|campaign|mold) [a-z-]+)(?=\))"
        ),
        _page_of,
    ),
    # what only a command line offers
    (re.compile(r" \(--replace overwrites\)| \([^()]*project\.toml\)"), ""),
    (re.compile(r"--shape auto\b"), "Shapes to search: auto"),
    (re.compile(r"(\b(add|use|predict) )?--fidelity \w+"), "'Solve this pad'"),
    # any other option has the name of its field
    (re.compile(r"(?<![\w-])--([a-z][a-z0-9-]*)"), lambda option: option[1].replace("-", " ")),
)
"""Words of the command line, and what pages say in their place."""


def in_page_words(text: str) -> str:
    """Return a sentence of a command as pages have it: commands are pages, options are named as fields are."""
    for typed, instead in WORDS:
        text = typed.sub(instead, text)
    return text


def filled(template: str, *values: object) -> Markup:
    """Fill the places of a piece of HTML of our own with values; ``verbatim`` keeps the words of a command."""
    return Markup(template).format(*(in_page_words(one) if type(one) is str else one for one in values))


verbatim = escape


def joined(template: str, rows: Iterable[Sequence[object]]) -> Markup:
    """Fill a piece of HTML with each row, one behind the other."""
    return Markup().join(filled(template, *row) for row in rows)

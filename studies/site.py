"""Pages of the documentation site that are made from elsewhere: the commands' own help, and files of the top folder.

``python -m mkdocs build`` calls these hooks (see ``mkdocs.yml``).
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

TOP = Path(__file__).resolve().parents[1]
COPIED = ("VERIFICATION.md", "CONTRIBUTING.md", "CHANGELOG.md")
# The start page is the README up to here: what follows are notes for who works in the folder.
LAST_HEADING = "## Licence"
# Links of the README and of pages point into the repository; on the site the pages lie beside each other.
MOVED = (
    (r"\]\(docs/", "]("),
    (r"\]\(\.\./(VERIFICATION|CONTRIBUTING|CHANGELOG)", r"](\1"),
    (r"\]\(\.\./README\.md", "](index.md"),
)
# What is in the repository only.
NO_PAGE = re.compile(r"\[([^\]]+)\]\((?:LICENSE|examples|docs|data/[^)]*\.csv|\.\./examples[^)]*)\)")


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are not written by hand to the site's files."""
    from mkdocs.structure.files import File

    pages = {name: (TOP / name).read_text(encoding="utf-8") for name in COPIED}
    pages["index.md"] = (TOP / "README.md").read_text(encoding="utf-8").split(LAST_HEADING)[0]
    pages["reference/commands.md"] = commands_page()
    pages["reference/python.md"] = python_page()
    for name, text in pages.items():
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Turn links into the repository into links of the site, or into plain words.

    Parameters
    ----------
    markdown : str
        Of the page.
    page, config, files
        As the site's builder gives them; not used.
    """
    for old, new in MOVED:
        markdown = re.sub(old, new, markdown)
    return NO_PAGE.sub(r"`\1`", markdown)


def commands_page() -> str:
    """Every command and its actions with their own help, as a page."""
    from dummydesign.cli.entry import COMMANDS, actions_of, parser_of

    parts = ["# Commands", "Every command takes `--json`; the exit status is 0, 1 (no answer) or 2 (bad input)."]
    for name in COMMANDS:
        parser = parser_of(name)
        helps = {name: parser} | {f"{name} {action}": below for action, below in actions_of(parser).items()}
        for title, one in helps.items():
            parts += [f"##{'#' * (one is not parser)} {title}", f"```text\n{one.format_help()}```"]
    return "\n\n".join(parts) + "\n"


def python_page() -> str:
    """Every call for scripts with its docstring, as a page."""
    import dummydesign
    from dummydesign import api

    parts = ["# Python", "`import dummydesign as dd`, then `dd.predict(...)` and so on."]
    named = {name: getattr(api, name) for name in dummydesign.CALLS if name != "close_loop"}
    for thing in [*named.values(), api.Answer, api.Rows, api.Fitted, api.Result]:
        parts.append(f"::: {thing.__module__}.{thing.__qualname__}")
    return "\n\n".join(parts) + "\n"

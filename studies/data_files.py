"""List the files of ``docs/data`` and where each is from: ``python -m studies.data_files`` writes its README."""

from __future__ import annotations

from pathlib import Path

from dummydesign.core.files import write_text
from studies.registry import BY_HAND, COPIED, DATA_FILES, STUDIES, WRITTEN

FOLDER = "docs/data/"
PAGE = Path(FOLDER) / "README.md"
HEAD = """# Data files

Tables behind the figures of the documentation. All end in `.csv`. Commands begin with `python -m`; `studies.data_files`
writes this list.
"""


def origins() -> dict[str, tuple[str, str]]:
    """Command and origin of each file, by its name."""
    made = {
        file.removeprefix(FOLDER): (study.command, WRITTEN)
        for study in STUDIES
        for file in study.files
        if file.startswith(FOLDER) and file.endswith(".csv")
    }
    return dict(sorted((made | {one.name: (one.command, one.origin) for one in DATA_FILES}).items()))


def _short(command: str) -> str:
    return command.removeprefix("python -m ")


def page() -> str:
    """The README: files that a command writes, files copied from what one prints, and lists by hand."""
    written: dict[str, list[str]] = {}
    copied, by_hand = [], []
    for file, (command, origin) in origins().items():
        name = file.removesuffix(".csv")
        if origin == WRITTEN:
            written.setdefault(command, []).append(name)
        elif command:
            copied.append(f"| {name} | `{_short(command)}` | {origin.removeprefix(COPIED).lstrip('; ')} |\n")
        else:
            by_hand.append(f"| {name} | {origin.removeprefix(BY_HAND).removeprefix(' of').lstrip('; ')} |\n")
    rows = [f"| `{_short(command)}` | {', '.join(names)} |\n" for command, names in written.items()]
    return "".join(
        [
            HEAD,
            "\n## Written by a command\n\n| command | files |\n|---|---|\n",
            *rows,
            "\n## Copied from what a command prints\n\n| file | command | |\n|---|---|---|\n",
            *copied,
            "\n## Lists by hand\n\n| file | of |\n|---|---|\n",
            *by_hand,
        ]
    )


def main() -> None:
    """Write the README."""
    write_text(PAGE, page())


if __name__ == "__main__":
    main()

"""List the files of ``docs/data`` and where each is from: ``python -m studies.data_files`` writes its README."""

from __future__ import annotations

from pathlib import Path

from dummydesign.core.files import write_text
from studies.registry import DATA_FILES, STUDIES

FOLDER = "docs/data/"
PAGE = Path(FOLDER) / "README.md"
HEAD = """# Data files

Tables behind the figures of the documentation. `python -m studies.data_files` writes this list.

| file | command | origin |
|---|---|---|
"""


def origins() -> dict[str, tuple[str, str]]:
    """Command and origin of each file, by its name."""
    made = {
        file.removeprefix(FOLDER): (study.command, "written by the command")
        for study in STUDIES for file in study.files if file.startswith(FOLDER) and file.endswith(".csv")
    }  # fmt: skip
    return dict(sorted((made | {one.name: (one.command, one.origin) for one in DATA_FILES}).items()))


def page() -> str:
    """The README."""
    rows = []
    for name, (command, origin) in origins().items():
        typed = f"`{command}`" if command else ""
        rows.append(f"| {name} | {typed} | {origin} |\n")
    return HEAD + "".join(rows)


def main() -> None:
    """Write the README."""
    write_text(PAGE, page())


if __name__ == "__main__":
    main()

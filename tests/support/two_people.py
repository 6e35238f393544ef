"""Exports of two people's presses, as a German test machine writes them: the second pushes back more."""

from __future__ import annotations

from pathlib import Path

from tests.support.walkthrough_files import write

STIFFER = {"anna": 1.0, "bert": 1.25}
PRESSES = ("v010_f04", "v250_f08")


def write_people(folder: Path) -> list[Path]:
    """Write two presses of each person; return the files."""
    write(folder)
    made = []
    for person, factor in STIFFER.items():
        for press in PRESSES:
            lines = (folder / "exports" / f"finger_{press}.txt").read_text(encoding="cp1252").splitlines()
            rows = []
            for line in lines[2:]:
                time, depth, force = line.split(";")
                rows.append(f"{time};{depth};{factor * float(force.replace(',', '.')):.4f}".replace(".", ","))
            made.append(folder / f"{person}_{press}.txt")
            made[-1].write_text("\n".join([*lines[:2], *rows]) + "\n", encoding="cp1252")
    return made

"""The paper's three dummies in simulation, compared with the paper's statements about them.

    python -m studies.paper_dummies.study [--solve]

presses dummies I, II, III (polyurethane at 100:15; slabs of 15, 20, 5 mm) on a glued and on a sliding base, with
four moduli, neo-Hookean and stiffening, fits the five-element law, and compares them with palm, thenar and
forefinger. Writes a short table into ``docs/dummies.md`` and all tables into ``docs/data/dummies-*.csv``. Nothing
is drawn at random. ``--solve`` solves the stiffening slabs again (twelve slabs, less than a minute) into
``docs/data/dummies.csv``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from dummydesign.core.files import write_text
from dummydesign.pad.fe_force_law import SolvedSlab, solve_slab
from studies.marked_page import MarkedPage
from studies.paper_dummies.presses import steady_scan, stiffening_cases, study
from studies.paper_dummies.tables import data_files, page_tables
from studies.thickness import curves_text, read_curves, stiffening

DATA = Path("docs") / "data"
CURVES = DATA / "dummies.csv"
PAGE = Path("docs") / "dummies.md"
MARKED = MarkedPage(PAGE, "<!-- dummies tables: begin -->", "<!-- dummies tables: end -->")


def read_or_solve(path: Path, solve: bool) -> list[SolvedSlab]:
    """Read the stiffening slabs; solve and store them if ``solve`` or if there are none."""
    if not solve and path.is_file():
        return read_curves(path.read_text(encoding="utf-8"))
    slabs = []
    for case in stiffening_cases():
        slabs.append(solve_slab(case))
        print(f"{case.base} base, c2/mu {stiffening(case):g}, {case.thickness_mm:g} mm", flush=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, curves_text(slabs))
    return slabs


def main(arguments: list[str] | None = None) -> None:
    """Press, judge and write the page.

    Raises
    ------
    InputError
        When the page or its marks are missing.
    """
    parser = argparse.ArgumentParser(prog="python -m studies.paper_dummies.study", description=__doc__)
    parser.add_argument("--solve", action="store_true", help="solve the stiffening slabs again")
    parser.add_argument("--repository", type=Path, default=Path("."), help="folder that holds docs/")
    options = parser.parse_args(arguments)
    MARKED.read(options.repository)
    slabs = read_or_solve(options.repository / CURVES, options.solve)
    results = study(slabs)
    made = page_tables(results)
    print(made)
    for part, text in data_files(results, steady_scan(slabs)).items():
        write_text(options.repository / DATA / f"dummies{part}.csv", text)
    MARKED.write(options.repository, made)


if __name__ == "__main__":
    main()

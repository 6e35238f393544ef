"""How far each shape closes the gap below 5 N, for the three tissues.

    python -m studies.shapes

designs a pad of every kind for the palm, the thenar and the forefinger of the library (average subject, the
paper's polyurethane), solves the best ones again by finite elements, and writes a table into ``docs/shapes.md``, the
designs into ``docs/data/shapes-designs.csv`` and the curves into ``docs/data/shapes.csv``. Nothing is drawn at random.
"""

from __future__ import annotations

import argparse
import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.files import write_text
from dummydesign.design.assessment.decision import MISFIT_N, ShapeComparison, force_at
from dummydesign.design.request import Request
from dummydesign.design.scoring.press_simulation import DEPTH_SHARE
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.suggest import centring_tolerance, suggest
from dummydesign.design.suggestion import CentringTolerance, Suggestion
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM, PUNCH_SIDE_MM
from dummydesign.geometry.interface import CONDITIONS
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.pad_under_punch import Pad
from studies.marked_page import MarkedPage

TISSUES = ("forefinger", "palm", "thenar")
CHECKED_N = MISFIT_N[::3]
PAGE, DATA = Path("docs") / "shapes.md", Path("docs") / "data"
CURVES, DESIGNS = DATA / "shapes.csv", DATA / "shapes-designs.csv"
MARKED = MarkedPage(PAGE, "<!-- shapes tables: begin -->", "<!-- shapes tables: end -->")


@dataclass(frozen=True)
class Solved:
    """Finite-element forces of one design at the depths where the aim carries CHECKED_N.

    ``force_N`` holds one array a condition of the face, NaN where the solve did not get; ``table_N`` is what the
    response table gives. ``misfit`` is that of each condition over the depths that were reached, with the tissue's
    force at the last of them; None where none was.
    """

    depth_mm: NDArray
    table_N: NDArray
    force_N: dict[str, NDArray]
    misfit: dict[str, tuple[float, float] | None]


def check(item: ShapeComparison, targets: Targets) -> Solved:
    """Solve one design by finite elements, glued and frictionless, at the tissue's depths."""
    from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad

    assert item.candidate is not None and item.shape is not None
    depth = targets.aim_depth_mm(CHECKED_N)
    slabs, wide_N = item.candidate.alone, targets.protocol.wide_N
    table = force_at(depth, item.candidate.steady_depth_mm(wide_N), wide_N)
    elastic = slabs.young_MPa[0] * slabs.curves.area_at(slabs.slab, depth[None])[0]
    thickness = item.candidate.thickness_mm
    within = depth[depth <= DEPTH_SHARE * thickness]
    forces: dict[str, NDArray] = {}
    for condition in CONDITIONS:
        force = np.full(len(depth), np.nan)
        try:
            curve = solve_shaped_pad(
                Pad(thickness, float(slabs.young_MPa[0]), PUNCH_RADIUS_MM, geometry=item.shape, condition=condition),
                within,
            )
        except NoAnswerError:
            forces[condition] = force
            continue
        force[: len(curve.force_N)] = curve.force_N
        # The share left of relaxation at the end of the hold is the table's.
        forces[condition] = force * table / elastic
    misfit = {name: _misfit(force) for name, force in forces.items()}
    return Solved(depth, table, forces, misfit)


def _misfit(force_N: NDArray) -> tuple[float, float] | None:
    """Misfit over the depths that were reached, and the tissue's force at the last. [-, N]"""
    known = np.isfinite(force_N)
    if not known.any():
        return None
    away = np.log(force_N[known] / CHECKED_N[known])
    return float(np.sqrt(np.mean(away**2))), float(CHECKED_N[known][-1])


@dataclass(frozen=True)
class Row:
    """One design of the study."""

    tissue: str
    item: ShapeComparison
    solved: Solved | None
    centring: CentringTolerance | None


def study(tissue: str) -> tuple[Suggestion, list[Row]]:
    """Design every kind of shape for one tissue and solve what was found."""
    answer = suggest(Request(tissue, shape="auto"))
    rows = []
    for item in answer.comparisons:
        if item.candidate is None or item.shape is None or item.low_force is None:
            rows.append(Row(tissue, item, None, None))
            continue
        solved = check(item, answer.targets) if item.kind != Slab.name and item.shape.axisymmetric else None
        lands = centring_tolerance(item.candidate, item.shape, PUNCH_RADIUS_MM, 0.5 * PUNCH_SIDE_MM)
        rows.append(Row(tissue, item, solved, lands))
        print(f"{tissue} {item.shape}: misfit {item.low_force.misfit_rms_ln_force}", flush=True)
    return answer, rows


def lowest_slab(answer: Suggestion, law: Any) -> tuple[float, float, float]:
    """Thickness [mm], modulus [kPa] and misfit of the slab that comes nearest, whatever else it misses."""
    depth = answer.targets.aim_depth_mm(CHECKED_N)
    best = (float("nan"), float("nan"), float("inf"))
    for thickness in np.arange(3.0, 30.5, 0.5):
        if depth[-1] > min(DEPTH_SHARE * thickness, float(law.depth_limit_mm(thickness, PUNCH_RADIUS_MM))):
            continue
        away = np.log(CHECKED_N / np.asarray(law.force(depth, thickness, 1.0, PUNCH_RADIUS_MM)))
        if away.std() < best[2]:
            best = (float(thickness), 1e3 * float(np.exp(away.mean())), float(away.std()))
    return best


def tables(studied: list[tuple[Suggestion, list[Row], tuple[float, float, float]]]) -> str:
    """Misfit and score of the best pad of each kind as a Markdown table, a column a tissue."""
    lines = [("pad", *(answer.tissue.name for answer, _, _ in studied)), ("---",) * (1 + len(studied))]
    for kind in [row.item.kind for row in studied[0][1]]:
        lines.append((kind, *(_cell(row) for _, rows, _ in studied for row in rows if row.item.kind == kind)))
    slabs = (f"{misfit:.2f} ({thickness:g} mm, {young:.3g} kPa)" for _, _, (thickness, young, misfit) in studied)
    lines.append(("slab of any modulus, least misfit", *slabs))
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def _cell(row: Row) -> str:
    """Misfit of a glued face, by finite elements where they reach all forces, and the total score."""
    item = row.item
    if item.candidate is None or item.low_force is None:
        return item.reason or "-"
    solved = row.solved.misfit[CONDITIONS[0]] if row.solved else None
    near = solved[0] if solved and solved[1] >= CHECKED_N[-1] * (1.0 - 1e-9) else item.low_force.misfit_rms_ln_force
    return f"{'-' if near is None else f'{near:.2f}'}; {item.candidate.total:.2f}"


def designs_text(rows: list[Row]) -> str:
    """Every design with its scores, and its contact radius and alignment tolerance at four forces, as CSV."""
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    forces = next(row.centring.force_N for row in rows if row.centring)
    exponents = next(row.item.low_force.exponent_at_N for row in rows if row.item.low_force)
    table.writerow(
        [
            "tissue",
            "shape",
            "thickness_mm",
            "young_kPa",
            "misfit",
            *(f"misfit_{name}" for name in CONDITIONS),
            *(f"misfit_{name}_to_N" for name in CONDITIONS),
            "steady_inside_below_5N",
            "steady_inside_above_5N",
            *(f"exponent_{force}N" for force in exponents),
            "depth_over_thickness_15N",
            "total",
            *(f"contact_radius_{force:g}N_mm" for force in forces),
            *(f"alignment_tolerance_{force:g}N_mm" for force in forces),
        ]
    )
    for row in rows:
        item, near, lands = row.item, row.item.low_force, row.centring
        if item.candidate is None or near is None:
            continue
        misfits = [(row.solved and row.solved.misfit[name]) or (None, None) for name in CONDITIONS]
        ends = (*lands.contact_radius_mm, *lands.margin_mm) if lands else (None,) * (2 * len(forces))
        values = (
            item.candidate.thickness_mm,
            item.young_kPa,
            near.misfit_rms_ln_force,
            *(one for one, _ in misfits),
            *(end for _, end in misfits),
            near.share_below_5N,
            near.share_above_5N,
            *near.exponent_at_N.values(),
            near.depth_over_thickness,
            item.candidate.total,
            *ends,
        )
        table.writerow([row.tissue, item.shape, *("" if value is None else f"{value:.4g}" for value in values)])
    return stream.getvalue()


def curves_text(rows: list[Row]) -> str:
    """Depths and forces of every solved design as CSV."""
    forces = "tissue_force_N,table_force_N,bonded_force_N,frictionless_force_N"
    lines = [f"tissue,shape,thickness_mm,young_kPa,depth_mm,{forces}"]
    for row in rows:
        if row.solved is None or row.item.candidate is None:
            continue
        head = f'{row.tissue},"{row.item.shape}",{row.item.candidate.thickness_mm:g},{row.item.young_kPa:.5g}'
        values = (row.solved.depth_mm, CHECKED_N, row.solved.table_N, *(row.solved.force_N[c] for c in CONDITIONS))
        lines += [f"{head},{','.join('' if np.isnan(v) else f'{v:.5g}' for v in point)}" for point in zip(*values)]
    return "\n".join(lines) + "\n"


def main(arguments: list[str] | None = None) -> None:
    """Design, solve and write the page.

    Raises
    ------
    InputError
        When the page or its marks are missing.
    """
    from dummydesign.geometry.dimensions import PUNCH
    from dummydesign.pad.tables.slab import load_table
    from dummydesign.pad.tables.square import punch_law

    parser = argparse.ArgumentParser(prog="python -m studies.shapes", description=__doc__)
    parser.add_argument("--repository", type=Path, default=Path("."), help="folder that holds docs/")
    options = parser.parse_args(arguments)
    MARKED.read(options.repository)
    law = punch_law(load_table(base="bonded"), PUNCH)
    studied = []
    for tissue in TISSUES:
        answer, rows = study(tissue)
        studied.append((answer, rows, lowest_slab(answer, law)))
    made = tables(studied)
    print(made)
    every = [row for _, rows, _ in studied for row in rows]
    write_text(options.repository / CURVES, curves_text(every))
    write_text(options.repository / DESIGNS, designs_text(every))
    MARKED.write(options.repository, made)


if __name__ == "__main__":
    main()

"""Does thickness dominate the nonlinearity? Finite-element curves, and what they say at equal terms.

    python -m studies.thickness [--solve]

writes ``docs/data/thickness.csv`` and a short table of it into ``docs/whatif.md``. With ``--solve`` the curves behind
them are solved again first (sixteen slabs, some minutes) into ``docs/data/thickness-curves.csv``.
"""

from __future__ import annotations

import argparse
import csv
import io
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.files import write_text
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.pad.fe_force_law import FeForceLaw, SolvedSlab, law_of, solve_slab
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.report.whatif import STATEMENT
from studies.marked_page import MarkedPage, wrapped

THICKNESS_MM = (5.0, 10.0, 15.0, 20.0)
STIFFENING = (0.1, 0.3)
"""c2 / mu of the Yeoh laws that are tried beside the neo-Hookean solid."""
RADIUS_MM = PUNCH_RADIUS_MM
YOUNG_MPA = 0.025
"""The paper's 25 kPa; it only matters at equal force."""
FORCES_N = (2.0, 5.0, 10.0, 15.0)
DEPTHS_MM = (1.0, 2.0, 2.9)
STRAINS = (0.1, 0.2, 0.3, 0.4)
_CASE = ("base", "yeoh_c2_over_mu", "thickness_mm", "radius_mm")
CURVES = Path("docs") / "data" / "thickness-curves.csv"
TABLE = Path("docs") / "data" / "thickness.csv"
PAGE = Path("docs") / "whatif.md"
ON_PAGE: dict[str, tuple[float, ...]] = {"force_N": (5.0,), "depth_mm": (1.0,)}
"""Rows of the page, on both bases of the neo-Hookean solid; the CSV file has all."""
MARKED = MarkedPage(PAGE, "<!-- thickness tables: begin -->", "<!-- thickness tables: end -->")


def unit_slab(thickness_mm: float, radius_mm: float, base: str, c2_over_mu: float) -> Pad:
    """A slab of unit modulus that stiffens by Yeoh's law."""
    return Pad(thickness_mm, 1.0, radius_mm, base=base, law=Yeoh(1.0, c2_over_mu))


def stiffening(slab: Pad) -> float:
    """Yeoh's c2 over mu of a slab."""
    return getattr(slab.law, "c2_MPa", 0.0)


def cases() -> list[Pad]:
    """Slabs of the study, glued to the punch: both bases neo-Hookean, then stiffening on a bonded base."""
    supports = [("bonded", 0.0), ("sliding", 0.0), *(("bonded", value) for value in STIFFENING)]
    return [unit_slab(thickness, RADIUS_MM, base, c2) for base, c2 in supports for thickness in THICKNESS_MM]


def curves_text(slabs: list[SolvedSlab]) -> str:
    """Write solved curves as CSV: force over modulus against depth."""
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow([*_CASE, "depth_mm", "force_over_young_mm2", "relative_error"])
    for slab in slabs:
        pad = slab.pad
        head = (pad.base, f"{stiffening(pad):g}", f"{pad.thickness_mm:g}", repr(pad.radius_mm))
        for row in zip(slab.depth_mm, slab.area_mm2, slab.error):
            table.writerow([*head, *(f"{value:.8g}" for value in row)])
    return stream.getvalue()


def read_curves(text: str) -> list[SolvedSlab]:
    """Read what :func:`curves_text` wrote."""
    groups: dict[Pad, list[tuple[float, ...]]] = {}
    for row in csv.DictReader(io.StringIO(text)):
        base, c2, thickness, radius = (row[name] for name in _CASE)
        slab = unit_slab(float(thickness), float(radius), base, float(c2))
        values = tuple(float(row[name]) for name in ("depth_mm", "force_over_young_mm2", "relative_error"))
        groups.setdefault(slab, []).append(values)
    return [SolvedSlab(slab, *np.array(rows).T) for slab, rows in groups.items()]


@dataclass(frozen=True)
class Curvature:
    """How curved one slab is at one place: depth, strain d / h, force, exponent, and the exponent's growth.

    ``exponent`` is n = d ln F / d ln x, 1 for a straight line; ``growth`` is dn / d ln x, how fast it rises.
    None beyond what was solved.
    """

    base: str
    thickness_mm: float
    depth_mm: float | None
    strain: float | None
    force_N: float | None
    exponent: float | None
    growth: float | None

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values."""
        return asdict(self)


def curvature_at(law: FeForceLaw, base: str, thickness_mm: float, depth_mm: float) -> Curvature:
    """Curvature of a solved slab at a depth.

    With F = E a x exp(p(x / h)) and u = x / h: n = 1 + u p'(u), dn / d ln x = u p'(u) + u^2 p''(u).

    Parameters
    ----------
    law : FeForceLaw
        The solved slabs.
    base : str
        ``bonded`` or ``sliding``, for the row.
    thickness_mm : float
        One of the solved thicknesses. [mm]
    depth_mm : float
        Where to look. [mm]

    Returns
    -------
    Curvature
        With None for what lies beyond the solved depth.
    """
    if not depth_mm <= law.depth_limit_mm(thickness_mm, law.radius_mm) * (1.0 + 1e-9):
        return Curvature(base, thickness_mm, None, None, None, None, None)
    series = np.polynomial.Polynomial(law.polynomials[thickness_mm])
    u = depth_mm / thickness_mm
    first, second = u * series.deriv()(u), u * u * series.deriv(2)(u)
    force = float(law.force(depth_mm, thickness_mm, YOUNG_MPA, law.radius_mm))
    return Curvature(base, thickness_mm, depth_mm, u, force, 1.0 + float(first), float(first + second))


def depth_at_force(law: FeForceLaw, thickness_mm: float, force_N: float) -> float:
    """Depth at which a solved slab of the study's modulus carries a force; infinite when out of reach. [mm]

    Parameters
    ----------
    law : FeForceLaw
        The solved slabs.
    thickness_mm : float
        One of the solved thicknesses. [mm]
    force_N : float
        The force to be carried. [N]
    """
    depth = np.linspace(0.0, law.depth_limit_mm(thickness_mm, law.radius_mm), 4001)
    force = law.force(depth, thickness_mm, YOUNG_MPA, law.radius_mm)
    return float(np.interp(force_N, force, depth, right=np.inf))


def study(slabs: list[SolvedSlab]) -> dict[str, dict[float, list[Curvature]]]:
    """Curvature at equal force, equal depth and equal strain: {terms: {value: one a support and thickness}}."""
    curvatures: dict[str, dict[float, list[Curvature]]] = {"force_N": {}, "depth_mm": {}, "strain": {}}
    for name, law in laws(slabs).items():
        for thickness in sorted(law.polynomials):
            for force in FORCES_N:
                depth = depth_at_force(law, thickness, force)
                curvatures["force_N"].setdefault(force, []).append(curvature_at(law, name, thickness, depth))
            for depth in DEPTHS_MM:
                curvatures["depth_mm"].setdefault(depth, []).append(curvature_at(law, name, thickness, depth))
            for strain in STRAINS:
                at = curvature_at(law, name, thickness, strain * thickness)
                curvatures["strain"].setdefault(strain, []).append(at)
    return curvatures


def laws(slabs: list[SolvedSlab]) -> dict[str, FeForceLaw]:
    """Force laws of the solved slabs by support: ``bonded``, ``sliding``, ``bonded, c2/mu 0.1`` .."""
    groups: dict[str, list[SolvedSlab]] = {}
    for slab in slabs:
        c2 = stiffening(slab.pad)
        groups.setdefault(slab.pad.base + (f", c2/mu {c2:g}" if c2 else ""), []).append(slab)
    return {name: law_of(group) for name, group in groups.items()}


def table_text(curvatures: dict[str, dict[float, list[Curvature]]]) -> str:
    """Write exponent and growth of every slab at equal force, depth and strain as CSV; empty beyond what was solved."""
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(["equal", "value", "base", "thickness_mm", "depth_over_thickness", "exponent", "growth"])
    for terms, values in curvatures.items():
        for value, rows in values.items():
            for row in rows:
                known = (row.strain, row.exponent, row.growth) if row.exponent is not None else (None, None, None)
                cells = ["" if number is None else f"{number:.3f}" for number in known]
                table.writerow([terms, f"{value:g}", row.base, f"{row.thickness_mm:g}", *cells])
    return stream.getvalue()


def page_text(curvatures: dict[str, dict[float, list[Curvature]]]) -> str:
    """Markdown table of exponents on both bases of the neo-Hookean solid, thickness across."""
    units = {"force_N": "N", "depth_mm": "mm", "strain": "of the thickness"}
    lines = ["| base | at | " + " | ".join(f"{thickness:g} mm" for thickness in THICKNESS_MM) + " |"]
    lines.append("|---" * (2 + len(THICKNESS_MM)) + "|")
    for base in ("bonded", "sliding"):
        for terms, values in ON_PAGE.items():
            for value in values:
                rows = [row for row in curvatures[terms][value] if row.base == base]
                cells = ["-" if row.exponent is None else f"{row.exponent:.2f}" for row in rows]
                lines.append(f"| {base} | {value:g} {units[terms]} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def write_page(folder: Path, slabs: list[SolvedSlab]) -> None:
    """Write the CSV file and put statement and table between their marks in the page.

    Raises
    ------
    InputError
        When the page or its marks are missing.
    """
    curvatures = study(slabs)
    statement = wrapped(STATEMENT).strip()
    MARKED.write(folder, f"{statement}\n\n{page_text(curvatures)}")
    (folder / TABLE).parent.mkdir(parents=True, exist_ok=True)
    write_text(folder / TABLE, table_text(curvatures))


def main(arguments: list[str] | None = None) -> None:
    """Solve when asked to, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m studies.thickness", description=__doc__)
    parser.add_argument("--solve", action="store_true", help="solve the curves again")
    parser.add_argument("--repository", type=Path, default=Path("."), help="folder that holds docs/")
    options = parser.parse_args(arguments)
    curves = options.repository / CURVES
    if options.solve:
        slabs = []
        for case in cases():
            slabs.append(solve_slab(case))
            print(f"{case.base} base, c2/mu {stiffening(case):g}, {case.thickness_mm:g} mm", flush=True)
        curves.parent.mkdir(parents=True, exist_ok=True)
        write_text(curves, curves_text(slabs))
    write_page(options.repository, read_curves(curves.read_text(encoding="utf-8")))


if __name__ == "__main__":
    main()

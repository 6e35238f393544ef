"""Figures of the pad model that docs/pad.md quotes: ``python -m studies.pad_figures [--only NAME ...]``.

Writes six files into ``docs/data``; about one minute of processor time. The pad is a slab of 25 kPa under a round punch
of the area of 14 x 14 mm. Errors of the sharp edge, of the square and of the quick prediction are read from the
response tables. Fillets, friction and a resting base are solved.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.files import write_text
from dummydesign.core.user_library import data_folder
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
from dummydesign.pad.force_law import ForceCurve
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.square import square_factor

FOLDER = Path("docs") / "data"
THICKNESS_MM = (5.0, 10.0, 15.0, 20.0)
YOUNG_MPA = 0.025
DEEPEST = 0.5
"""Largest depth over thickness."""
FILLET_MM = 0.5
"""Fillet of the punch where friction at the face is studied."""
Row = tuple[object, ...]


def _curve(pad: Pad, depths: tuple[float, ...] = (DEEPEST,), fidelity: str = "axisymmetric") -> ForceCurve:
    h = pad.thickness_mm
    return elastic_curve(pad, fidelity, h * max(depths), h * np.array(depths))


def _slab(thickness_mm: float, **options: Any) -> Pad:
    return Pad(thickness_mm, YOUNG_MPA, PUNCH_RADIUS_MM, **options)


def sharp_error() -> Iterator[Row]:
    """Stated error of the force under a sharp, glued edge."""
    yield "thickness_mm", "depth_over_thickness", "stated_error_percent"
    for h in THICKNESS_MM:
        curve = _curve(_slab(h), fidelity="table")
        for depth in (0.2, 0.3, 0.425):
            yield f"{h:g}", f"{depth:g}", f"{100 * curve.relative_error(np.array([h * depth]))[0]:.1f}"


def square() -> Iterator[Row]:
    """Force under the square punch over that under the circle of its area, bonded base."""
    yield "thickness_mm", "depth_over_thickness", "square_over_circle", "stated_error_percent"
    for h in THICKNESS_MM:
        for depth in (0.1, 0.2, 0.3, 0.4, 0.5):
            value, error = square_factor(h * depth, h, PUNCH_RADIUS_MM)
            yield f"{h:g}", f"{depth:g}", f"{float(value):.3f}", f"{100 * float(error):.2f}"


def quick_error() -> Iterator[Row]:
    """Error of the quick prediction at the peak, as ``studies.tables.separability`` measured it on three arms."""
    yield "thickness_mm", "depth_over_thickness", "velocity_mm_s", "error_percent"
    table = data_folder() / "materials" / "tables" / "quick-error.json"
    for row in json.loads(table.read_text(encoding="utf-8"))["values"]:
        if (row["arms"], row["base"]) == ("library", "bonded"):
            names = ("thickness_mm", "relative_depth", "velocity_mm_s")
            yield *(f"{row[name]:g}" for name in names), f"{100 * row['error_at_peak']:.1f}"


def base_friction() -> Iterator[Row]:
    """Force of a pad that rests on its base by weight and friction, over that of a bonded one."""
    yield "thickness_mm", "friction", "young_kPa", "depth_over_thickness", "force_over_bonded"
    depths, friction = (0.02, 0.1, 0.2, 0.3, 0.5), 0.3
    for h in (5.0, 20.0):
        resting, bonded = (_curve(_slab(h, base=base), depths) for base in (f"friction:{friction:g}", "bonded"))
        for depth, ratio in zip(depths, resting.force(h * np.array(depths)) / bonded.force(h * np.array(depths))):
            yield f"{h:g}", f"{friction:g}", f"{1e3 * YOUNG_MPA:g}", f"{depth:g}", f"{ratio:.2f}"


FILLETS = tuple(
    (h, fillet, sides, (0.05, 0.1, 0.2, 0.3, 0.4, 0.5), 1)
    for h in THICKNESS_MM for fillet, sides in ((0.2, True), (0.5, True), (0.5, False), (1.0, True))
) + tuple(
    (h, fillet, False, (0.05, 0.1, 0.15, 0.2, 0.3), 2)
    for h in (5.0, 10.0, 20.0) for fillet in (0.4, 0.2, 0.1, 0.05)
)  # fmt: skip
"""Thickness, fillet, whether the punch's side may touch, depths over thickness, digits. The second part is a series of
fillets that go to the sharp edge."""


def fillet() -> Iterator[Row]:
    """Force under a filleted edge over the table's of the sharp edge, in per cent."""
    yield "thickness_mm", "fillet_mm", "side_contact", "depth_over_thickness", "force_over_sharp_percent"
    for h, radius, sides, depths, digits in FILLETS:
        sharp = _curve(_slab(h), fidelity="table")
        solved = solve_under_fillet(_slab(h, edge_radius_mm=radius), h * np.array(depths), sides=sides)
        for depth_mm, force in zip(solved.depth_mm, solved.force_N):
            change = 100 * (force / sharp.force(np.array([depth_mm]))[0] - 1.0)
            yield f"{h:g}", f"{radius:g}", "yes" if sides else "no", f"{depth_mm / h:g}", f"{change:.{digits}f}"


FACES = (
    *((h, "0") for h in (5.0, 10.0, 15.0)),
    *((5.0, face) for face in ("0.3", "0.5", "glued")),
    *((10.0, face) for face in ("0.1", "0.3", "0.5", "glued")),
    *((20.0, face) for face in ("0.3", "0.5", "glued")),
)
"""Thickness and friction at the punch's face."""


def face_friction() -> Iterator[Row]:
    """Force under a filleted punch whose face slides, rubs or is glued."""
    yield "thickness_mm", "friction", "depth_over_thickness", "force_over_E_h_d", "stated_error_percent"
    depths = np.array([0.02, 0.1, 0.2, 0.3, 0.4, 0.5])
    for h, face in FACES:
        condition = {"0": "frictionless", "glued": "bonded"}.get(face, f"friction:{face}")
        solved = solve_under_fillet(_slab(h, edge_radius_mm=FILLET_MM, condition=condition), h * depths)
        for d, force, error in zip(solved.depth_mm, solved.force_N, solved.error_N):
            yield f"{h:g}", face, f"{d / h:g}", f"{force / (YOUNG_MPA * h * d):#.3g}", f"{100 * error / force:.1f}"


FIGURES: dict[str, Callable[[], Iterator[Row]]] = {
    "pad-sharp-error": sharp_error,
    "pad-square": square,
    "pad-quick-error": quick_error,
    "pad-base-friction": base_friction,
    "pad-fillet": fillet,
    "pad-friction": face_friction,
}


def text_of(name: str) -> str:
    """The content of one file."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(FIGURES[name]())
    return out.getvalue()


def main() -> None:
    """Write the files."""
    parser = argparse.ArgumentParser(description="Write the figures of the pad model into docs/data.")
    parser.add_argument("--only", nargs="+", choices=FIGURES, default=[*FIGURES])
    options = parser.parse_args()
    for name in options.only:
        write_text(FOLDER / f"{name}.csv", text_of(name))
        print(FOLDER / f"{name}.csv", flush=True)


if __name__ == "__main__":
    main()

"""Drawn moulds: what is printed lies on its bed without overhang, and programs of other makers open it.

``python -m benchmarks.accuracy.moulds_drawn [--moulds 500] [--built 20] [--seed N] [--out FILE.jsonl]`` draws pads
(3 to 30 mm thick, 30 to 200 mm long and wide, five kinds of shape, puck included), presets, machines and numbers of
cavities. A specification that is refused for its size must fit when the size of its advice is taken. Of every mould
that can be made, the parts' closed outlines are laid on the bed by arithmetic of this file's own.

The first ``--built`` of these are built: the 3MF of each printed part is written as ``mold`` writes it, and its mesh as
STL for programs that read no 3MF. The 3MF is read by trimesh and measured as they lie (on the bed, inside it, area
flatter than 45 degrees that hangs), and opened by PrusaSlicer, admesh and gmsh where they are installed. Those are run
as programs; no library of theirs is loaded.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from benchmarks.rows import keep_row, scratch
from dummydesign.core.errors import InputError
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.printed_parts import printed_parts
from dummydesign.mold.model.spec import MouldSpec

MOST_OVERHANG_MM2, STEEPEST_DEG = 300.0, 45.0


def drawn(rng: Generator) -> dict[str, Any]:
    """Arguments of a specification."""
    thickness = float(rng.integers(6, 61)) / 2
    length, width = (float(side) for side in rng.integers(30, 201, 2))
    kind = str(rng.choice(["slab", "crowned", "layered", "boned", "puck"]))
    preset = str(rng.choice(["open", "lidded", "printed"]))
    asked = {
        "thickness_mm": thickness,
        "length_mm": length,
        "width_mm": length if kind == "puck" else width,
        "preset": preset,
        "machines": str(rng.choice(["workshop", "large"])),
        "shape": kind,
    }
    part = rng.uniform(0.1, 0.6) * thickness
    if kind in ("crowned", "boned"):
        asked["shape"] = f"{kind}:{rng.uniform(4, 25):.1f},{part:.1f}"
    if kind == "layered":
        asked["shape"] = f"layered:{part:.1f},{rng.uniform(0.3, 3):.2f}"
    if kind in ("slab", "puck", "crowned") and preset != "lidded":
        asked["count"] = int(rng.choice([1, 1, 1, 2, 4]))
    return asked


def specified(asked: dict[str, Any]) -> MouldSpec:
    """The specification of drawn arguments."""
    given = dict(asked)
    text = given.pop("shape")
    if text == "puck":
        return mould_spec(**given, kind="puck")
    shape = read_shape(text)
    return mould_spec(**given, kind=shape.name, parameters=shape.parameters)


def advised(asked: dict[str, Any], message: str) -> dict[str, Any] | None:
    """Arguments with the size or count that a refusal names; None where it names none."""
    size = re.search(r"(?:a pad of|turned by 90 degrees,) (\S+) x (\S+) mm,? (?:fits|it fits)", message)
    if size:
        return {**asked, "length_mm": float(size[1]), "width_mm": float(size[2]), "count": 1}
    count = re.search(r"; (\d+) fits? in one mould", message)
    return {**asked, "count": int(count[1])} if count else None


def laid(spec: MouldSpec) -> float:
    """Least room that a part's closed outline leaves on the bed within its margin, or under the printer. [mm]"""
    machines = spec.machines
    bed = sorted(machines.bed_mm)
    rooms = []
    for part in printed_parts(spec):
        low, high = sorted((part.outline.length_mm, part.outline.width_mm))
        rooms += [bed[0] - low, bed[1] - high, machines.printer_height_mm - part.height_mm]
    return min(rooms)


def built(spec: MouldSpec, folder: Path) -> Iterator[dict[str, Any]]:
    """Each printed part as its files hold it."""
    import trimesh

    from dummydesign.mold.cad.build import build
    from dummydesign.mold.files.meshes import lying, tessellate, write_3mf

    made, bed = build(spec), sorted(spec.machines.bed_mm)
    for part in printed_parts(spec):
        solid = made.parts[part.name].solid
        mesh = lying(tessellate(solid), part.turned, spec.machines.print_scale)
        stl, threemf = folder / f"{part.name}.stl", folder / f"{part.name}.3mf"
        mesh.export(stl)
        write_3mf(mesh, threemf)
        read: Any = trimesh.load(threemf, force="mesh")
        low, high = read.bounds
        across = np.sort((high - low)[:2])
        expected = np.sort([part.outline.length_mm, part.outline.width_mm])
        yield {
            "part": part.name,
            "off_bed_mm": abs(float(low[2])),
            "overhang_mm2": hanging_mm2(read),
            "room_mm": float(min(bed[0] - across[0], bed[1] - across[1], spec.machines.printer_height_mm - high[2])),
            "off_outline_mm": float(max(np.abs(across - expected).max(), abs(high[2] - part.height_mm))),
            "complaints": [*opened(stl), *opened(threemf)],
        }


def hanging_mm2(mesh: Any) -> float:
    """Area that looks down flatter than 45 degrees and is not on the bed. [mm2]"""
    corners = np.asarray(mesh.triangles)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    down = normal[:, 2] < -np.cos(np.radians(STEEPEST_DEG - 1e-4)) * area
    return float(0.5 * area[down & (corners[:, :, 2].max(axis=1) > 1e-3)].sum())


def opened(path: Path) -> list[str]:
    """What programs of other makers say of a file; nothing where all is well or none is installed."""
    said = []
    if program := shutil.which("prusa-slicer"):
        text = _said([program, "--info", str(path)])
        if "manifold = yes" not in text or "number_of_parts =  1" not in text or "open_edges" in text:
            said.append(f"PrusaSlicer, {path.name}: {' '.join(text.split())[-200:]}")
    if path.suffix != ".stl":
        return said
    if program := shutil.which("admesh"):
        text = _said([program, str(path)])
        wrong = [line.strip() for line in text.splitlines() if re.search(WRONG, line)]
        wrong = wrong or ([] if "Number of parts" in text else ["no answer"])
        said += [f"admesh, {path.name}: {line}" for line in wrong]
    if program := shutil.which("gmsh"):
        text = _said([program, str(path), "-parse_and_exit"])
        if re.search("Warning|Error", text) or "Done reading" not in text:
            said.append(f"gmsh, {path.name}: {' '.join(text.split())[-200:]}")
    return said


WRONG = r"(?:Degenerate facets|Edges fixed|Facets (?:removed|added|reversed)|Backwards edges|Normals fixed|disconnected facets) +: +[1-9]"  # noqa: E501


def _said(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, encoding="utf-8", errors="replace", timeout=300)
    return done.stdout + done.stderr


def one(number: int, seed: int, build: bool) -> dict[str, Any]:
    """One drawn mould, as a line of the result."""
    asked = drawn(np.random.default_rng((seed, number)))
    row: dict[str, Any] = {"number": number, **asked}
    try:
        spec = specified(asked)
    except InputError as problem:
        row |= {"outcome": "refused", "code": problem.code, "quantity": problem.quantity, "message": str(problem)}
        if (other := advised(asked, str(problem))) is not None:
            row["advice_fits"] = _fits(other)
        return row
    row |= {"outcome": "fits", "room_mm": laid(spec)}
    if build:
        start = time.process_time()
        with scratch("moulds-drawn-") as folder:
            row["parts"] = list(built(spec, folder))
        row |= {"outcome": "built", "seconds": round(time.process_time() - start, 1)}
    return row


def _fits(asked: dict[str, Any]) -> bool:
    try:
        return laid(specified(asked)) >= 0.0
    except InputError:
        return False


def main() -> None:
    """Draw, lay, build some, write a line each and print the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--moulds", type=int, default=500)
    parser.add_argument("--built", type=int, default=20)
    parser.add_argument("--seed", type=int, default=20261126)
    parser.add_argument("--out", type=Path, default=Path("moulds_drawn.jsonl"))
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for number in range(options.moulds):
        more = sum(row["outcome"] == "built" for row in rows) < options.built
        rows.append(one(number, options.seed, more))
        keep_row(options.out, rows[-1])
        if rows[-1]["outcome"] == "built":
            print(number, rows[-1]["shape"], rows[-1]["preset"], rows[-1]["seconds"], flush=True)
    print(summary(rows))


def summary(rows: list[dict[str, Any]]) -> str:
    """The sums in words."""
    parts = [part for row in rows for part in row.get("parts", ())]
    fit = [row for row in rows if row["outcome"] != "refused"]
    advice = [row["advice_fits"] for row in rows if "advice_fits" in row]
    lines = [
        f"{len(rows)} drawn: {dict(Counter(row['outcome'] for row in rows))}",
        f"refused: {dict(Counter(row['code'] for row in rows if row['outcome'] == 'refused'))}",
        f"sizes and counts advised: {len(advice)}, of which fit {sum(advice)}",
        f"least room of a closed outline: {min(row['room_mm'] for row in fit):.2f} mm",
    ]
    if parts:
        programs = [name for name in ("prusa-slicer", "admesh", "gmsh") if shutil.which(name)]
        most = {name: max(part[name] for part in parts) for name in ("off_bed_mm", "off_outline_mm", "overhang_mm2")}
        lines += [
            f"{len(parts)} printed parts built: off the bed by at most {most['off_bed_mm']:.1g} mm, "
            f"least room {min(part['room_mm'] for part in parts):.2f} mm, off their outline by at most "
            f"{most['off_outline_mm']:.3f} mm, largest overhang {most['overhang_mm2']:.0f} mm2 "
            f"(allowed {MOST_OVERHANG_MM2:g})",
            f"opened by {', '.join(programs) or 'no other program'}: "
            f"{sum(bool(part['complaints']) for part in parts)} parts with complaints",
        ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()

"""Checks of the files: every one is read again from disk before it counts. CAD child only."""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dummydesign.mold.cad.parts import Part, Parts
from dummydesign.mold.cad.solids import rough_bounds
from dummydesign.mold.checks import Check, above, below, equal, genera, skipped
from dummydesign.mold.files.step import canonical_step, read_step, time_stamp
from dummydesign.mold.model.layout import Outline, bed_spare_mm
from dummydesign.mold.model.printed_parts import MOST_OVERHANG_MM2, STEEPEST_DEG

READER_LIMIT_S = 120
VOLUME_REL = 1e-6
# FreeCAD has its own kernel's exact volumes; gmsh prints what Open CASCADE integrates, in its own script language.
_GMSH = """SetFactory("OpenCASCADE");
v() = ShapeFromFile("{path}");
For i In {{0:#v()-1}}
  m = Mass Volume{{v(i)}};
  Printf("RESULT %.12g", m);
EndFor
"""


def volumes_by_gmsh(path: Path) -> list[float] | None:
    """Volumes of the solids of a STEP file as gmsh reads them; None without gmsh, or without an answer. [mm3]"""
    program = shutil.which("gmsh")
    if program is None:
        return None
    with tempfile.TemporaryDirectory(prefix="dummydesign-gmsh-") as folder:
        script = Path(folder) / "read.geo"
        script.write_text(_GMSH.format(path=path.resolve().as_posix()), encoding="utf-8")
        return [float(hit) for hit in re.findall(r"RESULT (\S+)", _run([program, str(script), "-"]))] or None


def check_second_reader(assembly: Path, volume_mm3: float, count: int) -> Check:
    """Read the assembly with FreeCAD or gmsh, whichever is installed; otherwise say that this was skipped."""
    name, limit = "step_second_reader", VOLUME_REL
    program = shutil.which("FreeCADCmd") or shutil.which("freecadcmd")
    if program is not None:
        script = (
            f"import Part; s = Part.Shape(); s.read({str(assembly)!r}); print('RESULT', len(s.Solids), "
            "sum(x.Volume for x in s.Solids), all(x.isValid() for x in s.Solids))"
        )
        hit = re.search(r"RESULT (\d+) (\S+) (\w+)", _run([program, "-c", script]))
        if hit is not None:
            error = abs(float(hit[2]) / volume_mm3 - 1) if int(hit[1]) == count and hit[3] == "True" else 1.0
            return below(name, error, limit, f"FreeCAD: {hit[1]} solids, valid {hit[3]}")
    volumes = volumes_by_gmsh(assembly)
    if volumes is not None:
        error = abs(sum(volumes) / volume_mm3 - 1) if len(volumes) == count else 1.0
        return below(name, error, limit, f"gmsh: {len(volumes)} solids")
    there = "did not answer" if program or shutil.which("gmsh") else "is installed on this machine"
    return skipped(name, f"neither FreeCAD nor gmsh {there}")


def _run(command: list[str]) -> str:
    """What a program prints; nothing when it cannot be run or takes too long."""
    try:
        done = subprocess.run(command, capture_output=True, encoding="utf-8", errors="replace", timeout=READER_LIMIT_S)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout


# Volumes of solids with splines are integrals to some 2e-9 of themselves.
STEP_VOLUME_REL, STEP_BOUNDS_MM, COLOUR_ABS, DENSITY_REL = 1e-8, 1e-5, 1e-6, 1e-6
MESH_VOLUME_REL = 1e-3


def check_step(parts: Mapping[str, Part], files: Mapping[str, Path], assembly: Path) -> list[Check]:
    """Read all STEP files again: names, solids, volumes, bounds, colours, materials, declared volumes."""
    volume = bounds = colour = density = 0.0
    wrong: list[str] = []
    names = 0
    single = {name: read_step(path) for name, path in files.items()}
    whole = {part.name: part for part in read_step(assembly, validity=False)}
    for name, part in parts.items():
        copies = [*single[name], *([whole[name]] if name in whole else [])]
        names += len(copies) == 2 and all(copy.name == name for copy in copies)
        for copy in copies:
            true = part.volume_mm3
            off = max(abs(copy.volume_mm3 / true - 1), abs((copy.declared_volume_mm3 or 0.0) / true - 1))
            volume = max(volume, off)
            bounds = max(bounds, *(abs(a - b) for a, b in zip(copy.bounds_mm, rough_bounds(part.solid))))
            colour = max(colour, *(abs(a - b) for a, b in zip(copy.colour or (9, 9, 9), part.material.colour)))
            density = max(density, abs((copy.density_g_per_cm3 or 0.0) / part.material.density_g_per_cm3 - 1))
            if copy.solids != 1 or not copy.valid or copy.material != part.material.name:
                wrong.append(name)
    return [
        equal("step_names", names, len(parts), "parts found under their name alone and in the assembly"),
        equal("step_solids", len(wrong), 0, ", ".join(sorted(set(wrong)))),
        below("step_volume", volume, STEP_VOLUME_REL, "read again, and as declared in the file"),
        below("step_bounds", bounds, STEP_BOUNDS_MM, "mm"),
        below("step_colour", colour, COLOUR_ABS),
        below("step_density", density, DENSITY_REL),
    ]


def check_step_text(assembly: Path, small: Path, spec_hash: str) -> list[Check]:
    """Header without translator names, millimetres, fixed stamp, the hash; a file that is the same in every run."""
    text = assembly.read_text(encoding="utf-8")
    head = text[: text.find("DATA;")]
    foreign = re.findall(r"Open CASCADE|translator|'Author'|Unknown|processor", text)
    good = not foreign and f"'{time_stamp()}'" in head and spec_hash in head and "AP242" in head
    units = re.findall(r"LENGTH_UNIT\(\)\s*NAMED_UNIT\(\*\)\s*SI_UNIT\(([^)]*)\)", text)
    again = small.read_text(encoding="utf-8")
    description = re.search(r"FILE_DESCRIPTION\(\('(.*?)'\)", again)
    canonical = canonical_step(again, small.name, description[1] if description else "") == again
    millimetres = bool(units) and set(units) <= {".MILLI.,.METRE.", ".CENTI.,.METRE."}
    return [
        equal("step_header", good, True, ", ".join(sorted(set(foreign)))),
        equal("step_millimetres", millimetres, True, "centimetres occur in the unit of density alone"),
        equal("step_canonical", canonical, True, "colours follow the parts, and no time or counter is in the file"),
    ]


ON_BED_MM = 1e-3


def overhang_mm2(mesh: Any) -> float:
    """Area of a mesh that looks down off the bed, flatter than 45 degrees: what needs support. [mm2]

    The bed is at the mesh's lowest point.
    """
    import numpy as np

    triangles = np.asarray(mesh.triangles)
    above_bed = triangles[:, :, 2].max(axis=1) > mesh.bounds[0][2] + ON_BED_MM
    flat = -np.asarray(mesh.face_normals)[:, 2] > math.cos(math.radians(STEEPEST_DEG)) + 1e-6
    return float(np.asarray(mesh.area_faces)[above_bed & flat].sum())


def check_lying(made: Parts, files: Mapping[str, Path]) -> list[Check]:
    """Print files lie on z = 0, hang over the bed nowhere, and fit it with their margin; read again from disk."""
    import numpy as np
    import trimesh

    machines = made.spec.machines
    low, spare, hanging, names = 0.0, math.inf, 0.0, {"spare": "", "hanging": ""}
    for name, path in files.items():
        mesh: Any = trimesh.load(path, force="mesh")
        (x0, y0, z0), (x1, y1, z1) = mesh.bounds
        low = max(low, abs(z0))
        covered = Outline(x1 - x0, y1 - y0, 0.0)
        if machines.bed_diameter_mm:
            from_middle = mesh.vertices[:, :2] - mesh.bounds.mean(axis=0)[:2]
            reach = float(np.hypot(*from_middle.T).max())
            covered = Outline(2 * reach, 2 * reach, reach)
        room = bed_spare_mm(machines, covered, z1)
        if room < spare:
            spare, names["spare"] = room, name
        if (area := overhang_mm2(mesh)) > hanging:
            hanging, names["hanging"] = area, name
    note = "mm2 flatter than 45 degrees off the bed"
    worst = f", {names['hanging']}" if names["hanging"] else ""
    return [
        below("print_on_bed", low, ON_BED_MM, "mm, lowest point of the print files off the bed"),
        below("print_overhang", hanging, MOST_OVERHANG_MM2, note + worst),
        above("print_fits_bed", spare, -BED_SLACK_MM, f"mm to spare for print file {names['spare']}, margin kept"),
    ]


BED_SLACK_MM = 0.01


def check_meshes(made: Parts, files: Mapping[str, Path]) -> list[Check]:
    """Load every mesh file again: watertight, wound outwards, the solid's volume, the expected Euler number."""
    import trimesh

    loose: list[str] = []
    torn: list[str] = []
    worst, genus, scale = 0.0, genera(made.spec), made.spec.machines.print_scale
    for name, path in files.items():
        mesh: Any = trimesh.load(path, force="mesh")
        if not (mesh.is_watertight and mesh.is_winding_consistent and mesh.is_volume):
            loose.append(path.name)
        if mesh.euler_number != 2 - 2 * genus[name]:
            torn.append(f"{path.name}: {mesh.euler_number} instead of {2 - 2 * genus[name]}")
        worst = max(worst, abs(mesh.volume / (scale**3 * made.parts[name].volume_mm3) - 1))
    return [
        equal("mesh_watertight", len(loose), 0, ", ".join(loose)),
        equal("mesh_euler", len(torn), 0, "; ".join(torn)),
        below("mesh_volume", worst, MESH_VOLUME_REL),
    ]

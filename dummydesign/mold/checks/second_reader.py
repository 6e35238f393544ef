"""The assembly read by another program, run beside this one: FreeCAD, or gmsh. CAD child only."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from dummydesign.mold.checks.result import Check, below, skipped

SECOND_READER_S = 120
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
        done = _run([program, str(script), "-"])
    found = [float(hit) for hit in re.findall(r"RESULT (\S+)", done)]
    return found or None


def check_second_reader(assembly: Path, volume_mm3: float, count: int) -> Check:
    """Read the assembly with FreeCAD or gmsh, whichever is installed; otherwise say that this was skipped.

    Parameters
    ----------
    assembly : Path
        The STEP file with all parts.
    volume_mm3 : float
        Sum of their volumes. [mm3]
    count : int
        How many solids it holds.

    Returns
    -------
    Check
    """
    program = next((found for name in ("FreeCADCmd", "freecadcmd") if (found := shutil.which(name))), None)
    if program is not None:
        script = (
            f"import Part; s = Part.Shape(); s.read({str(assembly)!r}); "
            "print('RESULT', len(s.Solids), sum(x.Volume for x in s.Solids), all(x.isValid() for x in s.Solids))"
        )
        hit = re.search(r"RESULT (\d+) (\S+) (\w+)", _run([program, "-c", script]))
        if hit is not None:
            error = abs(float(hit[2]) / volume_mm3 - 1) if int(hit[1]) == count and hit[3] == "True" else 1.0
            return below("step_second_reader", error, VOLUME_REL, f"FreeCAD: {hit[1]} solids, valid {hit[3]}")
    volumes = volumes_by_gmsh(assembly)
    if volumes is not None:
        error = abs(sum(volumes) / volume_mm3 - 1) if len(volumes) == count else 1.0
        return below("step_second_reader", error, VOLUME_REL, f"gmsh: {len(volumes)} solids")
    there = "did not answer" if program or shutil.which("gmsh") else "is installed on this machine"
    return skipped("step_second_reader", f"neither FreeCAD nor gmsh {there}")


def _run(command: list[str]) -> str:
    """What a program prints; nothing when it cannot be run or takes too long."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=SECOND_READER_S)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout

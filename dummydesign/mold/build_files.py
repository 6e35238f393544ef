"""Make all files of a mould in one folder and check them. CAD child only."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.progress import write_progress
from dummydesign.mold.cad.build import build
from dummydesign.mold.cad.kernel import beside
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.checks import Check, release
from dummydesign.mold.checks import files as check_files
from dummydesign.mold.checks.process import check_process
from dummydesign.mold.checks.solids import check_shape, check_solids
from dummydesign.mold.files import picture as view
from dummydesign.mold.files.meshes import tessellate, write_prints
from dummydesign.mold.files.part_drawings import part_views, sheets
from dummydesign.mold.files.picture import turned_over
from dummydesign.mold.files.pour_sheet import Foot, pour_sheet, write_papers
from dummydesign.mold.files.solid_view import mould_view
from dummydesign.mold.files.step import write_steps
from dummydesign.mold.model.printed_parts import printed_parts
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import gauge_points
from dummydesign.mold.pour.plan import PourPlan, pour_plan
from dummydesign.mold.pour.warnings import pour_warnings

PICTURE_S = 600
"""A renderer that hangs (a driver without a screen) is given up after this time; drawing takes a few seconds. [s]"""


def produce(spec: MouldSpec, folder: Path, foot: Foot) -> dict[str, Any]:
    """Build, write, read again and check; return what the parent turns into a result."""
    write_progress("step 1 of 5: building the solids")
    made = build(spec)
    write_progress("step 2 of 5: meshes and STEP files")
    meshes = {name: tessellate(part.solid) for name, part in made.parts.items()}
    picture = _start_picture(made, meshes, folder)
    try:
        return _write_and_check(made, meshes, folder, foot, picture)
    finally:
        if picture.poll() is None:
            # It takes too long, a check failed or the user stopped: nobody waits for it any more.
            picture.kill()
            picture.wait()


def _write_and_check(
    made: Parts, meshes: dict[str, Any], folder: Path, foot: Foot, picture: subprocess.Popen[bytes]
) -> dict[str, Any]:
    spec = made.spec
    volumes = {
        "cavity": made.cavity.Volume(),
        "pad_nominal": made.pad_nominal.Volume(),
        "pad_compensated": made.parts["pad"].volume_mm3,
        **{name: part.volume_mm3 for name, part in made.parts.items() if name != "pad"},
    }
    plan = pour_plan(spec)
    warnings = pour_warnings(spec, plan)
    written = beside(lambda: _write_and_read(made, meshes, folder))
    drawn = beside(lambda: _write_papers(made, plan, warnings, folder, foot))
    write_progress("step 3 of 5: checking the solids")
    tool = meshes["mould"] if made.whole is None else tessellate(made.mould)
    checks = check_solids(made, {**meshes, "mould": tool}) + check_shape(made)
    checks += release.check_mould_mesh(made, tool, tessellate(made.core, *release.FINE))
    write_progress("step 4 of 5: reading the files again")
    files, of_files = written()
    checks += [*of_files, *check_process(spec, plan, warnings)]
    write_progress("step 5 of 5: drawings, picture and pour sheet")
    files |= {"view": _write_view(made, meshes, folder)} | drawn() | finish_picture(picture, folder, spec, warnings)
    files |= {"spec": "spec.json", "checks": "checks.json"}
    listed = [item.to_dict() for item in checks]
    points = [point.to_dict() for point in gauge_points(spec)]
    write_json(folder / files["spec"], {"hash": spec.hash, "spec": spec.to_dict(), "gauge_points": points})
    write_json(folder / files["checks"], listed)
    return {
        "files": files,
        "volumes_mm3": volumes,
        "checks": listed,
        "warnings": warnings,
        "step_sha256": hashlib.sha256((folder / files["assembly"]).read_bytes()).hexdigest(),
    }


def _write_and_read(made: Parts, meshes: dict[str, Any], folder: Path) -> tuple[dict[str, str], list[Check]]:
    """Write the STEP and print files, and check what is read from them again; role to file name, and the checks."""
    spec = made.spec
    files = {name: f"{name}_{spec.tag}.step" for name in (*made.parts, "assembly")}
    words = f"{spec.preset} mould for a {spec.pad.title}, specification {spec.hash}, lengths in mm"
    write_steps(folder, made.parts, files, words)
    mesh_files = {name: folder / f"{name}_{spec.tag}.3mf" for name, part in made.parts.items() if part.is_printed}
    turned = [part.name for part in printed_parts(spec) if part.turned]
    write_prints(meshes, mesh_files, spec.machines.print_scale, turned)
    assembly = folder / files["assembly"]
    single = {name: folder / files[name] for name in made.parts}
    checks = check_files.check_step(made.parts, single, assembly)
    checks += check_files.check_step_text(assembly, folder / files["pad"], spec.hash)
    total = sum(part.volume_mm3 for part in made.parts.values())
    checks.append(check_files.check_second_reader(assembly, total, len(made.parts)))
    checks += check_files.check_meshes(made, mesh_files)
    checks += check_files.check_lying(made, mesh_files)
    return files | {f"{name}_3mf": path.name for name, path in mesh_files.items()}, checks


def _start_picture(made: Parts, meshes: dict[str, Any], folder: Path) -> subprocess.Popen[bytes]:
    spec = made.spec
    title = f"{spec.preset} mould, {spec.pad.title}   #{spec.hash}"
    packed = folder / ".picture.pickle"
    view.pack(*_shown(made, meshes), title, packed)
    picture = str(folder / f"mould_{spec.tag}.png")
    command = [sys.executable, "-m", "dummydesign.mold.files.picture", str(packed), picture]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _shown(made: Parts, meshes: dict[str, Any]) -> tuple[dict[str, Any], dict[str, tuple[float, float, float]]]:
    """Meshes as pictures show them and their colours: turned over where what matters is below, and named so."""
    shape, shown, colours = made.spec.pad.shape, {}, {}
    upside = {"carrier": "carrier, bone up"} if shape.bone_height_mm else {}
    upside |= {"pad": "pad, tested face up"} if shape.relief_mm else {}
    for name, part in meshes.items():
        if name == "pad" and "layer_top" in meshes:
            # Its two layers are shown instead.
            continue
        if name in upside:
            part = part.copy()
            part.vertices = turned_over(np.asarray(part.vertices))
        shown[upside.get(name, name)] = part
        colours[upside.get(name, name)] = made.parts[name].material.colour
    return shown, colours


def finish_picture(
    process: subprocess.Popen[bytes], folder: Path, spec: MouldSpec, warnings: list[dict[str, str]]
) -> dict[str, str]:
    """Wait for the picture; without one the mould is as good, with a warning."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(PICTURE_S)
    (folder / ".picture.pickle").unlink(missing_ok=True)
    picture = folder / f"mould_{spec.tag}.png"
    if picture.is_file():
        return {"picture": picture.name}
    message = "no picture: PyVista or OpenGL is missing here, or took too long; the drawings and files are complete"
    warnings.append({"code": "no_picture", "message": message})
    return {}


def _write_view(made: Parts, meshes: dict[str, Any], folder: Path) -> str:
    """A one-file HTML view with the stacked parts lifted apart; return its name."""
    page = mould_view(*_shown(made, meshes), f"Mould {made.spec.tag}, specification {made.spec.hash}")
    name = f"assembly_{made.spec.tag}.html"
    (folder / name).write_text(page, encoding="utf-8")
    return name


def _write_papers(
    made: Parts, plan: PourPlan, warnings: list[dict[str, str]], folder: Path, foot: Foot
) -> dict[str, str]:
    """Drawings and pour sheet; return role to file name."""
    drawn = sheets(made, part_views(made), foot.date, foot.paper)
    printed = {name: part.volume_mm3 for name, part in made.parts.items() if part.is_printed}
    blocks = pour_sheet(made.spec, plan, warnings, printed)
    return write_papers(folder, made.spec.tag, blocks, foot, list(drawn.values()), [drawn["pad"], drawn["mould"]])


def write_json(path: Path, content: Any) -> None:
    """Write plain data as JSON with sorted keys."""
    path.write_text(json.dumps(content, indent=1, sort_keys=True, allow_nan=False) + "\n", encoding="utf-8")

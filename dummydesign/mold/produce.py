"""Make all files of a mould in one folder and check them. CAD child only."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from dummydesign.core.outputs.progress import tell
from dummydesign.mold.cad.build import build
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.checks import files as check_files
from dummydesign.mold.checks import mesh as check_mesh
from dummydesign.mold.checks import process as check_process
from dummydesign.mold.checks import shape as check_shape
from dummydesign.mold.checks import solids as check
from dummydesign.mold.checks.holes import genera
from dummydesign.mold.checks.second_reader import check_second_reader
from dummydesign.mold.files import meshes as mesh
from dummydesign.mold.files import picture as view
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.files.drawings.dxf import to_dxf
from dummydesign.mold.files.drawings.parts import NO_PAPERS, Papers, part_views, sheets
from dummydesign.mold.files.drawings.pdf import to_pdf
from dummydesign.mold.files.drawings.svg import to_svg
from dummydesign.mold.files.sheet_pdf import Foot, sheet_pdf
from dummydesign.mold.files.step import COLOURS, Material, StepPart, step_text
from dummydesign.mold.files.view.mould import mould_view
from dummydesign.mold.gauging.points import gauge_points
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.batch import batches_of
from dummydesign.mold.pour.plan import PourPlan, pour_plan
from dummydesign.mold.pour.warnings import pour_warnings

GLASS = Material("glass or acrylic sheet", "cut to size, density of float glass", 2.5)
RIGID = Material("printed rigid polymer", "PETG or ASA, density as printed solid", 1.27)
PICTURE_S = 600
"""A renderer that hangs (a driver without a screen) is given up after this time; drawing takes a few seconds. [s]"""


def produce(
    spec: MouldSpec, folder: Path, papers: Papers = NO_PAPERS, bone_file: Path | None = None
) -> dict[str, Any]:
    """Build, write, read again and check; return what the parent turns into a result.

    Parameters
    ----------
    spec : MouldSpec
    folder : Path
        An empty folder; nothing in it counts until the parent has renamed it.
    papers : Papers
        What drawings and sheet carry besides: project, date, command line.
    bone_file : Path, optional
        Placed solid of a bone from a file.

    Returns
    -------
    dict
        ``files`` {role: file name}, ``volumes_mm3``, ``checks``, ``warnings``, ``sha256`` {role: ...},
        ``step_sha256`` of the assembly, ``pour``.
    """
    tell("step 1 of 5: building the solids")
    made = build(spec, bone_file)
    tell("step 2 of 5: meshes and STEP files")
    meshes = {name: mesh.tessellate(part.solid) for name, part in made.parts.items()}
    picture = _start_picture(made, meshes, folder)
    try:
        return _written(made, meshes, folder, papers, picture)
    finally:
        if picture.poll() is None:
            # A check failed or the user stopped: nobody waits for it any more.
            picture.kill()
            picture.wait()


def _written(
    made: Parts, meshes: dict[str, Any], folder: Path, papers: Papers, picture: subprocess.Popen[bytes]
) -> dict[str, Any]:
    spec = made.spec
    steps = {name: step_part(made, name) for name in made.parts}
    files = _write_steps(made, steps, folder)
    mesh_files = _write_meshes(made, meshes, folder)
    volumes = _volumes(made)
    plan = pour_plan(spec, volumes["pad_compensated"], volumes["mould"] + volumes.get("lid", 0.0))
    tell("step 3 of 5: checking the solids")
    tool = meshes["mould"] if made.whole is None else mesh.tessellate(made.mould)
    checks = check.check_solids(made, {**meshes, "mould": tool}) + check_shape.check_shape(made)
    fine = mesh.tessellate(made.core, *check_mesh.FINE)
    checks += check_mesh.check_mould_mesh(made, tool, fine)
    tell("step 4 of 5: reading the files again")
    checks += check_files.check_step(steps, {name: folder / files[name] for name in steps}, folder / files["assembly"])
    checks += check_files.check_step_text(folder / files["assembly"], folder / files["pad"], spec.hash)
    total = sum(part.volume_mm3 for part in made.parts.values())
    checks.append(check_second_reader(folder / files["assembly"], total, len(made.parts)))
    scales = {name: print_scale(made, name) for name in mesh_files}
    paths = {name: list(found.values()) for name, found in mesh_files.items()}
    checks += check_files.check_meshes(steps, genera(spec), paths, scales)
    tell("step 5 of 5: drawings, picture and pour sheet")
    warnings = pour_warnings(spec, plan)
    checks += check_process.check_process(spec, plan, warnings)
    for name, paths in mesh_files.items():
        files |= {f"{name}_{kind}": path.name for kind, path in paths.items()}
    files |= _write_views(made, meshes, folder)
    files |= _write_papers(made, plan, warnings, folder, papers)
    files |= finish_picture(picture, folder, spec, warnings)
    files |= _write_records(spec, [item.to_dict() for item in checks], folder)
    return {
        "files": files,
        "volumes_mm3": volumes,
        "checks": [item.to_dict() for item in checks],
        "warnings": warnings,
        "pour": plan.to_dict(),
        "batch": batches_of(spec, plan),
        "step_sha256": hashlib.sha256((folder / files["assembly"]).read_bytes()).hexdigest(),
    }


def step_part(made: Parts, name: str) -> StepPart:
    """One part with its material and colour, as a STEP file holds it."""
    spec, part, silicone = made.spec, made.parts[name], made.spec.silicone
    material = {
        "resin": Material(spec.pour.resin, f"ratio {spec.pour.ratio:g}", spec.pour.density_g_per_cm3),
        "resin_base": _base_material(spec),
        "silicone": silicone and Material(silicone.name, "mould silicone", silicone.density_g_per_cm3),
        "rigid": RIGID,
        "glass": GLASS,
    }[part.material]
    return StepPart(name, part.solid, material, COLOURS[part.material], part.offset_mm)


def _base_material(spec: MouldSpec) -> Material | None:
    if spec.base is None:
        return None
    pour = spec.base.pour
    return Material(f"{pour.resin} base", f"ratio {pour.ratio:.4g}", pour.density_g_per_cm3)


def _write_steps(made: Parts, steps: dict[str, StepPart], folder: Path) -> dict[str, str]:
    """One STEP file per part and one assembly; return role to file name."""
    spec, files = made.spec, {}
    for name, part in steps.items():
        files[name] = f"{name}_{spec.tag}.step"
        text = step_text([part], f"{name}_{spec.tag}", description(spec, name))
        (folder / files[name]).write_text(text, encoding="utf-8")
    files["assembly"] = f"assembly_{spec.tag}.step"
    text = step_text(list(steps.values()), f"assembly_{spec.tag}", description(spec, "assembly"))
    (folder / files["assembly"]).write_text(text, encoding="utf-8")
    return files


def description(spec: MouldSpec, name: str) -> str:
    """What a STEP file says of itself."""
    return f"{name} of the {spec.preset} mould for a {spec.pad.title}, specification {spec.hash}, lengths in mm"


def print_scale(made: Parts, name: str) -> float:
    """Size of a part's print files over the part: what is printed is enlarged by the shrinkage of the print."""
    return made.spec.machines.print_scale if made.parts[name].material == "rigid" else 1.0


def _write_meshes(made: Parts, meshes: dict[str, Any], folder: Path) -> dict[str, dict[str, Path]]:
    """STL and 3MF of what is printed or looked at in a slicer."""
    found: dict[str, dict[str, Path]] = {}
    for name, part in meshes.items():
        if (scale := print_scale(made, name)) != 1.0:
            part = part.copy()
            part.apply_scale(scale)
        stem = folder / f"{name}_{made.spec.tag}"
        found[name] = {"stl": stem.with_name(stem.name + ".stl")}
        mesh.write_stl(part, found[name]["stl"])
        if made.parts[name].material == "rigid":
            found[name]["3mf"] = stem.with_name(stem.name + ".3mf")
            mesh.write_3mf(part, found[name]["3mf"])
    return found


def _volumes(made: Parts) -> dict[str, float]:
    volumes = {"cavity": made.cavity.Volume(), "pad_nominal": made.pad_nominal.Volume()}
    volumes["pad_compensated"] = made.parts["pad"].volume_mm3
    return {**volumes, **{name: part.volume_mm3 for name, part in made.parts.items() if name != "pad"}}


def _start_picture(made: Parts, meshes: dict[str, Any], folder: Path) -> subprocess.Popen[bytes]:
    spec = made.spec
    title = f"{spec.preset} mould, {spec.pad.title}   #{spec.hash}"
    packed = folder / ".picture.npz"
    view.pack(*_shown(made, meshes), title, packed)
    picture = str(folder / f"mould_{spec.tag}.png")
    command = [sys.executable, "-m", "dummydesign.mold.files.picture", str(packed), picture]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _shown(made: Parts, meshes: dict[str, Any]) -> tuple[dict[str, Any], dict[str, tuple[float, float, float]]]:
    """Meshes as pictures show them and their colours: turned over where what matters is below, and named so."""
    pad = made.spec.pad
    upside = {"carrier": "carrier, bone up"} if pad.shape.bone_height_mm else {}
    upside |= {} if not pad.shape.relief_mm else {"pad": "pad, tested face up"}
    shown, colours = {}, {}
    for name, part in meshes.items():
        if name == "pad" and "layer_top" in meshes:
            # Its two layers stand for it.
            continue
        shown[upside.get(name, name)] = view.turned(part) if name in upside else part
        colours[upside.get(name, name)] = COLOURS[made.parts[name].material]
    return shown, colours


def finish_picture(
    process: subprocess.Popen[bytes], folder: Path, spec: MouldSpec, warnings: list[dict[str, str]]
) -> dict[str, str]:
    """Wait for the picture; without one the mould is as good, and a warning says so.

    Parameters
    ----------
    process : subprocess.Popen
        The renderer, started before the checks.
    folder : Path
        Where it writes.
    spec : MouldSpec
        The mould; its tag is part of the file name.
    warnings : list of dict
        A warning is appended when there is no picture.

    Returns
    -------
    dict
        ``{"picture": file name}``, empty without one.
    """
    try:
        process.wait(PICTURE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    (folder / ".picture.npz").unlink(missing_ok=True)
    picture = folder / f"mould_{spec.tag}.png"
    if picture.is_file():
        return {"picture": picture.name}
    message = "no picture: this machine cannot render (libegl1 or Mesa helps); the drawings and files are complete"
    warnings.append({"code": "no_picture", "message": message})
    return {}


def _write_views(made: Parts, meshes: dict[str, Any], folder: Path) -> dict[str, str]:
    """GLB of the assembly as in the STEP file, and a one-file HTML view with the stacked parts lifted apart."""
    colours = {name: COLOURS[part.material] for name, part in made.parts.items()}
    joined = {name: part.copy() for name, part in meshes.items()}
    for name, part in joined.items():
        part.apply_translation(made.parts[name].offset_mm)
    files = {"glb": f"assembly_{made.spec.tag}.glb", "view": f"assembly_{made.spec.tag}.html"}
    mesh.write_glb(mesh.coloured_scene(joined, colours, 1e-3), folder / files["glb"])
    shown, shown_colours = _shown(made, meshes)
    page = mould_view(shown, shown_colours, f"Mould {made.spec.tag}, specification {made.spec.hash}")
    (folder / files["view"]).write_text(page, encoding="utf-8")
    return files


def _write_papers(
    made: Parts, plan: PourPlan, warnings: list[dict[str, str]], folder: Path, papers: Papers
) -> dict[str, str]:
    """Drawings as DXF, SVG and, all in one, as PDF; the pour sheet as Markdown, HTML and PDF."""
    tag, files = made.spec.tag, {}
    views = part_views(made)
    drawn = {paper: sheets(made, views, papers, paper) for paper in ("A3", "A4")}
    for name, paper in drawn["A3"].items():
        for kind, text in (("svg", to_svg(paper)), ("dxf", to_dxf(paper))):
            files[f"drawing_{name}_{kind}"] = f"drawing_{name}_{tag}.{kind}"
            (folder / files[f"drawing_{name}_{kind}"]).write_text(text, encoding="utf-8")
    printed = {name: part.volume_mm3 for name, part in made.parts.items() if part.material == "rigid"}
    blocks = sheet.pour_sheet(made.spec, plan, warnings, printed)
    foot = Foot(made.spec.hash, papers.command, papers.date)
    for paper, end in (("A3", "_a3"), ("A4", "")):
        small, pages = paper.lower(), drawn[paper]
        files[f"drawings_{small}"], files[f"pour_sheet_{small}"] = f"drawings_{tag}_{small}.pdf", f"pour_{tag}{end}.pdf"
        bound = to_pdf(list(pages.values()), f"Drawings, specification {made.spec.hash}")
        (folder / files[f"drawings_{small}"]).write_bytes(bound)
        shown = [pages[name] for name in ("pad", "mould")]
        (folder / files[f"pour_sheet_{small}"]).write_bytes(sheet_pdf(blocks, foot, shown, paper))
    files["pour_sheet"], files["pour_sheet_html"] = f"pour_{tag}.md", f"pour_{tag}.html"
    (folder / files["pour_sheet"]).write_text(sheet.to_markdown(blocks), encoding="utf-8")
    page = sheet.to_html(blocks, to_svg(drawn["A3"]["mould"]))
    (folder / files["pour_sheet_html"]).write_text(page, encoding="utf-8")
    return files


def _write_records(spec: MouldSpec, checks: list[dict[str, Any]], folder: Path) -> dict[str, str]:
    """Specification and checks."""
    points = [point.to_dict() for point in gauge_points(spec)]
    write_json(folder / "spec.json", {"hash": spec.hash, "spec": spec.to_dict(), "gauge_points": points})
    write_json(folder / "checks.json", checks)
    return {"spec": "spec.json", "checks": "checks.json"}


def write_json(path: Path, content: Any) -> None:
    """Write plain data as JSON with sorted keys."""
    path.write_text(json.dumps(content, indent=1, sort_keys=True, allow_nan=False) + "\n", encoding="utf-8")

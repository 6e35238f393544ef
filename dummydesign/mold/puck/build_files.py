"""Make the files of puck rings in one folder and check them. CAD child only."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.progress import write_progress
from dummydesign.mold.build_files import write_json
from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.parts import Part, PartMaterial
from dummydesign.mold.cad.solids import single_solid
from dummydesign.mold.checks import Check, above, below, equal
from dummydesign.mold.checks import files as check_files
from dummydesign.mold.files.drawing_layout import Measure, Title, View, arrange
from dummydesign.mold.files.drawing_sheet import Drawing
from dummydesign.mold.files.meshes import tessellate, write_prints
from dummydesign.mold.files.part_drawings import cut, edges_from_above
from dummydesign.mold.files.pour_sheet import Foot, write_papers
from dummydesign.mold.files.step import write_steps
from dummydesign.mold.puck.plan import PuckPlan, puck_plan
from dummydesign.mold.puck.ring import (
    LUG_LONG_MM,
    LUG_THICK_MM,
    RIDGE_MM,
    WALL_MM,
    PuckSpec,
    Ring,
    cavity_mm3,
    groove_mm,
    ring_volume_mm3,
    spare_mm,
)
from dummydesign.mold.puck.sheet import puck_sheet

TURNED = "turned"
"""Mark of the second half of a ring, which is the first one turned: in the assembly only."""
EXACT_REL = 1e-9
OVERLAP_MM3 = 1e-6
GAP_MM = 30.0


def half_solid(spec: PuckSpec, ring: Ring) -> Any:
    """One half of a ring: an upright prism over z = 0, its joint face on y = 0, the ridge below it at x > 0."""
    inner, high = spec.scale * ring.diameter_mm / 2, spec.scale * ring.height_mm
    outer, lug = inner + WALL_MM, inner + WALL_MM + LUG_LONG_MM
    disc = cq.Workplane("XY").circle(outer).extrude(high).val()
    lugs = cq.Workplane("XY").rect(2 * lug, 2 * LUG_THICK_MM).extrude(high).val()
    upper = cq.Workplane("XY", origin=(0, lug, 0)).rect(4 * lug, 2 * lug).extrude(high).val()
    half = disc.fuse(lugs).cut(cq.Workplane("XY").circle(inner).extrude(high).val()).intersect(upper)
    middle, groove = outer + LUG_LONG_MM / 2, groove_mm(spec)
    ridge = _wedge(middle, -RIDGE_MM, RIDGE_MM, high)
    return single_solid(half.fuse(ridge).cut(_wedge(-middle, groove, groove, high)).clean())


def _wedge(x_mm: float, tip_mm: float, half_mm: float, high_mm: float) -> Any:
    """Upright prism over a triangle: its base on y = 0, its tip at ``tip_mm``."""
    corners = [(x_mm - half_mm, 0.0), (x_mm + half_mm, 0.0), (x_mm, tip_mm)]
    return cq.Workplane("XY").polyline(corners).close().extrude(high_mm).val()


def puck_solid(spec: PuckSpec, ring: Ring) -> Any:
    """What fills the closed ring up to its rim."""
    return cq.Solid.makeCylinder(spec.scale * ring.diameter_mm / 2, spec.scale * ring.height_mm)


def produce_pucks(spec: PuckSpec, folder: Path, foot: Foot) -> dict[str, Any]:
    """Build, write, read again and check; return what the parent turns into a result."""
    write_progress("step 1 of 3: building the rings")
    plan, parts = puck_plan(spec), _parts(spec)
    meshes = {name: tessellate(part.solid) for name, part in parts.items()}
    checks = [*_check_solids(spec, parts), *_check_prints(spec, parts, meshes), *_check_process(spec, plan)]
    write_progress("step 2 of 3: STEP files and meshes")
    shown = {name: part for name, part in parts.items() if TURNED not in name}
    files = {"assembly": f"assembly_puck_{spec.tag}.step", **{name: f"{name}.step" for name in shown}}
    write_steps(folder, parts, files, f"{spec.title}, specification {spec.hash}, mm")
    checks += check_files.check_step(shown, {name: folder / files[name] for name in shown}, folder / files["assembly"])
    prints = {name: folder / f"{name}.3mf" for name, part in shown.items() if part.is_printed}
    write_prints(meshes, prints, spec.machines.print_scale)
    files |= {f"{name}_3mf": path.name for name, path in prints.items()}
    write_progress("step 3 of 3: drawing and pour sheet")
    files |= _write_papers(spec, plan, parts, folder, foot)
    listed = [check.to_dict() for check in checks]
    for role, content in (("spec", {"hash": spec.hash, "puck": spec.to_dict()}), ("checks", listed)):
        files[role] = f"{role}.json"
        write_json(folder / files[role], content)
    volumes: dict[str, float] = {}
    for ring in spec.rings:
        volumes |= {
            f"cavity_{ring.tag}": parts[f"puck_{ring.tag}"].volume_mm3,
            f"puck_{ring.tag}": ring.volume_mm3,
            f"ring_{ring.tag}": 2 * parts[f"ring_half_{ring.tag}"].volume_mm3,
        }
    return {
        "files": files,
        "volumes_mm3": volumes,
        "checks": listed,
        "step_sha256": hashlib.sha256((folder / files["assembly"]).read_bytes()).hexdigest(),
    }


def _parts(spec: PuckSpec) -> dict[str, Part]:
    """Half and puck of each size side by side; the second half is the first turned by half a turn."""
    plastic = PartMaterial(
        "rigid",
        "printed rigid polymer",
        f"{spec.plastic.name.upper()}, density as printed solid",
        spec.plastic.density_g_per_cm3,
    )
    resin = PartMaterial("resin", spec.pour.resin, f"ratio {spec.pour.ratio:g}", spec.pour.density_g_per_cm3)
    parts: dict[str, Part] = {}
    x = 0.0
    for ring in spec.rings:
        wide = 2 * (spec.scale * ring.diameter_mm / 2 + WALL_MM + LUG_LONG_MM)
        offset = (x + wide / 2, 0.0, 0.0)
        half = half_solid(spec, ring)
        for name, solid, material in (
            ("ring_half", half, plastic),
            (f"ring_half_{TURNED}", half.rotate(cq.Vector(), cq.Vector(0, 0, 1), 180), plastic),
            ("puck", puck_solid(spec, ring), resin),
        ):
            parts[f"{name}_{ring.tag}"] = Part(f"{name}_{ring.tag}", solid, material, offset)
        x += wide + GAP_MM
    return parts


def _check_solids(spec: PuckSpec, parts: Mapping[str, Part]) -> list[Check]:
    """Volumes in closed form, single valid solids, halves and puck that do not overlap and leave no opening."""
    off = met = open_mm3 = 0.0
    for ring in spec.rings:
        half, other, puck = (parts[f"{name}_{ring.tag}"] for name in ("ring_half", "ring_half_turned", "puck"))
        off = max(
            off,
            abs(2 * half.volume_mm3 / ring_volume_mm3(spec, ring) - 1),
            abs(puck.volume_mm3 / cavity_mm3(spec, ring) - 1),
        )
        for one, two in ((half, other), (half, puck), (other, puck)):
            met = max(met, one.solid.intersect(two.solid).Volume())
        # a thin shell outside the puck must be plastic all round
        outer = spec.scale * ring.diameter_mm / 2 + WALL_MM / 2
        shell = cq.Solid.makeCylinder(outer, spec.scale * ring.height_mm).cut(puck.solid)
        open_mm3 = max(open_mm3, shell.cut(half.solid, other.solid).Volume())
    good = sum(len(part.solid.Solids()) == 1 and part.solid.isValid() for part in parts.values())
    return [
        below("closed_form", off, EXACT_REL, "largest relative difference of a volume from its closed form"),
        equal("valid_solids", good, len(parts)),
        below("parts_overlap", met, OVERLAP_MM3, "mm3"),
        below("ring_closed", open_mm3, OVERLAP_MM3, "mm3 of the wall's inner half that is open"),
    ]


def _check_prints(spec: PuckSpec, parts: Mapping[str, Part], meshes: Mapping[str, Any]) -> list[Check]:
    """No overhang, watertight meshes that hold their solid's volume, room on the printer."""
    hanging = worst = 0.0
    tight = 0
    for name, mesh in meshes.items():
        normals, low = np.asarray(mesh.face_normals), float(mesh.vertices[:, 2].min())
        above_bed = np.asarray(mesh.triangles)[:, :, 2].min(axis=1) > low + 1e-6
        hanging = max(hanging, float(np.max(-normals[:, 2] * above_bed, initial=0.0)))
        worst = max(worst, abs(mesh.volume / parts[name].volume_mm3 - 1))
        tight += bool(mesh.is_watertight and mesh.is_volume and mesh.euler_number == 2)
    spare = min(spare_mm(spec, ring) for ring in spec.rings)
    return [
        below("overhang", hanging, 1e-6, "sine of the steepest face that looks down off the bed"),
        equal("mesh_watertight", tight, len(meshes)),
        below("mesh_volume", worst, check_files.MESH_VOLUME_REL),
        above("fits_printer", spare, 0.0, "mm to spare beside a half on the bed, margin kept"),
    ]


def _check_process(spec: PuckSpec, plan: PuckPlan) -> list[Check]:
    pour, resolution = spec.pour, spec.machines.balance_resolution_g
    poured = sum(ring.count * mass for ring, mass in zip(spec.rings, plan.pour_g))
    lightest = min(mass for _, mass in plan.mix.components)
    return [
        above("batch_covers_rings", plan.mix.total_g - pour.film_loss_g, poured, "g after film loss"),
        below("weighing_error", plan.mix.error_percent, 100 * resolution / lightest, "%, what one balance step allows"),
        above(
            "plastic_bears_oven",
            spec.plastic.service_temperature_C - pour.cure_temperature_C,
            0.0,
            f"K to spare for {spec.plastic.name} in the oven",
        ),
        above("pot_life", pour.pot_life_min, pour.pour_and_degas_min, "min against degassing, pouring, striking off"),
    ]


def _drawing(spec: PuckSpec, ring: Ring, part: Part, date: str, number: str, paper: str) -> Drawing:
    """A half from above and the section of the closed ring."""
    solid = part.solid
    inner = spec.scale * ring.diameter_mm / 2
    outer, lug = inner + WALL_MM, inner + WALL_MM + LUG_LONG_MM
    top = View(
        "view from above",
        tuple(edges_from_above(solid)),
        (
            Measure((-lug, 0.0), (lug, 0.0), "below"),
            Measure((-inner, 0.0), (inner, 0.0), "below"),
            Measure((lug, 0.0), (lug, LUG_THICK_MM), "right"),
            Measure((0.0, 0.0), (0.0, outer), "left"),
        ),
    )
    loops = cut(solid.translate((0.0, -outer / 2, 0.0))).loops
    low = spec.scale * ring.height_mm
    side = View(
        "section through the walls",
        tuple((loop, "cut") for loop in loops),
        (Measure((-outer, 0.0), (-outer, low), "left"),),
        (),
        True,
    )
    title = Title(
        f"{spec.title}, printed ring",
        f"half of the ring {ring.tag}",
        spec.plastic.name.upper(),
        "ISO 2768-m",
        spec.hash,
        date or "-",
        number,
    )
    notes = [
        f"For a puck {ring.diameter_mm:g} x {ring.height_mm:g} mm after cure; ring x {spec.scale:.5f}.",
        f"Print {2 * ring.count} halves. Wall {WALL_MM:g}, ridge {RIDGE_MM:g}, groove {groove_mm(spec):g} deep, "
        "sides at 45 deg. No draft: the halves are taken apart.",
    ]
    return arrange([side, top], title, notes, paper)


def _write_papers(
    spec: PuckSpec, plan: PuckPlan, parts: Mapping[str, Part], folder: Path, foot: Foot
) -> dict[str, str]:
    """Drawings, and the pour sheet with its protocol; return role to file name."""
    count = len(spec.rings)
    drawn = [
        _drawing(spec, ring, parts[f"ring_half_{ring.tag}"], foot.date, f"{number} of {count}", foot.paper)
        for number, ring in enumerate(spec.rings, 1)
    ]
    return write_papers(folder, f"puck_{spec.tag}", puck_sheet(spec, plan), foot, drawn, drawn)

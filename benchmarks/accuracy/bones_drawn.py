"""Bones from files, drawn: made into a mould, or refused for the true reason.

``python -m benchmarks.accuracy.bones_drawn [--first 0] [--bones 60] [--moulds 1] [--seed N] [--out FILE.jsonl]`` draws
bones in sizes of the hand: closed forms (capsule, ellipsoid, piece of a torus), bodies of revolution, splines along a
curve, lofts, noisy scans, and files with faults (degenerate triangles, mixed winding, duplicates, holes, crossings,
several bodies, surfaces without a solid, metres, inches). Each is read, placed and measured; of every so many
(``--moulds``) the whole mould is made with all its checks. A line of the result says what was expected and what came of
it; volumes are compared with closed forms of this file's own.

A bone in metres or inches is asked about first and then given again with the factor of the question.
"""

from __future__ import annotations

import argparse
import math
import re
import resource
import tempfile
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.random import Generator

import dummydesign
from benchmarks.rows import keep_row
from dummydesign.core.errors import DummydesignError
from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.client import insert_bone
from dummydesign.mold.model.spec import Placing

MADE = ""


@dataclass(frozen=True)
class Bone:
    """A drawn file: what it is, how deep it hangs, why it must be refused, and the volume that hangs in the gel."""

    kind: str
    file: str
    height_mm: float
    refusal: str = MADE
    volume_mm3: float | None = None
    volume_within: float = 1e-3
    scale: float = 1.0


def capsule(rng: Generator) -> tuple[Any, float, float]:
    """Solid along x, its radius, and the closed volume of its lower part for a height."""
    r, long = rng.uniform(4.0, 8.0), rng.uniform(10.0, 35.0)
    ends = [
        cq.Solid.makeSphere(r, cq.Vector(), cq.Vector(0, 0, 1), -90, 90, 360).translate(cq.Vector(x, 0, 0))
        for x in (-long / 2, long / 2)
    ]
    middle = cq.Solid.makeCylinder(r, long, cq.Vector(-long / 2, 0, 0), cq.Vector(1, 0, 0))
    return middle.fuse(*ends).clean().Solids()[0], r, long


def capsule_mm3(r: float, long: float, h: float) -> float:
    """Volume of a lying capsule below the height h over its lowest line."""
    segment = r * r * math.acos(1 - h / r) - (r - h) * math.sqrt(2 * r * h - h * h)
    return segment * long + cap_mm3(r, r, r, h)


def cap_mm3(a: float, b: float, c: float, h: float) -> float:
    """Volume of an ellipsoid's cap of height h along c."""
    return math.pi * h * h * (3 * c - h) / 3 * a * b / (c * c)


def ellipsoid(rng: Generator) -> tuple[Any, tuple[float, float, float]]:
    """Solid of splines and its half axes along x, y, z."""
    axes = rng.uniform(10, 20), rng.uniform(5, 9), rng.uniform(5, 9)
    matrix = cq.Matrix([[axes[0], 0, 0, 0], [0, axes[1], 0, 0], [0, 0, axes[2], 0]])
    ball = cq.Solid.makeSphere(1.0, cq.Vector(), cq.Vector(0, 0, 1), -90, 90, 360)
    return ball.transformGeometry(matrix), axes


def torus_piece(rng: Generator) -> Any:
    """A bent cylinder that lies flat, 40 to 100 degrees of a torus."""
    r, bend = rng.uniform(4, 7), rng.uniform(18, 30)
    plane = cq.Workplane("XZ", origin=(bend, 0, 0)).circle(r)
    return plane.revolve(rng.uniform(40, 100), (-bend, 0, 0), (-bend, 1, 0)).val()


def revolution(rng: Generator) -> Any:
    """A shaft with two thicker ends, its outline a spline, along x."""
    long, r = rng.uniform(25, 45), rng.uniform(4, 6)
    outline = [(x * long, r * k) for x, k in ((0.08, 0.9), (0.25, 0.85), (0.5, 0.7), (0.75, 0.8), (0.92, 0.95))]
    wire = cq.Workplane("XZ").moveTo(0, 0).lineTo(0, 0.6 * r).spline(outline, includeCurrent=True)
    return wire.lineTo(long, 0.6 * r).lineTo(long, 0).close().revolve(360, (0, 0, 0), (1, 0, 0)).val()


def loft(rng: Generator) -> Any:
    """Ellipses of drawn half axes along x, joined by a smooth surface."""
    sketch = cq.Workplane("YZ")
    for step in range(4):
        if step:
            sketch = sketch.workplane(offset=rng.uniform(7, 12))
        sketch = sketch.ellipse(rng.uniform(4, 7), rng.uniform(4, 7))
    return sketch.loft(combine=True).val()


def swept(rng: Generator) -> Any:
    """A circle along a spline in the plane."""
    way = [(0, 0), (12, rng.uniform(-3, 3)), (24, rng.uniform(-3, 3)), (36, 0)]
    path = cq.Workplane("XY").spline(way)
    return cq.Workplane("YZ").circle(rng.uniform(4, 6)).sweep(path).val()


def mesh_of(solid: Any, near_mm: float) -> Any:
    """Triangles of a solid, corners joined."""
    points, faces = solid.copy().tessellate(near_mm, 0.15)
    mesh = trimesh.Trimesh([point.toTuple() for point in points], faces, process=False)
    mesh.merge_vertices(digits_vertex=6)
    mesh.update_faces(mesh.nondegenerate_faces())
    return mesh


def soup(mesh: Any, folder: Path, name: str) -> str:
    """Write a mesh as binary STL, triangle by triangle."""
    (folder / name).write_bytes(mesh.export(file_type="stl"))
    return str(folder / name)


def step(shape: Any, folder: Path, name: str, unit: str = "MM") -> str:
    """Write a STEP file in a unit."""
    occ.Interface_Static.SetCVal_s("write.step.unit", unit)
    writer = occ.STEPControl_Writer()
    occ.Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape.wrapped, occ.STEPControl_AsIs)
    writer.Write(str(folder / name))
    return str(folder / name)


def scan(rng: Generator, noise_mm: float) -> tuple[Any, tuple[float, float, float]]:
    """An ellipsoid of 20,000 or 82,000 triangles whose corners are off along their normal."""
    axes = rng.uniform(12, 20), rng.uniform(5, 8), rng.uniform(5, 8)
    mesh = trimesh.creation.icosphere(subdivisions=int(rng.integers(5, 7)))
    mesh.apply_scale(axes)
    mesh.vertices = mesh.vertices + noise_mm * rng.normal(size=(len(mesh.vertices), 1)) * mesh.vertex_normals
    return mesh, axes


def closed_steps(rng: Generator, folder: Path, number: int) -> Bone:
    """A STEP file of a solid; of five in turn, the first three with a closed form."""
    kind = ("capsule", "ellipsoid", "revolution", "torus", "loft", "swept")[number % 6]
    share, name = rng.uniform(0.3, 0.8), f"{kind}{number}.step"
    if kind == "capsule":
        solid, r, long = capsule(rng)
        h = round(share * r, 2)
        return Bone("capsule, STEP", step(solid, folder, name), h, MADE, capsule_mm3(r, long, h))
    if kind == "ellipsoid":
        solid, axes = ellipsoid(rng)
        h = round(share * axes[2], 2)
        return Bone("ellipsoid, STEP", step(solid, folder, name), h, MADE, cap_mm3(*axes, h))
    solid = {"torus": torus_piece, "revolution": revolution, "loft": loft, "swept": swept}[kind](rng)
    unit = ("MM", "INCH", "M")[number % 3] if number >= 18 else "MM"
    named = f", file in {unit}" if unit != "MM" else ""
    return Bone(f"{kind}, STEP{named}", step(solid, folder, name, unit), round(share * 4.0, 2))


def meshes(rng: Generator, folder: Path, number: int) -> Bone:
    """A clean STL of a drawn solid, the volume of the capsule's known."""
    solid, r, long = capsule(rng)
    h = round(rng.uniform(0.3, 0.8) * r, 2)
    mesh = mesh_of(solid, rng.choice([0.005, 0.02, 0.05]))
    file = soup(mesh, folder, f"clean{number}.stl")
    return Bone(f"capsule, STL of {len(mesh.faces)}", file, h, MADE, capsule_mm3(r, long, h), 0.03)


def scans(rng: Generator, folder: Path, number: int) -> Bone:
    """A scan with noise; where triangles are few for the noise, the error over 5 mm of gel decides."""
    noise = (0.01, 0.02, 0.04, 0.06, 0.03, 0.05, 0.25, 0.4)[number % 8]
    mesh, axes = scan(rng, noise)
    h = round(rng.uniform(0.3, 0.8) * axes[2], 2)
    file = soup(mesh, folder, f"scan{number}.stl")
    words = f"scan of {len(mesh.faces)}, noise {noise:g} mm"
    if noise > 0.1:
        return Bone(words, file, h, "of force over|crosses itself")
    return Bone(words, file, h, MADE, cap_mm3(*axes, h - 2.0 * noise), 0.06)


def damaged(rng: Generator, folder: Path, number: int) -> Bone:
    """A mesh with a fault that has one remedy: it is made as if it were whole."""
    solid, r, long = capsule(rng)
    h = round(rng.uniform(0.3, 0.8) * r, 2)
    mesh = mesh_of(solid, 0.05)
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces).copy()
    kind = ("degenerate", "flat", "mixed winding", "inside out", "duplicates", "degenerate and mixed")[number % 6]
    if "degenerate" in kind:
        some = rng.integers(0, len(points), 6)
        faces = np.vstack([faces, np.column_stack([some, some, rng.integers(0, len(points), 6)])])
    if kind == "flat":
        points, faces = with_flat(points, faces, rng.choice(len(faces), 5, replace=False))
    if "mixed" in kind:
        turn = rng.random(len(faces)) < rng.uniform(0.1, 0.9)
        faces[turn] = faces[turn][:, ::-1]
    if kind == "inside out":
        faces = faces[:, ::-1]
    if kind == "duplicates":
        faces = np.vstack([faces, faces[rng.integers(0, len(faces), 7)]])
    raw = trimesh.Trimesh(points, faces, process=False)
    return Bone(f"{kind}, STL", soup(raw, folder, f"damaged{number}.stl"), h, MADE, capsule_mm3(r, long, h), 0.03)


def with_flat(points: Any, faces: Any, chosen: Any) -> tuple[Any, Any]:
    """Split one side of some triangles, and close the slit with a triangle whose corners lie on one line."""
    points, faces = list(points), list(map(list, faces))
    for one in chosen:
        a, b, c = faces[one]
        points.append((np.asarray(points[a]) + np.asarray(points[b])) / 2)
        m = len(points) - 1
        faces[one] = [a, m, c]
        faces += [[m, b, c], [a, b, m]]
    return np.array(points), np.array(faces)


def broken(rng: Generator, folder: Path, number: int) -> Bone:
    """A mesh with a fault that has no one remedy: it is refused by its name."""
    solid, r, _ = capsule(rng)
    mesh = mesh_of(solid, 0.05)
    points, faces = np.asarray(mesh.vertices).copy(), np.asarray(mesh.faces).copy()
    kind, reason = (
        ("holes", "not closed"),
        ("crossing", "crosses itself"),
        ("two bodies", "2 bodies"),
        ("crossing bodies", "bodies|crosses itself"),
        ("fin", "more than two triangles"),
        ("crossing", "crosses itself"),
    )[number % 6]
    if kind == "holes":
        faces = faces[np.linalg.norm(points[faces].mean(axis=1) - points[rng.integers(len(points))], axis=1) > 1.5]
    if kind == "crossing":
        # A dent that is pushed out through the other side.
        top = points[:, 2] > 0.8 * points[:, 2].max()
        points[top, 2] -= rng.uniform(2.2, 2.6) * r
    if kind in ("two bodies", "crossing bodies"):
        other = points + (0.0, (2.5 if kind == "two bodies" else 0.5) * r, 0.0)
        points, faces = np.vstack([points, other]), np.vstack([faces, faces + len(points)])
    if kind == "fin":
        points = np.vstack([points, points[faces[0, 0]] + (0, 0, 3.0)])
        faces = np.vstack([faces, [faces[0, 0], faces[0, 1], len(points) - 1]])
        reason = "more than two triangles|not closed"
    raw = trimesh.Trimesh(points, faces, process=False)
    return Bone(f"{kind}, STL", soup(raw, folder, f"broken{number}.stl"), round(0.5 * r, 2), reason)


def broken_steps(rng: Generator, folder: Path, number: int) -> Bone:
    """STEP files without one sound solid."""
    kind = ("surfaces", "two solids", "crossing", "no STEP")[number % 4]
    solid, r, _ = capsule(rng)
    name = f"faces{number}.step"
    if kind == "surfaces":
        return Bone("surfaces, STEP", step(cq.Compound.makeCompound(solid.Faces()), folder, name), 2.0, "no solid")
    if kind == "two solids":
        two = cq.Compound.makeCompound([solid, solid.translate(cq.Vector(0, 3 * r, 0))])
        return Bone("two solids, STEP", step(two, folder, name), 2.0, "2 solids")
    if kind == "no STEP":
        (folder / name).write_text("solid but no STEP\n")
        return Bone("text, STEP", str(folder / name), 2.0, "not a STEP file")
    corners = np.array([(0, 0), (30, 0), (30, 10), (0, 10)]) + (0, -5)
    points, faces = crossed_prism(corners, 12.0)
    shell = sewn_shell(points, faces)
    return Bone("crossing, STEP", step(shell, folder, name), 2.0, "crosses itself|valid solid")


def crossed_prism(corners: Any, high: float) -> tuple[Any, Any]:
    """A box whose upper face is pushed down through the lower one at one corner."""
    low = np.column_stack([corners, np.zeros(4)])
    top = np.column_stack([corners, np.full(4, high)])
    top[0, 2] = -high
    quads = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    faces = [(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads]
    return np.vstack([low, top]), np.array(faces)


def sewn_shell(points: Any, faces: Any) -> Any:
    """A solid of triangles, sound or not."""
    from dummydesign.mold.cad.bone_mesh import sewn

    return sewn(points, faces, "crossing")


def other_units(rng: Generator, folder: Path, number: int) -> Bone:
    """An STL in metres or inches: asked about, and made with the factor of the question."""
    solid, r, long = capsule(rng)
    h = round(rng.uniform(0.3, 0.8) * r, 2)
    mesh = mesh_of(solid, 0.05)
    factor, unit = ((1000.0, "metres"), (25.4, "inches"))[number % 2]
    mesh.vertices = np.asarray(mesh.vertices) / factor
    file = soup(mesh, folder, f"units{number}.stl")
    return Bone(f"{unit}, STL", file, h, rf"{unit} with --bone-scale {factor:g} ", capsule_mm3(r, long, h), 0.03)


GROUPS: tuple[tuple[Callable[[Generator, Path, int], Bone], int], ...] = (
    (closed_steps, 24), (meshes, 4), (scans, 8), (damaged, 8), (broken, 8), (broken_steps, 4), (other_units, 4),
)  # fmt: skip


def drawn(number: int, seed: int, folder: Path) -> Bone:
    """The bone of a number; each group in turn draws its share of sixty."""
    rng, place = np.random.default_rng((seed, number)), number % 60
    for make, count in GROUPS:
        if place < count:
            return make(rng, folder, place + count * (number // 60))
        place -= count
    raise IndexError(number)


def tried(bone: Bone, rng: Generator, folder: Path, scale: float, whole: bool) -> dict[str, Any]:
    """Outcome of one call: made (or placed) with its volume, or refused with code and message."""
    cover = round(float(rng.uniform(3.0, 8.0)), 1)
    turn = (0.0, 0.0, round(float(rng.uniform(-20, 20)), 1))
    preset, before = str(rng.choice(["open", "printed"])), processor_s()
    try:
        if whole:
            answer = _whole(bone, cover, turn, preset, scale, folder)
        else:
            answer = _placed(bone, cover, turn, scale, folder)
    except DummydesignError as problem:
        answer = {"outcome": "refused", "code": problem.code, "message": str(problem)}
    return {**answer, "cover_mm": cover, "seconds": round(processor_s() - before, 1)}


Turn = tuple[float, float, float]


def _placed(bone: Bone, cover_mm: float, turn: Turn, scale: float, folder: Path) -> dict[str, Any]:
    placing = Placing(bone.height_mm, scale, turn)
    folder.mkdir(exist_ok=True)
    insert, _ = insert_bone(Path(bone.file), placing, bone.height_mm + cover_mm, 110.0, 80.0, folder / "bone.brep")
    return {"outcome": "placed", **{name: getattr(insert, name) for name in FACTS}}


def _whole(bone: Bone, cover_mm: float, turn: Turn, preset: str, scale: float, folder: Path) -> dict[str, Any]:
    made = dummydesign.make_mould(
        bone.height_mm + cover_mm,
        length_mm=110,
        width_mm=80,
        bone=bone.file,
        bone_height_mm=bone.height_mm,
        bone_scale=scale,
        bone_turn_deg=turn,
        preset=preset,
        out=folder,
        replace=True,
    ).to_dict()
    checks = {one["id"]: one for one in made["checks"]}
    insert = made["spec"]["insert"]
    return {
        "outcome": "made",
        **{name: insert.get(name) for name in FACTS},
        "preset": preset,
        **{name: checks[name]["value"] for name in CHECKS},
        "limit": checks["bone_kernel"]["limit"],
    }


FACTS = ("volume_mm3", "off_file_mm", "off_file_rms_mm", "mended")
CHECKS = ("closed_form", "bone_volume", "gel_and_bone", "bone_kernel")


def processor_s() -> float:
    """Processor time of this process and of those that it waited for. [s]"""
    return sum(
        use.ru_utime + use.ru_stime for use in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    )


def judged(bone: Bone, number: int, seed: int, work: Path, whole: bool) -> dict[str, Any]:
    """One line of the result: as expected or not, and why."""
    rng = np.random.default_rng((seed, number, 1))
    row = {"number": number, "kind": bone.kind, "height_mm": bone.height_mm, "expected": bone.refusal or "made"}
    answer = tried(bone, rng, work / "out", bone.scale, whole)
    if bone.refusal:
        row["as_expected"] = answer["outcome"] == "refused" and bool(re.search(bone.refusal, answer["message"]))
        factor = re.search(r"--bone-scale (\S+) ", answer.get("message", ""))
        if bone.volume_mm3 is not None and factor:
            row["question"] = answer["message"]
            answer = tried(bone, rng, work / "out", float(factor[1]), whole)
            row["as_expected"] = row["as_expected"] and answer["outcome"] != "refused"
    else:
        row["as_expected"] = answer["outcome"] != "refused"
    if bone.volume_mm3 is not None and answer["outcome"] != "refused":
        off = answer["volume_mm3"] / bone.volume_mm3 - 1
        row["volume_off"] = off
        row["as_expected"] = row["as_expected"] and abs(off) < bone.volume_within
    return {**row, **{key: hidden(value, work) for key, value in answer.items()}}


def hidden(value: Any, work: Path) -> Any:
    """A value without the folder it was made in."""
    return value.replace(f"{work}/", "") if isinstance(value, str) else value


def main() -> None:
    """Draw, make, write one line a bone and print the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--bones", type=int, default=60)
    parser.add_argument("--moulds", type=int, default=1, metavar="N", help="make the whole mould of every Nth")
    parser.add_argument("--seed", type=int, default=20261126)
    parser.add_argument("--out", type=Path, default=Path("bones_drawn.jsonl"))
    options = parser.parse_args()
    rows = []
    for number in range(options.first, options.first + options.bones):
        with tempfile.TemporaryDirectory() as folder:
            work = Path(folder)
            whole = number % options.moulds == 0
            rows.append(judged(drawn(number, options.seed, work), number, options.seed, work, whole))
        keep_row(options.out, rows[-1])
        mark = "" if rows[-1]["as_expected"] else "NOT AS EXPECTED"
        print(number, rows[-1]["kind"], rows[-1]["outcome"], mark, flush=True)
    outcomes = Counter(row["outcome"] for row in rows)
    print(
        f"{sum(row['as_expected'] for row in rows)} of {len(rows)} as expected; {dict(outcomes)}; "
        f"{sum(row['seconds'] for row in rows):.0f} s of processor time"
    )


if __name__ == "__main__":
    main()

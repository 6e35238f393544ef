"""The pad model against FElupe, another finite-element code, run as a separate program on the same meshes.

    python -m benchmarks.accuracy.pad_felupe [--python PATH] [--repeat N]

FElupe (GPL) is a tool of development: it is run in a process of its own and never imported by the package. PATH
is the Python that has it (default: this one); without it the comparison is skipped with a message.

Three comparisons, mu = 1, incompressible (bulk modulus 5000 mu there), nothing sliding, no contact in FElupe:

- one mesh, for the time: slabs of 5, 10 and 20 mm on a glued base under a sharp, glued punch of 7.9 mm, 12 depths to
  d/h 0.3 (20 mm: to 0.2, where its edge folds), biquadratic quadrilaterals with a corner cell of 0.1. FElupe has its
  mixed three-field solid with disconnected bilinear pressure and volume, this package linear pressure: at the
  singular edge they differ by what this corner cell is off, so the difference is printed, not judged;
- the sharp edge, for the force: FElupe with corner cells of 0.05 and 0.025, carried on linearly to 0, against the
  sharp-edge limit that this package reports (beads, contact, another mesh), at d/h 0.025 to 0.1;
- a bonded puck, radius = height, compressed by up to 20 %. There FElupe has linear quadrilaterals, each side halved
  twice.

FElupe has no cut-back: it gets the fewest equal steps with which it arrives. Both converge to residuals of 1e-7
(FElupe) and 1e-6 (here) of the forces. Times are the fastest of N runs (default 2) in processor seconds, which other
work on the machine hardly changes; imports are left out, the making of the mesh is in.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from typing import Any

import numpy as np

from dummydesign.core.blas_threads import ONE_THREAD
from dummydesign.pad.pad_under_punch import Pad

RADIUS_MM = 7.9
SLABS = {5.0: 0.3, 10.0: 0.3, 20.0: 0.2}
POINTS = 12
EXTENT_MM = 75.7
CORNER, FINE_CORNERS = 0.1, (0.05, 0.025)
LIMIT_DEPTH = (0.025, 0.05, 0.075, 0.1)
GROWTH = 1.3
COMPRESSION = (0.05, 0.1, 0.15, 0.2)
PUCK_CORNER = 0.02
PUCK_STEP = 0.005
# What the model is to have against independent codes: 1 %. A first bound of 0.5 % on the limit was met at 11 of 12.
TOLERANCE = {"puck": 0.01, "limit": 0.01}

PROGRAM = """
import json, sys, time
try:
    import felupe as fem
except ImportError:
    print(json.dumps({"skipped": "FElupe is not installed in " + sys.executable})); raise SystemExit
import numpy as np

task = json.load(sys.stdin)
r, z = np.array(task["r"]), np.array(task["z"])
halve = lambda x: np.unique(np.concatenate([x, 0.5 * (x[1:] + x[:-1])]))
for _ in range(task["halvings"]):
    r, z = halve(r), halve(z)

def solve(way):
    began = time.process_time()
    x, y = np.meshgrid(z, r, indexing="ij")  # FElupe: axis of rotation first
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    n = np.arange(len(points)).reshape(len(z), len(r))
    cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    mesh, make = fem.Mesh(points, cells, "quad"), fem.RegionQuad
    if task["quadratic"]:
        mesh, make = mesh.add_midpoints_edges().add_midpoints_faces(), fem.RegionBiQuadraticQuad
    field = fem.FieldsMixed(make(mesh), n=3, axisymmetric=True)
    solid = fem.SolidBody(fem.ThreeFieldVariation(fem.NeoHooke(mu=1.0, bulk=5000.0)), field)
    top = (mesh.points[:, 0] > z.max() - 1e-9) & (mesh.points[:, 1] < task["reach"] + 1e-9)
    low = mesh.points[:, 0] < z.min() + 1e-9
    bounds = {
        "axis": fem.Boundary(field[0], fy=0.0, skip=(1, 0)),
        "low": fem.Boundary(field[0], mask=low, skip=(0, 1)),
        "hold": fem.Boundary(field[0], mask=top, skip=(1, 0)),
        "move": fem.Boundary(field[0], mask=top, skip=(0, 1)),
    }
    if task["glued"]:
        bounds["base"] = fem.Boundary(field[0], mask=low, skip=(1, 0))
    found, count = [], [0]
    step = fem.Step([solid], ramp={bounds["move"]: -way}, boundaries=bounds)
    def keep(i, j, substep):
        if np.isclose(way[j], task["depth"], rtol=1e-6, atol=0.0).any():
            found.append(abs(float(fem.tools.force(field, substep.fun, bounds["low"])[0])))
    fem.Job([step], callback=keep).evaluate(verbose=False, tol=1e-7)
    return {"force": found, "seconds": time.process_time() - began, "steps": len(way), "version": fem.__version__,
            "unknowns": int(sum(f.values.size for f in field))}

depth = np.array(task["depth"])
for parts in task["parts"]:
    starts = np.concatenate([[0.0], depth[:-1]])
    way = np.concatenate([a + (b - a) * np.arange(1, parts + 1) / parts for a, b in zip(starts, depth)])
    try:
        with np.errstate(all="ignore"):
            best = solve(way)
            for _ in range(task["repeat"] - 1):
                again = solve(way)
                best["seconds"] = min(best["seconds"], again["seconds"])
        if np.isfinite(best["force"]).all():
            break
    except Exception as problem:
        best = {"failed": f"{parts} steps a depth: {type(problem).__name__}: {str(problem)[:100]}"}
print(json.dumps(best))
"""


def ours_slab(ratio: float, extent: float, depth: np.ndarray, corner: float = CORNER) -> dict[str, Any]:
    """Forces, seconds and mesh lines of a slab under a sharp, glued punch, in thicknesses."""
    from dummydesign.pad.fem import mesh_axisymmetric as meshes
    from dummydesign.pad.fem.mixed_solid import Solid
    from dummydesign.pad.material.hyperelastic import Yeoh
    from dummydesign.pad.solve.continuation import follow
    from dummydesign.pad.solve.equilibrium import ContactProblem

    began = time.process_time()
    scale = min(ratio, 1.0)
    cell = corner * scale
    r = np.concatenate([meshes.graded(ratio, 0.0, cell, GROWTH)[::-1], meshes.graded(ratio, extent, cell, GROWTH)[1:]])
    z = meshes.graded(0.0, -1.0, cell, GROWTH)
    number = np.arange(len(r) * len(z)).reshape(len(r), len(z))
    points = np.array([(x, y) for x in r for y in z]).T
    quads = np.stack([number[:-1, 1:], number[1:, 1:], number[1:, :-1], number[:-1, :-1]]).reshape(4, -1)
    mesh = meshes.discretise(points, quads)
    under = np.nonzero(meshes.on_top(mesh) & (mesh.nodes[0] <= ratio + 1e-9))[0]
    base = np.nonzero(meshes.on_base(mesh, 1.0))[0]
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    held[np.concatenate([2 * under, 2 * base, 2 * base + 1])] = True
    problem = ContactProblem(Solid(mesh, Yeoh(1.0)), held, 2 * under + 1, 2 * base + 1)
    path = follow(problem, depth, cell, 0.05 * scale, 1e-3 * scale)
    return {
        "force": path.force.tolist(),
        "seconds": time.process_time() - began,
        "unknowns": path.unknowns,
        "r": r.tolist(),
        "z": np.sort(z).tolist(),
        "steps": path.load_steps,
    }


def ours_puck() -> dict[str, Any]:
    """Forces, seconds and the mesh lines of the bonded puck."""
    from dummydesign.pad.axisymmetric.puck import UnitPuck, puck_problem
    from dummydesign.pad.material.hyperelastic import Yeoh
    from dummydesign.pad.solve.continuation import follow
    from dummydesign.pad.solve.equilibrium import ContactProblem

    began = time.process_time()
    full = puck_problem(UnitPuck(1.0, "bonded"), Yeoh(1.0), corner=PUCK_CORNER)
    mesh = full.solid.mesh
    held = np.ones(mesh.size, dtype=bool)
    held[full.pattern.free] = held[full.driven] = False
    problem = ContactProblem(full.solid, held, full.driven, full.base)
    path = follow(problem, 0.5 * np.array(COMPRESSION), 0.02, 0.05, 1e-3)
    seconds = time.process_time() - began
    vertices = mesh.dofs.reshape(-1, 9, 2)[:, :4, 0] // 2
    lines = [np.unique(np.round(mesh.nodes[axis][vertices], 7)).tolist() for axis in (0, 1)]
    return {
        "force": path.force.tolist(),
        "seconds": seconds,
        "unknowns": path.unknowns,
        "r": lines[0],
        "z": lines[1],
        "steps": path.load_steps,
    }


def theirs(python: str, task: dict[str, Any]) -> dict[str, Any]:
    """The answer of the other program; ``skipped`` or ``failed`` says why there is none."""
    # one thread, as this package's solves have: processor seconds are compared
    done = subprocess.run(
        [python, "-c", PROGRAM],
        input=json.dumps(task),
        capture_output=True,
        text=True,
        timeout=3600,
        env={**os.environ, **ONE_THREAD},
    )
    if done.returncode:
        return {"failed": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "no output"}
    return json.loads(done.stdout.strip().splitlines()[-1])


def compare(name: str, depth: list[float], one: dict[str, Any], other: dict[str, Any]) -> float:
    """Print both answers and return the largest relative difference; infinite when there is nothing to compare."""
    if "failed" in other:
        print(f"{name}: FElupe failed: {other['failed']}")
        return float("inf")
    print(
        f"{name}: FElupe {other['version']}: {other['unknowns']} unknowns, {other['steps']} steps, "
        f"{other['seconds']:.2f} s; dummydesign: {one['unknowns']} unknowns, {one['steps']} steps, "
        f"{one['seconds']:.2f} s; {other['seconds'] / one['seconds']:.1f} times as fast"
    )
    count = min(len(one["force"]), len(other["force"]))
    if count < len(depth):
        print(f"  only {len(one['force'])} and {len(other['force'])} of {len(depth)} depths were reached")
        if not count:
            return float("inf")
    print("  depth     dummydesign   FElupe        difference")
    for at, a, b in zip(depth, one["force"], other["force"]):
        print(f"  {at:7.4f}   {a:11.5f}   {b:11.5f}   {100 * (a / b - 1):+8.3f} %")
    return max(abs(a / b - 1.0) for a, b in zip(one["force"], other["force"]))


def slab_task(thickness_mm: float, depth: np.ndarray, corner: float, repeat: int) -> tuple[dict[str, Any], dict]:
    """This package's answer on the sharp-edged mesh, and the task for FElupe on the same lines."""
    ratio, extent = RADIUS_MM / thickness_mm, EXTENT_MM / thickness_mm
    one = min((ours_slab(ratio, extent, depth, corner) for _ in range(repeat)), key=lambda run: run["seconds"])
    task = {"r": one["r"], "z": one["z"], "halvings": 0, "quadratic": True, "glued": True, "reach": ratio}
    return one, task | {"depth": depth.tolist(), "parts": (1, 2, 4, 8), "repeat": repeat}


def limits(python: str) -> float:
    """FElupe carried on to a corner cell of 0, against the reported sharp-edge limit; the largest difference."""
    from dummydesign.pad.axisymmetric.sharp_edge import solve_curve

    depth, worst = np.array(LIMIT_DEPTH), 0.0
    print("sharp-edge limit: FElupe's last two corner cells and their extrapolation, and the reported force")
    for thickness in SLABS:
        curve = solve_curve(Pad(thickness, 0.003, RADIUS_MM, extent_mm=EXTENT_MM), depth * thickness)
        runs = [theirs(python, slab_task(thickness, depth, corner, 1)[1]) for corner in FINE_CORNERS]
        if any(len(run.get("force", ())) < len(depth) for run in runs):
            print(f"  {thickness:g} mm: FElupe did not arrive: {runs[-1].get('failed', '')}")
            return float("inf")
        coarse, fine = (np.array(run["force"]) for run in runs)
        limit, own = 2.0 * fine - coarse, curve.force_N / (1e-3 * thickness**2)
        for row in zip(depth, coarse, fine, limit, own, curve.error_N / curve.force_N):
            print(
                "  {:4g} mm, d/h {:5.3f}: {:9.5f} {:9.5f} {:9.5f} | {:9.5f} {:+7.3f} %, stated error {:.2f} %".format(
                    thickness, *row[:5], 100 * (row[4] / row[3] - 1.0), 100 * row[5]
                )
            )
        worst = max(worst, float(np.abs(own / limit - 1.0).max()))
    return worst


def whole_curves(repeat: int, single: dict[float, float]) -> None:
    """Time of the default curve, its ladder of beads included, against FElupe's one mesh."""
    from dummydesign.pad.axisymmetric.sharp_edge import solve_curve

    print("12-point default curve (ladder of beads and limit), against FElupe's single sharp-edged mesh")
    for thickness, deepest in SLABS.items():
        if thickness not in single:
            continue
        depth = thickness * deepest * np.arange(1, POINTS + 1) / POINTS
        seconds = float("inf")
        for _ in range(repeat):
            began = time.process_time()
            solve_curve(Pad(thickness, 0.003, RADIUS_MM, extent_mm=EXTENT_MM), depth)
            seconds = min(seconds, time.process_time() - began)
        print(f"  {thickness:4g} mm: {seconds:.2f} s, {single[thickness] / seconds:.1f} times as fast")


def main() -> None:
    """Run all three; exit code 1 when puck or limit differ by more than their tolerance."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", default=sys.executable, metavar="PATH", help="Python that has FElupe")
    parser.add_argument("--repeat", type=int, default=2, metavar="N", help="runs of which the fastest counts")
    options = parser.parse_args()
    os.environ["DUMMYDESIGN_CACHE"] = "off"
    worst, single = {}, {}
    for thickness, deepest in SLABS.items():
        depth = deepest * np.arange(1, POINTS + 1) / POINTS
        one, task = slab_task(thickness, depth, CORNER, options.repeat)
        other = theirs(options.python, task)
        if "skipped" in other:
            print(f"skipped: {other['skipped']}")
            sys.exit(0)
        compare(f"slab of {thickness:g} mm", depth.tolist(), one, other)
        single |= {thickness: other["seconds"]} if "seconds" in other else {}
    one = min((ours_puck() for _ in range(options.repeat)), key=lambda run: run["seconds"])
    squeezed = [0.5 * c for c in COMPRESSION]
    task = {"r": one["r"], "z": one["z"], "halvings": 2, "quadratic": False, "glued": False, "reach": 1.0}
    task |= {"depth": squeezed, "parts": (round(COMPRESSION[0] / PUCK_STEP),), "repeat": 1}
    worst["puck"] = compare("bonded puck", squeezed, one, theirs(options.python, task))
    whole_curves(options.repeat, single)
    worst["limit"] = limits(options.python)
    for name, tolerance in TOLERANCE.items():
        print(f"{name}: largest difference {100 * worst[name]:.2f} %, tolerance {100 * tolerance:g} %")
    sys.exit(0 if all(worst[name] <= tolerance for name, tolerance in TOLERANCE.items()) else 1)


if __name__ == "__main__":
    main()

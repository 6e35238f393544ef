"""The pad model against FElupe, another finite-element code, run as a separate program on the same problem.

    python benchmarks/pad_felupe.py [--python PATH]

FElupe (GPL) is a tool of development: it is run in a process of its own and never imported by the package. PATH
is the Python that has it (default: this one); without it the comparison is skipped with a message.

The problem: a bonded puck, radius = height, mu = 1, incompressible (bulk modulus 5000 mu there), compressed by up to
20 %, nothing in the way of its bulging side in either code. FElupe has its mixed three-field solid on linear
quadrilaterals, each side of our cells halved twice. Beyond 20 % the side folds over the singular edge and the
answer of any code without contact there depends on its cells: nothing to compare.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time

COMPRESSION = (0.05, 0.1, 0.15, 0.2)
CORNER = 0.02
STEP = 0.005
TOLERANCE = 0.01

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
r, z = halve(halve(r)), halve(halve(z))
began = time.perf_counter()
x, y = np.meshgrid(z, r, indexing="ij")  # FElupe: axis of rotation first
points = np.stack([x.ravel(), y.ravel()], axis=1)
n = np.arange(len(points)).reshape(len(z), len(r))
cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
mesh = fem.Mesh(points, cells, "quad")
region = fem.RegionQuad(mesh)
field = fem.FieldsMixed(region, n=3, axisymmetric=True)
solid = fem.SolidBody(fem.ThreeFieldVariation(fem.NeoHooke(mu=1.0, bulk=5000.0)), field)
bounds = {
    "axis": fem.Boundary(field[0], fy=0.0, skip=(1, 0)),
    "middle": fem.Boundary(field[0], fx=float(z.min()), skip=(0, 1)),
    "hold": fem.Boundary(field[0], fx=float(z.max()), skip=(1, 0)),
    "move": fem.Boundary(field[0], fx=float(z.max()), skip=(0, 1)),
}
found = []
# It has no cut-back of its own: steps small enough not to fold the cells at the edge.
way = np.arange(1, round(max(task["compression"]) / task["step"]) + 1) * task["step"]
step = fem.Step([solid], ramp={bounds["move"]: -0.5 * way}, boundaries=bounds)
def keep(i, j, substep):
    if np.isclose(way[j], task["compression"]).any():
        force = fem.tools.force(field, substep.fun, bounds["middle"])
        found.append(abs(float(force[0])))
fem.Job([step], callback=keep).evaluate(verbose=False, tol=1e-7)
print(json.dumps({"force": found, "seconds": time.perf_counter() - began, "version": fem.__version__,
                  "unknowns": int(sum(f.values.size for f in field))}))
"""


def ours() -> dict:
    """Forces, seconds and the mesh lines of this package's puck."""
    import numpy as np

    from dummydesign.pad.laws import neo_hookean
    from dummydesign.pad.newton import Problem, follow
    from dummydesign.pad.puck import Puck, puck_problem

    began = time.perf_counter()
    full = puck_problem(Puck(1.0, "bonded"), neo_hookean(1.0), corner=CORNER)
    mesh = full.solid.mesh
    held = np.ones(mesh.size, dtype=bool)
    held[full.pattern.free] = held[full.driven] = False
    problem = Problem(full.solid, held, full.driven, full.base)
    path = follow(problem, 0.5 * np.array(COMPRESSION), 0.02, 0.05, 1e-3)
    seconds = time.perf_counter() - began
    nodes = mesh.nodes
    vertices = mesh.dofs.reshape(-1, 9, 2)[:, :4, 0] // 2
    lines = [np.unique(np.round(nodes[axis][vertices], 7)).tolist() for axis in (0, 1)]
    return {
        "force": path.force.tolist(), "seconds": seconds, "unknowns": path.unknowns, "r": lines[0], "z": lines[1]
    }  # fmt: skip


def theirs(python: str, mesh: dict) -> dict:
    """The answer of the other program; ``skipped`` or ``failed`` says why there is none."""
    task = json.dumps({"r": mesh["r"], "z": mesh["z"], "compression": COMPRESSION, "step": STEP})
    done = subprocess.run([python, "-c", PROGRAM], input=task, capture_output=True, text=True, timeout=1800)
    if done.returncode:
        return {"failed": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "no output"}
    return json.loads(done.stdout.strip().splitlines()[-1])


def main() -> None:
    """Run both and compare; exit code 1 when they differ by more than the tolerance."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", default=sys.executable, metavar="PATH", help="Python that has FElupe")
    options = parser.parse_args()
    one = ours()
    other = theirs(options.python, one)
    if "skipped" in other or "failed" in other:
        print(f"skipped: {other.get('skipped') or other['failed']}")
        sys.exit(0 if "skipped" in other else 1)
    print(f"FElupe {other['version']}: {other['unknowns']} unknowns, {other['seconds']:.1f} s; "
          f"dummydesign: {one['unknowns']} unknowns, {one['seconds']:.1f} s")  # fmt: skip
    print("compression   dummydesign   FElupe        difference")
    worst = 0.0
    for at, a, b in zip(COMPRESSION, one["force"], other["force"]):
        worst = max(worst, abs(a / b - 1.0))
        print(f"{at:11.2f}   {a:11.5f}   {b:11.5f}   {100 * (a / b - 1):+8.3f} %")
    print(f"largest difference {100 * worst:.2f} %, tolerance {100 * TOLERANCE:g} %")
    sys.exit(0 if worst <= TOLERANCE else 1)


if __name__ == "__main__":
    main()

"""The pad model against GetFEM, another finite-element program that has contact, run as a process of its own.

    python -m benchmarks.accuracy.pad_getfem [--python PATH] [--quick]

PATH is a Python that has GetFEM's module (default: ``python3``; on Debian the package ``python3-getfem``); without it
the comparison is skipped with a message. GetFEM (LGPL) is never imported by the package.

There the same mechanics are written anew, as an energy from which the program derives residual and tangent: biquadratic
displacement with continuous bilinear pressure, a neo-Hookean law with a bulk modulus of 5000 shear moduli, the punch as
the distance from a rounded cylinder with sides, contact by a penalty. What touches sticks: a point that is inside the
punch at the end of a step is held where it came to it. Steps are made twice, the second time halved, and carried on to
none; the share that adds is printed.

Compared are filleted punches (0.5 mm) on slabs, the forefinger's crowned pad, and a crown without friction: the force,
and for slabs the pressure under the flat face.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
from typing import Any

import numpy as np

from dummydesign.core.blas_threads import ONE_THREAD
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.fields import solve_fields
from dummydesign.pad.pad_under_punch import Pad

Array = np.ndarray
RADIUS_MM, FILLET_MM, EXTENT_MM, YOUNG_MPA = 7.9, 0.5, 75.7, 0.03
BULK_OVER_SHEAR = 5000.0
# In shear moduli a mm. The stiffer ends some paths early, the softer lets the punch in by up to 0.3 % of a depth.
PENALTIES = (3000.0, 1000.0)
HALVINGS = 2
# Wanted of the model against independent codes.
TOLERANCE = 0.01

PROGRAM = r"""
import json, sys, time
try:
    import getfem as gf
except ImportError:
    print(json.dumps({"skipped": "GetFEM is not installed in " + sys.executable})); raise SystemExit
import numpy as np
gf.util_trace_level(0)
task = json.load(sys.stdin)
h, a, fillet, mu = (task[name] for name in ("h", "a", "fillet", "mu"))
TURN = "6.283185307179586*X(1)"

# cells of a crown are not parallelograms
mesh = gf.Mesh("cartesian Q1", np.array(task["r"]), np.array(task["z"]))
points = mesh.pts()
top = np.interp(points[0], task["top_r"], task["top_z"])
faces = mesh.outer_faces()
normal = mesh.normal_of_faces(faces)
middle = {int(c): points[0, mesh.pid_in_cvids(int(c))].mean() for c in np.unique(faces[0])}
near = np.array([middle[int(c)] < task["reach"] for c in faces[0]])
mesh.set_region(1, faces[:, normal[1] < -0.9])
mesh.set_region(2, faces[:, (normal[1] > 0.9) & near])
mesh.set_region(3, faces[:, normal[0] < -0.9])
mesh.set_pts(np.array([points[0], points[1] * top / h]))

u, p = gf.MeshFem(mesh, 2), gf.MeshFem(mesh, 1)
u.set_fem(gf.Fem("FEM_QK(2,2)")); p.set_fem(gf.Fem("FEM_QK(2,1)"))
rule = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,6)"))
model = gf.Model("real")
model.add_fem_variable("u", u); model.add_fem_variable("p", p)
for name, value in (("mu", mu), ("K", task["bulk"]), ("k", task["penalty"]), ("b", a - fillet), ("rho", fillet),
                    ("face", h)):
    model.add_initialized_data(name, value)
model.add_macro("F", "[1+Grad_u(1,1),Grad_u(1,2),0;Grad_u(2,1),1+Grad_u(2,2),0;0,0,1+u(1)/X(1)]")
model.add_macro("J", "Det(F)")
model.add_nonlinear_term(rule, TURN + "*(mu/2*(pow(J,-2/3)*Norm_sqr(F)-3)+p*(J-1)-p*p/(2*K))")
model.add_Dirichlet_condition_with_simplification("u", 1)
model.add_initialized_data("radial", np.array([[1.0, 0.0], [0.0, 0.0]]))
model.add_initialized_data("none", [0.0, 0.0])
model.add_generalized_Dirichlet_condition_with_multipliers(rule, "u", u, 3, "none", "radial")

# distance from the rounded cylinder
model.add_macro("pr", "(X(1)+u(1))"); model.add_macro("pz", "(X(2)+u(2))"); model.add_macro("zc", "(face+rho)")
model.add_macro("far", "sqrt(2*half_sqr_pos_part(pr-b)+2*half_sqr_pos_part(zc-pz)+1e-14)")
gap = "(far-rho)"
at = gf.MeshImData(rule, 2)
count = at.nbpts()
tied, tr, tz = np.zeros(count), np.zeros(count), np.zeros(count)
upward = "neg_part(%s)*pos_part(zc-pz)/far" % gap
if task["stick"]:
    for name in ("tied", "tr", "tz"):
        model.add_im_data(name, at)
    held = "(sqr(pr-tr)+sqr(pz-face-tz))/2"
    model.add_nonlinear_term(rule, TURN + "*k*((1-tied)*half_sqr_neg_part(%s)+tied*%s)" % (gap, held), 2)
    upward = "((1-tied)*%s+tied*(pz-face-tz))" % upward
    if task["flat"]:  # the flat face of the punch is glued from the start
        r = np.array(model.interpolation("X(1)", at, 2))
        tied = (r <= a - fillet + 1e-9) * 1.0
        tr = tied * r
else:
    model.add_nonlinear_term(rule, TURN + "*k*half_sqr_neg_part(%s)" % gap, 2)

def keep_ties():
    for name, value in (("tied", tied), ("tr", tr), ("tz", tz)):
        model.set_variable(name, value)

if task["stick"]:
    keep_ties()
began, depth, wanted, step = time.process_time(), 0.0, list(task["depth"]), task["step"]
force, pressure, before, last, iterations = [], [], None, 1.0, 0
while wanted:
    go = min(wanted[0], depth + step)
    now = model.from_variables()
    if depth > 0:
        model.to_variables(now + (now - before) * ((go - depth) / last))
    model.set_variable("face", h - go)
    made, found = model.solve("max_res", 1e-7 * mu * a * a, "max_iter", 30, "lsearch", "simplest", "alpha min", 0.1)
    iterations += made
    if not found:
        model.to_variables(now)
        step *= 0.5
        if step < 1e-3 * h:
            break
        continue
    before, last, depth = now, go - depth, go
    step = min(step * 1.5, task["step"])
    if task["stick"]:
        g = np.array(model.interpolation(gap, at, 2))
        r, z = (np.array(model.interpolation(name, at, 2)) for name in ("pr", "pz"))
        face, b = h - go, a - fillet
        right, below = np.maximum(r - b, 0.0), np.maximum(face + fillet - z, 0.0)
        share = fillet / np.maximum(np.hypot(right, below), 1e-12)
        new = (tied < 0.5) & (g < 0.0)
        tr = np.where(new, np.where(r > b, b + right * share, r), tr)
        tz = np.where(new, fillet - below * share, tz)
        tied = np.where(new, 1.0, tied)
        keep_ties()
    if depth >= wanted[0] - 1e-12:
        wanted.pop(0)
        force.append(float(gf.asm_generic(rule, 0, TURN + "*k*" + upward, 2, model)))
        part = TURN + "*k*Heaviside(%.12g-X(1))*" % task["ring"] + upward
        pressure.append(float(gf.asm_generic(rule, 0, part, 2, model)) / (np.pi * task["ring"] ** 2))
print(json.dumps({"force": force, "pressure": pressure, "seconds": time.process_time() - began,
                  "unknowns": model.nbdof(), "iterations": iterations}))
"""


def graded(at: float, low: float, high: float, cell: float, growth: float = 1.4) -> Array:
    """Lines from low to high, a cell wide at a place and wider away from it."""

    def way(length: float) -> Array:
        out, size = [0.0], cell
        while out[-1] < length - 1e-12:
            out.append(out[-1] + size)
            size *= growth
        return np.array(out) * (length / out[-1] if length > 0.0 else 1.0)

    return np.unique(np.round(np.concatenate([at - way(at - low), at + way(high - at)]), 10))


def theirs(python: str, pad: Pad, depth_mm: Array, step_mm: float, cell_mm: float, penalty: float) -> dict[str, Any]:
    """Force at the depths by GetFEM, its steps given; ``skipped`` or ``failed`` says why there is none."""
    h, shape = pad.thickness_mm, pad.geometry
    crown = isinstance(shape, Crowned)
    if crown:
        # the contact runs over the whole crown: even cells to the punch's edge
        end = RADIUS_MM + 0.5
        beyond = graded(end, end, EXTENT_MM, cell_mm)
        r = np.unique(np.round(np.concatenate([np.arange(0.0, end, cell_mm), beyond]), 10))
    else:
        r = graded(RADIUS_MM - 0.5 * FILLET_MM, 0.0, EXTENT_MM, cell_mm)
    along = np.linspace(0.0, EXTENT_MM, 4001)
    top = h - (shape.drop_mm(along, 0.0 * along) if crown else 0.0 * along)
    mu = YOUNG_MPA / 3.0
    ring = float(r[np.abs(r - 0.5 * RADIUS_MM).argmin()])
    task = {
        "ring": ring,
        "h": h,
        "a": RADIUS_MM,
        "fillet": FILLET_MM,
        "mu": mu,
        "bulk": BULK_OVER_SHEAR * mu,
        "penalty": penalty * mu,
        "r": r.tolist(),
        "z": graded(h, 0.0, h, cell_mm).tolist(),
        "top_r": along.tolist(),
        "top_z": top.tolist(),
        "reach": 1.5 * RADIUS_MM,
        "stick": pad.condition == "bonded",
        "flat": not crown,
        "depth": depth_mm.tolist(),
        "step": step_mm,
    }
    options: dict[str, Any] = {"capture_output": True, "text": True, "env": {**os.environ, **ONE_THREAD}}
    done = subprocess.run([python, "-c", PROGRAM], input=json.dumps(task), **options)
    if done.returncode or not done.stdout.strip():
        return {"failed": (done.stderr.strip().splitlines() or ["no output"])[-1]}
    return {"ring": ring, **json.loads(done.stdout.strip().splitlines()[-1])}


def same(first: list[float], second: list[float]) -> bool:
    """Whether two runs reached the same depths with forces within 1 %."""
    return len(first) == len(second) and bool(np.allclose(first, second, rtol=0.01))


def compare(name: str, python: str, pad: Pad, depth_mm: Array, step_mm: float, cell_mm: float) -> float | None:
    """Print both answers; the largest relative difference of the force, None where there is nothing to compare."""
    for penalty in PENALTIES:
        step = step_mm
        rough = other = theirs(python, pad, depth_mm, step, cell_mm, penalty)
        if "skipped" in rough:
            print("skipped:", rough["skipped"])
            return None
        for _ in range(HALVINGS):
            step, rough = 0.5 * step, other
            other = theirs(python, pad, depth_mm, step, cell_mm, penalty) if "failed" not in rough else rough
            # large steps may end early, or in another state than the one that follows the press
            if same(rough.get("force", []), other.get("force", [])):
                break
        if len(other.get("force", [])) == len(depth_mm):
            break
    count = min(len(rough.get("force", [])), len(other.get("force", [])))
    if not count:
        print(f"{name}: GetFEM failed: {other.get('failed', 'no depth was reached')}")
        return float("inf")
    states = solve_fields(pad, depth_mm[:count].tolist())[0]
    print(
        f"{name}: GetFEM {other['unknowns']} unknowns, penalty {penalty:g} mu/mm, {other['iterations']} iterations, "
        f"{other['seconds']:.1f} s"
    )
    print("  depth mm   dummydesign N   GetFEM N    difference   its last halving   pressure within a/2, kPa")
    worst = 0.0
    for k, state in enumerate(states):
        limit = 2.0 * other["force"][k] - rough["force"][k]
        difference = state.force_N / limit - 1.0
        worst = max(worst, abs(difference))
        text = f"  {depth_mm[k]:8.3f}   {state.force_N:13.4f}   {limit:8.4f}   {100 * difference:+9.2f} %"
        text += f"   {100 * (other['force'][k] / limit - 1):+14.2f} %"
        if pad.condition == "bonded" and not isinstance(pad.geometry, Crowned):
            # what is glued to the flat face moves with it: radii are those of the pad at rest
            r = np.linspace(0.0, other["ring"], 201)
            p = np.interp(r, state.face.radius_mm, state.face.pressure_MPa)
            mean = 2.0 * np.trapezoid(p * r, r) / other["ring"] ** 2
            text += f"   {1e3 * mean:.2f} and {1e3 * other['pressure'][k]:.2f}"
        print(text, flush=True)
    if count < len(depth_mm):
        print(f"  GetFEM ended after {count} of {len(depth_mm)} depths")
    return worst


def main() -> None:
    """Run the comparisons; exit 1 where one differs by more than 1 %."""
    parser = argparse.ArgumentParser(description="Compare the pad model with GetFEM, which has contact.")
    parser.add_argument("--python", default="python3")
    parser.add_argument("--quick", action="store_true", help="one slab, to d/h 0.2")
    asked = parser.parse_args()
    os.environ["DUMMYDESIGN_CACHE"] = "off"
    share = np.array([0.1, 0.2] if asked.quick else [0.1, 0.2, 0.3, 0.4])
    differences = []
    for h in (10.0,) if asked.quick else (5.0, 10.0, 20.0):
        pad = Pad(h, YOUNG_MPA, RADIUS_MM, extent_mm=EXTENT_MM, edge_radius_mm=FILLET_MM)
        differences.append(compare(f"slab of {h:g} mm, fillet 0.5 mm", asked.python, pad, h * share, 0.01 * h, 0.15))
    if not asked.quick:
        tip = Crowned(21.2, 2.0, 9.4)
        crown = Pad(4.5, YOUNG_MPA, RADIUS_MM, extent_mm=EXTENT_MM, edge_radius_mm=FILLET_MM, geometry=tip)
        depth = 4.5 * np.array([0.1, 0.15, 0.2, 0.25, 0.3])
        differences.append(compare("crowned pad of 4.5 mm", asked.python, crown, depth, 0.04, 0.15))
        dome = Crowned(40.0, 1.5, 11.0)
        plain = Pad(20.0, YOUNG_MPA, RADIUS_MM, extent_mm=EXTENT_MM, condition="frictionless", geometry=dome)
        shares = np.array([0.1, 0.2, 0.4])
        differences.append(compare("crown of 20 mm, no friction", asked.python, plain, shares, 0.05, 0.2))
    if any(value is not None and value > TOLERANCE for value in differences):
        raise SystemExit(f"a force differs by more than {100 * TOLERANCE:g} %")


if __name__ == "__main__":
    main()

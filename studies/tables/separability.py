"""Measure the error of the quick prediction: ``python -m studies.tables.separability [--part NAME]``.

What is measured and what for stands in :mod:`dummydesign.pad.predict`, which reads the result.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from dummydesign.core.files import write_text
from dummydesign.core.user_library import data_folder
from dummydesign.geometry.interface import BASES
from dummydesign.measurement.motion import DECELERATION_MM_S2, ramp_and_hold
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.finite_strain import SLAB_RIMS, nodes_of_motion, solve_ratio
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.predict import COMMAND, sums_of_arms
from dummydesign.pad.tables.slab import load_table
from studies.tables.common import Build
from studies.tables.separability_shapes import SPEEDS_MM_S, build_shapes, over_peak, with_earlier

RADIUS_MM = float(np.sqrt(14.0 * 14.0 / np.pi))
THICKNESSES_MM = (5.0, 10.0, 15.0, 20.0)
RELATIVE_DEPTHS = (0.1, 0.2, 0.3, 0.45)
# The sets to which the sum is fitted: much like the library's polyurethane, and another gel, weaker by half. They are
# fixed numbers, so that they do not move with the library.
SETS = {
    "library": (PronyTerm(0.03, 1.05), PronyTerm(0.3, 0.33), PronyTerm(3.0, 0.105)),
    "check": (PronyTerm(0.01, 0.2), PronyTerm(1.0, 0.4)),
}
# Where the viscous part is below this share of the force, rho is mostly mesh and is left out.
SMALLEST_VISCOUS = 0.05
# Rise time over the time of a single arm, and the speed at which it is pressed.
RISES = (0.5, 4.0, 20.0)
SINGLE_SPEED_MM_S = 50.0


def measure(
    base: str,
    thickness_mm: float,
    relative_depth: float,
    speed_mm_s: float,
    prony: tuple[PronyTerm, ...],
    finer: int = 1,
    rim: float | None = None,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
) -> dict[str, Any]:
    """Solve one press and hold and return the range of rho and the error of the quick force at its peak.

    Parameters
    ----------
    base : str
        ``bonded`` or ``sliding``.
    thickness_mm : float
        Of the slab; the punch has a radius of 14 mm. [mm]
    relative_depth : float
        Depth of the hold over the thickness.
    speed_mm_s : float
        Of the punch. [mm/s]
    prony : tuple of PronyTerm
        Relaxation of the pad.
    finer : int
        By how much the steps in time are finer than usual.
    rim : float, optional
        One fillet radius of the punch's edge over its radius; the usual ones and their extrapolation otherwise.
    deceleration_mm_s2 : float
        With which the punch stops, ``inf`` for at once. [mm/s2]

    Returns
    -------
    dict
        One row of the table.
    """
    from dummydesign.geometry.dimensions import PAD_EXTENT_MM

    motion = ramp_and_hold(speed_mm_s, relative_depth * thickness_mm, deceleration_mm_s2=deceleration_mm_s2)
    nodes = nodes_of_motion(motion.time_s, motion.displacement_mm / thickness_mm, prony, finer)
    slab = Case(RADIUS_MM / thickness_mm, PAD_EXTENT_MM / thickness_mm, base)
    path = solve_ratio(slab, prony, *nodes, rims=SLAB_RIMS if rim is None else (rim,))
    viscous = path.separable - path.elastic
    large = viscous > SMALLEST_VISCOUS * path.separable
    # Early in the ramp the depth is not the one this row stands for; those errors are smaller.
    deep = large & (path.depth > 0.95 * relative_depth)
    rho = (path.force - path.separable)[deep] / viscous[deep]
    peak = int(np.argmax(path.separable))
    return {
        "base": base,
        "thickness_mm": thickness_mm,
        "radius_over_thickness": RADIUS_MM / thickness_mm,
        "relative_depth": relative_depth,
        "velocity_mm_s": speed_mm_s,
        "rho_low": round(float(rho.min()), 4),
        "rho_high": round(float(rho.max()), 4),
        "error_at_peak": round(float(path.force[peak] / path.separable[peak] - 1.0), 4),
        "viscous_share_at_peak": round(float(viscous[peak] / path.separable[peak]), 4),
        "largest_error": round(float(np.abs(path.ratio - 1.0)[path.depth > 0.05 * relative_depth].max()), 4),
        "rim_over_scale": path.solver["rim_over_scale"],
        "seconds": round(path.solver["seconds"], 1),
    }


def measure_single(base: str, thickness_mm: float, relative_depth: float, rise: float) -> dict[str, Any]:
    """As :func:`measure`, with a single Prony term so strong that its force stands out from errors of the mesh.

    Parameters
    ----------
    base, thickness_mm, relative_depth
        As for :func:`measure`.
    rise : float
        Time of the rise over the time constant of the term.

    Returns
    -------
    dict
        A row of :func:`measure` with ``rise_over_tau``.
    """
    tau = relative_depth * thickness_mm / SINGLE_SPEED_MM_S / rise
    arm = (PronyTerm(tau, max(rise, 1.0)),)
    row = measure(base, thickness_mm, relative_depth, SINGLE_SPEED_MM_S, arm, deceleration_mm_s2=np.inf)
    return {"rise_over_tau": rise, **row}


def build_single() -> list[dict[str, Any]]:
    """What :func:`sums_of_arms` adds up."""
    rows = []
    for case in product(BASES, THICKNESSES_MM, RELATIVE_DEPTHS, RISES):
        rows.append(measure_single(*case))
        print(rows[-1], flush=True)
    return rows


def sums_at_peak(row: dict[str, Any], prony: tuple[PronyTerm, ...]) -> dict[str, float]:
    """Sums over the arms of a row at the peak of its quick force, over that."""
    h = row["thickness_mm"]
    motion = ramp_and_hold(row["velocity_mm_s"], row["relative_depth"] * h)
    depth, time_s = motion.displacement_mm, motion.time_s
    elastic = load_table(row["base"]).force(depth, h, 1.0, RADIUS_MM)
    force = relaxed_force(time_s, elastic, prony)
    sums = sums_of_arms(row["base"], RADIUS_MM / h, depth / h, time_s, elastic, prony)
    return over_peak(sums, force)


def build_sets() -> list[dict[str, Any]]:
    """The sets of arms to which it is fitted."""
    cases = [("library", case) for case in product(BASES, THICKNESSES_MM, RELATIVE_DEPTHS, SPEEDS_MM_S)]
    check = product(("bonded",), (5.0, 15.0), RELATIVE_DEPTHS[1:], (10.0, 250.0))
    cases += [("check", case) for case in check]
    rows = []
    for name, case in cases:
        row = measure(*case, SETS[name])
        rows.append({"arms": name, **row, **sums_at_peak(row, SETS[name])})
        print(rows[-1], flush=True)
    return rows


def grid_of(rows: list[dict[str, Any]], base: str) -> dict[str, Any]:
    """rho of single arms on a base over a / h, d / h and rise time, as ``dummydesign.pad.predict.QuickError``."""
    own = [row for row in rows if row["base"] == base]
    names = ("radius_over_thickness", "relative_depth", "rise_over_tau")
    axes = [np.array(sorted({row[name] for row in own})) for name in names]
    rho = np.full([len(axis) for axis in axes], np.nan)
    for row in own:
        index = tuple(int(np.searchsorted(axis, row[name])) for axis, name in zip(axes, names))
        rho[index] = row["error_at_peak"] / row["viscous_share_at_peak"]
    if not rho.size or not np.isfinite(rho).all():
        raise ValueError("values do not fill the grid")
    rho = np.concatenate([np.zeros_like(rho[:, :1]), rho], axis=1)
    ratio, depth, rise = (axis.tolist() for axis in axes)
    return {"ratio": ratio, "depth": [0.0, *depth], "rise": rise, "rho": rho.tolist()}


def shares_of(rows: list[dict[str, Any]]) -> list[list[float]]:
    """Shares (2, 2) of both sums over arms that pads of one kind show: in the error, and in its 95 % about that."""
    *sums, error = np.array([(row["rho_at_peak"], row["relaxing_at_peak"], row["error_at_peak"]) for row in rows]).T
    parts = np.stack(sums, axis=1)
    # a press errs by a share of its own sums
    size = parts.sum(axis=1)
    middle = np.linalg.lstsq(parts / size[:, None], error / size, rcond=None)[0]
    off = np.abs(error - parts @ middle)
    # of all widths that hold 95 % of them the one that is the least in the mean
    widths = np.stack([np.ones(81), np.geomspace(1e-3, 1e3, 81)])
    widths *= np.quantile(off[:, None] / (parts @ widths), 0.95, axis=0)
    return np.stack([middle, widths[:, np.argmin(parts.mean(axis=0) @ widths)]]).tolist()


def summary_of(made: dict[str, Any]) -> dict[str, Any]:
    """What predictions read: the grid of each base, and the shares of each kind and of all shaped pads."""
    kinds = {row["kind"] for row in made["shapes"]}
    by_kind = {kind: [row for row in made["shapes"] if row["kind"] == kind] for kind in sorted(kinds)}
    rows = {"slab": made["values"], "shaped": made["shapes"], **by_kind}
    return {
        "grids": {base: grid_of(made["single"], base) for base in BASES},
        "shares": {kind: shares_of(own) for kind, own in rows.items()},
    }


def build_convergence() -> dict[str, Any]:
    """How the numbers change with half the steps and half the fillet."""
    case = ("bonded", 10.0, 0.3, 50.0, SETS["library"])
    return {
        "case": "bonded, 10 mm, d/h 0.3, 50 mm/s, library",
        "rho_high": measure(*case)["rho_high"],
        "rho_high_half_steps": measure(*case, finer=2)["rho_high"],
        "rho_high_half_rim": measure(*case, rim=0.0125)["rho_high"],
    }


def main() -> None:
    """Measure and write; parts that are not asked for stay as they are."""
    parts: dict[str, Callable[[], Any]] = {
        "convergence": build_convergence,
        "single": build_single,
        "values": build_sets,
        "shapes": partial(build_shapes, SETS),
    }
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--part", action="append", choices=list(parts), help="measure this part only; may be repeated")
    parser.add_argument("--keep", action="store_true", help="keep the file's shapes beside those drawn now")
    options = parser.parse_args()
    asked = options.part or list(parts)
    run = Build.begin("studies.tables.separability")
    path = data_folder() / "materials" / "tables" / "quick-error.json"
    before = json.loads(path.read_text()) if options.keep or len(asked) < len(parts) else {}
    made: dict[str, Any] = dict(before)
    for name in asked:
        part = parts[name]()
        made |= with_earlier(before if options.keep else {}, part) if name == "shapes" else {name: part}
    head = {
        "schema": "dummydesign.quick-error/1",
        "command": COMMAND,
        "meaning": "rho = (F - F_quick) / (F_quick - F_elastic) at and after the stop of a ramp and hold of 10 s",
        "arms": {name: [term.to_dict() for term in terms] for name, terms in SETS.items()},
        "convergence": made["convergence"],
        "provenance": run.provenance(),
    }
    # on a line each: they are long
    short = [f'"{name}": {json.dumps(value)}' for name, value in summary_of(made).items()]
    names = ("single", "values", "shapes", "shapes_left_out")
    lists = [f'"{name}": [\n  ' + ",\n  ".join(map(json.dumps, made[name])) + "\n ]" for name in names]
    write_text(path, json.dumps(head, indent=1)[:-2] + ",\n " + ",\n ".join([*short, *lists]) + "\n}\n")


if __name__ == "__main__":
    main()

"""The error of the quick prediction (elastic table convolved with Prony terms), measured against finite strain.

``python -m dummydesign.pad.tables.separability`` solves presses and holds with :mod:`viscoelastic_ratio` over depth,
thickness and base and stores

    rho = (F - F_quick) / (F_quick - F_elastic),

the error as a share of the viscous part of the force. It is measured twice. For single arms, over the rise time in
units of the arm's time: its value at the stop is what :func:`allowance` uses, arm by arm, as a part of the
interval of every dynamic prediction (the stress of the arms adds, and the field of deformation hardly depends on
them). And for whole sets of arms, the first that of the
library's polyurethane, at 10, 50 and 250 mm/s, as a check that the sum holds.

An arm much slower than the rise has rho near 0 (its stress is that of a jump, which is separable in a hold); one
much faster has the largest, because the second Piola stress then lags by the current deformation and not by
that of the past.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from dummydesign.core.datafiles import data_folder
from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.interface import BASES
from dummydesign.measurement.motion import DECELERATION_MM_S2, ramp_and_hold
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force

Array = np.ndarray

RADIUS_MM = float(np.sqrt(14.0 * 14.0 / np.pi))
THICKNESSES_MM = (5.0, 10.0, 15.0, 20.0)
RELATIVE_DEPTHS = (0.1, 0.2, 0.3, 0.45)
SPEEDS_MM_S = (10.0, 50.0, 250.0)
# The sets that check the sum: much like the library's polyurethane, and another gel, weaker by half. They are fixed
# numbers, so that the check does not move with the library.
SETS = {
    "library": (PronyTerm(0.03, 1.05), PronyTerm(0.3, 0.33), PronyTerm(3.0, 0.105)),
    "check": (PronyTerm(0.01, 0.2), PronyTerm(1.0, 0.4)),
}
# Rise time over the time of a single arm, and the speed at which it is pressed.
RISES = (0.5, 4.0, 20.0)
SINGLE_SPEED_MM_S = 50.0
# Where the viscous part is below this share of the force, rho is mostly mesh and is left out.
SMALLEST_VISCOUS = 0.05
# Of 108 presses with whole sets of arms one errs by 1.33 times the sum over its single arms (20 mm, d/h 0.45, where
# the arms needed a larger bead), the others by at most 1.22 times.
MARGIN = 1.35
COMMAND = "python -m dummydesign.pad.tables.separability"


@dataclass(frozen=True)
class QuickError:
    """rho of one arm at the stop on a grid of a / h, d / h and rise time over the arm's time, all increasing."""

    ratio: Array
    depth: Array
    rise: Array
    rho: Array

    def at(self, ratio: float, depth: Array, rise: float) -> Array:
        """rho at one a / h, any d / h and one rise time.

        Linear between the grid in ln(a/h), d/h and ln(rise). Held at the ends of a / h and for longer rises;
        in proportion to shorter ones; the line in d / h is carried on beyond its end.
        """
        width = np.clip(np.log(ratio), *np.log(self.ratio[[0, -1]]))
        time = np.clip(np.log(rise), *np.log(self.rise[[0, -1]]))
        rows = np.apply_along_axis(lambda column: np.interp(width, np.log(self.ratio), column), 0, self.rho)
        row = np.apply_along_axis(lambda column: np.interp(time, np.log(self.rise), column), 1, rows)
        beyond = np.maximum(depth - self.depth[-1], 0.0) * (row[-1] - row[-2]) / (self.depth[-1] - self.depth[-2])
        return min(rise / self.rise[0], 1.0) * (np.interp(depth, self.depth, row) + beyond)


@lru_cache(maxsize=4)
def load_quick_error(base: str = "bonded") -> QuickError:
    """Read the stored values for a base.

    Raises
    ------
    NoAnswerError
        When the file is missing or damaged.
    """
    path = data_folder() / "materials" / "tables" / "quick-error.json"
    try:
        rows = [row for row in json.loads(path.read_text())["single"] if row["base"] == base]
        names = ("radius_over_thickness", "relative_depth", "rise_over_tau")
        axes = [np.array(sorted({row[name] for row in rows})) for name in names]
        rho = np.full([len(axis) for axis in axes], np.nan)
        for row in rows:
            place = tuple(int(np.searchsorted(axis, row[name])) for axis, name in zip(axes, names))
            rho[place] = row["error_at_peak"] / row["viscous_share_at_peak"]
        if not rho.size or not np.isfinite(rho).all():
            raise ValueError("values do not fill the grid")
        rho = np.concatenate([np.zeros_like(rho[:, :1]), rho], axis=1)
        return QuickError(axes[0], np.concatenate([[0.0], axes[1]]), axes[2], rho)
    except (OSError, ValueError, KeyError, IndexError) as problem:
        message = f"{path.name} is missing or damaged ({problem}); make it by {COMMAND}"
        raise NoAnswerError("bad_table", message) from None


def allowance(
    base: str, ratio: float, relative_depth: Array, time_s: Array, elastic: Array, prony: Sequence[PronyTerm]
) -> tuple[Array, Array]:
    """How far the force may lie below and above the quick prediction because that is separable. [unit of force]

    Parameters
    ----------
    base : str
        ``bonded`` or ``sliding``.
    ratio : float
        a / h.
    relative_depth, time_s, elastic : ndarray, shape (n,)
        Depth over thickness, time [s] and force of the relaxed material along the motion.
    prony : sequence of PronyTerm
        Relative to the long-term modulus.

    Returns
    -------
    below, above : ndarray, shape (n,), >= 0
    """
    deepest = np.maximum.accumulate(np.maximum(relative_depth, 0.0))
    inside = np.flatnonzero(deepest > 0.0)
    below, above = np.zeros(len(deepest)), np.zeros(len(deepest))
    if not len(inside):
        return below, above
    stop = int(np.argmax(deepest >= 0.99 * deepest[-1]))
    rise = time_s[stop] - time_s[max(inside[0] - 1, 0)]
    error = load_quick_error(base)
    for term in prony:
        viscous = np.abs(relaxed_force(time_s, elastic, (term,)) - elastic)
        shift = MARGIN * error.at(ratio, deepest, max(rise / term.tau_s, 1e-9)) * viscous
        below += np.maximum(-shift, 0.0)
        above += np.maximum(shift, 0.0)
    return below, above


def measure(
    base: str, thickness_mm: float, relative_depth: float, speed_mm_s: float, prony: tuple[PronyTerm, ...],
    finer: int = 1, rim: float | None = None, deceleration_mm_s2: float = DECELERATION_MM_S2,
) -> dict[str, Any]:  # fmt: skip
    """Solve one press and hold and return the range of rho and the error of the quick force at its peak."""
    from dummydesign.geometry.standard import PAD_EXTENT_MM
    from dummydesign.pad.material.hyperelastic import Yeoh
    from dummydesign.pad.slab.finite_strain_ratio import RIMS, nodes_of_motion, solve_ratio
    from dummydesign.pad.slab.problem import Slab

    motion = ramp_and_hold(speed_mm_s, relative_depth * thickness_mm, deceleration_mm_s2=deceleration_mm_s2)
    nodes = nodes_of_motion(motion.time_s, motion.displacement_mm / thickness_mm, prony, finer)
    slab = Slab(RADIUS_MM / thickness_mm, PAD_EXTENT_MM / thickness_mm, base)
    path = solve_ratio(slab, Yeoh(1.0), prony, *nodes, rims=RIMS if rim is None else (rim,))
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
    """The same for one arm, its time a share of the rise time, so strong that its force can be told from the mesh."""
    tau = relative_depth * thickness_mm / SINGLE_SPEED_MM_S / rise
    arm = (PronyTerm(tau, max(rise, 1.0)),)
    row = measure(base, thickness_mm, relative_depth, SINGLE_SPEED_MM_S, arm, deceleration_mm_s2=np.inf)
    return {"rise_over_tau": rise, **row}


def build_single() -> list[dict[str, Any]]:
    """What :func:`allowance` uses."""
    rows = []
    for case in product(BASES, THICKNESSES_MM, RELATIVE_DEPTHS, RISES):
        rows.append(measure_single(*case))
        print(rows[-1], flush=True)
    return rows


def build_sets() -> list[dict[str, Any]]:
    """The sets of arms that check it."""
    cases = [("library", case) for case in product(BASES, THICKNESSES_MM, RELATIVE_DEPTHS, SPEEDS_MM_S)]
    check = product(("bonded",), (5.0, 15.0), RELATIVE_DEPTHS[1:], (10.0, 250.0))
    cases += [("check", case) for case in check]
    rows = []
    for name, case in cases:
        rows.append({"arms": name, **measure(*case, SETS[name])})
        print(rows[-1], flush=True)
    return rows


def build_convergence() -> dict[str, Any]:
    """How the numbers change with half the steps and half the bead."""
    case = ("bonded", 10.0, 0.3, 50.0, SETS["library"])
    return {
        "case": "bonded, 10 mm, d/h 0.3, 50 mm/s, library",
        "rho_high": measure(*case)["rho_high"],
        "rho_high_half_steps": measure(*case, finer=2)["rho_high"],
        "rho_high_half_rim": measure(*case, rim=0.0125)["rho_high"],
    }


def main() -> None:
    """Measure and write; parts that are not asked for stay as they are."""
    from dummydesign.core.files import write_text

    parts = {"convergence": build_convergence, "single": build_single, "values": build_sets}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--part", action="append", choices=list(parts), help="measure this part only; may be repeated")
    asked = parser.parse_args().part or list(parts)
    path = data_folder() / "materials" / "tables" / "quick-error.json"
    before = json.loads(path.read_text()) if len(asked) < len(parts) else {}
    made = {name: build() if name in asked else before[name] for name, build in parts.items()}
    head = {
        "schema": "dummydesign.quick-error/1",
        "command": COMMAND,
        "meaning": "rho = (F - F_quick) / (F_quick - F_elastic) at and after the stop of a ramp and hold of 10 s",
        "arms": {name: [term.to_dict() for term in terms] for name, terms in SETS.items()},
        "convergence": made["convergence"],
    }
    lists = [f'"{name}": [\n  ' + ",\n  ".join(map(json.dumps, made[name])) + "\n ]" for name in ("single", "values")]
    write_text(path, json.dumps(head, indent=1)[:-2] + ",\n " + ",\n ".join(lists) + "\n}\n")


if __name__ == "__main__":
    main()

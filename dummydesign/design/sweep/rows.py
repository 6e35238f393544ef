"""Rows of a what-if study: one design each, worked out many at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.presses import Sampling, Slabs, press_to_depth, steady_depth
from dummydesign.geometry.shapes import Slab

if TYPE_CHECKING:
    from dummydesign.design.scoring.targets import Targets

PEAK_FORCE_N = 10.0
"""Steady force at which peak over steady is given, that of the paper's force-time figures. [N]"""


@dataclass(frozen=True)
class Task:
    """Some designs of one punch, condition and base with all that is needed to work them out anywhere.

    Attributes
    ----------
    fidelity, punch, condition, base : str
    radius_mm : float
        Radius of the circle of the punch's area. [mm]
    thickness_mm, ratio, young_MPa : ndarray, shape (D,)
    tau_s : tuple of float
        Times of the resin's arms. [s]
    beta : ndarray, shape (D, arms)
        Their strengths, relative to the long-term modulus.
    forces_N, velocities_mm_s : tuple of float
    targets : Targets or None
        What to score against.
    shapes : tuple of str
    shape : ndarray of int, shape (D,), optional
        Which of the shapes each design has; the first by default.
    edge_radius_mm : float
        Fillet of the punch's edge. [mm]
    sampling : Sampling
        Hold and braking of the presses.
    """

    fidelity: str
    punch: str
    condition: str
    base: str
    radius_mm: float
    thickness_mm: NDArray
    ratio: NDArray
    young_MPa: NDArray
    tau_s: tuple[float, ...]
    beta: NDArray
    forces_N: tuple[float, ...]
    velocities_mm_s: tuple[float, ...]
    targets: Targets | None = None
    shapes: tuple[str, ...] = (Slab.name,)
    shape: NDArray | None = None
    edge_radius_mm: float = 0.0
    sampling: Sampling = field(default_factory=Sampling)

    def take(self, chosen: NDArray) -> Task:
        """Keep the designs chosen by index or mask."""
        arrays = {name: getattr(self, name)[chosen] for name in ("thickness_mm", "ratio", "young_MPa", "beta")}
        return replace(self, **arrays, shape=None if self.shape is None else self.shape[chosen])

    def shape_of(self, index: int) -> str:
        """Shape of one design, as its text."""
        return self.shapes[0 if self.shape is None else int(self.shape[index])]


def rows_of(task: Task, slabs: Slabs, error: Callable[[NDArray], NDArray]) -> list[dict[str, Any]]:
    """Work out all designs at once and lay them out as rows.

    Parameters
    ----------
    task : Task
    slabs : Slabs
        Its designs, in its order.
    error : callable
        Relative error of the force at depths (D, n).
    """
    forces = np.array(task.forces_N)
    depth = slabs.curves.depth_at(slabs.slab, forces / slabs.young_MPa[:, None])
    slope = slabs.curves.slope_at(slabs.slab, depth) * slabs.young_MPa[:, None]
    with np.errstate(invalid="ignore"):
        columns = {
            "exponent_at_N": slope * depth / forces,
            "depth_mm_at_N": depth,
            "depth_over_thickness_at_N": depth / slabs.thickness_mm[:, None],
            "stiffness_N_per_mm_at_N": slope,
        }
    scores = _scores(slabs, task.targets)
    force_keys, speed_keys = _keys(task.forces_N), _keys(task.velocities_mm_s)
    plain = {name: _plain(values) for name, values in columns.items()}
    peaks, limits = _plain(_peaks(slabs, task.velocities_mm_s, task.sampling)), _limits(slabs, depth, task.forces_N)
    errors = _plain(_errors(depth, error)[:, None])
    rows = []
    for index in range(len(task.ratio)):
        row = {
            **_head(task, index),
            **{name: dict(zip(force_keys, values[index])) for name, values in plain.items()},
            "peak_over_steady": dict(zip(speed_keys, peaks[index])),
            "force_error_percent": errors[index][0],
            "limit": limits[index],
        }
        if scores is not None:
            own = {name: float(values[index]) for name, values in scores.items()}
            row["score"] = {name: None if value != value else value for name, value in own.items()}
        rows.append(row)
    return rows


def _head(task: Task, index: int) -> dict[str, Any]:
    return {
        "thickness_mm": float(task.thickness_mm[index]),
        "ratio": float(task.ratio[index]),
        "punch": task.punch,
        "condition": task.condition,
        "base": task.base,
        "shape": task.shape_of(index),
        "edge_radius_mm": task.edge_radius_mm,
        "young_kPa": float(1e3 * task.young_MPa[index]),
    }


def empty_row(task: Task, index: int, why: str) -> dict[str, Any]:
    """A row without values for a pad that could not be solved or cast.

    Parameters
    ----------
    task : Task
    index : int
        Of the design.
    why : str
        Said in ``limit``.
    """
    nothing = dict.fromkeys(_keys(task.forces_N))
    names = ("exponent_at_N", "depth_mm_at_N", "depth_over_thickness_at_N", "stiffness_N_per_mm_at_N")
    row = {**_head(task, index), **{name: dict(nothing) for name in names}}
    row |= {"peak_over_steady": dict.fromkeys(_keys(task.velocities_mm_s)), "force_error_percent": None, "limit": why}
    if task.targets is not None:
        row["score"] = dict.fromkeys(SCORES, 0.0)
    return row


def _keys(values: Sequence[float]) -> list[str]:
    return [f"{value:g}" for value in values]


def _peaks(slabs: Slabs, velocities: Sequence[float], sampling: Sampling) -> NDArray:
    """Peak over the force at the end of the hold where that is 10 N, shape (D, speeds)."""
    columns = []
    for velocity in velocities:
        depth = steady_depth(slabs, PEAK_FORCE_N, velocity, sampling)
        columns.append(press_to_depth(slabs, depth, velocity, sampling).peak_N / PEAK_FORCE_N)
    return np.stack(columns, axis=-1)


SCORES = ("total", "steady_state_range", "force_variation_range", "aim", "parametric", "low_force_range")


def _scores(slabs: Slabs, targets: Targets | None) -> dict[str, NDArray] | None:
    """Scores for a tissue as in the map of the search: the parametric part is that of gamma1."""
    if targets is None:
        return None
    from dummydesign.design.scoring.law_parameters import gamma1_score
    from dummydesign.design.scoring.score import evaluate, evaluated_gamma1

    found = evaluate(slabs, targets)
    parametric = gamma1_score(evaluated_gamma1(found, targets.power), targets)
    return {
        "total": found.total(parametric),
        "steady_state_range": found.steady_state_range,
        "force_variation_range": found.force_variation_range,
        "aim": found.aim,
        "parametric": parametric if targets.parametric else np.full(len(parametric), np.nan),
        "low_force_range": found.low_force_range,
    }


def _limits(slabs: Slabs, depth: NDArray, forces: Sequence[float]) -> list[str | None]:
    """Why a row stops early: the first force that is out of reach, and the limit it meets."""
    limits: list[str | None] = []
    edge = slabs.curves.limit_mm[slabs.slab]
    for index, row in enumerate(np.isnan(depth)):
        if not row.any():
            limits.append(None)
            continue
        share = edge[index] / slabs.thickness_mm[index]
        first = min(force for force, missing in zip(forces, row) if missing)
        limits.append(f"{first:g} N needs more than {edge[index]:.2f} mm ({share:.2f} of the thickness)")
    return limits


def _errors(depth: NDArray, error_of: Callable[[NDArray], NDArray]) -> NDArray:
    """Largest numerical error of the forces that are reached, shape (D,); NaN when the law states none. [%]"""
    known = np.isfinite(depth)
    error = error_of(np.where(known, depth, 0.0))
    largest = np.where(known, error, -np.inf).max(axis=-1)
    return 100.0 * np.where(np.isfinite(largest), largest, np.nan)


def _plain(values: NDArray) -> list[list[float | None]]:
    """Plain lists with None where a value is missing."""
    plain = values.tolist()
    if np.isnan(values).any():
        return [[None if value != value else value for value in row] for row in plain]
    return plain

"""What a residual depends on: shares explained by depth, speed, thickness, time, order, and so on.

Each factor is a family of smooth columns, whitened and cleaned of what the model's own parameters could
do; the drop of chi2 by the family, beside its number of columns, says how much of the residual follows it.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.reduction import HOLD, PRE, UNLOADING
from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.screening import project


@dataclass(frozen=True)
class Dependence:
    """How much of a residual follows one factor: drop of chi2, columns, share of all chi2, and how it looks."""

    factor: str
    drop: float
    columns: int
    share: float
    shape: str

    @property
    def excess(self) -> float:
        """Drop beyond what noise gives on average."""
        return self.drop - self.columns

    def to_dict(self) -> dict[str, Any]:
        """Return all fields and the excess."""
        return {**asdict(self), "excess": self.excess}


def hats(values: NDArray, knots: NDArray) -> list[NDArray]:
    """Piecewise-linear hat functions on knots, constant outside."""
    clipped = np.clip(values, knots[0], knots[-1])
    return [np.interp(clipped, knots, np.eye(len(knots))[i]) for i in range(len(knots))]


def families(found: Fit) -> dict[str, list[NDArray]]:
    """Columns (T, B) in newton for each factor, at the modelled forces."""
    presses = found.problem.presses
    force, bins, used = found.forces, presses.bins, presses.used
    middle = 0.5 * (bins.start + bins.end)
    since = middle - presses.stop_s[:, None]
    phase = np.where(used, presses.label // 100, PRE)
    history = presses.history
    log_time = np.log(np.clip(since, 1e-3, 20.0))
    depth = presses.measure(np.maximum(presses.displacement_mm, 0.0))
    pressed = np.where((phase == HOLD) | (phase == UNLOADING), 1.0, 0.0)
    times = np.log([1e-3, 6e-3, 3e-2, 0.12, 0.5, 2.0, 8.0])
    speed = np.log(np.maximum(presses.velocity_mm_s, 1e-3))[:, None]
    speed = speed - speed.mean()
    thick = np.log(presses.thickness_mm)[:, None]
    thick = thick - thick.mean()
    fast = presses.velocity_mm_s[:, None] / presses.velocity_mm_s.max()
    window = np.linspace(0.0, 0.3, 31)
    unit = force.max() or 1.0
    out = {
        "force": [force * (force / unit), force * (force / unit) ** 2, force * (force / unit) ** 3],
        "depth": [force * hat for hat in hats(depth, np.linspace(0.0, depth.max(), 9))],
        "speed": [force * speed * hat for hat in hats(log_time, times)],
        "thickness": [force * thick * hat for hat in hats(log_time, times)],
        "time since stop": [force * pressed * hat for hat in hats(log_time, times)],
        "oscillation after the stop": [fast * (since > 0) * (since < 0.3) * hat for hat in hats(since, window)],
        "order": [force * _standard(history.sequence), force * _standard(history.sequence) ** 2],
        "repeat": [force * _standard(history.repeat)],
        "loading or unloading": [force * (phase == UNLOADING), depth * (phase == UNLOADING)],
        "before contact": [1.0 * (phase == PRE) * (middle < presses.contact_s[:, None])],
        "single trials": [force * (np.arange(len(force)) == row)[:, None] for row in range(len(force))],
    }
    for column in ("temperature_C", "age_days"):
        declared = getattr(history, column)
        if np.all(np.isfinite(declared)):
            out[column.partition("_")[0]] = [force * _standard(declared)]
    return {name: [np.where(used, column, 0.0) for column in columns] for name, columns in out.items()}


def _standard(values: NDArray) -> NDArray:
    """Centred and scaled to one, as a column."""
    centred = values - values.mean()
    spread = np.abs(centred).max()
    return (centred / spread if spread > 0 else centred)[:, None]


def dependences(found: Fit) -> list[Dependence]:
    """Measure all factors on the residual of a fit, strongest first."""
    projection, whiten = project(found, law_free=True)
    clean = projection.remove(projection.residual)
    total = float(clean @ clean)
    out = []
    for name, columns in families(found).items():
        stacked = np.stack([np.r_[whiten(c).ravel(), np.zeros(projection.rows)] for c in columns], axis=1)
        length = np.linalg.norm(stacked, axis=0)
        cleaned = stacked - projection.basis @ (projection.basis.T @ stacked)
        cleaned = cleaned[:, length > 0] / length[length > 0]
        if not cleaned.size:
            continue
        basis, singular, turn = np.linalg.svd(cleaned, full_matrices=False)
        keep = singular > 0.02
        if not keep.any():
            continue
        along = basis[:, keep].T @ clean
        drop = float(along @ along)
        weights = np.zeros(len(columns))
        weights[length > 0] = turn[keep].T @ (along / singular[keep])
        shape = " ".join(f"{w:+.1f}" for w in weights[:12]) if name != "single trials" else ""
        out.append(Dependence(name, drop, int(keep.sum()), drop / total if total else 0.0, shape))
    return sorted(out, key=lambda one: -one.excess)

"""The error of the quick prediction (elastic table convolved with Prony terms), measured against finite strain.

``python -m studies.tables.separability`` solves presses and holds at finite strain over depth, thickness
and base and stores

    rho = (F - F_quick) / (F_quick - F_elastic),

the error as a share of the viscous part of the force. It is measured twice. For single arms, over the rise time in
units of the arm's time: its value at the stop is what :func:`allowance` uses, arm by arm, as a part of the
interval of every dynamic prediction (the stress of the arms adds, and the field of deformation hardly depends on
them). And for whole sets of arms, the first that of the
library's polyurethane, at 10, 50 and 250 mm/s, as a check that the sum holds.

An arm much slower than the rise has rho near 0 (its stress is that of a jump, which is separable in a hold); one
much faster has the largest, because the second Piola stress then lags by the current deformation and not by
that of the past.

Shaped pads were pressed too (part ``shapes``): what they do beyond a slab that is pressed as deep relative to its gel
is added as a share by kind (:func:`shape_share`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from dummydesign.core import library as json_table
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force

Array = np.ndarray

# Of 108 presses with whole sets of arms one errs by 1.33 times the sum over its single arms (20 mm, d/h 0.45, where
# the arms needed a larger fillet), the others by at most 1.22 times.
MARGIN = 1.35
NAME = "quick-error.json"
SLAB = Slab()
COMMAND = "python -m studies.tables.separability"


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
        in proportion to shorter ones; extrapolated linearly in d / h beyond its end.
        """
        width = np.clip(np.log(ratio), *np.log(self.ratio[[0, -1]]))
        time = np.clip(np.log(rise), *np.log(self.rise[[0, -1]]))
        rows = np.apply_along_axis(lambda column: np.interp(width, np.log(self.ratio), column), 0, self.rho)
        row = np.apply_along_axis(lambda column: np.interp(time, np.log(self.rise), column), 1, rows)
        beyond = np.maximum(depth - self.depth[-1], 0.0) * (row[-1] - row[-2]) / (self.depth[-1] - self.depth[-2])
        return min(rise / self.rise[0], 1.0) * (np.interp(depth, self.depth, row) + beyond)


@lru_cache(maxsize=4)
def load_quick_error(base: str = "bonded") -> QuickError:
    """Read the stored values for a base."""
    return json_table.read(NAME, "table", COMMAND, lambda data: _from_dict(data, base))


def _from_dict(data: dict[str, Any], base: str) -> QuickError:
    rows = [row for row in data["single"] if row["base"] == base]
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


def slab_allowance(
    base: str, ratio: float, relative_depth: Array, time_s: Array, elastic: Array, prony: Sequence[PronyTerm]
) -> tuple[Array, Array]:
    """How far the force may lie below and above the quick prediction because that is separable. [unit of force]"""
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


def over_gel(shape: PadShape, thickness_mm: float) -> float:
    """Thickness over the gel between bone and apex, which is what a depth is to be compared with."""
    nothing = np.zeros(1)
    return float(thickness_mm / (thickness_mm - shape.bone_mm(nothing, nothing)[0]))


@lru_cache(maxsize=8)
def shape_share(kind: str) -> tuple[float, float]:
    """What was found on shaped pads of a kind."""
    rows = json_table.read(NAME, "table", COMMAND, lambda data: data["shapes"])
    rows = [row for row in rows if row["kind"] == kind] or rows
    return max(0.0, *(row["below"] for row in rows)), max(0.0, *(row["above"] for row in rows))


def most_viscous(force: Array, elastic: Array) -> Array:
    """Largest viscous part of a force so far, shape (n,)."""
    return np.maximum.accumulate(np.abs(force - elastic))


def allowance(
    base: str, ratio: float, relative_depth: Array, time_s: Array, elastic: Array, prony: Sequence[PronyTerm],
    shape: PadShape = SLAB, thickness_mm: float = 1.0,
) -> tuple[Array, Array]:  # fmt: skip
    """How far the force of a slab or shaped pad may lie below and above the quick prediction. [unit of force]"""
    if shape.plain:
        return slab_allowance(base, ratio, relative_depth, time_s, elastic, prony)
    _, above = slab_allowance(base, ratio, relative_depth * over_gel(shape, thickness_mm), time_s, elastic, prony)
    low, high = shape_share(shape.name)
    viscous = most_viscous(relaxed_force(time_s, elastic, tuple(prony)), elastic)
    return low * viscous, above + high * viscous

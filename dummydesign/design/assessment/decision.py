"""Why a pad was chosen: its level and shares beside those of the best pad of every other kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.levels import LEVELS, level_name
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.design.request import NAGOYA_PROTOCOL
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.shape_search import ShapedDesign, fitted_candidates, none_usable
from dummydesign.design.search.slabs import DesignCandidate, SearchSpace
from dummydesign.geometry.pad_shape import PadShape

# Forces of the tissue over which the misfit is taken in the paper's test, even in the logarithm. [N]
MISFIT_N = NAGOYA_PROTOCOL.misfit_N
LEVEL, BEYOND, SHARE, POURED, MISFIT = "level", "beyond", "after_puck", "as_poured", "misfit"


@dataclass(frozen=True)
class Choice(Serialised):
    """Why a pad was taken: what decided over the best pad of another kind, in the order of the search's ranks."""

    text: str
    next_best: str | None
    decided_by: str | None


def explain(chosen: ShapedDesign, others: Sequence[ShapedDesign], space: SearchSpace) -> Choice:
    """Compare the recommended pad with the next best of another kind; ``others`` are ranked."""
    rest = [other for other in others if other.shape.name != chosen.shape.name]
    if not rest:
        return Choice("no other kind of shape was compared", None, None)
    other = rest[0]
    name = f"the {other.shape.name} pad ({other.thickness_mm:g} mm, ratio {other.outlook.ratio:g})"
    limits, strict = space.targets.limits, space.targets.strict
    mine, its = (design.outlook.level(limits, strict) for design in (chosen, other))
    if none_usable((chosen, other), space) and np.isfinite(chosen.outlook.beyond):
        beyond, its_beyond = (np.exp(design.outlook.beyond) for design in (chosen, other))
        far = f"{name} {its_beyond:.3f} times" if np.isfinite(its_beyond) else f"{name} misses a press"
        return Choice(f"no pad is usable: its largest reading is {beyond:.3f} times its limit, {far}", name, BEYOND)
    share, other_share = (100.0 * design.outlook.after_puck for design in (chosen, other))
    if mine < its:
        words = f"it is better by its level: {name} comes next and is '{level_name(LEVELS[its])}'"
        return Choice(words, name, LEVEL)
    if not other.outlook.ties(chosen.outlook):
        words = f"more of its castings are usable once a puck is pressed: {share:.0f} %, {name} {other_share:.0f} %"
        return Choice(words, name, SHARE)
    if not other.outlook.ties(chosen.outlook, poured=True):
        share, other_share = (100.0 * design.outlook.as_poured for design in (chosen, other))
        words = f"more of its castings are usable as poured: {share:.0f} %, {name} {other_share:.0f} %"
        return Choice(words, name, POURED)
    words = f"it comes nearer to the subjects: misfit {chosen.outlook.misfit:.2f}, {name} {other.outlook.misfit:.2f}"
    return Choice(words, name, MISFIT)


@dataclass(frozen=True)
class LowForce(Serialised):
    """One design against the tissue from a tenth of the lowest force of the test to its highest: 0.5 to 15 N."""

    misfit_rms_ln_force: float | None
    share_below_5N: float
    share_above_5N: float
    exponent_at_N: dict[str, float | None]
    depth_over_thickness: float | None


def low_force(candidate: DesignCandidate, targets: Targets) -> LowForce:
    """Compare a design with the aim and the subjects' range over 0.5 to 15 N."""
    index, evaluation, slabs, protocol = candidate.index, candidate.evaluation, candidate.alone, targets.protocol
    area = np.array(protocol.exponent_at_N) / slabs.young_MPa[0]
    depth = slabs.curves.depth_at(slabs.slab, area[None])
    exponent = (slabs.curves.slope_at(slabs.slab, depth) * depth / area)[0]
    deepest = float(candidate.steady_depth_mm(np.array([protocol.forces_N[-1]]))[0])
    wide = candidate.steady_depth_mm(protocol.wide_N)
    return LowForce(
        misfit(wide, protocol.wide_N, targets.aim_depth_mm(protocol.misfit_N), protocol.misfit_N),
        float(evaluation.low_force_range[index]),
        float(evaluation.steady_state_range[index]),
        to_plain({f"{force:g}": value for force, value in zip(protocol.exponent_at_N, exponent)}),
        to_plain(deepest / candidate.thickness_mm),
    )


def misfit(depth_mm: NDArray, force_N: NDArray, aim_depth_mm: NDArray, aim_N: NDArray = MISFIT_N) -> float | None:
    """Root mean square of ln F(pad) - ln F(aim) over the aim's forces."""
    known = np.isfinite(depth_mm)
    if known.sum() < 2 or depth_mm[known].max() < aim_depth_mm.max() * (1.0 - 1e-9):
        return None
    away = np.log(force_at(aim_depth_mm, depth_mm, force_N) / aim_N)
    return float(np.sqrt(np.mean(away**2)))


def force_at(at_mm: NDArray, depth_mm: NDArray, force_N: NDArray) -> NDArray:
    """Force at depths on a curve, straight in ln F over ln depth; NaN beyond the curve's deepest point. [N]"""
    known = np.isfinite(depth_mm)
    curve = np.log(depth_mm[known]), np.log(force_N[known])
    # A little slack: the aim's deepest point may be the curve's own.
    held = np.minimum(at_mm, depth_mm[known].max() * (1.0 + 1e-9))
    force = np.exp(np.interp(np.log(held), *curve))
    return np.where(at_mm <= held, force, np.nan)


@dataclass(frozen=True)
class ShapeComparison:
    """The best design of one kind of shape, or the reason why there is none.

    ``by`` says where its force comes from: ``table``, ``law`` or ``elements``; ``level`` is by its outlook.
    """

    kind: str
    shape: PadShape | None = None
    candidate: DesignCandidate | None = None
    young_kPa: float | None = None
    low_force: LowForce | None = None
    reason: str | None = None
    by: str | None = None
    level: str | None = None
    after_puck: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the design and how near it comes to the tissue as plain values."""
        if self.candidate is None or self.low_force is None:
            return {"kind": self.kind, "shape": None, "reason": self.reason}
        return {
            "kind": self.kind,
            "shape": str(self.shape),
            "thickness_mm": self.candidate.thickness_mm,
            "ratio": self.candidate.ratio,
            "young_kPa": self.young_kPa,
            "total": self.candidate.total,
            "by": self.by,
            "level": self.level,
            "after_puck": self.after_puck,
            "acceptable": self.level != LEVELS[-1],
            **self.low_force.to_dict(),
            "reason": None,
        }


def compare_kinds(
    designs: Sequence[ShapedDesign], missing: dict[str, str], space: SearchSpace
) -> list[ShapeComparison]:
    """Rows of the best design of each kind, and the reasons of kinds without one."""
    limits, strict = space.targets.limits, space.targets.strict
    pads = [(one.cast, one.thickness_mm, one.outlook.ratio) for one in designs]
    rows = []
    for design, best in zip(designs, fitted_candidates(pads, space)):
        young = 1e3 * float(np.asarray(space.resin.young_MPa(best.ratio)))
        level = LEVELS[design.outlook.level(limits, strict)]
        rows.append(
            ShapeComparison(
                design.shape.name,
                design.shape,
                best,
                young,
                low_force(best, space.targets),
                None,
                design.source,
                level,
                design.outlook.after_puck,
            )
        )
    return rows + [
        ShapeComparison(kind, reason=reason)
        for kind, reason in missing.items()
        if kind not in {row.kind for row in rows}
    ]

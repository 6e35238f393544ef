"""One design in the form of the ``suggest`` contract."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.design.scoring.targets import LOW_GRID_N, Targets
from dummydesign.design.search.low_force import low_force
from dummydesign.geometry.shapes import Shape, Slab

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.resin.model.resin import Resin

LOW_FORCES_N = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0)


def design_dict(
    candidate: Candidate,
    resin: Resin,
    targets: Targets,
    recipe: tuple[tuple[str, float], ...],
    shape: Shape | None = None,
) -> dict[str, Any]:
    """Return one design as plain values.

    Parameters
    ----------
    candidate : Candidate
        Design with scores, presses and fitted parameters.
    resin, targets
        What it was made for.
    recipe : tuple of (name, mass in g)
        What to weigh.
    shape : Shape, optional
        A flat slab without it.
    """
    index, evaluation = candidate.index, candidate.evaluation
    parameters = None
    if candidate.parameters is not None:
        parameters = {name: _plain(value) for name, value in candidate.parameters.to_dict().items() if name != "law"}
    return {
        "resin": resin.name,
        "ratio": candidate.ratio,
        "ratio_meaning": resin.ratio_meaning,
        "shape": str(shape or Slab()),
        "thickness_mm": candidate.thickness_mm,
        "young_kPa": resin.modulus_kPa(candidate.ratio).to_dict(),
        "prony": [term.to_dict() for term in resin.prony(candidate.ratio)],
        "recipe": {
            "components": [{"name": name, "mass_g": mass} for name, mass in recipe],
            "total_g": round(sum(mass for _, mass in recipe), 6),
        },
        "parameters": parameters,
        "parameters_law": targets.tissue.law,
        "scores": {
            "total": candidate.total,
            "steady_state_range": float(evaluation.steady_state_range[index]),
            "force_variation_range": float(evaluation.force_variation_range[index]),
            "aim": float(evaluation.aim[index]),
            "parametric": candidate.parametric,
            "low_force_range": float(evaluation.low_force_range[index]),
        },
        "conditions": _conditions(candidate, targets),
        "low_force": _low_force(candidate, targets),
        "from_first_touch": low_force(candidate, targets).to_dict(),
    }


def _conditions(candidate: Candidate, targets: Targets) -> list[dict[str, Any]]:
    """One row a condition; a condition out of reach has no depth and says why."""
    rows = []
    for column, condition in enumerate(targets.conditions):
        depth = float(candidate.evaluation.depth_mm[candidate.index, column])
        reached = bool(np.isfinite(depth))
        press = candidate.evaluation.presses[column]
        rows.append(
            {
                "steady_force_N": condition.steady_force_N,
                "velocity_mm_s": condition.velocity_mm_s,
                "depth_mm": depth if reached else None,
                "depth_over_thickness": depth / candidate.thickness_mm if reached else None,
                "peak_force_N": float(press.peak_N[candidate.index]) if reached else None,
                "target_peak_low_N": condition.range.peak_low_N,
                "target_peak_high_N": condition.range.peak_high_N,
                "inside_fraction": float(candidate.evaluation.inside[candidate.index, column]),
                "out_of_reach": None if reached else _why(candidate, condition.steady_force_N),
            }
        )
    return rows


def _why(candidate: Candidate, force_N: float) -> str:
    slabs = candidate.evaluation.slabs
    limit = float(slabs.curves.limit_mm[slabs.slab[candidate.index]])
    share = limit / candidate.thickness_mm
    return f"{force_N:g} N steady needs more than {limit:.1f} mm, {share:.2f} of the thickness"


def _low_force(candidate: Candidate, targets: Targets) -> list[dict[str, Any]]:
    """Depths at small steady forces beside the tissue's extrapolated range."""
    stiff, soft = targets.depth_range_mm(np.array(LOW_FORCES_N))
    rows = []
    for force, low, high in zip(LOW_FORCES_N, stiff, soft):
        column = int(np.argmin(np.abs(LOW_GRID_N - force)))
        depth = float(candidate.evaluation.low_depth_mm[candidate.index, column])
        rows.append(
            {
                "force_N": force,
                "depth_mm": depth if np.isfinite(depth) else None,
                "tissue_depth_low_mm": float(low),
                "tissue_depth_high_mm": float(high),
            }
        )
    return rows


def _plain(value: Any) -> Any:
    return {key: float(item) for key, item in value.items()} if isinstance(value, dict) else float(value)

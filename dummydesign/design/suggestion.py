"""The answer of a design request with all its objects, and as values in the form of the ``suggest`` contract."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.design.assessment.castings import GROUPS, TISSUE
from dummydesign.design.scoring.deviations import TOLERANCE
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.low_force import low_force
from dummydesign.geometry.shapes import PadShape

if TYPE_CHECKING:
    from dummydesign.design.assessment.castings import Castings, PadCastings
    from dummydesign.design.assessment.centring import CentringTolerance
    from dummydesign.design.assessment.choice import Choice
    from dummydesign.design.assessment.measure_first import MeasureFirst
    from dummydesign.design.assessment.pour_yield import PourYield
    from dummydesign.design.assessment.verification import Verification
    from dummydesign.design.expected.expectation import Expectation
    from dummydesign.design.own_test.punch import AskedPunch
    from dummydesign.design.request import Request
    from dummydesign.design.scoring.presses import ForceLaw
    from dummydesign.design.scoring.verdict import Verdict
    from dummydesign.design.search.best_of_kinds import Beside
    from dummydesign.design.search.slabs import Candidate, SearchResult
    from dummydesign.design.sites.layout import Sites
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue

LOW_SHARES = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Forces below the lowest of the test at which depths are listed, over that force."""


@dataclass(frozen=True)
class Design:
    """One pad: what was evaluated (scores, presses, parameters), its shape, what it takes, and what to mix for it.

    ``recipe`` are (name, mass in g) of the pour, ``batch`` what to mix and how much of it to pour.
    """

    candidate: Candidate
    shape: PadShape
    recipe: tuple[tuple[str, float], ...]
    batch: dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Suggestion:
    """The answer: verdict, recommended design and the others, the search, tolerance, verification, and its basis.

    ``law`` is the force law in proportion with thickness, ``cast`` that of the shape as it is cast, from elements
    when it was verified; ``beside`` the best design of each kind of shape; ``centring`` how far off the centre of
    a crown the punch may press (with verification); ``warnings`` are {code, message}; ``calibration`` says what was
    used of one and what it left; ``sites`` the grid of crowns, where several were asked for.
    """

    request: Request
    tissue: Tissue
    resin: Resin
    targets: Targets
    found: SearchResult
    verdict: Verdict
    castings: PadCastings
    recommended: Design
    alternatives: tuple[Design, ...]
    law: ForceLaw
    cast: ForceLaw
    beside: tuple[Beside, ...]
    pour: PourYield
    verification: Verification
    centring: CentringTolerance | None
    rests_on: dict[str, Any]
    warnings: tuple[dict[str, str], ...]
    punch: AskedPunch
    choice: Choice
    expectation: Expectation
    measure_first: MeasureFirst
    calibration: dict[str, Any] | None = None
    sites: Sites | None = None

    @property
    def radius_mm(self) -> float:
        """Radius of the circle of the punch's area. [mm]"""
        return self.punch.radius_mm

    @property
    def best(self) -> Candidate:
        """The recommended design as it was evaluated."""
        return self.recommended.candidate

    @property
    def shape(self) -> PadShape:
        """Shape of the recommended pad."""
        return self.recommended.shape

    @property
    def recipe(self) -> tuple[tuple[str, float], ...]:
        """What to weigh for the recommended pad. [g]"""
        return self.recommended.recipe

    @property
    def batch(self) -> dict[str, Any]:
        """What to mix for the recommended pad, and how much of it to pour."""
        return self.recommended.batch

    @property
    def force_law(self) -> str:
        """Where the elastic forces come from, in words; empty for a law of the user's own."""
        made_by = self.law.provenance.get("command", "")
        return f"response table of {self.shape.name} pads, made by {made_by}" if made_by else ""

    def to_dict(self) -> dict[str, Any]:
        """Return the answer in the form of the ``suggest`` contract."""
        slope = self.resin.log_slope(self.best.ratio)
        return {
            "verdict": self.verdict.to_dict(),
            "castings": castings_dict(self.castings.castings, self.verdict),
            "measure_first": self.measure_first.to_dict(),
            "choice": {
                **self.choice.to_dict(),
                "expectation": self.expectation.to_dict(),
                "weights": self.targets.weights.to_dict(),
            },
            "calibration": self.calibration,
            "recommendation": design_dict(self.recommended, self.resin, self.targets),
            "alternatives": [design_dict(other, self.resin, self.targets) for other in self.alternatives],
            "sensitivity": {"d_ln_young_per_percent_ratio": 0.01 * slope, **self.pour.to_dict()},
            "verification": self.verification.to_dict(),
            "shapes": [item.to_dict() for item in self.beside],
            "tissue_exponent": self.targets.power,
            "landing": self.centring.to_dict() if self.centring else None,
            "sites": self.sites.to_dict(self.shape) if self.sites else None,
            "rests_on": dict(self.rests_on),
            "warnings": [dict(item) for item in self.warnings],
            "sources": [*self.tissue.sources, *self.resin.references, *filter(None, [self.force_law])],
        }


def design_dict(design: Design, resin: Resin, targets: Targets) -> dict[str, Any]:
    """Return one design as plain values.

    Parameters
    ----------
    design : Design
    resin, targets
        What it was made for.
    """
    candidate, recipe = design.candidate, design.recipe
    index, evaluation = candidate.index, candidate.evaluation
    parameters = None
    if candidate.parameters is not None:
        parameters = {name: _plain(value) for name, value in candidate.parameters.to_dict().items() if name != "law"}
    return {
        "resin": resin.name,
        "ratio": candidate.ratio,
        "ratio_meaning": resin.ratio_meaning,
        "shape": str(design.shape),
        "thickness_mm": candidate.thickness_mm,
        "young_kPa": resin.modulus_kPa(candidate.ratio).to_dict(),
        "prony": [term.to_dict() for term in resin.prony(candidate.ratio)],
        "recipe": {
            "components": [{"name": name, "mass_g": mass} for name, mass in recipe],
            "total_g": round(sum(mass for _, mass in recipe), 6),
        },
        "batch": design.batch,
        "parameters": parameters,
        "parameters_law": targets.tissue.law,
        "scores": {
            "total": candidate.total,
            "steady_state_range": float(evaluation.steady_state_range[index]),
            "force_variation_range": float(evaluation.force_variation_range[index]),
            "aim": float(evaluation.aim[index]),
            "parametric": candidate.parametric if targets.parametric else None,
            "low_force_range": float(evaluation.low_force_range[index]),
        },
        "conditions": condition_rows(candidate, targets, design.shape),
        "low_force": _low_force(candidate, targets),
        "from_first_touch": low_force(candidate, targets).to_dict(),
    }


def castings_dict(castings: Castings, verdict: Verdict) -> dict[str, Any]:
    """The castings of an answer: how many, what they are drawn by and over, and the share of each class."""
    groups = [group for group in GROUPS if group != TISSUE]
    return {"n": castings.n, "seed": castings.seed, "groups": groups, **(verdict.castings or {})}


def condition_rows(candidate: Candidate, targets: Targets, shape: PadShape) -> list[dict[str, Any]]:
    """One row a condition; a condition out of reach has no depth and gives the reason.

    Parameters
    ----------
    candidate : Candidate
    targets : Targets
    shape : PadShape
        Of the pad, for the gel under the punch.
    """
    rows = []
    gel = candidate.thickness_mm - shape.bone_height_mm
    for column, condition in enumerate(targets.conditions):
        depth = float(candidate.evaluation.depth_mm[candidate.index, column])
        reached = bool(np.isfinite(depth))
        press = candidate.evaluation.presses[column]
        peak = float(press.peak_N[candidate.index]) if reached else None
        low, high = condition.range.peak_low_N, condition.range.peak_high_N
        reads, outside = _reads(peak, low, high)
        rows.append(
            {
                "steady_force_N": condition.steady_force_N,
                "velocity_mm_s": condition.velocity_mm_s,
                "depth_mm": depth if reached else None,
                "depth_over_thickness": depth / candidate.thickness_mm if reached else None,
                "gel_compression": depth / gel if reached else None,
                "peak_force_N": peak,
                "target_peak_low_N": low,
                "target_peak_high_N": high,
                "reads": reads,
                "percent_outside": outside,
                "inside_fraction": float(candidate.evaluation.inside[candidate.index, column]),
                "out_of_reach": None if reached else _why(candidate, condition.steady_force_N),
            }
        )
    return rows


def _reads(peak_N: float | None, low_N: float, high_N: float) -> tuple[str | None, float | None]:
    """Whether a peak is inside, low or high, and by how many per cent it is outside; None where out of reach."""
    if peak_N is None:
        return None, None
    if low_N / peak_N > 1.0 + TOLERANCE:
        return "low", 100.0 * (1.0 - peak_N / low_N)
    if peak_N / high_N > 1.0 + TOLERANCE:
        return "high", 100.0 * (peak_N / high_N - 1.0)
    return "inside", 0.0


def _why(candidate: Candidate, force_N: float) -> str:
    slabs = candidate.evaluation.slabs
    limit = float(slabs.curves.limit_mm[slabs.slab[candidate.index]])
    share = limit / candidate.thickness_mm
    return f"{force_N:g} N steady needs more than {limit:.1f} mm, {share:.2f} of the thickness; the gel bottoms out"


def _low_force(candidate: Candidate, targets: Targets) -> list[dict[str, Any]]:
    """Depths at small steady forces beside the tissue's extrapolated range."""
    grid = targets.protocol.low_grid_N
    forces = [float(f"{share * targets.protocol.forces_N[0]:.6g}") for share in LOW_SHARES]
    stiff, soft = targets.depth_range_mm(np.array(forces))
    rows = []
    for force, low, high in zip(forces, stiff, soft):
        column = int(np.argmin(np.abs(grid - force)))
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

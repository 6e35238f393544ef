"""The answer of a design request with all its objects: its verification, its mould, its values by the contract."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.design.assessment.budget import Budget
from dummydesign.design.assessment.curves import CurveMatch
from dummydesign.design.assessment.decision import Choice, ShapeComparison, low_force
from dummydesign.design.assessment.pad_castings import PadCastings, PourYield, Shares
from dummydesign.design.crown_array import Sites
from dummydesign.design.problem import Problem, recipe_and_batch
from dummydesign.design.request import Request
from dummydesign.design.scoring.castings import GROUPS
from dummydesign.design.scoring.targets import Targets, shares_below
from dummydesign.design.scoring.verdict import TOLERANCE, Verdict
from dummydesign.design.search.slabs import DesignCandidate, ScoreMap
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch
from dummydesign.mold.moulded_pads import mould_command
from dummydesign.pad.force_law import ForceLaw
from dummydesign.resin.model.resin import Resin
from dummydesign.tissue.model.tissue import Tissue

# Forces below the lowest of the test at which depths are listed, over that force.
LOW_SHARES = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Suggestion:
    """The answer: verdict, shares, recommended design and the others, the search, verification, and its basis.

    ``law`` is the force law in proportion with thickness, ``cast`` that of the shape as it is cast, from elements
    when it was verified; ``comparisons`` the best design of each kind of shape; ``centring`` how far off the centre of
    a crown the punch may press (with verification); ``warnings`` are {code, message}; ``sites`` the grid of crowns,
    where several were requested; ``other_mould`` what the best other mould would be worth, where one was kept.
    """

    problem: Problem
    score_map: ScoreMap
    verdict: Verdict
    castings: PadCastings
    shares: Shares
    best: DesignCandidate
    alternatives: tuple[DesignCandidate, ...]
    law: ForceLaw
    cast: ForceLaw
    comparisons: tuple[ShapeComparison, ...]
    pour: PourYield
    verification: Verification
    centring: CentringTolerance | None
    rests_on: dict[str, Any]
    warnings: tuple[dict[str, str], ...]
    choice: Choice
    curves: CurveMatch
    budget: Budget | None
    sites: Sites | None
    other_mould: dict[str, Any] | None

    @property
    def request(self) -> Request:
        """The question."""
        return self.problem.request

    @property
    def tissue(self) -> Tissue:
        """The tissue that the pad stands for."""
        return self.problem.tissue

    @property
    def resin(self) -> Resin:
        """The resin, as a calibration changes it."""
        return self.problem.resin

    @property
    def targets(self) -> Targets:
        """What the pad is compared with."""
        return self.problem.targets

    @property
    def punch(self) -> Punch:
        """The punch of the test."""
        return self.problem.punch

    @property
    def calibration(self) -> dict[str, Any] | None:
        """What was used of a calibration and what it left; None without one."""
        return None if self.problem.calibrated is None else self.problem.calibrated.summary

    @property
    def radius_mm(self) -> float:
        """Radius of the circle of the punch's area. [mm]"""
        return self.punch.radius_mm

    @property
    def batch(self) -> dict[str, Any]:
        """What to mix for the recommended pad, and how much of it to pour. [g]"""
        return recipe_and_batch(self.problem.mould(self.best))[1]

    @property
    def shape(self) -> PadShape:
        """Shape of the recommended pad."""
        return self.best.shape

    @property
    def mould_command(self) -> str:
        """The command that makes the mould of the recommended pad."""
        best, request = self.best, self.request
        outline = None if request.pad_mm == (PAD_LENGTH_MM, PAD_WIDTH_MM) else request.pad_mm
        preset = "" if request.preset == "open" else request.preset
        return mould_command(best.thickness_mm, best.ratio, str(self.shape), request.resin, outline, preset)

    def to_dict(self) -> dict[str, Any]:
        """Return the answer in the form of the ``suggest`` contract, without the question, what is next and files."""
        made_by = self.law.provenance.get("command", "")
        force_law = [f"response table of {self.shape.name} pads, made by {made_by}"] if made_by else []
        sources = [*self.tissue.sources, *self.resin.references, *force_law]
        castings, verdict, shares = self.castings.castings, self.verdict.to_dict(), self.shares.to_dict()
        drawn = {"n": castings.n, "seed": castings.seed, "groups": list(GROUPS)}
        recommendation = design_dict(self.best, self.problem)
        return {
            "verdict": verdict,
            "batch_measured": self.resin.measured,
            "window_kPa": shares.pop("window_kPa"),
            "shares": {**shares, "as_poured": {**shares["as_poured"], **drawn}},
            "people": shares_below(self.targets, self.best.readings.peak_N).to_dict(),
            "choice": {**self.choice.to_dict(), "weights": self.targets.weights.to_dict()},
            "curves": to_plain(self.curves),
            "budget": to_plain(self.budget),
            "calibration": self.calibration,
            "recommendation": recommendation,
            "alternatives": [design_dict(other, self.problem) for other in self.alternatives],
            "sensitivity": {
                "d_ln_young_per_percent_ratio": 0.01 * self.resin.log_slope(self.best.ratio),
                **self.pour.to_dict(),
            },
            "verification": self.verification.to_dict(),
            "shapes": to_plain(self.comparisons),
            "tissue_exponent": self.targets.power,
            "landing": to_plain(self.centring),
            "sites": self.sites.to_dict(self.shape) if self.sites else None,
            "other_mould": self.other_mould,
            "rests_on": self.rests_on,
            "warnings": list(self.warnings),
            "sources": sources,
        }


def design_dict(candidate: DesignCandidate, problem: Problem) -> dict[str, Any]:
    """Return one design as plain values, with what it takes and what to mix for it."""
    resin, targets = problem.resin, problem.targets
    recipe, batch = recipe_and_batch(problem.mould(candidate))
    at, one = candidate.index, candidate.evaluation
    fitted = {} if candidate.parameters is None else to_plain(candidate.parameters.to_dict())
    return {
        "resin": resin.name,
        "ratio": candidate.ratio,
        "ratio_meaning": resin.ratio_meaning,
        "shape": str(candidate.shape),
        "thickness_mm": candidate.thickness_mm,
        "young_kPa": resin.modulus_kPa(candidate.ratio).to_dict(),
        "prony": to_plain(resin.prony(candidate.ratio)),
        "recipe": recipe,
        "batch": batch,
        "parameters": {name: value for name, value in fitted.items() if name != "law"} or None,
        "parameters_law": targets.tissue.law,
        "scores": {
            "total": candidate.total,
            "steady_state_range": float(one.steady_state_range[at]),
            "force_variation_range": float(one.force_variation_range[at]),
            "aim": float(one.aim[at]),
            "parametric": candidate.parametric if targets.parametric else None,
            "low_force_range": float(one.low_force_range[at]),
        },
        "conditions": condition_rows(candidate, targets, candidate.shape),
        "low_force": _low_force(candidate, targets),
        "from_first_touch": low_force(candidate, targets).to_dict(),
    }


def condition_rows(candidate: DesignCandidate, targets: Targets, shape: PadShape) -> list[dict[str, Any]]:
    """One row a condition; a condition out of reach has no depth and gives the reason."""
    rows, at, thickness = [], candidate.index, candidate.thickness_mm
    gel, limit = thickness - shape.bone_height_mm, candidate.limit_mm
    for column, condition in enumerate(targets.conditions):
        steady_mm = float(candidate.depth_mm[column])
        depth = steady_mm if np.isfinite(steady_mm) else None
        peak = None if depth is None else float(candidate.evaluation.presses[column].peak_N[at])
        low, high = condition.range.peak_low_N, condition.range.peak_high_N
        reads, outside = _reads(peak, low, high)
        why = (
            None
            if depth is not None
            else (
                f"{condition.steady_force_N:g} N steady needs more than {limit:.1f} mm, {limit / thickness:.2f} of the "
                "thickness; the gel bottoms out"
            )
        )
        rows.append(
            {
                "steady_force_N": condition.steady_force_N,
                "velocity_mm_s": condition.velocity_mm_s,
                "depth_mm": depth,
                "depth_over_thickness": None if depth is None else depth / thickness,
                "gel_compression": None if depth is None else depth / gel,
                "peak_force_N": peak,
                "target_peak_low_N": low,
                "target_peak_high_N": high,
                "reads": reads,
                "percent_outside": outside,
                "inside_fraction": float(candidate.evaluation.inside[at, column]),
                "out_of_reach": why,
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


def _low_force(candidate: DesignCandidate, targets: Targets) -> list[dict[str, Any]]:
    """Depths at small steady forces beside the tissue's extrapolated range."""
    forces = [float(f"{share * targets.protocol.forces_N[0]:.6g}") for share in LOW_SHARES]
    columns = [int(np.argmin(np.abs(targets.protocol.low_grid_N - force))) for force in forces]
    depths = candidate.evaluation.low_depth_mm[candidate.index, columns]
    names = ("force_N", "depth_mm", "tissue_depth_low_mm", "tissue_depth_high_mm")
    stiff, soft = targets.depth_range_mm(np.array(forces))
    return [to_plain(dict(zip(names, row))) for row in zip(forces, depths, stiff, soft)]


def make_mould(answer: Suggestion, folder: Path) -> dict[str, Any]:
    """Make the mould of the recommended pad into a folder; return it with its files, warnings and sources."""
    from dummydesign.mold import client

    best = answer.best
    try:
        spec = answer.problem.mould(best)
        spec = replace(spec, pour=replace(spec.pour, usable_kPa=answer.shares.window_kPa or ()))
        return client.make_mold(spec, folder).to_dict() | {"sources": list(spec.sources)}
    except NoAnswerError as problem:
        message = f"{problem}; the recipe stands, the mould is missing: then run '{answer.mould_command}'"
        raise NoAnswerError(problem.code, message, quantity=problem.quantity) from None


@dataclass(frozen=True)
class Verification(Serialised):
    """Elastic forces of the table and of the finite-element solve at the same depths.

    ``max_difference_percent`` is None when the solve was not made; ``notes`` then say why.
    """

    fidelity: str
    max_difference_percent: float | None
    depth_mm: tuple[float, ...] = ()
    table_force_N: tuple[float, ...] = ()
    solved_force_N: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()


# The largest loss of force of the crowns solved in space is 2 % at 1 mm off centre (docs/shapes.md).
LOSS_PERCENT = 1.0


@dataclass(frozen=True)
class CentringTolerance(Serialised):
    """Contact radius at each steady force, and the way the punch may be moved until its side meets the contact."""

    force_N: tuple[float, ...]
    contact_radius_mm: tuple[float | None, ...]
    margin_mm: tuple[float | None, ...]

    @property
    def text(self) -> str:
        """The margins as a sentence."""
        free = [f"{m:.1f} mm at {f:g} N" for f, m in zip(self.force_N, self.margin_mm) if m is not None and m >= 0.05]
        wide = [f"{f:g}" for f, m in zip(self.force_N, self.margin_mm) if m is not None and m < 0.05]
        parts = [f"no effect within {', '.join(free)}"] if free else []
        if wide:
            parts.append(
                f"at {', '.join(wide)} N the force falls by at most {LOSS_PERCENT:g} % per 0.5 mm, up to 1 mm "
                "(docs/shapes.md)"
            )
        return f"punch off the crown's centre: {'; '.join(parts)}"

"""What a user must know beside the numbers: out of reach, edges of the search, and what is not measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.tissue.model.maxwell_law import law_named

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dummydesign.design.assessment.decision import ShapeComparison
    from dummydesign.design.assessment.pad_castings import PourYield
    from dummydesign.design.search.shape_search import ShapedDesign
    from dummydesign.design.search.slabs import DesignCandidate, SearchSpace
    from dummydesign.design.suggestion import CentringTolerance, Verification
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue

WEAK = ("inferred", "assumed")
DRAWS = 2000
Warnings = list[tuple[str, str]]


def count_unmeasured(resin: Resin, tissue: Tissue, best: DesignCandidate) -> dict[str, Any]:
    """Say how much of an answer rests on inferred or assumed numbers, and what that does to the ratio.

    Counted are the numbers that decide the design: the tissue's parameters, the modulus law and the
    relaxation of the resin. ``ratio_low`` and ``ratio_high`` bound (95 %) the ratio that really gives the
    wanted modulus, over what is not known of the resin; None where that lies outside the resin's range.
    """
    numbers = {
        "tissue": [quantity for subject in tissue.subjects for quantity in _leaves(subject.numbers)],
        "resin": [*resin.numbers.values(), *(arm.beta for arm in resin.arms), resin.softness_exponent],
    }
    weak = {name: sum(quantity.kind in WEAK for quantity in listed) for name, listed in numbers.items()}
    count = {name: len(listed) for name, listed in numbers.items()}
    wanted = resin.young_MPa(best.ratio) * 1e3
    with np.errstate(invalid="ignore"):
        ratios = resin.law.ratio(wanted, resin.draw(DRAWS).numbers)
    low, high = (float(end) for end in np.percentile(ratios, [2.5, 97.5]))
    text = (
        f"{sum(weak.values())} of the {sum(count.values())} numbers that decide this design are inferred or assumed "
        f"(tissue {weak['tissue']} of {count['tissue']}, resin {weak['resin']} of {count['resin']}). "
        f"The design needs {wanted:.3g} kPa; given the uncertainty of the resin, the ratio that gives it "
        f"lies between {low:.2f} and {high:.2f} (95 %)."
    )
    return {
        "numbers": sum(count.values()),
        "inferred_or_assumed": sum(weak.values()),
        **{name: {"numbers": count[name], "inferred_or_assumed": weak[name]} for name in numbers},
        "wanted_young_kPa": wanted,
        "ratio_low": low,
        "ratio_high": high,
        "text": text,
    }


def _leaves(numbers: dict[str, Any]) -> list[Any]:
    return [one for value in numbers.values() for one in (value.values() if isinstance(value, dict) else [value])]


def design_warnings(
    chosen: ShapedDesign,
    best: DesignCandidate,
    comparisons: Sequence[ShapeComparison],
    space: SearchSpace,
    tissue: Tissue,
    pour: PourYield,
    verification: Verification,
    centring: CentringTolerance | None,
    verify: bool,
) -> Warnings:
    """List what is out of reach, at an edge, doubtful or contradictory, as (code, message)."""
    notes = _of_forces(chosen, best, len(comparisons), space)
    notes += [("off_centre", centring.text)] if centring else []
    notes += [("no_shape", reason) for reason in _reasons(comparisons)]
    notes += _edges(best, space)
    alone = len(tissue.subjects) < 2
    if alone:
        text = f"{tissue.name} has one subject, who makes no range: shares in range and of castings mean nothing"
        notes.append(("one_subject", f"{text}; scores and verdict compare the pad with this one person"))
    notes += _of_speeds(space, tissue)
    if pour.yield_fraction < 0.5 and not alone:
        share, exact = 100 * pour.yield_fraction, 100 * pour.making_only_fraction
        text = f"{share:.0f} % of castings are in the steady-state range"
        notes.append(("low_yield", f"{text} ({exact:.0f} % of an average batch)"))
    notes += [("calibration", note) for note in chosen.law.notes]
    missed = [force for force in space.targets.protocol.forces_N if force not in pour.judged_at_N]
    if missed and not alone:
        *first, last = (f"{force:g}" for force in missed)
        where = f"{', '.join(first)} and {last}" if first else last
        notes.append(("outside_steady_range", f"the steady curve is outside the tissue's range at {where} N"))
    notes += _of_data(space.resin, tissue)
    off = verification.max_difference_percent
    if off is not None and off > 1.0 and chosen.shape.plain:
        notes.append(("table_error", f"the table differs by {off:.1f} % from the finite-element solution"))
    notes += [("verification", note) for note in verification.notes if verify]
    return notes


def _of_forces(chosen: ShapedDesign, best: DesignCandidate, kinds: int, space: SearchSpace) -> Warnings:
    """Conditions out of reach, and a start that is too stiff."""
    notes = []
    for column, condition in enumerate(space.targets.conditions):
        if not np.isfinite(best.depth_mm[column]):
            force, speed = condition.steady_force_N, condition.velocity_mm_s
            notes.append(("out_of_reach", f"{force:g} N at {speed:g} mm/s is out of reach and counts as out of range"))
    low = float(best.evaluation.low_force_range[best.index])
    if low < 0.5:
        lowest = space.targets.protocol.forces_N[0]
        share = f"below {lowest:g} N only {100 * low:.0f} % of the steady curve lies in the (extrapolated) range: "
        notes.append(("stiff_at_first_touch", share + _why_stiff(chosen, kinds)))
    return notes


def _of_speeds(space: SearchSpace, tissue: Tissue) -> Warnings:
    """Speeds that are designed for and at which no subject was measured."""
    notes = [] if tissue.notice is None else [tissue.notice]
    asked = sorted({condition.velocity_mm_s for condition in space.targets.conditions})
    near = 1.15 if tissue.measured else 1.5
    far = [v for v in asked if all(max(v / known, known / v) > near for known in tissue.velocities_mm_s)]
    there, known = (" and ".join(f"{v:g}" for v in speeds) for speeds in (far, tissue.velocities_mm_s))
    if tissue.measured:
        text = f"nobody was pressed at {there} mm/s: what {tissue.name} does there lies between its curves"
    else:
        text = (
            f"{tissue.name} is known at {known} mm/s only: what it does at {there} mm/s is extrapolated by its dampers"
        )
    if far and (tissue.measured or law_named(tissue.law).fitted):
        notes.append(("speed_not_in_band", f"{text}, not a measurement"))
    return notes


def _of_data(resin: Resin, tissue: Tissue) -> Warnings:
    """Numbers that contradict each other, and those that nobody measured."""
    notes = [("contradictory_points", text) for text in resin.contradictions]
    weak_tissue = [kind for kind in tissue.kinds if kind in WEAK]
    if weak_tissue:
        text = f"the parameters of {tissue.name} are {' and '.join(weak_tissue)}, not measured"
        notes.append(("inferred_tissue", text))
    weak = resin.uncertain()
    if weak:
        text = f"{len(weak)} numbers of resin {resin.name} are inferred or assumed, not measured"
        notes.append(("not_measured", f"{text}; 'dummydesign resins show {resin.name}' lists them"))
    return notes


def _why_stiff(chosen: ShapedDesign, kinds: int) -> str:
    if not chosen.shape.flat_top:
        return "the shape starts stiffer or softer than tissue there"
    text = "a flat pad starts far more linear than tissue, whatever its ratio"
    # other kinds were compared already where rows of them are beside it
    return text if kinds > 1 else f"{text}; '--shape auto' looks for others"


def _reasons(comparisons: Sequence[ShapeComparison]) -> list[str]:
    """Why kinds have no design, in one line those that share a reason."""
    kinds: dict[str, list[str]] = {}
    for item in comparisons:
        if item.reason:
            own = item.reason.startswith(f"{item.kind} pads ")
            reason = item.reason.removeprefix(f"{item.kind} ") if own else item.reason
            kinds.setdefault(reason, []).extend([item.kind] if own else [])
    return [f"{', '.join(names)} {reason}".strip() for reason, names in kinds.items()]


def _edges(best: DesignCandidate, space: SearchSpace) -> Warnings:
    """A best design at the end of a range: what may be had outside, where there is an outside."""
    resin = space.resin
    ends = float(resin.young_MPa(resin.ratio_min)), float(resin.young_MPa(resin.ratio_max))
    others = ("softer", "stiffer") if ends[0] < ends[1] else ("stiffer", "softer")
    notes = []
    for name, value, steps, limits, beyond in (
        (
            "thickness",
            best.thickness_mm,
            space.thickness_mm,
            space.allowed_mm,
            ("no thinner pad is designed", "no thicker pad is designed"),
        ),
        (
            "ratio",
            best.ratio,
            space.ratio,
            (resin.ratio_min, resin.ratio_max),
            [f"the limit of {resin.name}, try a {other} resin" for other in others],
        ),
    ):
        if len(steps) < 2 or value not in (steps[0], steps[-1]):
            continue
        at = int(value != steps[0])
        advice = f"widen --{name}" if abs(value - limits[at]) > 1e-6 else beyond[at]
        text = f"the best {name} {value:g} is at the limit of the range searched; {advice}"
        notes.append(("at_edge", text))
    return notes

"""The main job: from a tissue and an aim to ratio, thickness, recipe and reasons."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.design.assessment.centring import Landing, landing
from dummydesign.design.assessment.pour_yield import Tolerances, Yield, pour_yield
from dummydesign.design.assessment.verification import Verification, not_verified, of_shape, verify_design
from dummydesign.design.assessment.warnings import design_warnings, rests_on
from dummydesign.design.scoring.presses import ForceLaw, Sampling, make_curves
from dummydesign.design.scoring.targets import FORCES_N, Targets, make_targets
from dummydesign.design.search.best_of_kinds import Beside, Chosen, choose, kinds_of
from dummydesign.design.search.shape_family import ShapeLaw
from dummydesign.design.search.slabs import THICKNESS_MM, Candidate, SearchResult, search, thickness_steps
from dummydesign.design.suggestion import design_dict
from dummydesign.geometry.shapes import Shape, Slab
from dummydesign.pad.tables.punch import punch_law

if TYPE_CHECKING:
    from dummydesign.mold.model.spec import MouldSpec
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue

PUNCH_SIDE_MM = 14.0
PUNCH = f"square:{PUNCH_SIDE_MM:g}"
RADIUS_MM = PUNCH_SIDE_MM / math.sqrt(math.pi)
"""Circle of the area of the paper's 14 x 14 mm impactor. [mm]"""
PAD_LENGTH_MM, PAD_WIDTH_MM = 150.0, 120.0
SLAB = Slab()
LOW_FORCES_N = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0)


@dataclass(frozen=True)
class Request:
    """What is asked for. Ranges are (low, high) with both ends included, None for all that is allowed."""

    tissue: str
    aim: str = "average"
    resin: str = "polyurethane-nagoya"
    thickness_mm: tuple[float, float] | None = None
    ratio: tuple[float, float] | None = None
    shape: str = "slab"
    verify: bool = True
    hold_s: float = 10.0
    deceleration_mm_s2: float = 30_000.0
    weighing_g: float = 0.1
    thickness_tolerance_mm: float = 0.2
    calibration: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return what was asked, defaults included."""
        return asdict(self)


@dataclass(frozen=True, kw_only=True)
class Suggestion:
    """The answer: the search, the tolerance study, the verification, and all it was made from.

    ``law`` is the force law in proportion with thickness, ``cast`` that of the shape as it is cast, from elements
    when it was verified; ``beside`` the best design of each kind of shape, ``landing`` how far off the centre of a
    crown the punch may land (with verification).
    """

    request: Request
    tissue: Tissue
    resin: Resin
    targets: Targets
    found: SearchResult
    pour: Yield
    verification: Verification
    recipe: tuple[tuple[str, float], ...]
    law: ForceLaw
    cast: ForceLaw
    shape: Shape = SLAB
    beside: tuple[Beside, ...] = ()
    landing: Landing | None = None

    @property
    def force_law(self) -> str:
        """Where the elastic forces come from, in words; empty for a law of the user's own."""
        made_by = getattr(self.law, "provenance", {}).get("command", "")
        return f"response table of {self.shape.name} pads, made by {made_by}" if made_by else ""

    @property
    def best(self) -> Candidate:
        """The recommended design."""
        return self.found.best

    def shape_of(self, candidate: Candidate) -> Shape:
        """Shape of the best design or, in proportion to its thickness, of an alternative."""
        if candidate is self.best or not isinstance(self.law, ShapeLaw):
            return self.shape
        return self.law.shape_at(candidate.thickness_mm)

    def to_dict(self) -> dict[str, Any]:
        """Return the answer in the form of the ``suggest`` contract."""
        best = design_dict(self.best, self.resin, self.targets, self.recipe, self.shape)
        slope = self.resin.log_slope(self.best.ratio)
        return {
            "recommendation": best,
            "alternatives": [
                design_dict(other, self.resin, self.targets, pour_recipe(self.resin, other, shape), shape)
                for other, shape in zip(self.found.alternatives, map(self.shape_of, self.found.alternatives))
            ],
            "sensitivity": {
                "d_ln_young_per_percent_ratio": 0.01 * slope,
                **{key: value for key, value in self.pour.to_dict().items()},
            },
            "verification": self.verification.to_dict(),
            "shapes": [item.to_dict() for item in self.beside],
            "landing": self.landing.to_dict() if self.landing else None,
            "rests_on": rests_on(self.resin, self.tissue, self.best),
            "warnings": design_warnings(self),
            "sources": [*self.tissue.sources, *self.resin.references, *filter(None, [self.force_law])],
        }


def suggest(request: Request, law: ForceLaw | None = None) -> Suggestion:
    """Find ratio, thickness and, if asked for, shape of a pad for a tissue, with tolerance study and verification.

    Parameters
    ----------
    request : Request
        Tissue, aim, resin and limits.
    law : ForceLaw, optional
        Elastic force of slabs; the response table of the bonded slab by default.

    Returns
    -------
    Suggestion

    Raises
    ------
    InputError
        For unknown names or ranges outside what is allowed.
    NoAnswerError
        ``no_feasible_design`` when no slab reaches 10 N steady.
    """
    tissue, resin, thickness, ratio = accept(request)
    sampling = Sampling(hold_s=request.hold_s, deceleration_mm_s2=request.deceleration_mm_s2)
    targets = make_targets(tissue, request.aim, sampling)
    reason = "not asked for"
    if request.calibration is not None:
        from dummydesign.design.calibrated import with_calibration

        resin, law, _ = with_calibration(resin, request.calibration)
        reason = "designed with a calibration: its correction rests on the campaign, the table below it on elements"
    if law is None:
        from dummydesign.pad.tables.slab import load_table

        law = punch_law(load_table(base="bonded"), PUNCH)
    if is_slab(request.shape):
        chosen = Chosen(Slab(), search(law, resin, targets, thickness, ratio, RADIUS_MM, sampling), law, law, ())
    else:
        chosen = choose(request.shape, law, resin, targets, thickness, ratio, RADIUS_MM, sampling, request.verify)
    best = chosen.found.best
    recipe = pour_recipe(resin, best, chosen.shape)
    poured = sum(mass for name, mass in recipe if not name.endswith("(base)"))
    tolerances = Tolerances(poured, request.weighing_g, request.thickness_tolerance_mm)
    pour = pour_yield(chosen.cast, resin, targets, best.thickness_mm, best.ratio, RADIUS_MM, tolerances)
    checked, lands = not_verified(reason), None
    if request.verify and request.calibration is None:
        checked = _verify(best, resin, chosen.cast, chosen.shape)
        lands = landing(best, chosen.shape, RADIUS_MM, 0.5 * PUNCH_SIDE_MM)
    return Suggestion(
        request=request,
        tissue=tissue,
        resin=resin,
        targets=targets,
        found=chosen.found,
        pour=pour,
        verification=checked,
        recipe=recipe,
        law=chosen.law,
        cast=chosen.cast,
        shape=chosen.shape,
        beside=chosen.beside,
        landing=lands,
    )


def accept(request: Request) -> tuple[Tissue, Resin, np.ndarray, np.ndarray]:
    """Read what a request names and refuse what is not allowed, before any work.

    Returns
    -------
    tuple
        Tissue, resin, thicknesses [mm] and ratios to search.

    Raises
    ------
    InputError
        For unknown names or ranges outside what is allowed.
    """
    from dummydesign.resin import load_resin
    from dummydesign.tissue.model.tissue_file import load_tissue

    if not is_slab(request.shape):
        kinds_of(request.shape)
        if request.calibration is not None:
            raise InputError(f"shape = {request.shape} cannot be designed with a calibration, which is of a flat slab")
    tissue, resin = load_tissue(request.tissue), load_resin(request.resin)
    tissue.target(request.aim)
    thickness = thickness_steps(*(request.thickness_mm or THICKNESS_MM))
    return tissue, resin, thickness, _ratios(resin, request.ratio)


def is_slab(shape: str) -> bool:
    """Whether a request is for a flat slab."""
    return shape.lower() == Slab.name


def pour_recipe(resin: Resin, candidate: Candidate, shape: Shape | None = None) -> tuple[tuple[str, float], ...]:
    """Masses to weigh for the open mould of a design, with what stays in cup and meniscus; both pours of layers. [g]"""
    from dummydesign.mold.pour.plan import pour_plan

    plan = pour_plan(mould_of(resin, candidate, shape))
    if plan.base is None:
        return plan.components
    return (*plan.components, *((f"{name} (base)", mass) for name, mass in plan.base.components))


def mould_of(resin: Resin, candidate: Candidate, shape: Shape | None = None) -> MouldSpec:
    """Specification of the open mould of a design."""
    from dummydesign.mold.model.preset import mould_spec

    shape = shape or Slab()
    return mould_spec(
        candidate.thickness_mm, PAD_LENGTH_MM, PAD_WIDTH_MM, "open", resin, candidate.ratio,
        shape.name, shape.parameters,
    )  # fmt: skip


def _ratios(resin: Resin, wanted: tuple[float, float] | None) -> np.ndarray:
    """Practical ratios inside the wanted range, which must lie inside the resin's."""
    if wanted is None:
        return resin.ratios()
    resin.check_ratio(wanted)
    ratios = resin.ratios(*wanted)
    if not len(ratios):
        raise InputError(
            f"ratio range {wanted[0]:g}:{wanted[1]:g} holds no step of {resin.ratio_step:g}; "
            f"{resin.name} allows {resin.ratio_min:g} to {resin.ratio_max:g}"
        )
    return ratios


def _verify(best: Candidate, resin: Resin, law: ForceLaw, shape: Shape) -> Verification:
    """Solve the depths of the slow conditions by finite elements; the fast ones differ by micrometres.

    Compared are the forces of the circle of the punch's area, which is what is solved. A design with a shape has
    been worked out on its elements already; what the table was off is said.
    """
    from dummydesign.design.search.resolved_by_fem import ElementsLaw

    if isinstance(law, ElementsLaw):
        return of_shape(law, resin.young_MPa(best.ratio), RADIUS_MM)
    if shape != Slab():
        return not_verified(f"{shape} was designed by its response table; predict --fidelity 3d solves it in minutes")
    law = getattr(law, "circle", law)
    depth = best.evaluation.depth_mm[best.index, : len(FORCES_N)]
    depth = depth[np.isfinite(depth)]
    young = resin.young_MPa(best.ratio)
    table = make_curves(law, [best.thickness_mm], RADIUS_MM)
    depth = depth[depth <= table.limit_mm[0]]
    forces = young * np.asarray(law.force(depth, best.thickness_mm, 1.0, RADIUS_MM))
    return verify_design(best.thickness_mm, young, RADIUS_MM, depth, forces)

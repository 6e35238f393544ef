"""The mould of a design: what to weigh by closed forms, and its files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.assessment.castings import Tolerances
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import PadShape

if TYPE_CHECKING:
    from dummydesign.design.request import Request
    from dummydesign.design.search.slabs import DesignCandidate
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.mold.model.spec import MouldSpec
    from dummydesign.resin.model.resin import Resin


def mould_of(resin: Resin, candidate: DesignCandidate, request: Request, shape: PadShape) -> MouldSpec:
    """Specification of the mould of a design."""
    from dummydesign.mold.model.preset import mould_spec

    return mould_spec(
        candidate.thickness_mm, *request.pad_mm, request.preset, resin, candidate.ratio,
        shape.name, shape.parameters, machines=request.machine, silicone=request.silicone,
    )  # fmt: skip


def recipe_and_batch(spec: MouldSpec) -> tuple[dict[str, Any], dict[str, Any]]:
    """Masses to weigh for a mould, both pours of a layered pad, and what to mix and how much of it to pour. [g]"""
    from dummydesign.mold.pour.plan import batches_of, pour_plan

    plan = pour_plan(spec)
    masses = list(plan.components)
    if plan.base is not None:
        masses += [(f"{name} (base)", mass) for name, mass in plan.base.components]
    components = [{"name": name, "mass_g": mass} for name, mass in masses]
    recipe = {"components": components, "total_g": round(sum(mass for _, mass in masses), 6)}
    return recipe, batches_of(spec, plan)


def tolerances_of(resin: Resin, candidate: DesignCandidate, request: Request, shape: PadShape) -> Tolerances:
    """How well a pad of a design is made: the batch that is mixed is what is weighed."""
    _, batch = recipe_and_batch(mould_of(resin, candidate, request, shape))
    return Tolerances(batch["total_g"], request.weighing_g, request.thickness_tolerance_mm)


def make_mould(answer: Suggestion, folder: Path) -> dict[str, Any]:
    """Make the mould of the recommended pad into a folder; return it with its files, warnings and sources."""
    from dummydesign.mold import runner

    best = answer.best
    try:
        spec = mould_of(answer.resin, best, answer.request, answer.shape)
        return runner.make_mold(spec, folder).to_dict() | {"sources": list(spec.sources)}
    except NoAnswerError as problem:
        step = f"dummydesign mold --thickness {best.thickness_mm:g} --resin {answer.request.resin}"
        step += f" --ratio {best.ratio:g} --shape {answer.shape}"
        if answer.request.pad_mm != (PAD_LENGTH_MM, PAD_WIDTH_MM):
            step += " --length {:g} --width {:g}".format(*answer.request.pad_mm)
        if answer.request.preset != "open":
            step += f" --preset {answer.request.preset}"
        message = f"{problem}; the recipe stands, the mould is missing: then run '{step}'"
        raise NoAnswerError(problem.code, message, quantity=problem.quantity) from None

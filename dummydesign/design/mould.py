"""The mould of a design: what to weigh by closed forms, its files, and the recipe by the volumes of the solids."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.assessment.castings import Tolerances
from dummydesign.geometry.shapes import PadShape, Slab
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM

if TYPE_CHECKING:
    from dummydesign.design.request import Request
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.mold.model.spec import MouldSpec
    from dummydesign.resin.model.resin import Resin



def pour_recipe(
    resin: Resin, candidate: Candidate, request: Request, shape: PadShape | None = None
) -> tuple[tuple[str, float], ...]:
    """Masses to weigh for the mould of a design, with what stays in cup and meniscus; both pours of layers.

    Parameters
    ----------
    resin : Resin
        What is poured.
    candidate : Candidate
        Thickness and ratio.
    request : Request
        Size of the pad, mould preset, machine and silicone.
    shape : PadShape, optional
        A flat slab by default.

    Returns
    -------
    tuple of (str, float)
        Name and mass of each component. [g]
    """
    from dummydesign.mold.pour.plan import pour_plan

    plan = pour_plan(mould_of(resin, candidate, request, shape))
    if plan.base is None:
        return plan.components
    return (*plan.components, *((f"{name} (base)", mass) for name, mass in plan.base.components))


def pour_batch(
    resin: Resin, candidate: Candidate, request: Request, shape: PadShape | None = None
) -> dict[str, Any]:
    """What to mix and how much of it to pour, in plain values; see :func:`dummydesign.mold.pour.batch.batches_of`.

    Parameters
    ----------
    resin, candidate, request, shape
        As for :func:`pour_recipe`.
    """
    from dummydesign.mold.pour.batch import batches_of
    from dummydesign.mold.pour.plan import pour_plan

    spec = mould_of(resin, candidate, request, shape)
    return batches_of(spec, pour_plan(spec))


def tolerances_of(
    resin: Resin, candidate: Candidate, request: Request, shape: PadShape | None = None
) -> Tolerances:
    """How well a pad of a design is made: the batch that is mixed is what is weighed.

    Parameters
    ----------
    resin, candidate, request, shape
        As for :func:`pour_recipe`.
    """
    mixed_g = pour_batch(resin, candidate, request, shape)["total_g"]
    return Tolerances(mixed_g, request.weighing_g, request.thickness_tolerance_mm)


def mould_of(resin: Resin, candidate: Candidate, request: Request, shape: PadShape | None = None) -> MouldSpec:
    """Specification of the mould of a design.

    Parameters
    ----------
    resin : Resin
        What is poured.
    candidate : Candidate
        Thickness and ratio.
    request : Request
        Size of the pad, mould preset, machine and silicone.
    shape : PadShape, optional
        A flat slab by default.

    Returns
    -------
    MouldSpec
    """
    from dummydesign.mold.model.preset import mould_spec

    shape = shape or Slab()
    return mould_spec(
        candidate.thickness_mm, *request.pad_mm, request.preset, resin, candidate.ratio,
        shape.name, shape.parameters, machines=request.machine, silicone=request.silicone,
    )  # fmt: skip


def with_mould(result: dict[str, Any], answer: Suggestion, folder: Path) -> dict[str, Any]:
    """Make the mould of the recommended pad into a folder and return the answer with it.

    Parameters
    ----------
    result : dict
        The answer in values; it is not changed.
    answer : Suggestion
        The answer with its objects.
    folder : Path
        Where the files of the mould go.

    Returns
    -------
    dict
        ``result`` with ``mold``, its files, warnings and sources, and the recipe by the volumes of the solids.

    Raises
    ------
    NoAnswerError
        Without CAD or when the mould fails a check; the message names the command that makes it later, the recipe
        of the closed forms stands in the error's ``result``.
    """
    from dummydesign.mold import runner

    best = answer.best
    try:
        spec = mould_of(answer.resin, best, answer.request, answer.shape)
        mould = runner.make_mold(spec, folder).to_dict()
    except NoAnswerError as problem:
        step = f"dummydesign mold --thickness {best.thickness_mm:g} --resin {answer.request.resin}"
        step += f" --ratio {best.ratio:g} --shape {answer.shape}"
        if answer.request.pad_mm != (PAD_LENGTH_MM, PAD_WIDTH_MM):
            step += " --length {:g} --width {:g}".format(*answer.request.pad_mm)
        if answer.request.preset != "open":
            step += f" --preset {answer.request.preset}"
        message = f"{problem}; the recipe stands, the mould is missing: then run '{step}'"
        raise NoAnswerError(problem.code, message, result) from None
    files, warnings = mould.pop("files"), mould.pop("warnings")
    return {
        **result,
        "recommendation": {**result["recommendation"], "recipe": _recipe(mould["pour"]), "batch": mould["batch"]},
        "warnings": [*result["warnings"], *warnings],
        "sources": [*result["sources"], *(text for text in spec.sources if text not in result["sources"])],
        "files": files,
        "mold": mould,
    }


def _recipe(pour: dict[str, Any]) -> dict[str, Any]:
    """Masses to weigh of one or, for a layered pad, both pours. [g]"""
    pours = [("", pour)] + ([(" (base)", pour["base"])] if "base" in pour else [])
    return {
        "components": [{**item, "name": item["name"] + layer} for layer, one in pours for item in one["components"]],
        "total_g": sum(one["batch_mass_g"] for _, one in pours),
    }

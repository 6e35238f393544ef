"""The problem of a design: everything a request names, read once, as values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json
from dummydesign.design.request import ANSWER, Request
from dummydesign.design.scoring.castings import Castings, Tolerances
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.settings import PadMaking, crown_making, pad_making, puck_error, settings_files
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search.shape_family import Family, under_square, with_elastic_law
from dummydesign.design.search.shape_search import kinds_of
from dummydesign.design.search.slabs import Correct, DesignCandidate, SearchSpace, thickness_steps
from dummydesign.design.test_conditions import (
    check_calibrated,
    check_test,
    correctable,
    own_slab_law,
    standard_press,
    tabulated,
)
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, PUNCH, THICKNESS_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch, read_punch
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.mold.model.preset import Preset, mould_spec, read_preset
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import batches_of, least_film_mm, pour_plan
from dummydesign.pad.force_law import ForceLaw, ScaledLaw
from dummydesign.pad.tables.elastic_law import elastic_factor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.design.calibrated import Calibrated
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem(SearchSpace):
    """What is searched, with the request and all that it names: tissue, test, mould and force law.

    Nothing that works on it reads a user's folder. ``files`` are those that were read, by what they are; they belong to
    the key of an answer. ``wide_mm`` are the thicknesses that would be searched without the mould that is kept, None
    without one.
    """

    request: Request
    tissue: Tissue
    slab_law: ForceLaw
    punch: Punch
    preset: Preset
    files: Mapping[str, Path]
    calibrated: Calibrated | None = None
    wide_mm: NDArray | None = None

    def mould(self, candidate: DesignCandidate) -> MouldSpec:
        """Specification of the mould of a design."""
        return _mould(self.request, self.preset, self.resin, candidate.shape, candidate.thickness_mm, candidate.ratio)


def read_problem(request: Request, law: ForceLaw | None = None) -> Problem:
    """Read tissue, resin, calibration, mould and force law, and lay out what is searched.

    Raises
    ------
    InputError
        For what is not known, or cannot be designed.
    """
    from dummydesign.resin import load_resin
    from dummydesign.tissue.model.tissue_file import load_tissue

    asked, kept = request, None
    if request.mould is not None:
        request, kept = _with_mould(request)
    if request.shape.lower() != Slab.name:
        kinds_of(request.shape)
    punch = read_punch(request.punch)
    check_test(request, punch)
    tissue, resin = load_tissue(request.tissue), load_resin(request.resin)
    if kept is not None:
        _check_mould(kept, str(asked.mould), resin, request.punch)
    sampling = Sampling(hold_s=request.hold_s, deceleration_mm_s2=request.deceleration_mm_s2)
    tissue.target(request.aim)
    steps = thickness_steps(*(asked.thickness_mm or THICKNESS_MM))
    thickness = tabulated(steps if kept is None else np.array([kept.pad.thickness_mm]), request, punch)
    allowed = tabulated(thickness_steps(*THICKNESS_MM), request, punch).tolist()
    ratios = _ratios(resin, request.ratio)
    targets = make_targets(tissue, request.aim, sampling, request.protocol)
    glued = punch.square and request.face == "bonded"
    calibrated: Calibrated | None = None
    corrections: list[Correct] = [under_square] if glued else []
    if request.calibration is not None:
        from dummydesign.design.calibrated import CalibratedFamily, with_calibration

        if not standard_press(request):
            check_calibrated(request, punch, thickness)
            allowed = correctable(request, punch, np.array(allowed))
        calibrated = with_calibration(resin, request.calibration, request.punch, punch.square, request.edge_radius_mm)
        resin, law = calibrated.resin, cast(ForceLaw, calibrated.law)
        corrections.append(cast(Correct, partial(CalibratedFamily, correction=calibrated.law.correction)))
    if law is None:
        law = own_slab_law(request, punch, thickness)
    if (alpha := resin.ogden_alpha) is not None:
        glued = (
            standard_press(replace(request, punch=PUNCH, pad_mm=(PAD_LENGTH_MM, PAD_WIDTH_MM))) and not punch.profile_mm
        )
        law = ScaledLaw(law, partial(elastic_factor, alpha=alpha, shape="slab" if glued else "other"))
        corrections.append(partial(with_elastic_law, alpha=alpha))
    preset = read_preset(request.preset)
    making = pad_making()
    made = partial(_tolerances, request, preset, resin, making)
    made(Slab(), float(thickness[0]), float(ratios[0]))  # a pad that no mould can make is refused at once
    return Problem(
        resin=resin,
        targets=targets,
        thickness_mm=thickness,
        ratio=ratios,
        radius_mm=punch.radius_mm,
        castings=Castings(resin, making.castings),
        tolerances=made,
        puck_error=puck_error(),
        sampling=sampling,
        pad_mm=request.pad_mm,
        base=request.base,
        correct=partial(_corrected, corrections) if corrections else None,
        edge_radius_mm=request.edge_radius_mm,
        allowed_mm=(allowed[0], allowed[-1]),
        least_film_mm=_least_film_mm(request, preset, resin, float(thickness[-1]), ratios),
        request=request,
        tissue=tissue,
        slab_law=law,
        punch=punch,
        preset=preset,
        files={**settings_files(), **preset.files},
        calibrated=calibrated,
        wide_mm=None if kept is None else tabulated(steps, request, punch),
    )


def _corrected(corrections: list[Correct], family: Family) -> Family:
    """A family of shapes under the punch, the calibration and the elastic law of a request."""
    for correct in corrections:
        family = correct(family)
    return family


def _with_mould(request: Request) -> tuple[Request, MouldSpec]:
    """The request for the pad of a mould that was made."""
    from dummydesign.mold.moulded_pads import one_mould

    spec = one_mould(str(request.mould))
    pad, given = spec.pad, []
    given += ["--shape"] if request.shape.lower() not in ("auto", pad.name) else []
    given += ["--thickness"] if request.thickness_mm is not None else []
    given += ["--sites"] if request.sites is not None else []
    given += ["--pad"] if request.pad_mm not in ((PAD_LENGTH_MM, PAD_WIDTH_MM), (pad.length_mm, pad.width_mm)) else []
    if given:
        message = f"mould = {request.mould} keeps shape, thickness and size of its pad; leave {' and '.join(given)} out"
        raise InputError(message, "conflict", "mould", request.mould)
    preset = spec.preset if request.preset == "open" else request.preset
    return replace(request, shape=pad.name, pad_mm=(pad.length_mm, pad.width_mm), preset=preset), spec


def _check_mould(spec: MouldSpec, place: str, resin: Resin, punch: str) -> None:
    """Refuse a mould that was made for other liquids, or designed under another punch."""
    made, liquids = [name for name, _ in spec.pour.components], [liquid.name for liquid in resin.liquids]
    if not set(made) <= set(liquids):
        raise InputError(
            f"mould '{place}' was made for {spec.pour.resin} ({', '.join(made)}) and its shrinkage; {resin.name} is "
            f"mixed of {', '.join(liquids)}: leave --mould out, or name a resin of these liquids",
            "inconsistent",
            "mould",
            spec.pour.resin,
            resin.name,
        )
    folder = Path(place) if Path(place).is_dir() else Path(place).parent
    designed = read_json(folder / ANSWER).get("inputs", {}).get("punch")
    if designed is not None and designed != punch:
        raise InputError(
            f"mould '{place}' was designed under the punch {designed}; it is now {punch}: leave --mould "
            f"out, or give --punch {designed}",
            "inconsistent",
            "mould",
            punch,
            designed,
        )


def _mould(
    request: Request, preset: Preset, resin: Resin, shape: PadShape, thickness_mm: float, ratio: float
) -> MouldSpec:
    return mould_spec(thickness_mm, *request.pad_mm, preset, resin, ratio, shape.name, shape.parameters)


def _tolerances(
    request: Request,
    preset: Preset,
    resin: Resin,
    making: PadMaking,
    shape: PadShape,
    thickness_mm: float,
    ratio: float,
) -> Tolerances:
    """How well a pad is made: the batch that is mixed is what is weighed."""
    _, batch = recipe_and_batch(_mould(request, preset, resin, shape, thickness_mm, ratio))
    crown = crown_making() if shape.crowned else None
    return Tolerances(batch["total_g"], making.weighing_g, making.thickness_mm, crown)


def _least_film_mm(request: Request, preset: Preset, resin: Resin, thickness_mm: float, ratios: NDArray) -> float:
    """Thinnest gel that levels itself within the pot life, over the ratios. [mm]"""
    ends = (float(ratios[0]), float(ratios[-1]))
    return max(least_film_mm(_mould(request, preset, resin, Slab(), thickness_mm, one)) for one in ends)


def _ratios(resin: Resin, wanted: tuple[float, float] | None) -> NDArray:
    """Practical ratios inside the wanted range, which must lie inside the resin's."""
    if wanted is None:
        return resin.ratios()
    resin.check_ratio(wanted)
    ratios = resin.ratios(*wanted)
    if not len(ratios):
        raise InputError(
            f"ratio range {wanted[0]:g}:{wanted[1]:g} holds no step of {resin.ratio_step:g}; "
            f"{resin.name} allows {resin.ratio_min:g} to {resin.ratio_max:g}",
            "out_of_range",
            "ratio",
            wanted,
            (resin.ratio_min, resin.ratio_max),
        )
    return ratios


def recipe_of_pour(pour: dict[str, Any]) -> dict[str, Any]:
    """Masses to weigh of a pour or, for a layered pad, of both. [g]"""
    pours = [("", pour)] + ([(" (base)", pour["base"])] if "base" in pour else [])
    items = [{**item, "name": item["name"] + layer} for layer, one in pours for item in one["components"]]
    return {"components": items, "total_g": round(sum(item["mass_g"] for item in items), 6)}


def recipe_and_batch(spec: MouldSpec) -> tuple[dict[str, Any], dict[str, Any]]:
    """Masses to weigh for a mould, both pours of a layered pad, and what to mix and how much of it to pour. [g]"""
    plan = pour_plan(spec)
    return recipe_of_pour(plan.to_dict()), batches_of(spec, plan)

"""First step of a suggestion: read what the request names, refuse what is not allowed, before any work."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, cast

from dummydesign.core.errors import InputError
from dummydesign.design.assessment.castings import Castings
from dummydesign.design.request import Request
from dummydesign.design.scoring.presses import Sampling
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search.best_of_kinds import kinds_of
from dummydesign.design.search.slabs import Correct, SearchSpace, thickness_steps
from dummydesign.design.test_setup import (
    check_calibrated,
    check_mould,
    check_test,
    own_slab_law,
    standard_press,
    tabulated,
)
from dummydesign.geometry.dimensions import THICKNESS_MM
from dummydesign.geometry.punch import Punch, read_punch
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.design.calibrated import Calibrated
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue


@dataclass(frozen=True)
class Inputs:
    """A request with what it names."""

    request: Request
    tissue: Tissue
    space: SearchSpace
    slab_law: ForceLaw
    punch: Punch
    castings: Castings
    calibrated: Calibrated | None = None


def resolve(request: Request, law: ForceLaw | None = None) -> Inputs:
    """Read tissue, resin, calibration and force law, and lay out what is searched."""
    from dummydesign.resin import load_resin
    from dummydesign.tissue.model.tissue_file import load_tissue

    if request.shape.lower() != Slab.name:
        kinds_of(request.shape)
    punch = read_punch(request.punch)
    check_test(request, punch)
    tissue, resin = load_tissue(request.tissue), load_resin(request.resin)
    sampling = Sampling(hold_s=request.hold_s, deceleration_mm_s2=request.deceleration_mm_s2)
    tissue.target(request.aim)
    thickness = tabulated(thickness_steps(*(request.thickness_mm or THICKNESS_MM)), request, punch)
    ratios = _ratios(resin, request.ratio)
    targets = make_targets(tissue, request.aim, sampling, request.protocol)
    calibrated, correct = None, None
    if request.calibration is not None:
        from dummydesign.design.calibrated import CalibratedFamily, with_calibration

        if not standard_press(request):
            check_calibrated(request, punch, thickness)
        calibrated = with_calibration(resin, request.calibration, request.punch, punch.square, request.edge_radius_mm)
        resin, law = calibrated.resin, cast(ForceLaw, calibrated.law)
        correct = cast(Correct, partial(CalibratedFamily, correction=calibrated.law.correction))
    if law is None:
        law = own_slab_law(request, punch, thickness)
    castings = Castings(resin, request.castings)
    verdict_limits()
    check_mould(request, resin, float(thickness[0]), float(ratios[0]))
    space = SearchSpace(
        resin, targets, thickness, ratios, punch.radius_mm, sampling, request.pad_mm, request.base, correct,
        request.edge_radius_mm,
    )  # fmt: skip
    return Inputs(request, tissue, space, law, punch, castings, calibrated)


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
            "out_of_range", "ratio", wanted, (resin.ratio_min, resin.ratio_max),
        )  # fmt: skip
    return ratios

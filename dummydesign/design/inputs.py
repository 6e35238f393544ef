"""First step of a suggestion: read what the request names, refuse what is not allowed, before any work."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from dummydesign.core.errors import InputError
from dummydesign.design.request import PUNCH, RADIUS_MM, Request
from dummydesign.design.scoring.presses import ForceLaw, Sampling
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search.best_of_kinds import AUTO, kinds_of
from dummydesign.design.search.slabs import THICKNESS_MM, thickness_steps
from dummydesign.design.search.space import SearchSpace
from dummydesign.geometry.shapes import Slab
from dummydesign.pad.tables.punch import punch_law

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue


@dataclass(frozen=True)
class Inputs:
    """A request with what it names.

    Attributes
    ----------
    request : Request
    tissue : Tissue
    space : SearchSpace
        Resin (with what a calibration taught), targets, thicknesses and ratios to search.
    slab_law : ForceLaw
        Elastic force of flat slabs under the punch.
    """

    request: Request
    tissue: Tissue
    space: SearchSpace
    slab_law: ForceLaw


def resolve(request: Request, law: ForceLaw | None = None) -> Inputs:
    """Read tissue, resin, calibration and force law, and lay out what is searched.

    Parameters
    ----------
    request : Request
    law : ForceLaw, optional
        Elastic force of slabs; the response table of the bonded slab by default.

    Raises
    ------
    InputError
        For unknown names or ranges outside what is allowed.
    """
    from dummydesign.resin import load_resin
    from dummydesign.tissue.model.tissue_file import load_tissue

    if request.shape.lower() == AUTO and request.calibration is not None:
        request = replace(request, shape=Slab.name)
    if request.shape.lower() != Slab.name:
        kinds_of(request.shape)
        if request.calibration is not None:
            raise InputError(f"shape = {request.shape} cannot be designed with a calibration, which is of a flat slab")
    tissue, resin = load_tissue(request.tissue), load_resin(request.resin)
    sampling = Sampling(hold_s=request.hold_s, deceleration_mm_s2=request.deceleration_mm_s2)
    tissue.target(request.aim)
    thickness = thickness_steps(*(request.thickness_mm or THICKNESS_MM))
    ratios = _ratios(resin, request.ratio)
    targets = make_targets(tissue, request.aim, sampling)
    if request.calibration is not None:
        from dummydesign.design.calibrated import with_calibration

        resin, law, _ = with_calibration(resin, request.calibration)
    if law is None:
        from dummydesign.pad.tables.slab import load_table

        law = punch_law(load_table(base="bonded"), PUNCH)
    return Inputs(request, tissue, SearchSpace(resin, targets, thickness, ratios, RADIUS_MM, sampling), law)


def _ratios(resin: Resin, wanted: tuple[float, float] | None) -> NDArray:
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

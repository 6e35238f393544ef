"""One pad against a tissue, fast enough to follow a slider: its steady curve, its presses and the verdict on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.castings import Castings, PadCastings, Tolerances
from dummydesign.design.assessment.readings import limits_that_bind, reading_of, verdict_of_design
from dummydesign.design.scoring.acceptability import ranges_of, strict_aim
from dummydesign.design.scoring.presses import ForceLaw, make_curves, steady_depth
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.verdict import Verdict, verdict
from dummydesign.design.search.shape_family import Family, ShapeLaw
from dummydesign.design.search.slabs import Candidate, make_slabs
from dummydesign.design.search.space import SearchSpace
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM


@dataclass(frozen=True)
class OnePad:
    """One pad as it stands, whether it is a good one or not.

    Attributes
    ----------
    candidate : Candidate
        With its evaluation; parameters are not fitted.
    law : ForceLaw
        Elastic force of the pad as cast.
    verdict : Verdict
        Of the pad as exactly known; :func:`with_castings` adds what its castings may turn out as.
    """

    candidate: Candidate
    law: ForceLaw
    verdict: Verdict

    def steady_depth_mm(self, force_N: NDArray) -> NDArray:
        """Depth at steady forces; NaN out of reach. [mm]

        Parameters
        ----------
        force_N : ndarray, shape (n,)
            Steady forces. [N]
        """
        found = self.candidate.evaluation
        return np.asarray(steady_depth(found.slabs, force_N, found.protocol.slow_mm_s, found.sampling.coarse)[0])


def law_of_shape(
    slab_law: ForceLaw, shape: PadShape, thickness_mm: float,
    pad_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM), correct: Callable[[Family], Family] | None = None,
) -> ForceLaw:  # fmt: skip
    """Elastic force of a pad of a shape: the slabs' law, or the response surface of the kind.

    Parameters
    ----------
    slab_law : ForceLaw
        Of flat slabs.
    shape : PadShape
    thickness_mm : float
        Of the pad. [mm]
    pad_mm : (float, float)
        Its length and width. [mm]
    correct : callable, optional
        Puts what a calibration taught into the response surface, as ``SearchSpace.correct`` does; ``slab_law`` has it.

    Raises
    ------
    InputError
        When the shape does not fit the pad, or its kind has no response surface.
    """
    if shape.plain:
        return slab_law
    from dummydesign.design.search.tabulated_shapes import load_family

    shape.check(thickness_mm, *pad_mm)
    family = load_family(shape.name)
    family.check(shape)
    if correct is not None:
        family = correct(family)
    return ShapeLaw(family, shape, thickness_mm, cast=True)


def one_pad(law: ForceLaw, space: SearchSpace, thickness_mm: float, ratio: float) -> OnePad:
    """Press one pad as the search presses its best ones, and judge it.

    Parameters
    ----------
    law : ForceLaw
        Of the pad as cast, from :func:`law_of_shape`.
    space : SearchSpace
        Resin, targets, punch and sampling; its steps say which limits bind.
    thickness_mm, ratio : float
        The pad. [mm, resin's ratio]
    """
    curves = make_curves(law, np.array([thickness_mm]), space.radius_mm)
    slabs = make_slabs(curves, np.array([0]), space.resin, np.array([ratio]))
    found = evaluate(slabs, space.targets, space.sampling, exact=True)
    candidate = Candidate(thickness_mm, ratio, 0, found, None, 0.0, 0.0)
    bound = limits_that_bind(candidate, space.thickness_mm, space.ratio)
    strict = strict_aim(space.targets)
    return OnePad(candidate, law, verdict(ranges_of(space.targets), reading_of(candidate), None, bound, strict=strict))


def with_castings(
    pad: OnePad, space: SearchSpace, castings: Castings, tolerances: Tolerances, beyond: float = 1.0
) -> Verdict:
    """The verdict with what the castings of a pad may turn out as; the same as that of ``suggest``.

    Parameters
    ----------
    pad : OnePad
    space : SearchSpace
        As for :func:`one_pad`.
    castings : Castings
        Of the resin.
    tolerances : Tolerances
        Of weighing and thickness.
    beyond : float
        Largest steady force of the test over the hardest press of people.
    """
    return verdict_of_design(PadCastings(castings, pad.law, pad.candidate, space, tolerances), beyond)

"""One pad of a kind with its castings, without a search; and resins of which a part is known exactly."""

from __future__ import annotations

import dataclasses

import numpy as np

from dummydesign.core.quantity import Quantity
from dummydesign.design.assessment.pad_castings import PadCastings, poured_curves
from dummydesign.design.pad_evaluator import law_of_shape, one_pad
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.castings import Castings, Tolerances
from dummydesign.design.scoring.crowns import finite_strain_of
from dummydesign.design.scoring.outlook import Outlook
from dummydesign.design.scoring.press_simulation import PadBatch
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.verdict import classes, deviations, ranges_of, readings_of
from dummydesign.design.search.slabs import SearchSpace
from dummydesign.geometry.shape_registry import read_shape

CROWNED = ("crowned:radius=5.1,height=3.8,foot=7.8", 10.0, 15.3)
"""Shape, thickness and ratio of a pad for the palm: near the subjects, and mostly uncertain by its resin."""
SHARP = Tolerances(1e6, 1e-9, 1e-9)


def exact(number):
    """The same number as if it were known."""
    return Quantity(number.value, number.value, number.value, number.kind, number.source)


def known(resin, modulus=True, relaxation=True):
    """The same resin with its modulus, its relaxation or both known exactly."""
    changes = {}
    if modulus:
        changes["numbers"] = {name: exact(number) for name, number in resin.numbers.items()}
    if relaxation:
        changes["arms"] = tuple(
            dataclasses.replace(arm, tau_s=exact(arm.tau_s), beta=exact(arm.beta)) for arm in resin.arms
        )
        changes["softness_exponent"] = exact(resin.softness_exponent)
    return dataclasses.replace(resin, **changes)


def space_of(tissue="palm", **asked):
    """What a request for a tissue is searched over, and its flat law."""
    inputs = read_problem(Request(tissue, verify=False, **({"shape": "slab"} | asked)))
    return inputs, inputs.slab_law, inputs.castings


def space_with(resin, targets, thickness_mm, ratio, tolerances=Tolerances(100.0), **more):  # noqa: B008
    """What is searched of a resin under the paper's punch, however pads are made."""
    radius, castings = 14.0 / np.sqrt(np.pi), more.pop("castings", None) or Castings(resin)
    return SearchSpace(
        resin,
        targets,
        np.asarray(thickness_mm, float),
        np.asarray(ratio, float),
        radius,
        castings,
        lambda *_: tolerances,
        more.pop("puck_error", 0.03),
        **more,
    )


def cast_pad(space, slab_law, castings, pad=CROWNED, tolerances=Tolerances(60.0)):  # noqa: B008
    """Castings of one pad: its shape, thickness and ratio."""
    shape, thickness, ratio = pad
    made = read_shape(shape)
    law = law_of_shape(slab_law, made, thickness)
    candidate = one_pad(law, space, thickness, ratio).candidate
    own = dataclasses.replace(space, castings=castings)
    strain = finite_strain_of(candidate.alone, made, space.base, space.targets, space.radius_mm)
    return PadCastings(castings, law, candidate, own, tolerances, outlook_at(ratio, castings.n), strain)


def poured_slabs(law, pours, space):
    """Pours as designs to press."""
    return PadBatch(*poured_curves(law, pours, space)(0), pours.young_MPa, space.resin.tau_s, pours.beta)


def evaluated(cast, groups=()):
    """Scores and quick presses of all castings with some groups known."""
    (slabs,) = cast.slabs(cast.pours(groups))
    return evaluate(slabs, cast.space.targets, cast.space.sampling.coarse)


def kinds_of(cast, groups=()):
    """Class of each casting with some groups known, by its whole presses."""
    read = cast.finite_strain.judged(readings_of(evaluated(cast, groups)), cast.pours(groups).finite_strain)
    return classes(deviations(ranges_of(cast.space.targets), read), cast.space.targets.limits)


def outlook_at(ratio, count):
    """An outlook that takes one ratio whatever is known."""
    none = np.zeros(count)
    return Outlook(ratio, 0.0, 0.0, ratio, 0.0, 0.0, 0.0, 0.0, none, none, np.full(count, ratio), none > 1.0)

"""Search over shapes: which of a family comes nearest to the tissue's curve, then ratio and thickness exactly.

The first sieve is elastic and free of the resin's steps: at the depths where the aim carries 0.5 to 15 N
every shape's force is known up to its modulus, whose best value in ln F is a mean. The remainder is the
misfit (:mod:`dummydesign.design.search.best_of_kinds`). The best of it, one a thickness, go through the same
search over ratio and thickness as slabs do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.scoring.presses import DEPTH_SHARE
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.shape_family import Designs, Family, FamilyLaw
from dummydesign.design.search.slabs import THICKNESS_STEP_MM, SearchResult, SearchSpace, search, search_each
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.pad.force_law import ForceLaw

if TYPE_CHECKING:
    from dummydesign.resin.model.resin import Resin

TRIED, AROUND_STEPS, REFINED = 6, 2, 4
SIEVE_STEP = 3


@dataclass(frozen=True)
class Prescreened:
    """Castable designs that reach the aim's depth at 15 N, by rising misfit, with their best modulus (M,)."""

    designs: Designs
    misfit: NDArray
    young_MPa: NDArray


@dataclass(frozen=True)
class Shaped:
    """A design with a shape; ``elements`` is its force law once it has been solved by finite elements."""

    shape: PadShape
    law: FamilyLaw
    found: SearchResult
    elements: ForceLaw | None = None

    @property
    def merit(self) -> float:
        """What is expected of a design with a shape, whether it is representative or not."""
        return self.found.best.merit() - self.found.best.loss

    @property
    def worth(self) -> float:
        """By what designs with a shape are chosen; see :meth:`DesignCandidate.worth`."""
        return self.found.best.worth()


def prescreen(family: Family, targets: Targets, thickness_mm: NDArray, young_MPa: tuple[float, float], radius_mm: float,
          count: int = 400, pad_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM),
          thicknesses: int | None = None) -> Prescreened:  # fmt: skip
    """Misfit of every candidate of a family with its best modulus inside a range."""
    forces = targets.protocol.misfit_N[::SIEVE_STEP]
    depth = targets.aim_depth_mm(forces)
    designs = family.candidates(thickness_mm, radius_mm)
    limit = family.limit_mm(designs, radius_mm)
    deep = np.minimum(limit, DEPTH_SHARE * designs.thickness_mm) >= depth[-1]
    designs = replace(designs, limit_mm=limit).take(deep)
    wanted = np.log(forces)
    misfit, best = np.full(len(designs.thickness_mm), np.nan), np.empty(len(designs.thickness_mm))
    for start in range(0, len(misfit), 4000):
        rows = np.arange(start, min(start + 4000, len(misfit)))
        area = family.area_mm2(designs.take(rows), np.broadcast_to(depth, (len(rows), len(depth))), radius_mm)
        away = wanted - np.log(area)
        level = np.clip(away.mean(axis=1), *np.log(young_MPa))
        misfit[rows] = np.sqrt(np.mean((away - level[:, None]) ** 2, axis=1))
        best[rows] = np.exp(level)
    order = np.argsort(np.where(np.isfinite(misfit), misfit, np.inf), kind="stable")
    order = order[np.isfinite(misfit[order])][:count]
    if thicknesses is None:
        kept = order[designs.take(order).castable(pad_mm)] if len(order) else order
    else:
        kept = order[_one_a_thickness(designs.take(order), pad_mm, thicknesses)]
    if not len(kept):
        raise NoAnswerError(
            "no_feasible_design",
            f"no {family.kind} pad of {thickness_mm[0]:g} to {thickness_mm[-1]:g} mm reaches {depth[-1]:.2f} mm, the "
            f"tissue's depth at {forces[-1]:g} N, within {DEPTH_SHARE:g} of its thickness; allow thicker pads",
            quantity="pad",
        )
    return Prescreened(designs.take(kept), misfit[kept], best[kept])


def search_shape(family: Family, space: SearchSpace) -> list[Shaped]:
    """Find shape, thickness and ratio of one family; designs of several thicknesses, the best first."""
    found = search_shapes([family], space)[0]
    if isinstance(found, NoAnswerError):
        raise found
    return found


def search_shapes(families: Sequence[Family], space: SearchSpace) -> list[list[Shaped] | NoAnswerError]:
    """Make the search of :func:`search_shape` for several families at once; what each gives, or why it has none."""
    young = space.resin.young_MPa(space.ratio)
    moduli = (float(np.min(young)), float(np.max(young)))
    starts: list[list[tuple[Family, PadShape, float]] | NoAnswerError] = []
    for family in families:
        try:
            sieved = prescreen(family, space.targets, space.thickness_mm, moduli, space.radius_mm, pad_mm=space.pad_mm,
                           thicknesses=TRIED)  # fmt: skip
        except NoAnswerError as problem:
            starts.append(problem)
            continue
        thickness = sieved.designs.thickness_mm.tolist()
        starts.append([(family, sieved.designs.shape(i), at) for i, at in enumerate(thickness)])
    around = iter(_around([one for each in starts if not isinstance(each, NoAnswerError) for one in each], space))
    found: list[list[Shaped] | NoAnswerError] = []
    for family, each in zip(families, starts):
        if isinstance(each, NoAnswerError):
            found.append(each)
            continue
        able = [shaped for shaped in (next(around) for _ in each) if shaped is not None]
        why = f"no {family.kind} pad reaches {space.targets.protocol.needed_N:g} N within its depth limit"
        best_first = sorted(able, key=lambda shaped: shaped.worth, reverse=True)
        found.append(best_first if able else NoAnswerError("no_feasible_design", why, quantity="pad"))
    return found


def search_fixed(family: Family, shape: PadShape, space: SearchSpace) -> Shaped:
    """Find thickness and ratio of a shape whose lengths are given: only what lies under it changes."""
    family.check(shape)
    fitting = [float(thickness) for thickness in space.thickness_mm if _accepts(shape, float(thickness), space.pad_mm)]
    if not fitting:
        shape.check(float(space.thickness_mm[-1]), *space.pad_mm)
    law = FamilyLaw(family, shape, fitting[0], cast=True)
    steps = np.array(fitting)[law.depth_limit_mm(np.array(fitting), space.radius_mm) > 0.0]
    if not len(steps):
        raise NoAnswerError(
            "no_feasible_design",
            f"{shape} lies outside the response surface of {family.kind} pads at every thickness from {fitting[0]:g} "
            f"to {fitting[-1]:g} mm; press it with 'dummydesign predict --shape {shape} --fidelity {shape.fidelity}'",
            quantity="shape",
        )
    found = search(law, replace(space, thickness_mm=steps), space.targets.weights.low_aim, fitted=0)
    return Shaped(shape, law, found)


def mixable(shape: PadShape, ratio: float, resin: Resin) -> bool:
    """Whether the second resin of a layered shape can be mixed where the first has a ratio; others need none."""
    layers = shape.layers()
    if layers is None:
        return True
    low, high = np.sort(np.asarray(resin.young_MPa(np.array([resin.ratio_min, resin.ratio_max]))))
    return bool(low <= layers[1] * np.asarray(resin.young_MPa(ratio)) <= high)


def _accepts(shape: PadShape, thickness_mm: float, pad_mm: tuple[float, float]) -> bool:
    try:
        shape.check(thickness_mm, *pad_mm)
    except InputError:
        return False
    return True


def _around(starts: Sequence[tuple[Family, PadShape, float]], space: SearchSpace) -> list[Shaped | None]:
    """Search ratio and the thicknesses near each start, in proportion; then its own, rounded shape exactly."""
    near = [_near(*start, space) for start in starts]
    laws: list[tuple[ForceLaw, NDArray]] = [(FamilyLaw(*one), steps) for one, steps in zip(starts, near) if len(steps)]
    results = iter(search_each(laws, space, space.targets.weights.low_aim, REFINED, 0))
    rough = [next(results) if len(steps) else None for steps in near]
    own: list[FamilyLaw | None] = []
    for (family, shape, thickness), found in zip(starts, rough):
        own.append(None)
        if isinstance(found, SearchResult):
            chosen = found.best.thickness_mm
            rounded = family.at_thickness(shape, thickness, np.array([chosen])).shape(0).rounded()
            if _accepts(rounded, chosen, space.pad_mm):
                own[-1] = FamilyLaw(family, rounded, chosen)
    laws = [(law, np.array([law.made_for_mm])) for law in own if law is not None]
    results = iter(search_each(laws, space, space.targets.weights.low_aim, REFINED, 0, others=False))
    made: list[Shaped | None] = []
    for law, found in zip(own, rough):
        made.append(None)
        if law is not None and isinstance(found, SearchResult):
            exact = next(results)
            if isinstance(exact, SearchResult):
                made[-1] = Shaped(law.shape, law, replace(found, best=exact.best))
    return made


def _near(family: Family, shape: PadShape, thickness: float, space: SearchSpace) -> NDArray:
    """Thicknesses of the space near that of a start at which the shape in proportion is known and can be cast."""
    near = space.thickness_mm[np.abs(space.thickness_mm - thickness) <= AROUND_STEPS * THICKNESS_STEP_MM + 1e-9]
    known = FamilyLaw(family, shape, thickness).depth_limit_mm(near, space.radius_mm) > 0.0
    return near[known & family.at_thickness(shape, thickness, near).castable(space.pad_mm)]


def _one_a_thickness(designs: Designs, pad_mm: tuple[float, float], count: int) -> list[int]:
    """Places of the first castable design of each thickness, in order; no more than a count."""
    found: list[int] = []
    seen: set[float] = set()
    for index, thickness in enumerate(designs.thickness_mm.tolist()):
        if len(found) < count and thickness not in seen and designs.take(np.array([index])).castable(pad_mm)[0]:
            seen.add(thickness)
            found.append(index)
    return found

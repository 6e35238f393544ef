"""Designs with a shape of their own: the best pad of each kind, beside the slab, by one rule."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.scoring.presses import ForceLaw, Sampling
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.low_force import LowForce, low_force
from dummydesign.design.search.shapes import LOW_SHARE, Shaped, search_fixed, search_shape
from dummydesign.design.search.slabs import Candidate, SearchResult, search
from dummydesign.geometry.shapes import Shape, Slab, read_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.resin.model.resin import Resin

AUTO = "auto"
SOLVED = 3


@dataclass(frozen=True)
class Beside:
    """The best design of one kind of shape, or the reason why there is none.

    ``by`` says where its force comes from: ``table`` or ``elements``.
    """

    kind: str
    shape: Shape | None
    candidate: Candidate | None
    young_kPa: float | None
    low_force: LowForce | None
    reason: str | None = None
    by: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the design and how near it comes to the tissue as plain values."""
        if self.candidate is None:
            return {"kind": self.kind, "shape": None, "reason": self.reason}
        return {
            "kind": self.kind,
            "shape": str(self.shape),
            "thickness_mm": self.candidate.thickness_mm,
            "ratio": self.candidate.ratio,
            "young_kPa": self.young_kPa,
            "merit": self.candidate.merit(LOW_SHARE),
            "total": self.candidate.total,
            "by": self.by,
            **self.low_force.to_dict(),
            "reason": None,
        }


@dataclass(frozen=True)
class Chosen:
    """The winning design with its force laws: in proportion with thickness, and as cast."""

    shape: Shape
    found: SearchResult
    law: ForceLaw
    cast: ForceLaw
    beside: tuple[Beside, ...]


def kinds_of(text: str) -> tuple[str, ...]:
    """Kinds of shapes a request names: one kind, one given shape, or ``auto`` for all with a response surface.

    Raises
    ------
    InputError
        For unknown names, parameters that make no shape, or kinds without a response surface.
    """
    from dummydesign.design.search.tabulated_shapes import FAMILIES

    if text.lower() == AUTO:
        return tuple(FAMILIES)
    name = text.partition(":")[0].lower()
    shape = read_shape(text) if ":" in text else None
    if shape is None and name not in FAMILIES and name != Slab.name:
        from dummydesign.core.errors import unknown_name

        raise unknown_name("shape", text, (*FAMILIES, Slab.name, AUTO))
    if name not in FAMILIES and name != Slab.name:
        raise InputError(f"shape {name} has no response surface; press it with 'dummydesign predict --shape {text}'")
    return (name,)


def choose(
    text: str,
    slab_law: ForceLaw,
    resin: Resin,
    targets: Targets,
    thickness_mm: NDArray,
    ratio: NDArray,
    radius_mm: float,
    sampling: Sampling,
    solve: bool = True,
) -> Chosen:
    """Find the best design of the kinds that ``text`` names, and the slab's by the same rule.

    Parameters
    ----------
    text : str
        ``crowned``, ..., a shape with its parameters such as ``crowned:10,2``, or ``auto``.
    slab_law : ForceLaw
    resin, targets, thickness_mm, ratio, radius_mm, sampling
        As for :func:`dummydesign.design.search.slabs.search`.
    solve : bool
        Work the best round pads out again on finite elements before one is chosen.

    Raises
    ------
    NoAnswerError
        ``no_feasible_design`` when no kind has one.
    """
    args = (resin, targets, ratio, radius_mm, sampling)
    slab = Beside(Slab.name, None, None, None, None)
    flat: SearchResult | None = None
    try:
        flat = search(slab_law, resin, targets, thickness_mm, ratio, radius_mm, sampling, LOW_SHARE)
        slab = _beside(Slab.name, Slab(), flat.best, resin, targets, "table")
    except NoAnswerError as problem:
        slab = replace(slab, reason=str(problem))
    designs, failed = _designs(text, resin, targets, thickness_mm, ratio, radius_mm, sampling)
    if solve:
        designs = _solved(designs, *args)
    beside = [slab]
    for kind in dict.fromkeys(shaped.shape.name for shaped in designs):
        best = max((shaped for shaped in designs if shaped.shape.name == kind), key=_rank)
        by = "table" if best.elements is None else "elements"
        beside.append(_beside(kind, best.shape, best.found.best, resin, targets, by))
    listed = (*beside, *failed)
    if text.lower() == AUTO and flat is not None:
        if not designs or flat.best.merit(LOW_SHARE) >= max(designs, key=_rank).merit:
            return Chosen(Slab(), flat, slab_law, slab_law, listed)
    if not designs:
        raise NoAnswerError("no_feasible_design", "; ".join(item.reason for item in failed if item.reason))
    best = max(designs, key=_rank)
    return Chosen(best.shape, best.found, best.law, best.elements or replace(best.law, cast=True), listed)


def _rank(shaped: Shaped) -> tuple[bool, float]:
    """Solved designs before those that only a table knows, then by merit."""
    return shaped.elements is not None, shaped.merit


def _designs(
    text: str, resin: Resin, targets: Targets, thickness_mm: NDArray, ratio: NDArray, radius_mm: float,
    sampling: Sampling,
) -> tuple[list[Shaped], list[Beside]]:  # fmt: skip
    """Designs of the kinds asked for by their tables, and the kinds that have none with the reason."""
    from dummydesign.design.search.tabulated_shapes import load_family

    found: list[Shaped] = []
    failed = []
    for kind in kinds_of(text):
        args = (resin, targets, thickness_mm, ratio, radius_mm, sampling)
        try:
            if ":" in text:
                found.append(search_fixed(load_family(kind), read_shape(text), *args))
            else:
                found += search_shape(load_family(kind), *args)
        except NoAnswerError as problem:
            failed.append(Beside(kind, None, None, None, None, str(problem)))
    able = [pourable for shaped in found if (pourable := _pourable(shaped, resin)) is not None]
    for kind in {shaped.shape.name for shaped in found} - {shaped.shape.name for shaped in able}:
        reason = f"no {kind} pad has a base that {resin.name} can be mixed for"
        failed.append(Beside(kind, None, None, None, None, reason))
    return able, failed


def _pourable(shaped: Shaped, resin: Resin) -> Shaped | None:
    """The design with those alternatives whose second resin can be mixed; None when its own cannot."""
    layers = shaped.shape.layers()
    if layers is None:
        return shaped
    low, high = np.sort(np.asarray(resin.young_MPa(np.array([resin.ratio_min, resin.ratio_max]))))

    def mixed(candidate: Candidate) -> bool:
        return bool(low <= layers[1] * np.asarray(resin.young_MPa(candidate.ratio)) <= high)

    if not mixed(shaped.found.best):
        return None
    others = tuple(other for other in shaped.found.alternatives if mixed(other))
    return replace(shaped, found=replace(shaped.found, alternatives=others))


def _solved(
    designs: list[Shaped], resin: Resin, targets: Targets, ratio: NDArray, radius_mm: float, sampling: Sampling
) -> list[Shaped]:
    """Designs with the best round ones of each kind worked out on elements; those that cannot be solved fall away.

    Of every kind the first is solved, of the best kind the first three. Fields of caps take minutes in space and
    are solved, the first of them, when nothing else was asked for.
    """
    from dummydesign.design.search.resolved_by_fem import on_elements

    order = sorted((shaped for shaped in designs if shaped.shape.axisymmetric), key=lambda shaped: -shaped.merit)
    if not order:
        order = sorted(designs, key=lambda shaped: -shaped.merit)[:1]
    if not order:
        return designs
    leading = [shaped for shaped in order if shaped.shape.name == order[0].shape.name][:SOLVED]
    firsts = [next(s for s in order if s.shape.name == kind) for kind in dict.fromkeys(s.shape.name for s in order)]
    found = [shaped for shaped in designs if not shaped.shape.axisymmetric]
    for shaped in [*leading, *firsts[1:]]:
        try:
            found.append(on_elements(shaped, resin, targets, ratio, radius_mm, sampling))
        except NoAnswerError:
            continue
    return found if any(shaped.elements for shaped in found) else designs


def _beside(kind: str, shape: Shape, best: Candidate, resin: Resin, targets: Targets, by: str) -> Beside:
    young = 1e3 * float(np.asarray(resin.young_MPa(best.ratio)))
    return Beside(kind, shape, best, young, low_force(best, targets), None, by)

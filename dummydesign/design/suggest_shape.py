"""Designs with a shape of their own: the best pad of each kind, beside the slab, by one rule."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.design.curves import ForceLaw, Sampling
from dummydesign.design.low_force import LowForce, low_force
from dummydesign.design.search import Candidate, SearchResult, search
from dummydesign.design.shape_search import LOW_SHARE, search_fixed, search_shape
from dummydesign.design.targets import Targets
from dummydesign.errors import InputError, NoAnswerError
from dummydesign.shape import Shape, Slab, read_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.resin.model import Resin

AUTO = "auto"


@dataclass(frozen=True)
class Beside:
    """The best design of one kind of shape, or the reason why there is none."""

    kind: str
    shape: Shape | None
    candidate: Candidate | None
    young_kPa: float | None
    low_force: LowForce | None
    reason: str | None = None

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
    from dummydesign.design.families import FAMILIES

    if text.lower() == AUTO:
        return tuple(FAMILIES)
    name = text.partition(":")[0].lower()
    shape = read_shape(text) if ":" in text else None
    if shape is None and name not in FAMILIES and name != Slab.name:
        from dummydesign.errors import unknown_name

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
) -> Chosen:
    """Find the best design of the kinds that ``text`` names, and the slab's by the same rule.

    Parameters
    ----------
    text : str
        ``crowned``, ..., a shape with its parameters such as ``crowned:10,2``, or ``auto``.
    slab_law : ForceLaw
    resin, targets, thickness_mm, ratio, radius_mm, sampling
        As for :func:`dummydesign.design.search.search`.

    Raises
    ------
    NoAnswerError
        ``no_feasible_design`` when no kind has one.
    """
    from dummydesign.design.families import load_family

    flat = _flat(slab_law, resin, targets, thickness_mm, ratio, radius_mm, sampling)
    tried: list[tuple[Beside, Any]] = [flat] if flat[0].candidate else []
    failed = [] if flat[0].candidate else [flat[0]]
    for kind in kinds_of(text):
        args = (resin, targets, thickness_mm, ratio, radius_mm, sampling)
        try:
            family = load_family(kind)
            if ":" in text:
                shaped = search_fixed(family, read_shape(text), *args)
            else:
                shaped = search_shape(family, *args)
        except NoAnswerError as problem:
            failed.append(Beside(kind, None, None, None, None, str(problem)))
            continue
        tried.append((_beside(kind, shaped.shape, shaped.found.best, resin, targets), shaped))
    wanted = [pair for pair in tried if text.lower() == AUTO or pair[0].kind != Slab.name]
    if not wanted:
        raise NoAnswerError("no_feasible_design", "; ".join(item.reason for item in failed if item.reason))
    best, shaped = max(wanted, key=lambda pair: pair[0].candidate.merit(LOW_SHARE))
    beside = tuple(pair[0] for pair in tried) + tuple(failed)
    if best.kind == Slab.name:
        return Chosen(Slab(), shaped, slab_law, slab_law, beside)
    cast = replace(shaped.law, cast=True)
    return Chosen(shaped.shape, shaped.found, shaped.law, cast, beside)


def _flat(
    law: ForceLaw, resin: Resin, targets: Targets, thickness_mm: NDArray, ratio: NDArray, radius_mm: float,
    sampling: Sampling,
) -> tuple[Beside, SearchResult | None]:  # fmt: skip
    try:
        found = search(law, resin, targets, thickness_mm, ratio, radius_mm, sampling, LOW_SHARE)
    except NoAnswerError as problem:
        return Beside(Slab.name, None, None, None, None, str(problem)), None
    return _beside(Slab.name, Slab(), found.best, resin, targets), found


def _beside(kind: str, shape: Shape, best: Candidate, resin: Resin, targets: Targets) -> Beside:
    return Beside(kind, shape, best, 1e3 * float(np.asarray(resin.young_MPa(best.ratio))), low_force(best, targets))

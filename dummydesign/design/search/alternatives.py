"""The other designs of an answer: from all that were worked out exactly, those that no other beats."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate

ALTERNATIVES = 4


def alternatives_to(candidates: list[Candidate], best: Candidate) -> tuple[Candidate, ...]:
    """From all that were worked out exactly, those that no other beats, by falling total."""
    parts = ("steady_state_range", "force_variation_range", "aim", "low_force_range")
    values = np.array([[getattr(c.evaluation, name)[c.index] for name in parts] for c in candidates])
    left = []
    for index in sorted(range(len(candidates)), key=lambda i: -candidates[i].total):
        candidate = candidates[index]
        others = np.delete(values, index, axis=0)
        beaten = np.all(others >= values[index], axis=1) & np.any(others > values[index], axis=1)
        near = any(
            abs(candidate.thickness_mm - other.thickness_mm) <= 1.0 and abs(candidate.ratio - other.ratio) <= 0.3
            for other in (best, *left)
        )
        if candidate is not best and not beaten.any() and not near:
            left.append(candidate)
    return tuple(left[:ALTERNATIVES])

"""The other designs of an answer: from all that were worked out exactly, those that no other beats."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.design.search.slabs import Candidate, ScoreMap

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


def _objectives(score_map: ScoreMap) -> NDArray:
    """What a user may weigh differently: measured steady range, force range, aim, low forces. (D, 4)"""
    parts = ("steady_state_range", "force_variation_range", "aim", "low_force_range")
    return np.stack([getattr(score_map, name).ravel() for name in parts], axis=-1)


def pareto(score_map: ScoreMap, best: int) -> NDArray:
    """Feasible designs of the map that no other beats in every objective, the far ones from each other.

    From those with at least half of the best total, the highest is taken again and again, leaving out what
    lies within 1 mm and 0.3 parts of one already taken.
    """
    values, total = _objectives(score_map), score_map.total.ravel()
    able = np.nonzero(score_map.feasible.ravel() & (total >= 0.5 * total[best]))[0]
    order = able[np.argsort(-values[able].sum(axis=-1), kind="stable")]
    front: list[int] = []
    for index in order:
        if not front:
            front.append(index)
            continue
        others = values[front]
        beaten = np.all(others >= values[index] - 1e-12, axis=-1)
        if not beaten.any():
            front.append(index)
    place = np.stack(np.unravel_index(np.array(front), score_map.total.shape), axis=-1)
    thickness, ratio = score_map.thickness_mm[place[:, 0]], score_map.ratio[place[:, 1]]
    at = np.unravel_index(best, score_map.total.shape)
    taken = [(score_map.thickness_mm[at[0]], score_map.ratio[at[1]])]
    kept = []
    for index in np.argsort(-total[front], kind="stable"):
        here = (thickness[index], ratio[index])
        if all(abs(here[0] - t) > 1.0 or abs(here[1] - r) > 0.3 for t, r in taken):
            taken.append(here)
            kept.append(front[index])
        if len(kept) == ALTERNATIVES:
            break
    return np.array(kept, dtype=int)

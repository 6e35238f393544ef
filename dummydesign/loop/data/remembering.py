"""A law that keeps its values at the depths it was asked last."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable

from numpy.typing import NDArray

KEPT = 6
"""Depths of which the values are kept: a fit asks for those of the trials, and for the same a little less deep."""


def remembering(law: Callable[[NDArray, NDArray], NDArray]) -> Callable[[NDArray, NDArray], NDArray]:
    """A law that gives the same values, from memory where it was asked for the same depths a short time ago.

    Parameters
    ----------
    law : callable
        F / E [mm2] of depths (T, N) and thicknesses (T, 1). [mm]

    Returns
    -------
    callable
        Its values are read-only arrays; ``__wrapped__`` is the law itself.
    """
    kept: OrderedDict[tuple[bytes, bytes], NDArray] = OrderedDict()

    def remembered(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        key = depth_mm.tobytes(), thickness_mm.tobytes()
        if key in kept:
            kept.move_to_end(key)
        else:
            kept[key] = law(depth_mm, thickness_mm)
            kept[key].flags.writeable = False
            if len(kept) > KEPT:
                kept.popitem(last=False)
        return kept[key]

    remembered.__wrapped__ = law  # type: ignore[attr-defined]
    return remembered

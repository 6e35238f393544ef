"""How a Poisson's ratio below 1/2 softens a glued slab.

The table is made by ``python -m dummydesign.studies.tables.compressibility``.

F(nu) / F(1/2) at equal Young's modulus is 1 / (1 + (1 - 2 nu) c): bulk and shear in series. c(a/h, d/h) comes from
finite elements at nu = 0.48.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core import json_table
from dummydesign.pad.tables.interpolation import place_on

NAME = "slab-compressibility.json"
COMMAND = "python -m dummydesign.studies.tables.compressibility"


@dataclass(frozen=True)
class CompressibilityTable:
    """c at nodes of a/h (R,) and d/h (D,); shape (R, D)."""

    ratio: NDArray
    depth: NDArray
    values: NDArray

    def coefficient(self, share: NDArray, ratio: NDArray) -> NDArray:
        """c at relative depths (T, N) and a/h (T, 1): linear in d/h and in ln a/h of ln c, constant outside."""
        low, part = place_on(np.log(self.ratio), np.log(ratio))
        logs = np.log(self.values)
        rows = (1.0 - part) * logs[low[:, 0]] + part * logs[low[:, 0] + 1]
        left, step = place_on(self.depth, share)
        first = np.take_along_axis(rows, left, axis=1)
        second = np.take_along_axis(rows, left + 1, axis=1)
        return np.exp(first + step * (second - first))


@lru_cache(maxsize=1)
def load_compressibility() -> CompressibilityTable:
    """Read the shipped table.

    Raises
    ------
    NoAnswerError
        When it is missing or damaged.
    """
    return json_table.read(NAME, "table", COMMAND, _from_dict)


def _from_dict(data: dict[str, Any]) -> CompressibilityTable:
    return CompressibilityTable(*(np.array(data[key]) for key in ("ratio", "depth", "coefficient")))

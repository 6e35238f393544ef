"""How a Poisson's ratio below 1/2 softens a glued slab.

The table is made by ``python -m dummydesign.studies.tables.compressibility``.

F(nu) / F(1/2) at equal Young's modulus is 1 / (1 + (1 - 2 nu) c): bulk and shear in series. c(a/h, d/h) comes from
finite elements at nu = 0.48.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.datafiles import data_folder
from dummydesign.core.errors import NoAnswerError

NAME = "slab-compressibility.json"


@dataclass(frozen=True)
class CompressibilityTable:
    """c at nodes of a/h (R,) and d/h (D,); shape (R, D)."""

    ratio: NDArray
    depth: NDArray
    values: NDArray

    def coefficient(self, share: NDArray, ratio: NDArray) -> NDArray:
        """c at relative depths (T, N) and a/h (T, 1): linear in d/h and in ln a/h of ln c, constant outside."""
        place = np.interp(np.log(ratio), np.log(self.ratio), np.arange(len(self.ratio)))
        low = np.minimum(place.astype(int), len(self.ratio) - 2)
        part = place - low
        logs = np.log(self.values)
        rows = (1.0 - part) * logs[low[:, 0]] + part * logs[low[:, 0] + 1]
        at = np.interp(share, self.depth, np.arange(len(self.depth)))
        left = np.minimum(at.astype(int), len(self.depth) - 2)
        first = np.take_along_axis(rows, left, axis=1)
        second = np.take_along_axis(rows, left + 1, axis=1)
        return np.exp(first + (at - left) * (second - first))


@lru_cache(maxsize=1)
def load_compressibility() -> CompressibilityTable:
    """Read the shipped table.

    Raises
    ------
    NoAnswerError
        When it is missing or damaged.
    """
    path = data_folder() / "materials" / "tables" / NAME
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        return CompressibilityTable(*(np.array(data[key]) for key in ("ratio", "depth", "coefficient")))
    except (OSError, ValueError, KeyError) as problem:
        raise NoAnswerError(
            "table_unavailable",
            f"table {NAME} cannot be read ({type(problem).__name__}); "
            "rebuild it with: python -m dummydesign.studies.tables.compressibility",
        ) from None

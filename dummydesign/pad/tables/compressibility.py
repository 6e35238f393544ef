"""How a Poisson's ratio below 1/2 softens a glued slab.

The table is made by ``python -m dummydesign.pad.tables.compressibility``.

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
from dummydesign.core.files import write_text

POISSON = 0.48
RATIOS = (0.28, 0.395, 0.527, 0.79, 1.1, 1.58, 2.2, 2.6)
DEPTHS = (0.02, 0.1, 0.2, 0.3, 0.4, 0.5)
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
            "rebuild it with: python -m dummydesign.pad.tables.compressibility",
        ) from None


def build() -> dict[str, object]:
    """Solve the compressible and the incompressible slab at all nodes."""
    from dummydesign.pad.slab.sharp_edge import solve_curve

    rows = []
    for ratio in RATIOS:
        soft, hard = (
            solve_curve(1.0, ratio, 1.0, DEPTHS, poisson=poisson, extent_mm=ratio + 8.0) for poisson in (POISSON, 0.5)
        )
        both, at, under = np.intersect1d(np.round(soft.depth_mm, 6), np.round(hard.depth_mm, 6), return_indices=True)
        row = (hard.force_N[under] / soft.force_N[at] - 1.0) / (1.0 - 2.0 * POISSON)
        rows.append([float(f"{c:.5g}") for c in np.interp(DEPTHS, both, row)])
    return {
        "meaning": "F(nu) / F(1/2) = 1 / (1 + (1 - 2 nu) coefficient[a/h][d/h]); equal E, glued punch and base",
        "ratio": list(RATIOS),
        "depth": list(DEPTHS),
        "coefficient": rows,
        "provenance": {"command": "python -m dummydesign.pad.tables.compressibility", "poisson": POISSON},
    }


if __name__ == "__main__":
    write_text(data_folder() / "materials" / "tables" / NAME, json.dumps(build(), indent=1) + "\n")

"""Rows of a sweep as an xarray Dataset: what was varied are its dimensions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError

VARIED = ("thickness_mm", "ratio", "shape", "punch", "edge_radius_mm", "condition", "base")
INNER = {"_at_N": "force_N", "peak_over_steady": "velocity_mm_s"}
"""Values that hold one number a force or a speed, by how their names end, and the dimension of that number."""


def dataset_of(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Make a Dataset of rows; combinations that were not worked out are NaN.

    Parameters
    ----------
    rows : sequence of mapping
        As ``whatif`` gives them.

    Returns
    -------
    xarray.Dataset
        Dimensions thickness_mm, ratio, shape, punch, edge_radius_mm, condition, base, and force_N or velocity_mm_s
        where a value depends on it; parts of the score are ``score_total`` and so on, ``limit`` is text.

    Raises
    ------
    InputError
        When xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise InputError("to_xarray needs xarray, which is not installed; pip install xarray, or use to_dict") from None
    axes = {name: list(dict.fromkeys(row[name] for row in rows)) for name in VARIED}
    for name in ("thickness_mm", "ratio"):
        axes[name].sort()
    shape = tuple(len(values) for values in axes.values())
    place = {name: {value: k for k, value in enumerate(values)} for name, values in axes.items()}
    found: dict[str, tuple[tuple[str, ...], np.ndarray]] = {}
    inner: dict[str, list[float]] = {}
    for row in rows:
        at = tuple(place[name][row[name]] for name in VARIED)
        for name, value in _flat(row):
            if isinstance(value, Mapping):
                along = next(axis for ending, axis in INNER.items() if name.endswith(ending))
                inner.setdefault(along, [float(key) for key in value])
                if name not in found:
                    found[name] = ((*VARIED, along), np.full((*shape, len(value)), np.nan))
                found[name][1][at] = [np.nan if one is None else one for one in value.values()]
            elif name == "limit":
                found.setdefault(name, (VARIED, np.full(shape, "", dtype=object)))[1][at] = value or ""
            else:
                found.setdefault(name, (VARIED, np.full(shape, np.nan)))[1][at] = np.nan if value is None else value
    return xarray.Dataset(found, coords={**axes, **inner})


def _flat(row: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Values of a row without what was varied; parts of the score by names of their own."""
    found = []
    for name, value in row.items():
        if name == "score" and isinstance(value, Mapping):
            found += [(f"score_{part}", one) for part, one in value.items() if not isinstance(one, str)]
        elif name not in VARIED:
            found.append((name, value))
    return [(name, value) for name, value in found if name == "limit" or not isinstance(value, str | list | tuple)]

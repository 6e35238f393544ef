"""A sweep as an xarray Dataset."""

import sys

import numpy as np
import pytest

import dummydesign
from tests.support.refusal import raises_code


def test_a_sweep_is_a_dataset_over_what_was_varied(monkeypatch):
    xarray = pytest.importorskip("xarray")
    found = dummydesign.whatif("5:15:5", "15,16", tissue="palm", force_N=[5, 10], velocity_mm_s=[10.0, 250.0])
    data = found.to_xarray()
    assert isinstance(data, xarray.Dataset)
    assert data.sizes == {
        "thickness_mm": 3,
        "ratio": 2,
        "shape": 1,
        "punch": 1,
        "edge_radius_mm": 1,
        "condition": 1,
        "base": 1,
        "force_N": 2,
        "velocity_mm_s": 2,
    }
    for row in found.rows:
        at = data.sel(thickness_mm=row["thickness_mm"], ratio=row["ratio"]).squeeze()
        assert float(at.young_kPa) == row["young_kPa"] and float(at.score_total) == row["score"]["total"]
        assert float(at.peak_over_steady.sel(velocity_mm_s=250.0)) == row["peak_over_steady"]["250"]
        depth = row["depth_mm_at_N"]["10"]
        assert (
            np.isnan(at.depth_mm_at_N.sel(force_N=10.0))
            if depth is None
            else (float(at.depth_mm_at_N.sel(force_N=10.0)) == depth)
        )
    monkeypatch.setitem(sys.modules, "xarray", None)
    with raises_code("program_missing", "xarray"):
        found.to_xarray()

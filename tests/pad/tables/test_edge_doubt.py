"""What the sharp edge is said to be off by covers what independent codes differ by."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.tables.slab import load_table, sharp_edge_doubt
from dummydesign.pad.tables.square import square_factor

# Per cent, at d/h 0.3 and 0.425: 0.2, 0.5, 0.9, 1.4 and 2.1, 1.6, 2.0, 1.7 to the table as it was then, less what the
# table fell by when the term against folding was taken off the edge.
MEASURED = {5.0: (0.35, 0.7), 10.0: (0.05, 0.65), 15.0: (0.45, 1.25), 20.0: (1.1, 1.45)}


@pytest.mark.parametrize("thickness", MEASURED)
@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_the_table_states_at_least_what_independent_codes_differ_by(thickness, base):
    stated = load_table(base).relative_error(np.array([0.3, 0.425]) * thickness, thickness, 7.9)
    assert np.all(stated >= 0.01 * np.array(MEASURED[thickness]) * (1.0 - 1e-2))


def test_small_depths_keep_the_error_of_elements_and_interpolation():
    table = load_table()
    assert float(table.relative_error(0.5, 10.0, 7.9)) < 0.003
    assert np.all(sharp_edge_doubt(np.array([0.0, 0.05, 0.1]), 1.0) == 0.0)


def test_the_doubt_grows_with_depth_and_is_continuous_in_depth_and_ratio():
    depth, ratio = np.meshgrid(np.linspace(0.0, 0.6, 121), np.geomspace(0.2, 3.0, 600), indexing="ij")
    doubt = sharp_edge_doubt(depth, ratio)
    assert np.all(np.diff(doubt, axis=0) >= 0.0)
    assert np.abs(np.diff(doubt, axis=0)).max() < 1e-3
    assert np.abs(np.diff(doubt, axis=1)).max() < 3e-4


def test_a_square_on_a_thin_pad_states_what_independent_codes_differ_by():
    depth = 0.45 * 5.0
    stated = float(load_table().relative_error(depth, 5.0, 7.9)) + float(square_factor(depth, 5.0, 7.9)[1])
    # 3.5 % to the earlier table, 1.6 % above this one.
    assert stated >= 0.019

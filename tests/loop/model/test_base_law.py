"""The fast force laws of the loop against the tables they read."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.model import base_law as loop_law
from dummydesign.loop.model.base_law import SlabLaw
from dummydesign.pad.tables import square
from dummydesign.pad.tables.slab import load_table
from tests.support.refusal import raises_code

RADIUS = 14.0 / np.sqrt(np.pi)
H = np.array([[5.0], [10.0], [20.0]])
D = np.array([[0.1, 0.2, 0.3]]) * H


def test_a_missing_table_of_square_factors_is_an_error_and_not_another_number(monkeypatch, tmp_path):
    law = SlabLaw(load_table("bonded"), RADIUS, True)
    monkeypatch.setattr("dummydesign.core.user_library.data_folder", lambda: tmp_path)
    for cached in (square.load_square, loop_law._square_curve):
        cached.cache_clear()
    with raises_code("table_unavailable", "table"):
        law(D, H)


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_the_square_punch_has_the_factor_of_the_base_it_presses_on(base):
    bonded = SlabLaw(load_table("bonded"), RADIUS, True)
    law = bonded if base == "bonded" else bonded.sliding()
    factor, _ = square.square_factor(D, H, RADIUS, base)
    np.testing.assert_allclose(law(D, H), factor * load_table(base).force(D, H, 1.0, RADIUS), rtol=2e-4)

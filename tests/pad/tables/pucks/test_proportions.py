"""Friction tables of pucks of any proportion: solved ones as they are, between them the solves made now."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.tables.puck import (
    grip,
    interpolate,
    load_puck_table,
    load_shapes,
    shape_range,
    table_for,
    uniaxial,
)
from tests.support.refusal import raises_code


def test_a_solved_proportion_gives_its_own_table():
    assert table_for(50.0, 30.0) is load_puck_table()
    for table in load_shapes():
        assert table_for(2.0 * table.radius_over_height, 1.0).log_factor is table.log_factor


def test_friction_stiffens_a_flat_puck_more_than_a_tall_one_and_frictionless_plates_none():
    factors = [table_for(shape, 1.0).factor(2.0, 1.0, np.array([0.1]))[0] for shape in (0.8, 1.2, 2.0, 3.0, 3.6)]
    assert np.all(np.diff(factors) > 0.0) and factors[0] > 1.0
    assert table_for(1.3, 1.0).factor(2.0, 0.0, np.array([0.1, 0.4])) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(("shape", "apparent"), [(1.0, 1.196), (1.668, 1.404)])
def test_small_compressions_between_bonded_plates_have_the_published_apparent_modulus(shape, apparent):
    """E_app / E of a disc of shape factor diameter / (4 height)."""
    assert table_for(shape, 1.0).factor(2.0, 1.0, np.array([0.005]))[0] == pytest.approx(apparent, rel=0.01)


@pytest.mark.slow
def test_between_solved_proportions_the_table_agrees_with_a_solve():
    """The standard disc of 29 x 12.5 mm; benchmarks/accuracy/puck_shapes.py measures all half-way places."""
    compression, law = np.array([0.1, 0.25]), Ogden([2.0 / 3.0], [3.0])
    curve = solve_puck(Puck(12.5, 0.03, 29.0, plates="friction:0.25", law=law), 12.5 * compression)
    factor = table_for(29.0, 12.5).factor(3.0, float(grip(0.25)), compression)
    made = 0.03 * 0.25 * np.pi * 29.0**2 * uniaxial(3.0, compression) * factor
    assert made == pytest.approx(curve.force_N, rel=0.018)


def test_left_out_the_50_by_30_shape_comes_back_from_its_neighbours():
    known = load_puck_table()
    others = tuple(table for table in load_shapes() if table is not known)
    again = interpolate(others, known.radius_over_height)
    apart = np.abs(again.log_factor - known.log_factor[..., : again.log_factor.shape[-1]])
    assert np.max(apart[..., again.compression <= 0.2]) < 0.006
    assert np.max(apart[..., again.compression <= 0.3]) < 0.015


def test_proportions_beyond_the_solved_ones_are_refused():
    low, high = shape_range()
    for shape in (0.95 * low, 1.05 * high):
        with raises_code("out_of_range", "diameter_over_height"):
            table_for(shape, 1.0)


def test_a_missing_table_names_the_command_that_makes_it(monkeypatch, tmp_path):
    monkeypatch.setattr("dummydesign.core.user_library.data_folder", lambda: tmp_path)
    load_shapes.cache_clear()
    with raises_code("table_unavailable", "table"):
        load_shapes()
    load_shapes.cache_clear()

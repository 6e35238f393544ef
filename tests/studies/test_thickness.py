"""What the documentation says of thickness and nonlinearity is what the solved curves and the table say."""

from pathlib import Path

import numpy as np
import pytest

from dummydesign.pad.fe_force_law import SolvedSlab
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import load_table
from studies import thickness as module

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def slabs():
    return module.read_curves((ROOT / module.CURVES).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def found(slabs):
    return module.study(slabs)


def exponents(rows, support):
    return {row.thickness_mm: row.exponent for row in rows if row.base == support and row.exponent is not None}


def test_curvature_of_a_power_law_is_its_power():
    depth = np.linspace(0.05, 6.0, 14)
    slab = SolvedSlab(Pad(10.0, 1.0, 7.9), depth, 3.0 * depth * np.exp(0.8 * depth / 10.0), 0 * depth + 1e-3)
    at = module.curvature_at(module.law_of([slab]), "bonded", 10.0, 4.0)
    # n = 1 + 0.8 u and dn / d ln x = 0.8 u for F = x exp(0.8 u)
    assert at.exponent == pytest.approx(1.32, abs=1e-6) and at.growth == pytest.approx(0.32, abs=1e-5)


def test_at_equal_depth_and_equal_strain_thinner_is_more_curved_on_every_support(found):
    checked = 0
    for terms in ("depth_mm", "strain"):
        for rows in found[terms].values():
            for support in {row.base for row in rows}:
                values = [value for _, value in sorted(exponents(rows, support).items())]
                assert len(values) >= 3 and np.all(np.diff(values) < 0)
                checked += 1
    assert checked == 4 * (len(module.DEPTHS_MM) + len(module.STRAINS))


def test_at_equal_force_the_thickest_slab_is_the_least_curved(found):
    checked = 0
    for rows in found["force_N"].values():
        for support in {row.base for row in rows}:
            values = exponents(rows, support)
            if len(values) == len(module.THICKNESS_MM):
                assert min(values, key=values.get) == 20.0
                checked += 1
    assert checked >= 9


def test_numbers_in_the_statement_are_those_of_the_curves(found):
    for force, thin, thick in ((5.0, 1.21, 1.05), (10.0, 1.35, 1.15)):
        values = exponents(found["force_N"][force], "bonded")
        assert round(values[5.0], 2) == thin and round(values[20.0], 2) == thick
        assert f"{thin:.2f}" in module.STATEMENT and f"{thick:.2f}" in module.STATEMENT
    ten = exponents(found["force_N"][10.0], "bonded")
    assert ten[5.0] == pytest.approx(ten[10.0], abs=0.02)


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_solved_curves_and_table_tell_the_same_exponents(found, base):
    table = load_table(base)
    for rows in found["strain"].values():
        for thickness, value in exponents(rows, base).items():
            strain = next(r.strain for r in rows if r.thickness_mm == thickness)
            pad = strain * thickness, thickness, 1.0, module.RADIUS_MM
            force, stiffness = table.force(*pad), table.stiffness(*pad)
            known = float(strain * thickness * stiffness / force)
            assert value == pytest.approx(known, abs=0.06)


def test_the_page_holds_what_the_command_writes(slabs, tmp_path):
    page = tmp_path / module.PAGE
    page.parent.mkdir()
    text = (ROOT / module.PAGE).read_text(encoding="utf-8")
    page.write_text(text, encoding="utf-8")
    module.write_page(tmp_path, slabs)
    assert page.read_text(encoding="utf-8") == text
    assert (tmp_path / module.TABLE).read_text(encoding="utf-8") == (ROOT / module.TABLE).read_text(encoding="utf-8")


def test_curves_survive_being_written(slabs):
    again = module.read_curves(module.curves_text(slabs))
    assert [slab.pad for slab in again] == [slab.pad for slab in slabs] == module.cases()
    for a, b in zip(again, slabs):
        np.testing.assert_array_equal(a.area_mm2, b.area_mm2)


@pytest.mark.slow
def test_a_curve_solved_now_is_the_curve_in_the_file(slabs):
    kept = next(slab for slab in slabs if slab.pad.thickness_mm == 5.0 and slab.pad.base == "bonded")
    now = module.solve_slab(kept.pad)
    np.testing.assert_allclose(now.area_mm2, np.interp(now.depth_mm, kept.depth_mm, kept.area_mm2), rtol=5e-3)

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import predict_static
from dummydesign.pad.tables.slab import load_filleted, load_table, slab_table
from tests.support.refusal import raises_code

RADIUS_MM = 14.0 / np.sqrt(np.pi)


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_small_fillets_tend_to_the_sharp_edge(base):
    depth = np.array([0.5, 1.0, 2.0, 3.0, 4.0])
    sharp = load_table(base).force(depth, 10.0, 0.025, RADIUS_MM)
    gaps = [
        np.abs(np.log(load_filleted(base, s).force(depth, 10.0, 0.025, RADIUS_MM) / sharp)) for s in (2e-2, 2e-3, 2e-4)
    ]
    assert np.all(gaps[2] < 4e-3)
    assert np.all(gaps[2] <= gaps[0] + 1e-3)


def test_a_larger_fillet_carries_less_at_small_depth():
    forces = [load_filleted("bonded", s).force(0.3, 10.0, 0.025, RADIUS_MM) for s in (0.03, 0.08, 0.15, 0.28)]
    assert np.all(np.diff(forces) < 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(("thickness", "fillet", "base"), [(6.5, 0.4, "bonded"), (13.0, 0.9, "sliding")])
def test_a_fillet_between_those_of_the_table_is_within_its_stated_error(thickness, fillet, base):
    depth = np.array([0.05, 0.15, 0.3, 0.45]) * thickness
    solved = solve_under_fillet(Pad(thickness, 0.025, RADIUS_MM, base=base, edge_radius_mm=fillet), depth)
    table = slab_table(base, fillet, RADIUS_MM)
    miss = np.abs(table.force(depth, thickness, 0.025, RADIUS_MM) / solved.force_N - 1.0)
    stated = table.relative_error(depth, thickness, RADIUS_MM) + solved.error_N / solved.force_N
    assert np.all(miss < stated)


def test_predict_answers_a_fillet_from_the_table_and_says_so():
    pad = Pad(10.0, 0.025, RADIUS_MM, edge_radius_mm=0.5)
    found = predict_static(pad, [1.0, 3.0])
    assert found.force_N == pytest.approx(
        slab_table("bonded", 0.5, RADIUS_MM).force([1.0, 3.0], 10.0, 0.025, RADIUS_MM)
    )
    assert found.solver["unknowns"] == 0
    assert found.force_N[0] < predict_static(Pad(10.0, 0.025, RADIUS_MM), [1.0]).force_N[0]


def test_a_fillet_on_a_shaped_pad_is_not_answered_by_the_sharp_table():
    pad = Pad(4.5, 0.025, RADIUS_MM, edge_radius_mm=0.5, geometry=read_shape("crowned:21.2,2,9.4"))
    with raises_code("not_tabulated", "edge_radius_mm"):
        predict_static(pad, [1.0])


@pytest.mark.slow
def test_on_a_crown_a_fillet_changes_nothing_before_the_contact_reaches_it_and_softens_after():
    crown, depth = read_shape("crowned:21.2,2,9.4"), np.array([0.4, 0.8, 1.6])
    sharp, filleted = (
        solve_shaped_pad(Pad(4.5, 0.025, RADIUS_MM, geometry=crown, edge_radius_mm=edge), depth).force_N
        for edge in (0.0, 0.5)
    )
    assert filleted[:2] == pytest.approx(sharp[:2], rel=8e-3)
    assert filleted[2] < 0.97 * sharp[2]

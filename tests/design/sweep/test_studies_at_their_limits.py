"""What a study may vary and what a test may press, just inside and just beyond each limit."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.design.request import NAGOYA_PROTOCOL, Request
from dummydesign.design.sweep.spec import SHOWN_N, Study, check_friction, parse_shapes
from dummydesign.design.test_conditions import (
    beyond_people,
    check_test,
    own_warnings,
    pressed_N,
    refused_kinds,
    standard_press,
    tabulated,
    tissue_warnings,
    why_solved,
)
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.geometry.punch import read_punch
from dummydesign.pad.tables.slab import load_table
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code

SQUARE = (("square:14", PUNCH_RADIUS_MM),)
STUDY = Study((5.0, 10.0), (15.0, 16.0), SQUARE)
RESIN = load_resin(STUDY.resin)
CROWN = "crowned:radius=21.2,height=2,foot=9.4"


def refused(code, quantity=None, **changes):
    with raises_code(code, quantity):
        replace(STUDY, **changes).check(RESIN)


def test_every_combination_is_named_once_the_ratio_fastest():
    study = replace(STUDY, bases=("bonded", "sliding"), shapes=("slab", CROWN))
    keys = study.keys()
    assert study.size == len(keys) == len(set(keys)) == 2 * 2 * 2 * 2
    assert [key[-2:] for key in keys[:4]] == [(5.0, 15.0), (5.0, 16.0), (10.0, 15.0), (10.0, 16.0)]
    assert keys[0][:5] == ("square:14", "bonded", "bonded", "slab", 0.0) and keys[-1][2:4] == ("sliding", CROWN)
    assert len(study.setups) == 2 and len(study.pads) == 2


def test_scores_are_those_of_the_paper_unless_forces_are_named():
    assert replace(STUDY, forces_N=(15.0, 1.0, 5.0, 10.0)).protocol.forces_N == NAGOYA_PROTOCOL.forces_N
    assert STUDY.forces_N == SHOWN_N
    assert replace(STUDY, forces_N=(8.0, 4.0, 8.0)).protocol.forces_N == (4.0, 8.0)
    sampling = replace(STUDY, hold_s=3.0, deceleration_mm_s2=1e4).sampling
    assert (sampling.hold_s, sampling.deceleration_mm_s2) == (3.0, 1e4)


def test_what_a_study_may_hold():
    STUDY.check(RESIN)
    replace(STUDY, thickness_mm=(4.0, 20.0), velocities_mm_s=(0.1,), forces_N=(0.01,), hold_s=0.05).check(RESIN)
    refused("unknown_name", fidelity="2d")
    refused("out_of_range", thickness_mm=(2.9,))
    refused("out_of_range", thickness_mm=(30.5,))
    refused("out_of_range", ratio=(5.0,))
    for name in ("forces_N", "velocities_mm_s"):
        refused("out_of_range", **{name: (5.0, 0.0)})
    refused("out_of_range", hold_s=0.04)
    refused("duplicate", thickness_mm=(5.0, 10.0, 5.0))
    refused("duplicate", bases=("bonded", "bonded"))
    refused("unknown_name", bases=("glued",))
    refused("not_tabulated", conditions=("frictionless",))
    refused("not_tabulated", bases=("sliding",), shapes=(CROWN,))
    refused("unsupported", fidelity="3d", shapes=(CROWN,))
    refused("unsupported", fidelity="3d", punches=(("round:16", 8.0),))
    refused("too_large", thickness_mm=tuple(np.linspace(4.0, 20.0, 2000)), ratio=tuple(np.linspace(14.0, 17.0, 2000)))


def test_punches_lie_in_the_table_on_all_thicknesses():
    low, high = load_table("bonded").ratio_range
    for ratio, allowed in ((low * 1.001, True), (low * 0.999, False), (high * 0.999, True), (high * 1.001, False)):
        study = replace(STUDY, thickness_mm=(8.0, 10.0), punches=(("round:x", ratio * (10.0 if ratio < 1.0 else 8.0)),))
        if allowed:
            study._check_setups()
            continue
        with raises_code("out_of_range"):
            study._check_setups()


def test_frictions_are_solved_axisymmetric_alone_and_from_0_to_5():
    replace(STUDY, fidelity="axisymmetric", conditions=("friction:0.3", "frictionless")).check(RESIN)
    for coefficient in ("0", "5"):
        check_friction(f"friction:{coefficient}")
    for wrong in ("friction:5.1", "friction:-0.1", "friction:x"):
        with raises_code("out_of_range"):
            check_friction(wrong)
    known = {}
    for fidelity in ("axisymmetric", "3d"):
        with pytest.raises(InputError) as caught:
            replace(STUDY, fidelity=fidelity, conditions=("glued",)).check(RESIN)
        known[fidelity] = caught.value.allowed
    assert len(known["axisymmetric"]) == len(known["3d"]) + 1
    refused("unknown_name", fidelity="3d", conditions=("friction:0.3",))


@pytest.mark.parametrize(("edge", "allowed"), [(0.5, True), (2.1, True), (3.6, False), (-0.1, False)])
def test_fillets_are_a_share_of_the_half_width(edge, allowed):
    study = replace(STUDY, edge_radii_mm=(0.0, edge))
    if allowed:
        study.check(RESIN)
        return
    with raises_code("out_of_range"):
        study.check(RESIN)


def test_fillets_are_of_slabs_by_their_tables_and_of_round_pads_solved():
    refused("not_tabulated", edge_radii_mm=(0.5,), shapes=(CROWN,))
    refused("unsupported", edge_radii_mm=(0.5,), fidelity="3d")
    refused("unsupported", edge_radii_mm=(0.5,), shapes=(CROWN,), fidelity="axisymmetric", conditions=("frictionless",))
    replace(STUDY, edge_radii_mm=(0.5,), shapes=(CROWN,), fidelity="axisymmetric").check(RESIN)


def test_shapes_that_no_thickness_holds_are_refused():
    refused("cannot_be_made", thickness_mm=(3.0,), shapes=("crowned:radius=21.2,height=2.5,foot=10",))
    replace(STUDY, thickness_mm=(3.0, 5.0), shapes=(CROWN,)).check(RESIN)


def test_ranges_of_shapes_are_all_their_combinations():
    made = parse_shapes("slab, crowned:radius=20/22,height=2:3:0.5,foot=9")
    assert len(made) == 1 + 2 * 3 and made[0] == "slab" and len(set(made)) == 7
    many = "crowned:radius=1:100:0.01,height=1:9:0.01"
    for text, code in (("", "missing"), ("pyramid", "unknown_name"), (many, "too_large")):
        with raises_code(code):
            parse_shapes(text)


def test_punches_taken_for_their_circle_are_named():
    assert STUDY.reduced == [] and replace(STUDY, shapes=(CROWN,)).reduced == ["square:14"]
    wide = (("rectangle:20x10", float(np.sqrt(200.0 / np.pi))),)
    assert replace(STUDY, punches=wide).reduced == ["rectangle:20x10"]
    assert replace(STUDY, punches=(("round:16", 8.0),)).reduced == []
    assert replace(STUDY, fidelity="3d", punches=wide).reduced == []


def test_slabs_are_kept_where_the_table_holds_the_punch():
    request = Request("palm")
    punch = read_punch("square:14")
    low, high = load_table("bonded").ratio_range
    thickness = np.array([3.0, 5.0, 10.0, 20.0, 30.0])
    kept = tabulated(thickness, request, punch)
    ratio = punch.radius_mm / thickness
    np.testing.assert_array_equal(kept, thickness[(ratio >= low) & (ratio <= high)])
    with raises_code("out_of_range"):
        tabulated(np.array([3.0]), request, SimpleNamespace(radius_mm=3.05 * high))
    with raises_code("out_of_range", "punch_radius_mm"):
        tabulated(thickness, request, SimpleNamespace(radius_mm=31.0 * high))


@pytest.mark.parametrize(("side", "allowed"), [(21.0, True), (20.9, False)])
def test_a_pad_is_at_least_one_and_a_half_times_the_punch(side, allowed):
    """As the error says."""
    request = Request("palm", shape="slab", pad_mm=(60.0, side))
    if allowed:
        check_test(request, read_punch(request.punch))
        return
    with raises_code("out_of_range", "pad_mm"):
        check_test(request, read_punch(request.punch))


def built_in(**more):
    return SimpleNamespace(origin="built-in", name="palm", parameter_sets=(), subjects=(), **more)


def test_a_built_in_tissue_is_known_from_5_to_15_newtons_under_its_punch():
    assert tissue_warnings(built_in(), "square:14", 0.0, (5.0, 15.0)) == []
    for forces in ((4.9, 10.0), (10.0, 15.1)):
        assert [code for code, _ in tissue_warnings(built_in(), "square:14", 0.0, forces)] == ["force_not_in_band"]
    assert [code for code, _ in tissue_warnings(built_in(), "square:14", 0.5, (10.0,))] == ["tissue_punch"]
    assert [code for code, _ in tissue_warnings(built_in(), "round:16", 0.0, (10.0,))] == ["tissue_punch"]
    own = SimpleNamespace(origin="file", name="own", parameter_sets=(), subjects=())
    assert tissue_warnings(own, "round:16", 0.5, (1.0, 99.0)) == []
    request = Request("palm", force_N=(10.0, 30.0))
    forces_N = request.protocol.forces_N
    assert beyond_people(forces_N, built_in()) == 2.0 and beyond_people(NAGOYA_PROTOCOL.forces_N, built_in()) == 1.0
    assert beyond_people(forces_N, own) == 1.0 and pressed_N(own) is None
    presses = [SimpleNamespace(hold_s=10.0, steady_N=lambda hold, f=f: f + hold) for f in (2.0, 5.0)]
    measured = SimpleNamespace(origin="file", parameter_sets=(SimpleNamespace(presses=presses),), subjects=())
    assert pressed_N(measured) == (12.0, 15.0)


def test_what_a_test_of_ones_own_must_say():
    request, square = Request("palm"), read_punch("square:14")
    assert own_warnings(request, square, built_in(), True) == [] and standard_press(request)
    rectangle = replace(request, punch="rectangle:20x10")
    codes = [code for code, _ in own_warnings(rectangle, read_punch(rectangle.punch), built_in(), True)]
    assert codes == ["tissue_punch", "equal_area_punch"]
    sliding = replace(request, condition="frictionless", edge_radius_mm=0.5)
    assert [code for code, _ in own_warnings(sliding, square, built_in(), True)] == ["tissue_punch", "equal_area_punch"]
    ((_, _), (code, text)) = own_warnings(replace(request, edge_radius_mm=0.5), square, built_in(), False)
    assert code == "fillet" and "6.5 mm from the centre" in text and "a punch 1 mm narrower" in text
    for change in ({"pad_mm": (100.0, 120.0)}, {"base": "sliding"}, {"edge_radius_mm": 0.1}, {"punch": "round:16"}):
        assert not standard_press(replace(request, **change))


def test_slabs_near_their_rim_or_under_another_face_are_solved():
    request, square = Request("palm"), read_punch("square:14")
    assert why_solved(request, square, 10.0) == ""
    small = replace(request, pad_mm=(30.0, 30.0))
    assert "rim" in why_solved(small, square, 20.0)
    assert "tables" in why_solved(replace(request, punch="ball:20"), read_punch("ball:20"), 10.0)


def test_kinds_are_refused_for_tests_that_their_tables_do_not_hold():
    request, square = Request("palm"), read_punch("square:14")
    assert refused_kinds(request, square) == {}
    sliding = refused_kinds(replace(request, base="sliding"), square)
    assert "crowned" not in sliding and {"boned", "layered"} <= set(sliding)
    assert "crowned" in refused_kinds(replace(request, base="sliding", verify=False), square)
    ball = refused_kinds(replace(request, punch="ball:20"), read_punch("ball:20"))
    assert {"boned", "layered", "crowned"} <= set(ball) and "slab" not in ball

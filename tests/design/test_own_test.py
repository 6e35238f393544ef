"""One's own test: forces, speeds, hold, punch and pad change the answer as physics says."""

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.assessment.decision import ShapeComparison, low_force
from dummydesign.design.assessment.warnings import _reasons
from dummydesign.design.problem import read_problem
from dummydesign.design.request import NAGOYA_PROTOCOL, Protocol, Request
from dummydesign.design.scoring.law_parameters import gamma1_score
from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, make_curves
from dummydesign.design.scoring.score import evaluate, steady_gamma1
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.verdict import ranges_of
from dummydesign.design.suggest import design, suggest
from dummydesign.design.test_conditions import refused_kinds
from dummydesign.geometry.punch import read_punch
from dummydesign.tissue.model.ranges import force_range
from dummydesign.tissue.model.tissue_file import load_tissue
from tests.support.refusal import raises_code
from tests.support.slab_by_formula import LayerLaw

FINGER = "forefinger"


def one_slab(tau_s=(), beta=()):
    curves = make_curves(LayerLaw(), [6.0], 7.9, 0.6)
    return PadBatch(
        curves, np.array([0]), np.array([0.03]), tuple(tau_s), np.array([list(beta)]).reshape(1, len(tau_s))
    )


def test_the_grids_of_the_papers_test_are_those_of_the_paper():
    np.testing.assert_array_equal(NAGOYA_PROTOCOL.steady_grid_N, np.linspace(5.0, 15.0, 41))
    np.testing.assert_array_equal(NAGOYA_PROTOCOL.low_grid_N, np.arange(1, 11) * 0.5)
    assert NAGOYA_PROTOCOL.exponent_at_N == (0.5, 1.0, 5.0, 10.0, 15.0) and NAGOYA_PROTOCOL.needed_N == 10.0


@pytest.mark.parametrize("hold_s", [0.3, 1.0, 3.0])
def test_the_subjects_steady_depth_is_that_at_the_end_of_the_hold(hold_s):
    tissue = load_tissue(FINGER)
    targets = make_targets(tissue, "average", Sampling(hold_s=hold_s), Protocol((2.0, 6.0), (20.0,)))
    for force in (2.0, 4.4, 6.0):
        stiff, soft = (float(side[0]) for side in targets.depth_range_mm(np.array([force])))
        own = force_range(tissue.parameter_sets, force, 20.0, hold_s).depth_mm
        np.testing.assert_allclose([stiff, soft], [own.min(), own.max()], rtol=2e-4)
    aim = force_range((targets.parameters,), 4.0, 20.0, hold_s).depth_mm[0]
    assert targets.aim_depth_mm(np.array([4.0]))[0] == pytest.approx(aim, rel=2e-4)


def test_a_short_hold_makes_the_subjects_stiffer_and_a_long_one_is_the_relaxed_cube():
    tissue = load_tissue(FINGER)
    short, long = (make_targets(tissue, "average", Sampling(hold_s=hold)) for hold in (1.0, 10.0))
    force = np.array([5.0, 15.0])
    assert (short.aim_depth_mm(force) < 0.99 * long.aim_depth_mm(force)).all()
    np.testing.assert_allclose(long.aim_depth_mm(force), np.cbrt(force / long.parameters.gamma1_N_per_mm3))


@pytest.mark.parametrize("hold_s", [0.5, 10.0])
def test_a_pad_that_is_the_aim_has_the_full_gamma1_score_at_any_hold(hold_s):
    targets = make_targets(load_tissue(FINGER), "average", Sampling(hold_s=hold_s))
    assert gamma1_score(np.array([targets.steady_gamma1_N_per_mm3]), targets)[0] == pytest.approx(1.0)


def test_the_hold_of_the_test_reaches_scores_misfit_and_verdict():
    slabs = one_slab((2.0,), (1.0,))
    found = {}
    for hold in (1.0, 10.0):
        targets = make_targets(load_tissue(FINGER), "average", Sampling(hold_s=hold))
        evaluation = evaluate(slabs, targets)
        gamma1 = steady_gamma1(slabs, targets.protocol, targets.sampling.coarse)[0]
        found[hold] = (evaluation.steady_depth_mm[0, 20], gamma1, ranges_of(targets).soft_mm[20])
    # with an arm of 2 s a pad still carries part of it after 1 s: it is less deep and looks stiffer
    assert found[1.0][0] < 0.95 * found[10.0][0] and found[1.0][1] > 1.1 * found[10.0][1]
    assert found[1.0][2] < 0.99 * found[10.0][2]


def test_a_test_of_other_forces_is_scored_over_its_own_forces():
    protocol = Protocol((2.0, 4.0, 8.0), (100.0,))
    targets = make_targets(load_tissue(FINGER), "average", Sampling(), protocol)
    evaluation = evaluate(one_slab(), targets)
    assert evaluation.depth_mm.shape == (1, 3)
    np.testing.assert_allclose(ranges_of(targets).steady_N[[0, -1]], [2.0, 8.0])
    assert evaluation.steady_depth_mm.shape == (1, 41) and evaluation.feasible.all()


def test_a_tissue_and_a_pad_stiffer_by_the_same_factor_at_forces_that_are_too_have_the_same_scores(tmp_path):
    from dataclasses import replace

    from tests.support.slab_by_formula import make_tissue

    factor = 2.0
    plain, stiff = make_tissue((0.6, 0.9, 1.3)), make_tissue((1.2, 1.8, 2.6))
    scores = []
    for tissue, forces, young in ((plain, (5.0, 10.0, 15.0), 0.03), (stiff, (10.0, 20.0, 30.0), 0.03 * factor)):
        targets = make_targets(tissue, "average", Sampling(), Protocol(forces, (10.0,)))
        slabs = replace(one_slab(), young_MPa=np.array([young]))
        found = evaluate(slabs, targets)
        scores.append((found.steady_state_range[0], found.depth_mm[0, 0]))
    assert scores[0] == pytest.approx(scores[1], rel=1e-6)


@pytest.mark.slow
def test_one_force_and_one_speed_are_a_test():
    asked = Request(FINGER, force_N=(8.0,), velocity_mm_s=(50.0,), shape="slab", verify=False)
    answer = design(read_problem(asked, LayerLaw()))
    assert len(answer.to_dict()["recommendation"]["conditions"]) == 1
    assert low_force(answer.best, answer.targets).exponent_at_N.keys() == {"0.8", "1.6", "8"}


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"pad_mm": (15.0, 15.0)}, "out_of_range"),
        ({"force_N": (400.0,)}, "out_of_range"),
        ({"velocity_mm_s": (0.0,)}, "out_of_range"),
        ({"hold_s": -1.0}, "out_of_range"),
        ({"punch": "plate"}, "not_applicable"),
        ({"base": "loose"}, "unknown_name"),
        ({"edge_radius_mm": 5.0}, "out_of_range"),
        ({"punch": "round:150"}, "out_of_range"),
        ({"punch": "round:40", "thickness_mm": (3.0, 4.0), "pad_mm": (150.0, 120.0)}, "out_of_range"),
        ({"preset": "shut"}, "unknown_name"),
        ({"punch": "ball:20", "shape": "crowned"}, "unsupported"),
        ({"condition": "glue"}, "unknown_name"),
        ({"condition": "frictionless"}, "unsupported"),
        ({"condition": "friction:0"}, "unsupported"),
        ({"condition": "friction:0.3", "shape": "crowned"}, "unsupported"),
        ({"condition": "friction:0.3", "edge_radius_mm": 0.5, "base": "friction:0.3"}, "unsupported"),
    ],
)
def test_what_cannot_be_pressed_is_refused_before_the_work_in_one_line(given, code):
    with raises_code(code) as caught:
        suggest(Request(FINGER, verify=False, **({"shape": "slab"} | given)))
    assert "\n" not in str(caught.value)


def test_a_resting_base_leaves_the_crowned_pad_and_needs_its_elements():
    request = Request(FINGER, base="sliding")
    assert set(refused_kinds(request, read_punch(request.punch))) == {"layered", "boned"}
    unverified = Request(FINGER, base="sliding", verify=False)
    assert "crowned" in refused_kinds(unverified, read_punch(unverified.punch))
    assert refused_kinds(Request(FINGER), read_punch("square:14")) == {}


def test_a_face_that_is_not_glued_leaves_slabs():
    request = Request(FINGER, condition="friction:0.3")
    assert set(refused_kinds(request, read_punch(request.punch))) == {"layered", "boned", "crowned"}
    assert [Request(FINGER, punch=punch).face for punch in ("square:14", "ball:20")] == ["bonded", "frictionless"]
    assert Request(FINGER).to_dict()["condition"] == "bonded"


def test_kinds_that_are_refused_for_the_same_reason_are_warned_of_in_one_line():
    def beside(kind, reason):
        return ShapeComparison(kind, None, None, None, None, reason)

    compared = (
        beside("crowned", "crowned pads need glue"),
        beside("boned", "boned pads need glue"),
        beside("layered", "nothing reaches 10 N"),
        beside("slab", "slabs are tabulated on 14 mm"),
    )
    wanted = ["crowned, boned pads need glue", "nothing reaches 10 N", "slabs are tabulated on 14 mm"]
    assert _reasons(compared) == wanted


def test_the_default_test_takes_the_table_itself():
    law = read_problem(Request(FINGER)).slab_law
    from dummydesign.pad.force_law import ScaledLaw
    from dummydesign.pad.tables.slab import load_table

    assert isinstance(law, ScaledLaw) and law.law is load_table(base="bonded")


@pytest.mark.slow
def test_a_larger_punch_on_the_same_slab_needs_a_softer_resin_for_the_same_tissue():
    def young(punch):
        asked = Request(FINGER, punch=punch, shape="slab", thickness_mm=(6.0, 6.0), verify=False)
        return suggest(asked).to_dict()["recommendation"]["young_kPa"]["value"]

    assert young("round:20") < 0.8 * young("round:15")


def test_under_a_wide_punch_exponents_are_known_for_pads_that_are_tabulated_and_no_others():
    from dummydesign.design.plot_data import THICKNESS_GRID_MM, exponent_over_thickness, force_grids
    from dummydesign.pad.tables.slab import load_table
    from dummydesign.resin import load_resin

    resin, table = load_resin("polyurethane-nagoya"), load_table("bonded")
    targets = SimpleNamespace(limits=SimpleNamespace(gel_compression=0.6))
    answer = SimpleNamespace(radius_mm=12.0, resin=resin, best=SimpleNamespace(ratio=15.0), targets=targets)
    found = exponent_over_thickness(answer, table, force_grids(NAGOYA_PROTOCOL))
    tabulated = 12.0 / THICKNESS_GRID_MM <= table.ratio_range[1]
    assert not tabulated.all() and np.isnan(found[~tabulated]).all()
    assert (found[tabulated, 0] >= 1.0).all()


@pytest.mark.parametrize(
    ("forces", "factor"), [((5.0, 15.0), 1.0), ((2.0,), 1.0), ((140.0,), 140 / 15), ((5.0, 30.0), 2.0)]
)
def test_how_far_a_test_goes_beyond_the_people_of_a_built_in_tissue_is_a_factor_in_its_warning(forces, factor):
    from dummydesign.design.test_conditions import beyond_people, tissue_warnings

    request, finger = Request(FINGER, force_N=forces), load_tissue(FINGER)
    assert beyond_people(request.protocol.forces_N, finger) == pytest.approx(factor)
    said = dict(tissue_warnings(finger, "square:14", 0.0, request.protocol.forces_N))
    assert ("force_not_in_band" in said) == (forces != (5.0, 15.0))
    assert (f"{factor:.3g} times" in said.get("force_not_in_band", "")) == (factor > 1.0)


def test_people_are_known_as_far_as_they_were_pressed_and_a_fit_that_does_not_say_is_unknown():
    from dataclasses import replace

    from dummydesign.core.quantity import Quantity
    from dummydesign.design.test_conditions import beyond_people, tissue_warnings
    from dummydesign.tissue.model.measured_curves import SHARES, HeldPress, MeasuredPerson
    from dummydesign.tissue.model.subject import PRESSED

    def person(*steady):
        held = [
            HeldPress(10.0, force, force * SHARES, np.array([0.0, 10.0]), np.array([2.0, 1.0]) * force)
            for force in steady
        ]
        return MeasuredPerson(held)

    finger = load_tissue(FINGER)
    own = replace(finger, origin="user")
    assert beyond_people((140.0,), own) == 1.0
    span = {name: Quantity(5.0, 2.0, 10.0, "measured", "presses") for name in PRESSED}
    fitted = replace(own, subjects=tuple(replace(one, pressed=span) for one in own.subjects))
    assert beyond_people((5.0, 25.0), fitted) == pytest.approx(2.5)
    for force, codes in ((11.9, []), (1.7, []), (12.1, ["force_not_in_band"]), (1.6, ["force_not_in_band"])):
        assert [code for code, _ in tissue_warnings(fitted, "square:14", 0.0, (5.0, force))] == codes
    people = (person(2.0, 7.0), person(3.0, 10.0))
    subjects = tuple(replace(one, parameters=made) for one, made in zip(finger.subjects, people))
    curves = replace(own, subjects=subjects)
    assert beyond_people((5.0, 25.0), curves) == pytest.approx(2.5)
    assert beyond_people((5.0, 10.0), curves) == 1.0

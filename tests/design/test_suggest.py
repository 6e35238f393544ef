"""The design does not know which resin or tissue it serves: thinned silicones, single subjects, other laws."""

import dataclasses

import numpy as np
import pytest

from dummydesign.core.quantity import Quantity
from dummydesign.design.assessment.pad_castings import pour_yield
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.suggest import design
from dummydesign.resin import load_resin
from dummydesign.resin.model.modulus_laws import LAWS
from dummydesign.resin.model.resin import Liquid
from dummydesign.resin.model.resin_file import save_resin
from tests.support.refusal import raises_code
from tests.support.slab_by_formula import make_tissue


def number(value, spread=1.05):
    return Quantity(value, value / spread, value * spread, "measured", "made for this test")


@pytest.fixture
def thinned(tmp_path):
    """A silicone of two parts with thinner, as a file."""
    liquids = tuple(
        Liquid(name, parts, number(1.05), number(3.0)) for name, parts in (("A", 50.0), ("B", 50.0), ("thinner", None))
    )
    resin = dataclasses.replace(
        load_resin(),
        name="thinned-silicone",
        ratio_meaning="thinner parts per 100 A+B by weight",
        ratio_min=0.0,
        ratio_max=100.0,
        ratio_step=0.5,
        liquids=liquids,
        law=LAWS["polymer_fraction"],
        numbers={"young_neat_kPa": number(110.0), "exponent": number(3.0)},
        arms=(),
        relaxation_ratio_ref=0.0,
    )
    return str(save_resin(resin, tmp_path / "thinned.toml"))


@pytest.mark.slow
def test_a_thinned_silicone_is_designed_with_its_own_components(thinned, layer_law):
    answer = design(read_problem(Request("forefinger", resin=thinned, verify=False, shape="slab"), layer_law)).to_dict()
    best = answer["recommendation"]
    masses = {item["name"]: item["mass_g"] for item in best["recipe"]["components"]}
    assert best["ratio_meaning"] == "thinner parts per 100 A+B by weight" and best["prony"] == []
    assert masses["A"] == pytest.approx(masses["B"], abs=0.11)
    if best["ratio"]:
        thinner = 100 * masses["thinner"] / (masses["A"] + masses["B"])
        assert thinner == pytest.approx(best["ratio"], abs=0.3)
    assert answer["rests_on"]["resin"]["inferred_or_assumed"] <= 1
    slope = answer["sensitivity"]["d_ln_young_per_percent_ratio"]
    assert slope == pytest.approx(-0.03 * best["ratio"] / (100 + best["ratio"]), abs=1e-6)


@pytest.mark.slow
def test_a_measured_resin_makes_more_pours_stay_inside(layer_law):
    answer = design(read_problem(Request("forefinger", verify=False, shape="slab"), layer_law))
    resin = answer.resin
    known = {
        name: dataclasses.replace(q, low=q.value - 0.1 * (q.value - q.low), high=q.value + 0.1 * (q.high - q.value))
        for name, q in resin.numbers.items()
    }
    castings = dataclasses.replace(answer.castings.castings, resin=dataclasses.replace(resin, numbers=known))
    narrow = pour_yield(dataclasses.replace(answer.castings, castings=castings))
    wide = answer.pour
    assert narrow.making_only_fraction == wide.making_only_fraction
    assert wide.yield_fraction < narrow.yield_fraction <= narrow.making_only_fraction + 0.05


def tissue_file(tmp_path, tissue):
    from dummydesign.tissue.model.tissue_file import tissue_toml

    path = tmp_path / "mine.toml"
    path.write_text(tissue_toml(tissue), encoding="utf-8")
    return str(path)


@pytest.mark.slow
def test_a_single_subject_can_be_followed(tmp_path, layer_law):
    asked = Request(tissue_file(tmp_path, make_tissue((1.2,))), verify=False, shape="slab")
    answer = design(read_problem(asked, layer_law))
    best = answer.best
    depth = best.evaluation.depth_mm[best.index, 1]
    assert depth == pytest.approx(np.cbrt(10.0 / 1.2), rel=0.15)
    assert answer.to_dict()["recommendation"]["scores"]["aim"] >= 0.0


@pytest.mark.slow
def test_one_subject_is_said_to_make_no_range_and_has_no_share_of_castings(tmp_path, layer_law):
    asked = Request(tissue_file(tmp_path, make_tissue((1.2,))), verify=False, shape="slab")
    answer = design(read_problem(asked, layer_law)).to_dict()
    codes = {item["code"] for item in answer["warnings"]}
    assert "one_subject" in codes and not codes & {"low_yield", "outside_steady_range"}
    assert answer["verdict"]["subjects"] == 1 and answer["verdict"]["light"] != "green"


@pytest.mark.slow
def test_speeds_and_law_come_from_the_tissue(tmp_path, layer_law):
    asked = Request(tissue_file(tmp_path, make_tissue(law="published")), verify=False, shape="slab")
    answer = design(read_problem(asked, layer_law)).to_dict()
    assert answer["recommendation"]["parameters_law"] == "published"


@pytest.mark.slow
def test_contradictory_points_reach_the_answer(tmp_path, layer_law):
    from dummydesign.resin.model.resin import Point
    from dummydesign.resin.update import update_resin

    resin = update_resin(load_resin(), [Point(15.0, number(50.0)), Point(16.0, number(35.0))], "mine")
    path = str(save_resin(resin, tmp_path / "mine.toml"))
    asked = Request("forefinger", resin=path, verify=False, shape="slab")
    warnings = design(read_problem(asked, layer_law)).to_dict()["warnings"]
    assert any(item["code"] == "contradictory_points" for item in warnings)


@pytest.mark.slow
def test_measured_points_narrow_the_ratio_that_is_recommended(tmp_path, layer_law):
    from dummydesign.resin.model.resin import Point
    from dummydesign.resin.update import update_resin

    resin = update_resin(load_resin(), [Point(15.0, number(26.0)), Point(16.0, number(65.0))], "mine")
    path = str(save_resin(resin, tmp_path / "mine.toml"))
    widths = []
    for name in ("polyurethane-nagoya", path):
        asked = Request("forefinger", resin=name, verify=False, shape="slab")
        found = design(read_problem(asked, layer_law)).to_dict()["rests_on"]
        widths.append(found["ratio_high"] - found["ratio_low"])
    assert widths[1] < 0.4 * widths[0]


def test_unknown_shapes_are_refused(layer_law):
    with raises_code("unknown_name", "shape"):
        design(read_problem(Request("palm", shape="cube"), layer_law))

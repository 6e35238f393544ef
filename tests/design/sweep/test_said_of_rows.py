"""What a study of many pads says of its tissue and of several crowns, as the answer on one pad does."""

import pytest

import dummydesign
from dummydesign.tissue.adding.from_traces import add_curves
from tests.support.fung_people import PEOPLE, write_table

TWO = "crowned:radius=14,height=4,sites_along=2,pitch_along=40"
FOUR = "crowned:radius=14,height=4,sites_along=2,pitch_along=40,sites_across=2,pitch_across=40"


def codes(found):
    return [warning["code"] for warning in found.to_dict()["warnings"]]


def test_one_crown_of_several_is_said_once_for_all_rows_as_for_one_pad():
    many = dummydesign.whatif([8, 9, 10], [15, 16], shape=["slab", TWO, FOUR])
    one = dummydesign.predict(8, young_kPa=25, depth_mm=[1], shape=TWO)
    assert codes(many).count("several_sites") == codes(one).count("several_sites") == 1
    said = next(w["message"] for w in many.to_dict()["warnings"] if w["code"] == "several_sites")
    assert "one of 2 or 4 crowns is pressed as if it were alone" in said


def test_a_single_crown_and_a_slab_are_not_warned_of():
    assert "several_sites" not in codes(dummydesign.whatif([8, 9], [15], shape=["slab", "crowned:radius=14,height=4"]))


@pytest.fixture
def measured(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    add_curves("mine", str(write_table(tmp_path / "c.csv", PEOPLE[:2])), "none", "5")
    return "mine"


@pytest.mark.slow
def test_rows_and_one_pad_against_measured_curves_say_so_and_have_no_parameters(measured):
    many = dummydesign.whatif([5, 6], [15], tissue=measured)
    one = dummydesign.predict(5, young_kPa=25, tissue=measured)
    assert codes(many)[0] == "measured_curves" and "measured_curves" in codes(one)
    for row in many.rows:
        assert row["score"]["parametric"] is None and 0.0 < row["score"]["total"] < 1.0
    weights = {"aim": 0.6, "steady_state_range": 0.15, "force_variation_range": 0.15}
    row = many.rows[0]["score"]
    total = sum(weight * row[name] for name, weight in weights.items()) / sum(weights.values())
    assert row["total"] == pytest.approx(total, rel=1e-9)

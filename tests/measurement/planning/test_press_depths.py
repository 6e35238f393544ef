"""The plan gives the depth of each force and the force of each depth, by the pad's own law and with its interval."""

from __future__ import annotations

import json
import re

import pytest

import dummydesign
from dummydesign.api.campaigns import plan_campaign
from dummydesign.cli.entry import run
from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity
from dummydesign.loop.model.material import Material, material_of
from dummydesign.loop.planning import expected_presses
from dummydesign.measurement.campaign import Campaign, PadSpec, PunchSpec
from dummydesign.measurement.campaign_plan import PlanSettings, make_plan
from dummydesign.resin import load_resin

pytestmark = pytest.mark.slow

RESIN = ["--resin", "polyurethane-nagoya", "--ratio", "15.4"]
CROWN = "crowned:radius=21.2,height=2,foot=9.4"
ONE_DAY = ["--repeats", "1", "--ages", "7", "--no-power"]


def planned(tmp_path, capsys, *words):
    assert run(["campaign", "new", str(tmp_path / "c"), *ONE_DAY, *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out), (tmp_path / "c" / "sheet.html").read_text()


def pressed_to(trial, **given):
    """Steady force of ``predict`` at the sheet's depth, along the planned ramp and hold."""
    from dummydesign.api.predictions import pad_of_inputs
    from dummydesign.measurement.motion import ramp_and_hold
    from dummydesign.pad.predict import predict_motion

    asked = {
        "young_kPa": None,
        "resin": None,
        "ratio": None,
        "punch": "square:14",
        "condition": "bonded",
        "base": "bonded",
        "pad": "slab:150x120",
        "shape": "slab",
        "poisson": 0.5,
        "law": "neo-hookean",
        "edge_radius_mm": 0.0,
        "prony": None,
        "thickness_mm": trial["thickness_mm"],
        **given,
    }
    fidelity = asked.pop("fidelity", "table")
    pad, _, _ = pad_of_inputs(asked)
    motion = ramp_and_hold(trial["velocity_mm_s"], trial["expected_depth_mm"], trial["hold_s"], 30000.0)
    return predict_motion(pad, motion, fidelity).steady_force_N


@pytest.mark.parametrize(
    "words, given",
    [
        (["--young", "25"], {"young_kPa": 25.0}),
        (RESIN, {"resin": "polyurethane-nagoya", "ratio": 15.4}),
        (
            [*RESIN, "--punch", "round:16", "--base", "sliding"],
            {"resin": "polyurethane-nagoya", "ratio": 15.4, "punch": "round:16", "base": "sliding"},
        ),
        ([*RESIN, "--shape", CROWN], {"resin": "polyurethane-nagoya", "ratio": 15.4, "shape": CROWN}),
        (
            ["--young", "60", "--pad", "cylinder:50", "--contact", "frictionless"],
            {
                "young_kPa": 60.0,
                "pad": "cylinder:50",
                "punch": "plate",
                "condition": "frictionless",
                "fidelity": "axisymmetric",
            },
        ),
    ],
    ids=["slab", "resin", "round sliding", "crown", "puck"],
)
def test_pressed_to_the_sheets_depth_the_pad_carries_the_sheets_force(words, given, tmp_path, capsys):
    found, page = planned(tmp_path, capsys, *words, "--pads", "6,10", "--force", "2,5")
    assert len(found["trials"]) == 8
    for trial in found["trials"]:
        # A solved curve meets other depths exactly than the whole range does.
        near = 0.01 if "fidelity" in given else 2e-3
        assert pressed_to(trial, **given) == pytest.approx(trial["target_force_N"], rel=near)
        assert f">{trial['expected_depth_mm']:.3g} (" in page
    assert read_toml_keys(tmp_path) == {"target_force_N"}


def read_toml_keys(tmp_path):
    text = (tmp_path / "c" / "campaign.toml").read_text()
    return set(re.findall(r"^((?:target|expected)_\w+) =", text, re.MULTILINE))


def test_depths_rise_with_the_force_and_lie_inside_their_interval(tmp_path, capsys):
    found, _ = planned(tmp_path, capsys, *RESIN, "--pads", "6,12", "--force", "1,2,4", "--velocity", "10")
    for pad in (6.0, 12.0):
        rows = sorted((t for t in found["trials"] if t["thickness_mm"] == pad), key=lambda t: t["target_force_N"])
        for name in ("expected_depth_mm", "expected_depth_low_mm", "expected_depth_high_mm"):
            values = [row[name] for row in rows]
            assert values == sorted(values) and len(set(values)) == 3
        assert all(r["expected_depth_low_mm"] < r["expected_depth_mm"] < r["expected_depth_high_mm"] for r in rows)
    assert found["expected"]["young_kPa"]["low"] < found["expected"]["young_kPa"]["value"]


def campaign_of(**pad):
    given = {"young_kPa_nominal": None, "resin": None, "ratio": None, **pad}
    return Campaign(
        "c",
        None,
        PadSpec(**given, shape="slab", length_mm=150.0, width_mm=120.0, diameter_mm=None, base="bonded"),
        PunchSpec("square", 14.0, None, "bonded"),
        None,
        0.01,
        (),
    )


def test_the_interval_brackets_the_depths_at_both_ends_of_the_modulus():
    plan = make_plan(PlanSettings((6.0, 12.0), (10.0, 250.0), (2.0, 5.0), ages_days=(7.0,), repeats=1))
    campaign = campaign_of(resin="polyurethane-nagoya", ratio=15.4)
    material = material_of(campaign)
    modulus = load_resin("polyurethane-nagoya").modulus_kPa(15.4)
    assert material.young_kPa == modulus
    nominal = expected_presses(plan, campaign, material)
    for end, name in ((modulus.low, "high"), (modulus.high, "low")):
        at_end = expected_presses(plan, campaign, Material(Quantity(end, end, end, "assumed", ""), material.prony))
        for one, other in zip(nominal, at_end, strict=True):
            # Beyond the modulus' own end by the law's error alone.
            bound = getattr(one, name)
            assert abs(bound - one.value) >= abs(other.value - one.value)
            assert bound == pytest.approx(other.value, rel=0.05)


def test_a_plan_by_depth_has_the_forces(tmp_path, capsys):
    found, page = planned(tmp_path, capsys, *RESIN, "--pads", "10", "--depth", "1,3", "--velocity", "10")
    given = {"resin": "polyurethane-nagoya", "ratio": 15.4, "velocity_mm_s": 10.0}
    for trial in found["trials"]:
        depth, force = trial["target_depth_mm"], trial["expected_force_N"]
        assert trial["expected_force_low_N"] < force < trial["expected_force_high_N"]
        back = dummydesign.predict(10.0, force_N=force, hold_s=trial["hold_s"], **given).to_dict()
        assert back["depth_mm"] == pytest.approx(depth, rel=1e-3)
        assert f">{force:.3g} (" in page
    assert "steady force N (95 %)" in page


def test_presses_deeper_than_the_law_goes_are_named(tmp_path, capsys):
    found, page = planned(tmp_path, capsys, *RESIN, "--pads", "5,15", "--force", "2,12,60")
    codes = {one["code"] for one in found["warnings"]}
    assert {"beyond_depth_limit", "may_go_beyond_depth_limit"} <= codes
    for trial in found["trials"]:
        depth, high = trial["expected_depth_mm"], trial["expected_depth_high_mm"]
        assert trial["beyond_depth_limit"] == (depth is None) and trial["may_go_beyond_depth_limit"] == (high is None)
        assert trial["depth_limit_mm"] == pytest.approx(0.6 * trial["thickness_mm"], rel=0.01)
        assert depth is None or depth <= 0.6 * trial["thickness_mm"]
        assert not (trial["target_force_N"] == 60.0 and trial["thickness_mm"] == 15.0) or depth is None
    assert "over 8.99 !" in page


def test_without_a_modulus_the_column_is_left_out_and_the_reason_said(tmp_path, monkeypatch):
    from dummydesign.loop.model import material as press_targets
    from dummydesign.measurement.campaign_file import SetUp

    with pytest.raises(InputError):
        material_of(campaign_of())

    def unknown(campaign):
        raise InputError("no modulus")

    monkeypatch.setattr(press_targets, "material_of", unknown)
    design = PlanSettings((6.0, 12.0), (10.0,), (2.0, 5.0), repeats=1, ages_days=(7.0,))
    found = plan_campaign(tmp_path / "c", SetUp("c", young_kPa=25.0), design, power=False).to_dict()
    assert [one["code"] for one in found["warnings"]] == ["no_ratio", "no_expected"] and found["expected"] is None
    assert not any("depth" in key for trial in found["trials"] for key in trial)
    page = (tmp_path / "c" / "sheet.html").read_text()
    assert "depth mm" not in page and "no modulus" in page


def test_an_interval_that_is_not_known_is_said_and_is_the_laws_alone(tmp_path, capsys):
    found, page = planned(tmp_path, capsys, "--young", "25", "--pads", "10", "--force", "2,4")
    assert found["expected"]["young_kPa"] == {"value": 25.0, "low": 25.0, "high": 25.0}
    for trial in found["trials"]:
        assert trial["expected_depth_high_mm"] / trial["expected_depth_mm"] < 1.05
    assert "not known" in page

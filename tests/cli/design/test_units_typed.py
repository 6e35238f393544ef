"""Inches, pounds-force and pounds per square inch as option values."""

import json

import pytest

from dummydesign.cli.entry import run
from dummydesign.core.parsing import FORCE, THICKNESS, VELOCITY, YOUNG, read_number


@pytest.mark.parametrize(
    ("text", "purpose", "value"),
    [
        ("0.5in", THICKNESS, 12.7),
        ("2 in/s", VELOCITY, 50.8),
        ("1lbf", FORCE, 0.45359237 * 9.80665),
        ("1psi", YOUNG, 0.45359237 * 9.80665 / 25.4**2 * 1000),
    ],
)
def test_their_definitions(text, purpose, value):
    assert read_number(text, purpose) == pytest.approx(value, rel=1e-11)


@pytest.mark.parametrize("edge", ["0.5", "0.5mm", "0.05cm"])
def test_the_edge_radius_of_a_campaign_carries_its_unit(tmp_path, edge, capsys):
    plan = tmp_path / "plan"
    assert run(["campaign", "new", str(plan), "--young", "30", "--pads", "5", "--edge-radius", edge, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)
    assert "edge_radius_mm = 0.5\n" in (plan / "campaign.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("edge", ["x", "nan", "-1", "1kg", "3"])
def test_an_edge_radius_that_cannot_be_is_refused(tmp_path, edge, capsys):
    plan = tmp_path / "plan"
    assert run(["campaign", "new", str(plan), "--young", "30", "--pads", "5", f"--edge-radius={edge}"]) == 2
    assert capsys.readouterr().err.count("\n") == 1 and not plan.exists()

"""What lies in a project, by its manifests: whose mould, whose calibration; files of a mould in groups."""

from __future__ import annotations

import json
import os

import pytest

from dummydesign.core.manifest import sha256_of
from dummydesign.mold.pour.plan import batches_of, pour_plan
from dummydesign.project.folder import make_project
from dummydesign.project.status import status_of
from dummydesign.studio import project_index
from dummydesign.studio.state import State, next_page, next_state, read_state
from tests.support.mould_checks import shape_spec


def write(folder, name, command, inputs, date="2026-01-01T00:00:00+00:00", **more):
    path = folder / name
    path.mkdir(parents=True)
    told = {"command": command, "date": date, "finished": True, "inputs": inputs, **more}
    (path / "manifest.json").write_text(json.dumps(told), encoding="utf-8")


def mould(shape="slab", thickness=6.0, ratio=15.0, preset="open", resin="polyurethane-nagoya", size=(150.0, 120.0)):
    return {
        "shape": shape,
        "thickness_mm": thickness,
        "length_mm": size[0],
        "width_mm": size[1],
        "preset": preset,
        "resin": resin,
        "ratio": ratio,
    }


def design(shape="slab", thickness=6.0, ratio=15.0, tissue="forefinger", verdict="not_settled", calibration=None):
    inputs = {"tissue": tissue, "aim": "average", "punch": "square:14", "calibration": calibration}
    summary = {
        "shape": shape,
        "thickness_mm": thickness,
        "ratio": ratio,
        "resin": "polyurethane-nagoya",
        "verdict": verdict,
        "text": "words",
    }
    return {"command": "suggest", "inputs": inputs, "summary": summary}


PLAN = """schema = 1
name = "NAME"
[pad]
young_kPa_nominal = 25.0
[punch]
side_mm = 14.0
[[trial]]
file = "a.csv"
thickness_mm = 5.0
velocity_mm_s = 10.0
"""


@pytest.fixture
def project(tmp_path):
    return make_project(tmp_path / "thumb", tissue="forefinger")


def plan(project, name):
    (project.root / "campaigns" / name).mkdir(parents=True)
    (project.root / "campaigns" / name / "campaign.toml").write_text(PLAN.replace("NAME", name), encoding="utf-8")


def test_a_mould_is_that_of_the_pad_by_all_that_makes_it(project):
    write(project.root, "moulds/a", "mold", mould())
    write(project.root, "moulds/b", "mold", mould("crowned:radius=20,height=2,foot=9", 4.5), date="2026-02-01")
    write(project.root, "moulds/c", "mold", mould(size=(50.0, 40.0)), date="2026-03-01")
    write(project.root, "moulds/broken", "mold", {"shape": 3})
    found = project_index.moulds(project.root)
    assert [one.folder for one in found] == ["moulds/a", "moulds/b", "moulds/c"]
    state = read_state(project, {})
    assert [one.is_of(state) for one in found] == [True, False, True]
    crowned = state.changed(shape="crowned:20,2,9", thickness_mm=4.5)
    assert [one.is_of(crowned) for one in found] == [False, True, False]
    assert not found[0].is_of(state.changed(ratio=15.1))
    chosen = state.changed(**found[1].pad)
    assert found[1].is_of(chosen) and chosen.thickness_mm == 4.5


def test_files_of_a_mould_are_grouped_under_plain_names_and_none_is_lost():
    names = [
        "pad_t6.step",
        "mould_t6.step",
        "master_t6.3mf",
        "strike_off_t6.3mf",
        "assembly_t6.html",
        "assembly_t6.step",
        "drawings_t6.dxf",
        "drawings_t6.pdf",
        "pour_t6.pdf",
        "pour_t6.html",
        "mould_t6.png",
        "checks.json",
        "manifest.json",
        "spec.json",
        "record.json",
        "mine.odt",
    ]
    groups = dict(project_index.grouped_files(names))
    assert sorted(name for rows in groups.values() for _, name in rows) == sorted(names)
    assert groups["Pour"][0][1] == "pour_t6.pdf"
    assert {"pad_t6.step", "strike_off_t6.3mf", "assembly_t6.html"} <= {name for _, name in groups["Print or machine"]}
    drawn = {name for _, name in groups["Draw"]}
    assert drawn == {"drawings_t6.dxf", "drawings_t6.pdf", "mould_t6.png"}
    assert {name for _, name in groups["Check"]} == {"checks.json", "manifest.json", "spec.json", "record.json"}
    assert [name for _, name in groups["More"]] == ["mine.odt"]
    words = [said for rows in groups.values() for said, _ in rows]
    assert len(set(words)) == len(words) and not any("_" in one for one in words if one != "mine.odt")


def test_names_of_a_crowned_mould_are_grouped_too():
    names = ["strike_off_crowned_t4.5.3mf", "pour_crowned_t4.5.pdf", "pour_crowned_t4.5.html"]
    groups = dict(project_index.grouped_files(names))
    assert groups["Print or machine"] == [("Strike off, 3MF", "strike_off_crowned_t4.5.3mf")]
    assert groups["Pour"][0][1] == "pour_crowned_t4.5.pdf"


def test_calibrations_are_those_of_their_campaign_wherever_they_were_made(project, monkeypatch):
    root = project.root
    plan(project, "first")
    plan(project, "second")
    for name, campaign in (
        ("a", "campaigns/first"),
        ("b", str(root / "campaigns" / "first")),
        ("c", "campaigns/second"),
        ("d", "../campaigns/first"),
        ("e", "/elsewhere/campaigns/first"),
    ):
        write(root, f"calibrations/{name}", "loop", {"campaign": campaign}, summary={"campaign": "first"})
        (root / "calibrations" / name / "calibration.json").write_text("{}", encoding="utf-8")
    write(root, "calibrations/f", "loop", {"campaign": "campaigns/first"})  # ended without a calibration
    monkeypatch.chdir(os.path.dirname(root))
    assert [one.folder for one in project_index.calibrations(root, "campaigns/first")] == [
        "calibrations/a",
        "calibrations/b",
        "calibrations/d",
    ]
    assert [one.folder for one in project_index.calibrations(root, "campaigns/second")] == ["calibrations/c"]


def test_a_calibration_of_a_campaign_that_changed_since_is_known(project):
    root = project.root
    plan(project, "first")
    toml = root / "campaigns" / "first" / "campaign.toml"
    from dummydesign.core.manifest import sha256_of

    read = [{"name": "campaigns/first/campaign.toml", "file": "campaign.toml", "sha256": sha256_of(toml)}]
    write(root, "calibrations/a", "loop", {"campaign": "campaigns/first"}, files_read=read)
    (root / "calibrations" / "a" / "calibration.json").write_text("{}", encoding="utf-8")
    assert not project_index.calibrations(root, "campaigns/first")[0].outdated(root)
    toml.write_text(PLAN.replace("NAME", "other"), encoding="utf-8")
    assert project_index.calibrations(root, "campaigns/first")[0].outdated(root)


def test_the_next_step_opens_the_campaign_that_it_is_about(project):
    write(project.root, "designs/a", **design())
    write(project.root, "moulds/a", "mold", mould())
    for name in ("first", "second"):
        plan(project, name)
    status = status_of(project)
    assert status.next_command.split()[1:3] == ["campaign", "check"]
    named = status.next_command.split()[-1]
    other = ({"campaigns/first", "campaigns/second"} - {named}).pop()
    chosen = read_state(project, {"campaign": other})
    assert chosen.campaign == other
    assert next_state(status, chosen).campaign == named
    assert next_page(status) == "/campaign"


def test_the_next_step_opens_the_design_whose_mould_it_makes(project):
    write(project.root, "designs/a", **design(thickness=6.0))
    best = design("crowned:radius=20,height=2,foot=9", 4.5, 15.4, verdict="stands_for")
    write(project.root, "designs/b", date="2026-02-01", **best)
    chosen = read_state(project, {"design": "designs/a"})
    assert chosen.thickness_mm == 6.0
    status = status_of(project)
    assert next_page(status) == "/mould"
    after = next_state(status, chosen)
    assert (after.design, after.thickness_mm, after.ratio) == ("designs/b", 4.5, 15.4)


def test_the_next_step_after_learning_chooses_the_calibration(project):
    write(project.root, "designs/a", **design())
    write(project.root, "moulds/a", "mold", mould())
    plan(project, "first")
    (project.root / "campaigns" / "first" / "a.csv").write_text("time_s,displacement_mm,force_N\n", encoding="utf-8")
    status = status_of(project)
    from dataclasses import replace

    told = replace(
        status,
        next_command="dummydesign suggest --tissue 'my tissue' --shape slab "
        "--calibration 'calibrations/of may/calibration.json'",
    )
    after = next_state(told, read_state(project, {}))
    assert after.calibration == "calibrations/of may/calibration.json" and after.tissue == "my tissue"
    assert next_page(told) == "/design"
    ready = replace(status, next_command="dummydesign loop campaigns/first")
    pages = {
        "resins list": "/design",
        "mold --puck 50x30": "/resin",
        "mold --thickness 5": "/mould",
        "history": "/design",
    }
    for command, path in pages.items():
        assert next_page(replace(status, next_command=f"dummydesign {command}")) == path
    assert next_page(ready) == "/learn" and next_state(ready, read_state(project, {})).campaign == "campaigns/first"


def test_a_campaign_that_was_renamed_keeps_its_calibration(project):
    root = project.root
    from dummydesign.core.manifest import sha256_of

    plan(project, "first")
    plan(project, "other")
    toml = root / "campaigns" / "first" / "campaign.toml"
    read = [{"name": "campaigns/first/campaign.toml", "file": "campaign.toml", "sha256": sha256_of(toml)}]
    write(root, "calibrations/a", "loop", {"campaign": "campaigns/first"}, files_read=read)
    (root / "calibrations" / "a" / "calibration.json").write_text("{}", encoding="utf-8")
    (root / "campaigns" / "first").rename(root / "campaigns" / "may")
    assert [one.folder for one in project_index.calibrations(root, "campaigns/may")] == ["calibrations/a"]
    assert not project_index.calibrations(root, "campaigns/may")[0].outdated(root)
    assert project_index.calibrations(root, "campaigns/other") == []


@pytest.mark.parametrize(
    ("name", "unit", "words"),
    [
        ("compliance_mm_per_N", "mm/N", "compliance"),
        ("drift_N_per_s", "N/s", "drift"),
        ("tau_s", "s", "tau"),
        ("modulus_loss_per_K", "1/K", "modulus loss"),
        ("slip_fraction", "", "slip fraction"),
        ("beta", "", "beta"),
        ("growth_per_doubling", "", "growth per doubling"),
        ("offset_mm", "mm", "offset"),
        ("viscosity_Pa_s", "Pa s", "viscosity"),
        ("density_g_per_cm3", "g/cm3", "density"),
        ("beta_at_0.03_s", "", "beta at 0.03 s"),
    ],
)
def test_units_are_read_from_the_names_of_parameters(name, unit, words):
    assert project_index.name_and_unit(name) == (words, unit)


def test_the_verdict_of_a_pad_is_that_of_its_design_while_its_files_are_the_same(project):
    root = project.root
    tissue = root / "tissue" / "mine.toml"
    tissue.write_text("1", encoding="utf-8")
    read = [{"name": "tissue tissue/mine.toml", "file": "mine.toml", "sha256": sha256_of(tissue)}]
    made_for = design(tissue="tissue/mine.toml", verdict="usable_with_correction")
    write(root, "designs/a", files_read=read, **made_for)
    state = State("tissue/mine.toml", thickness_mm=6.0, ratio=15.0)
    assert project_index.verdict_of_design(root, state) == ("amber", "words")
    for other in ({"ratio": 15.1}, {"aim": "safe-side"}, {"calibration": "calibrations/a/calibration.json"}):
        assert project_index.verdict_of_design(root, state.changed(**other)) is None
    tissue.write_text("2", encoding="utf-8")
    assert project_index.verdict_of_design(root, state) is None


@pytest.mark.parametrize(("shape", "thickness_mm"), [("slab", 6.0), ("layered:3,0.4", 8.0)])
def test_the_page_of_a_mould_weighs_every_batch_that_is_mixed_and_poured(shape, thickness_mm):
    pytest.importorskip("nicegui", reason="no NiceGUI here: pip install nicegui")
    from dummydesign.studio.pages.mould import poured

    spec = shape_spec(shape, thickness_mm)
    plan = pour_plan(spec)
    batch = batches_of(spec, plan)
    rows = [(float(value.removesuffix(" g")), words) for value, words in poured(batch, plan.to_dict())]
    pours = [batch, *([batch["base"]] if "base" in batch else [])]
    assert len(pours) == (2 if shape.startswith("layered") else 1)
    mixed = [part["mass_g"] for one in pours for part in one["witness"]["components"]]
    assert [mass for mass, words in rows if "to mix" in words] == pytest.approx(mixed, abs=0.05)
    cast = [mass for mass, words in rows if "into the mould" in words]
    assert cast == pytest.approx([one["pour_g"] for one in pours], abs=0.05)

"""Several pads in one job: a folder each, one list of what is needed, all or none."""

from __future__ import annotations

import json
import re

import pytest

from dummydesign import cli
from dummydesign.mold import client
from dummydesign.mold.batch import Ordered, check_job, folder_name, job_bill, job_sheet, read_thicknesses
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials
from dummydesign.mold.pour.plan import pour_plan
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

SPECS = [mould_spec(t, 60.0, 50.0) for t in (5.0, 8.0)]
PRINTED = {"master": 120_000.0, "tray": 70_000.0}
ORDERED = [Ordered(spec, pour_plan(spec), PRINTED) for spec in SPECS]
# A child that makes one file and the volumes of the closed forms, without CAD.
CHILD = """
import json, pathlib, sys
asked = json.load(open(sys.argv[1])); folder = pathlib.Path(asked["folder"])
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import gauge_points
from dummydesign.mold.pour.plan import batches_of
from dummydesign.mold.pour.plan import pour_plan
spec = MouldSpec.from_dict(asked["spec"]); plan = pour_plan(spec)
points = [one.to_dict() for one in gauge_points(spec)]
(folder / "spec.json").write_text(json.dumps({"hash": spec.hash, "spec": spec.to_dict(), "gauge_points": points}))
volumes = {"cavity": 1.0, "pad_nominal": 1.0, "pad_compensated": plan.cavity_mm3}
volumes |= {"mould": 1e5, "master": 1.2e5, "tray": 7e4}
status = "fail" if spec.pad.thickness_mm == 7.0 else "pass"
checks = [{"id": "a", "value": 1.0, "limit": 1.0, "status": status}]
found = {"files": {"spec": "spec.json"}, "volumes_mm3": volumes, "checks": checks, "warnings": [],
         "pour": plan.to_dict(), "batch": batches_of(spec, plan), "step_sha256": "0", "seconds": 1.0, "memory_MB": 1.0}
pathlib.Path(sys.argv[2]).write_text(json.dumps(found))
"""


@pytest.fixture
def no_cad(monkeypatch, tmp_path):
    monkeypatch.setattr(client, "WORKER", ("-c", CHILD))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def amounts(rows):
    return {what: float(re.search(r"[\d.]+", much)[0]) for what, much, _ in rows[1:] if re.search(r"\d", much)}


def test_a_jobs_list_is_the_sum_of_its_moulds_with_resin_for_every_casting():
    alone = [amounts(bill_of_materials(materials(one.spec, one.plan, PRINTED))) for one in ORDERED]
    three = amounts(job_bill(ORDERED, 3))
    assert three["polyol"] == pytest.approx(3 * sum(one["polyol"] for one in alone), abs=0.2)
    silicone = next(what for what in three if "silicone" in what)
    assert three[silicone] == pytest.approx(sum(one[silicone] for one in alone), abs=1.01)
    assert three["ASA: master"] == pytest.approx(2 * alone[0]["ASA: master"], abs=1.01)
    assert three["gloves, goggles, extraction"] == 1
    assert three["spirit level or inclinometer"] == min(one["spirit level or inclinometer"] for one in alone)


def test_a_job_of_one_casting_of_one_mould_needs_what_the_mould_needs():
    assert job_bill(ORDERED[:1], 1) == bill_of_materials(materials(SPECS[0], ORDERED[0].plan, PRINTED))


def test_the_sheet_names_every_mould_its_folder_and_the_castings():
    text = sheet_text(job_sheet(ORDERED, 2))
    for spec in SPECS:
        assert spec.hash in text and spec.tag in text
    assert "2 moulds, 4 pads" in text


@pytest.mark.parametrize(
    "thicknesses, count, code",
    [
        ((5.0, 5.0), 1, "out_of_range"),
        ((5.0,), 0, "out_of_range"),
        ((5.0,), 21, "out_of_range"),
        ((), 1, "out_of_range"),
    ],
)
def test_a_job_without_sense_is_refused(thicknesses, count, code):
    with raises_code(code):
        check_job(thicknesses, count)


def test_thicknesses_are_read_from_numbers_lists_and_text():
    assert read_thicknesses(5) == read_thicknesses([5]) == (5.0,) and read_thicknesses("5, 7.5") == (5.0, 7.5)
    with raises_code("not_a_number", "thickness_mm"):
        read_thicknesses("5,,8")
    assert folder_name((5.0,), 1) == "mould_t5" and folder_name((5.0, 7.5), 1, "crowned") == "moulds_crowned_t5_t7.5"


@pytest.mark.slow
def test_the_command_makes_a_folder_each_under_one_manifest_and_records_go_with_it(no_cad, capsys):
    words = ["mold", "--thickness", "5,8", "--length", "60", "--width", "50", "--castings", "2"]
    assert cli.run([*words, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    folder = no_cad / "moulds_t5_t8"
    assert [one["thickness_mm"] for one in answer["moulds"]] == [5.0, 8.0] and answer["inputs"]["castings"] == 2
    sums = json.loads((folder / "manifest.json").read_text())["sha256"]
    assert set(sums) == {"job.pdf", "t5/spec.json", "t8/spec.json"}
    assert (folder / "job.pdf").read_bytes().startswith(b"%PDF")
    mass = f"{pour_plan(SPECS[0]).pad_mass_g:.1f}"
    assert cli.run(["mold", "record", "moulds_t5_t8/t5", "--thickness", "5,5,5,5,5", "--mass", mass]) == 0
    assert set(json.loads((folder / "manifest.json").read_text())["records"]) == {"t5/record.json"}
    capsys.readouterr()
    assert cli.run(words) == 0 and (folder / "t5/record.json").is_file()
    text = capsys.readouterr().out
    assert "2 castings of each" in text and "polyol" in text
    assert set(json.loads((folder / "manifest.json").read_text())["records"]) == {"t5/record.json"}


def test_one_mould_that_fails_leaves_nothing_of_the_job(no_cad, capsys):
    assert cli.run(["mold", "--thickness", "5,7", "--length", "60", "--width", "50"]) == 1
    assert "7 mm" in capsys.readouterr().err and list(no_cad.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["--thickness", "5,400"],
        ["--thickness", "5,5"],
        ["--thickness", "5,x"],
        ["--thickness", "5", "--castings", "0"],
        ["--thickness", "5", "--count", "0"],
    ],
)
def test_a_bad_job_is_one_line_and_no_file(no_cad, capsys, arguments):
    assert cli.run(["mold", *arguments]) == 2
    assert capsys.readouterr().err.count("\n") == 1 and list(no_cad.iterdir()) == []

"""Designs side by side: the numbers of each folder, differences of the questions first, and folders that are none."""

from __future__ import annotations

import json
import shutil
from html.parser import HTMLParser
from pathlib import Path

import pytest

import dummydesign
from dummydesign.cli.commands.compare_designs import COLUMNS
from dummydesign.cli.entry import run
from dummydesign.report.page import figure_values

pytestmark = pytest.mark.slow

ASKED = {
    "thin": ("forefinger", {"thickness_mm": (5, 6), "ratio": (15, 15.5)}),
    "thick": ("forefinger", {"thickness_mm": (8, 9), "ratio": (15, 15.5)}),
    "palm": ("palm", {"thickness_mm": (10, 12), "ratio": (15, 15.5)}),
}


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """Folders of three designs and their answers, as they came from the calls."""
    root = tmp_path_factory.mktemp("designs")
    answers = {}
    for name, (tissue, limits) in ASKED.items():
        answer = dummydesign.suggest(tissue, shape="slab", verify=False, cad=False, out=root / name, **limits)
        answers[name] = json.loads(json.dumps(answer.to_dict()))
    return root, answers


@pytest.fixture
def designs(made, tmp_path, monkeypatch):
    """A copy of the folders, which is the current one."""
    for name in ASKED:
        shutil.copytree(made[0] / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return made[1]


def answered(capsys, *words):
    assert run(["compare-designs", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def changed(folder, change, name="suggest.json"):
    content = json.loads(Path(folder, name).read_text())
    change(content)
    Path(folder, name).write_text(json.dumps(content))


@pytest.mark.slow
def test_the_folder_of_a_design_keeps_its_answer(made):
    root, answers = made
    for name, answer in answers.items():
        kept = json.loads((root / name / "suggest.json").read_text())
        assert kept.pop("schema") == "dummydesign.suggest/2" and kept.pop("version") == dummydesign.__version__
        curve, files = kept.pop("steady_curve"), kept.pop("files")
        assert len(curve["depth_mm"]) == len(curve["force_N"]) > 20
        assert all((root / name / file).is_file() for file in files.values())
        mine = {key: value for key, value in answer.items() if key != "files"}
        mine["inputs"] = {key: value for key, value in mine["inputs"].items() if key != "out"}
        assert kept == mine and Path(answer["files"]["json"]) == root / name / "suggest.json"
        assert "suggest.json" in json.loads((root / name / "manifest.json").read_text())["sha256"]


@pytest.mark.slow
def test_each_design_has_the_numbers_of_its_answer(designs, capsys):
    found = answered(capsys, "thin", "thick")
    assert found["schema"] == "dummydesign.compare-designs/1"
    assert found["differences"] == [] and found["warnings"] == [] and found["sources"]
    for one, name in zip(found["designs"], ("thin", "thick")):
        answer, best = designs[name], designs[name]["recommendation"]
        assert one["name"] == name and one["tissue"] == "forefinger"
        assert one["verdict"] == {key: answer["verdict"][key] for key in ("level", "light", "reads", "text")}
        assert one["pad"]["thickness_mm"] == best["thickness_mm"] and one["scores"] == best["scores"]
        assert one["ratio"] == best["ratio"] and one["young_kPa"]["high"] == best["young_kPa"]["high"]
        assert one["shortfall"]["q95"] == answer["verdict"]["shortfall"]["q95"]
        assert one["correction"]["factor"] == answer["verdict"]["correction"]["factor"]
        usable = answer["castings"]["stands_for"] + answer["castings"]["with_correction"]
        assert one["castings"]["usable_fraction"] == pytest.approx(usable)
        assert one["batch"]["total_g"] == best["batch"]["total_g"]
        peaks = [row["peak_force_N"] for row in best["conditions"]]
        assert [row["peak_force_N"] for row in one["conditions"]] == peaks
    assert found["designs"][0]["pad"]["thickness_mm"] != found["designs"][1]["pad"]["thickness_mm"]


def test_other_questions_come_before_any_number(designs, capsys):
    found = answered(capsys, "thin", "palm")
    assert [(one["input"], one["values"]) for one in found["differences"]] == [("tissue", ["forefinger", "palm"])]
    assert [one["code"] for one in found["warnings"]] == ["different_questions"]
    assert run(["compare-designs", "thin", "palm"]) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert "tissue" in first and "forefinger" in first and "palm" in first


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("punch", "round:10"),
        ("aim", "safe-side"),
        ("resin", "ecoflex-00-30"),
        ("force_N", [2.0]),
        ("hold_s", 3.0),
        ("verify", True),
        ("castings", 2400),
    ],
)
def test_every_input_that_counts_is_a_difference(key, value, designs, capsys):
    changed("thick", lambda content: content["inputs"].update({key: value}))
    found = answered(capsys, "thin", "thick")
    assert [(one["input"], one["values"][1]) for one in found["differences"]] == [(key, value)]


def test_limits_of_the_search_are_no_difference_and_a_changed_tissue_file_is(designs, capsys):
    assert designs["thin"]["inputs"]["thickness_mm"] != designs["thick"]["inputs"]["thickness_mm"]
    changed("thick", lambda content: content["files_read"][0].update(sha256="0" * 64), "manifest.json")
    (one,) = answered(capsys, "thin", "thick")["differences"]
    assert one["input"] == "file" and "forefinger" in one["name"]


def test_designs_of_another_version_are_named(designs, capsys):
    changed("thick", lambda content: content.update(version="0.0.1"))
    assert [one["code"] for one in answered(capsys, "thin", "thick")["warnings"]] == ["different_versions"]


@pytest.mark.parametrize("count", range(2, 8))
def test_the_answer_fits_one_screen(count, designs, capsys):
    names = ["thin", "thick", "palm", *(f"copy-with-quite-a-long-name-{number}" for number in range(4))][:count]
    for name in names[3:]:
        shutil.copytree("thin", name)
    assert run(["compare-designs", *names]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 30 and max(map(len, lines)) <= 100
    totals = [f"{designs[name]['recommendation']['scores']['total']:.2f}" for name in ("thin", "thick")]
    assert all(total in next(line for line in lines if line.startswith("score")) for total in totals)
    assert any(f"{count - COLUMNS} more" in line for line in lines) == (count > COLUMNS)
    assert run(["compare-designs", *names, "--details"]) == 0
    shown = capsys.readouterr().out
    assert shown.count("250 mm/s") >= 3 * -(-count // COLUMNS) and max(map(len, shown.splitlines())) < 400


class Cells(HTMLParser):
    def __init__(self):
        super().__init__()
        self.rows, self.links = [[]], []

    def handle_starttag(self, tag, attrs):
        self.rows += [[]] if tag == "tr" else []
        self.links += [value for key, value in attrs if key in ("src", "href")]

    def handle_data(self, data):
        self.rows[-1].append(data)


def test_the_report_has_every_design_and_the_steady_curves(designs, capsys):
    names = ["thin", "thick", "palm"]
    found = answered(capsys, *names, "--out", "o")
    assert found["files"]["report"] == str(Path("o/report.html")) and Path("o/manifest.json").is_file()
    page = Cells()
    page.feed(Path("o/report.html").read_text(encoding="utf-8"))
    assert not page.links
    lead = next(row for row in page.rows if "Designs side by side" in "".join(row))
    assert "tissue" in "".join(lead).partition("3 designs")[0]
    (score,) = [row[1:] for row in page.rows if row[:1] == ["score"]]
    assert score == [f"{designs[name]['recommendation']['scores']['total']:.2f}" for name in names]
    for name in names:
        mine = [row["x"] for row in figure_values(found["files"]["report_values"])["steady"] if row["series"] == name]
        rows = figure_values(Path(name, "report.csv"))["steady"]
        theirs = [row["x"] for row in rows if row["series"] == "recommended pad"]
        assert mine == theirs and len(mine) > 20


def test_the_call_is_the_answer_of_the_command_and_writes_only_where_it_is_told(designs, capsys):
    theirs = answered(capsys, "thin", "thick", "--out", "o")
    assert theirs.pop("schema") and theirs.pop("version")
    mine = dummydesign.compare_designs(["thin", Path("thick")], out="o").to_dict()
    assert json.loads(json.dumps(mine)) == theirs
    before = sorted(Path().iterdir())
    assert dummydesign.compare_designs(["thin", "thick"]).to_dict()["files"] == {}
    assert sorted(Path().iterdir()) == before


def _no_design(folder):
    shutil.rmtree(folder)
    Path(folder).mkdir()


def _old(folder):
    Path(folder, "suggest.json").unlink()


def _damaged(folder):
    Path(folder, "suggest.json").write_text('{"schema": "dummydesign.suggest/2"}')


def _cut(folder):
    path = Path(folder, "suggest.json")
    path.write_text(path.read_text()[:2000])


@pytest.mark.parametrize("spoil", [shutil.rmtree, _no_design, _old, _damaged, _cut])
def test_a_folder_that_holds_no_design_is_refused_by_name(spoil, designs, capsys):
    spoil("thick")
    assert run(["compare-designs", "thin", "thick"]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1
    assert "thick" in shown.err and not Path("compare-designs").exists()


@pytest.mark.parametrize(("words", "named"), [(["thin"], "two"), (["thin", "./thin"], "twice")])
def test_one_design_is_not_enough(words, named, designs, capsys):
    assert run(["compare-designs", *words]) == 2
    assert named in capsys.readouterr().err

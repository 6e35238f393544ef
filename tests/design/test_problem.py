"""The problem of a design: read once, with all files named; nothing below reads a user's folder; the mould one has."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

from dummydesign.cli import run
from dummydesign.core import user_library
from dummydesign.core.user_library import data_folder
from dummydesign.design.problem import read_problem
from dummydesign.design.request import ANSWER, Request
from dummydesign.design.suggest import design
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.mold.model.preset import mould_spec, read_preset
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code

CROWN = "crowned:radius=21.2,height=2,foot=9.4"
RESIN = "polyurethane-nagoya"
NARROW = {"shape": "slab", "thickness_mm": (5.0, 6.0), "verify": False}
BUILT_IN = data_folder() / "materials"


@pytest.mark.slow
@pytest.mark.parametrize("aim", ["average", "safe-side"])
def test_nothing_below_the_problem_reads_a_users_folder(monkeypatch, aim):
    problem = read_problem(Request("forefinger", aim=aim, **NARROW))

    def refuse(*given, **more):
        raise AssertionError(f"a file was looked up: {given}")

    # draws of a tissue's posterior lie beside its file, and are read when other people are drawn
    from dummydesign.tissue.model import posterior

    for name, module in list(sys.modules.items()):
        if (
            name.startswith("dummydesign.")
            and vars(module).get("find") is user_library.find
            and module is not posterior
        ):
            monkeypatch.setattr(module, "find", refuse)
    found = design(problem)
    assert found.verdict.limits == problem.targets.limits and found.to_dict()["shares"]


def test_the_problem_names_the_files_that_decide(own_folder):
    plain = read_problem(Request("forefinger", **NARROW))
    assert {"materials/score", "materials/verdict", "materials/puck", "mould preset open"} <= set(plain.files)
    path = own_folder("materials/verdict.toml", "[usable.over]\nvalue = 1.25", "[usable.over]\nvalue = 1.45")
    own = read_problem(Request("forefinger", **NARROW))
    assert own.files["materials/verdict"] == path and own.targets.limits.over == 1.45
    assert own.targets.limits.origin == "user"


SUGGEST = [
    "suggest",
    "--tissue",
    "forefinger",
    "--shape",
    "slab",
    "--thickness",
    "5:5.5",
    "--ratio",
    "15:15.4",
    "--no-verify",
    "--no-cad",
    "--out",
    "s1",
    "--json",
]


def asked(capsys, words):
    assert run(words) in (0, 1)
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("materials/verdict.toml", "[usable.over]\nvalue = 1.25", "[usable.over]\nvalue = 1.45"),
        ("materials/puck.toml", "value = 0.043", "value = 0.06"),
        ("materials/making.toml", "low = -0.05", "low = -0.06"),
    ],
)
def test_an_answer_under_other_limits_goes_into_a_folder_of_its_own_and_names_them(
    own_folder, capsys, tmp_path, monkeypatch, name, old, new
):
    monkeypatch.chdir(tmp_path)
    first = asked(capsys, SUGGEST)
    path = own_folder(name, old, new)
    second = asked(capsys, SUGGEST)
    folders = sorted(one.name for one in tmp_path.iterdir() if (one / "manifest.json").exists())
    assert len(folders) == 2, "the first answer is kept"
    read = [
        {
            entry["name"]: entry["sha256"]
            for entry in json.loads((tmp_path / one / "manifest.json").read_text())["files_read"]
        }
        for one in folders
    ]
    key = name.removesuffix(".toml")
    assert all(key in one for one in read) and read[0][key] != read[1][key] and path.exists()
    if key == "materials/verdict":
        assert first["shares"] != second["shares"]


def test_an_edited_machine_of_the_users_library_is_part_of_the_question(own_folder):
    from dummydesign.api.answers import question

    def key():
        problem = read_problem(Request("forefinger", **NARROW))
        machine = next(path for what, path in problem.files.items() if what.startswith("machine "))
        return machine, question("suggest", {"a": 1}, files=(), named=dict(problem.files)).key

    machine, first = key()
    copy = own_folder(str(machine.relative_to(data_folder())))
    copy.write_text(copy.read_text() + "\n# mine\n")
    found, second = key()
    assert found == copy and first != second


# --- the mould that one has ------------------------------------------------------------------------------------------


@pytest.fixture
def mould(tmp_path, monkeypatch):
    """The folder of a mould with its specification alone."""
    monkeypatch.chdir(tmp_path)

    def make(name="m", thickness_mm=4.5, shape=CROWN, resin=RESIN, ratio=15.4, size=(120.0, 100.0), **more):
        made = read_shape(shape)
        spec = mould_spec(
            thickness_mm,
            *size,
            resin=load_resin(resin),
            ratio=ratio,
            kind=made.name,
            parameters=made.parameters,
            **more,
        )
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "spec.json").write_text(json.dumps({"spec": spec.to_dict(), "hash": spec.hash}))
        return name

    return make


@pytest.mark.parametrize("place", ["m", "m/spec.json", "design"])
def test_a_mould_keeps_shape_thickness_and_size_of_its_pad(mould, place):
    mould("design/pad" if place == "design" else "m")
    problem = read_problem(Request("forefinger", mould=place, verify=False))
    assert problem.request.pad_mm == (120.0, 100.0) and problem.thickness_mm.tolist() == [4.5]
    assert read_shape(problem.request.shape) == read_shape(CROWN)
    assert len(problem.wide_mm) > 20


def test_a_mould_keeps_its_preset_unless_another_one_is_asked_for(mould):
    mould(preset=read_preset("lidded"))
    for asked, preset in (({}, "lidded"), ({"preset": "printed"}, "printed")):
        assert read_problem(Request("forefinger", mould="m", verify=False, **asked)).preset.name == preset


@pytest.mark.slow
def test_the_ratio_for_a_mould_follows_the_resin_and_its_modulus_does_not(mould, tmp_path):
    """a resin twice as stiff at every ratio is poured leaner, to a modulus in the same window"""
    from dataclasses import replace

    from dummydesign.core.quantity import Quantity
    from dummydesign.resin.model.resin_file import save_resin

    mould()
    resin = load_resin(RESIN)
    old = resin.numbers["young_ref_kPa"]
    stiff = Quantity(2.0 * old.value, 2.0 * old.low, 2.0 * old.high, "measured", "made for this test")
    path = save_resin(
        replace(resin, name="stiff", numbers={**resin.numbers, "young_ref_kPa": stiff}), tmp_path / "stiff.toml"
    )
    found = [
        design(read_problem(Request("forefinger", mould="m", resin=name, verify=False))) for name in (RESIN, str(path))
    ]
    for one in found:
        assert one.best.thickness_mm == 4.5 and one.shape == read_shape(CROWN)
        assert one.other_mould["text"]
    ratios = [one.best.ratio for one in found]
    young = [float(one.resin.young_MPa(ratio)) for one, ratio in zip(found, ratios)]
    assert ratios[1] < ratios[0] and young[1] / young[0] < 1.5
    low_kPa, high_kPa = found[0].to_dict()["window_kPa"]
    assert all(low_kPa < 1e3 * value < high_kPa for value in young)


def test_a_pad_of_another_size_than_the_mould_is_refused(mould):
    mould()
    read_problem(Request("forefinger", mould="m", pad_mm=(120.0, 100.0), verify=False))
    with raises_code("conflict", "mould") as caught:
        read_problem(Request("forefinger", mould="m", pad_mm=(100.0, 80.0), thickness_mm=(4.0, 8.0), verify=False))
    assert "leave --thickness and --pad out" in str(caught.value)


def test_two_moulds_and_what_contradicts_the_mould_are_refused(mould, tmp_path):
    mould("two/a")
    mould("two/b", 5.0)
    with raises_code("conflict", "mould"):
        read_problem(Request("forefinger", mould="two"))
    (tmp_path / "empty").mkdir()
    with raises_code("nothing_found", "mould"):
        read_problem(Request("forefinger", mould="empty"))
    mould("one")
    for more in ({"shape": "slab"}, {"thickness_mm": (4.0, 5.0)}, {"sites": (2, 2)}):
        with raises_code("conflict", "mould"):
            read_problem(Request("forefinger", mould="one", **more))
    with raises_code("inconsistent", "mould"):
        read_problem(Request("forefinger", mould="one", resin="ecoflex-00-30"))
    (tmp_path / "one" / ANSWER).write_text(json.dumps({"inputs": {"punch": "round:20"}}))
    with raises_code("inconsistent", "mould"):
        read_problem(Request("forefinger", mould="one"))
    assert read_problem(Request("forefinger", mould="one", punch="round:20")).punch.radius_mm == 10.0


def test_refusals_of_a_mould_are_status_2_in_one_line(mould, capsys):
    mould()
    for more in (["--shape", "slab"], ["--thickness", "4:5"], ["--resin", "ecoflex-00-30"]):
        assert run(["suggest", "--tissue", "forefinger", "--mould", "m", "--no-cad", "--no-verify", *more]) == 2
        (line,) = capsys.readouterr().err.strip().splitlines()
        assert "mould" in line


@pytest.mark.slow
def test_a_worse_mould_is_told_by_how_much_another_would_be_better(mould):
    mould(thickness_mm=9.0, shape="slab")
    problem = read_problem(Request("forefinger", mould="m", verify=False))
    found = design(problem)
    other = found.other_mould
    assert other["shape"] is not None and "slab" not in other["shape"]
    assert other["after_puck"] > found.castings.outlook.after_puck
    mine = found.castings.outlook
    for name in ("as_poured", "after_puck"):
        assert f"{100 * other[name]:.0f} instead of {100 * getattr(mine, name):.0f} %" in other["text"]
    assert found.to_dict()["other_mould"] == other
    assert np.isfinite(other["ratio"])

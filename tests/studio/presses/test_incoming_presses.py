"""Presses of a campaign that come in: planned, bad ones replaced, others held until they are assigned, all undone."""

from __future__ import annotations

import pytest

from dummydesign.core.errors import InputError
from dummydesign.project.folder import make_project
from dummydesign.studio import trash as bin
from dummydesign.studio.pages import campaign as incoming
from tests.support.refusal import raises_code

PLAN = """schema = 1
name = "first"
[pad]
young_kPa_nominal = 25.0
[punch]
side_mm = 14.0
""" + "".join(
    f'[[trial]]\nfile = "{name}.csv"\nthickness_mm = 6.0\nvelocity_mm_s = {speed}\ntarget_force_N = {force}\n'
    for name, speed, force in (("a", 2.0, 3.0), ("b", 2.0, 9.0))
)


def trace(force=3.0):
    rows = (f"{0.01 * k:.2f},{min(0.02 * k, 1.0):.3f},{force * min(0.02 * k, 1.0):.3f}\n" for k in range(200))
    return ("time_s,displacement_mm,force_N\n" + "".join(rows)).encode()


@pytest.fixture
def root(tmp_path):
    made = make_project(tmp_path / "thumb", tissue="forefinger").root
    folder = made / "campaigns" / "first"
    folder.mkdir(parents=True)
    (folder / "campaign.toml").write_text(PLAN, encoding="utf-8")
    return made


FOLDER = "campaigns/first"


def test_a_press_under_its_planned_name_replaces_the_bad_one_which_can_come_back(root):
    assert incoming.take_press(root, FOLDER, "a.csv", trace(2.0)).gone is None
    taken = incoming.take_press(root, FOLDER, "a.csv", trace(3.0))
    place = root / FOLDER / "a.csv"
    assert place.read_bytes() == trace(3.0)
    assert taken.gone is not None and "bin" in taken.text
    bin.restore(root, taken.gone)
    assert place.read_bytes() == trace(2.0)
    assert not list((root / FOLDER).glob("a-*"))
    again = [one for one in bin.deleted(root) if one.path == f"{FOLDER}/a.csv"]
    bin.restore(root, again[0])
    assert place.read_bytes() == trace(3.0)


@pytest.mark.parametrize("content", [b"", b"no numbers\n", b"time_s,displacement_mm\n0,1\n"])
def test_a_file_that_is_no_trace_is_refused_and_the_good_one_stays(root, content):
    incoming.take_press(root, FOLDER, "a.csv", trace())
    with raises_code("missing"):
        incoming.take_press(root, FOLDER, "a.csv", content)
    with raises_code("missing"):
        incoming.take_press(root, FOLDER, "odd.csv", content, "a.csv")
    assert (root / FOLDER / "a.csv").read_bytes() == trace()


def test_a_file_of_another_name_becomes_the_press_that_is_chosen(root):
    with raises_code("unknown_name", "campaign.trials"):
        incoming.take_press(root, FOLDER, "run 7.csv", trace(9.0))
    assert [path.name for path in (root / FOLDER).iterdir()] == ["campaign.toml"]
    incoming.take_press(root, FOLDER, "b.csv", trace(8.5))
    taken = incoming.take_press(root, FOLDER, "run 7.csv", trace(9.0), "b.csv")
    assert (root / FOLDER / "b.csv").read_bytes() == trace(9.0) and "run 7.csv" in taken.text
    bin.restore(root, taken.gone)
    assert (root / FOLDER / "b.csv").read_bytes() == trace(8.5)


def test_the_same_press_is_not_taken_twice(root):
    incoming.take_press(root, FOLDER, "a.csv", trace())
    with raises_code("duplicate", "trace"):
        incoming.take_press(root, FOLDER, "b.csv", trace())
    assert not (root / FOLDER / "b.csv").exists()
    same = incoming.take_press(root, FOLDER, "a.csv", trace())
    assert same.gone is None and not bin.deleted(root)


def test_only_planned_presses_can_be_chosen(root):
    for name in ("c.csv", "../a.csv", "campaign.toml"):
        with pytest.raises(InputError):
            incoming.take_press(root, FOLDER, "run.csv", trace(), name)
    assert [path.name for path in (root / FOLDER).iterdir()] == ["campaign.toml"]


def test_a_plan_that_names_itself_as_a_press_stays(root):
    place = root / FOLDER / "campaign.toml"
    place.write_text(PLAN.replace("b.csv", "campaign.toml"), encoding="utf-8")
    before = place.read_bytes()
    with pytest.raises(InputError):
        incoming.take_press(root, FOLDER, "run.csv", trace(), "campaign.toml")
    assert place.read_bytes() == before and not bin.deleted(root)


@pytest.mark.parametrize("file", ["../../../theirs.csv", "/elsewhere/theirs.csv", "in/theirs.csv"])
def test_a_plan_cannot_name_a_press_in_another_folder(root, file):
    (root / FOLDER / "campaign.toml").write_text(PLAN.replace("b.csv", file), encoding="utf-8")
    with pytest.raises(InputError):
        incoming.take_press(root, FOLDER, "run.csv", trace(), file)
    assert not (root.parent / "theirs.csv").exists()


def test_a_campaign_folder_that_leads_out_takes_no_press(root, tmp_path):
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "campaign.toml").write_text(PLAN, encoding="utf-8")
    (root / "campaigns" / "far").symlink_to(tmp_path / "theirs")
    for name in ("a.csv", "run.csv"):
        with pytest.raises(InputError):
            incoming.take_press(root, "campaigns/far", name, trace())
    assert [path.name for path in (tmp_path / "theirs").iterdir()] == ["campaign.toml"]

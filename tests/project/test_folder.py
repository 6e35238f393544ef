"""The project folder: found from inside, read strictly, written so that it reads back."""

import pytest

from dummydesign.project.folder import (
    FOLDERS,
    change_project,
    find_project,
    make_project,
    output_path_for,
    read_project,
    words_for,
)
from tests.support.refusal import raises_code


def test_a_project_is_found_from_a_folder_deep_inside(tmp_path):
    made = make_project(tmp_path / "thumb", tissue="thenar")
    inside = made.root / "designs" / "a" / "b"
    inside.mkdir(parents=True)
    assert find_project(inside) == made
    assert find_project(tmp_path) is None


def test_the_nearest_project_counts(tmp_path):
    make_project(tmp_path / "a")
    inner = make_project(tmp_path / "a" / "measured" / "b")
    assert find_project(tmp_path / "a" / "measured" / "b" / "tissue") == inner


def test_a_project_file_of_something_else_is_passed_over(tmp_path):
    (tmp_path / "project.toml").write_text('[tool]\nname = "other"\n', encoding="utf-8")
    assert find_project(tmp_path) is None


@pytest.mark.parametrize("name", ["plain", 'with "quotes" and \\', "Ä ö 手", "tab\tand \x7f"])
def test_what_is_written_reads_back(tmp_path, name):
    made = make_project(tmp_path, name, tissue="tissue/mine.toml", punch="round:16", aim="safe-side", shape="slab")
    assert read_project(tmp_path) == made
    assert made.given() == {"tissue": "tissue/mine.toml", "punch": "round:16", "aim": "safe-side", "shape": "slab"}
    changed = change_project(made, tissue="palm", aim=None, resin="ecoflex-00-30")
    assert read_project(tmp_path) == changed
    given = {"tissue": "palm", "resin": "ecoflex-00-30", "punch": "round:16", "shape": "slab"}
    assert changed.given() == given


def test_a_new_project_has_its_folders_and_an_old_one_is_not_written_over(tmp_path):
    make_project(tmp_path)
    assert all((tmp_path / name).is_dir() for name in FOLDERS)
    with raises_code("file_exists", "project"):
        make_project(tmp_path)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("schema = 1\nname = ", "file_unreadable"),
        ("schema = 2\n", "unsupported"),
        ("schema = 1\ntisue = 'palm'\n", "unknown_key"),
        ("schema = 1\ntissue = 5\n", "malformed"),
        ("schema = 1\nname = ' '\n", "malformed"),
        ("schema = 1\nasked = 3\n", "malformed"),
        ("schema = 1\n[asked]\naims = 'average'\n", "unknown_key"),
    ],
)
def test_a_damaged_project_is_refused_with_what_is_wrong(tmp_path, text, code):
    (tmp_path / "project.toml").write_text(text, encoding="utf-8")
    with raises_code(code):
        find_project(tmp_path)


def test_a_project_file_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "project.toml").write_bytes(b"\xff\xfe\x00")
    with raises_code("file_unreadable", "project"):
        find_project(tmp_path)


def test_options_come_from_the_project_and_what_is_typed_wins(tmp_path):
    project = make_project(tmp_path, tissue="palm", resin="ecoflex-00-30", aim="safe-side", ratio="0:20")
    assert words_for(project, ["suggest"]) == [
        "--tissue",
        "palm",
        "--resin",
        "ecoflex-00-30",
        "--aim",
        "safe-side",
        "--ratio",
        "0:20",
    ]
    assert words_for(project, ["suggest", "--aim=average", "--ratio", "5:10"]) == [
        "--tissue",
        "palm",
        "--resin",
        "ecoflex-00-30",
    ]
    assert words_for(project, ["compare", "a.csv"]) == ["--tissue", "palm"]
    assert words_for(project, ["replay", "a"]) == []


def test_limits_of_a_ratio_do_not_follow_to_another_resin_nor_a_subject_to_another_tissue(tmp_path):
    project = make_project(tmp_path, tissue="palm", resin="ecoflex-00-30", aim="subject:A", ratio="0:20")
    words = words_for(project, ["suggest", "--resin", "polyurethane-nagoya", "--tissue", "thenar"])
    assert words == []


def test_files_of_the_project_are_named_from_where_one_stands(tmp_path):
    project = make_project(tmp_path, tissue="tissue/mine.toml")
    inside = tmp_path / "designs"
    assert words_for(project, ["suggest"], inside) == ["--tissue", "../tissue/mine.toml"]
    assert output_path_for(project, "suggest", "suggest-mine", inside) == "suggest-mine"
    assert output_path_for(project, "loop", "loop-a", tmp_path) == "calibrations/loop-a"

"""Whole answers are as they were; ``python -m tests.support.snapshots`` renews them after a change of words."""

from __future__ import annotations

import pytest

from tests.support.snapshots import CASES, FOLDER, answers, differs


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DUMMYDESIGN_HOME", str(tmp_path_factory.mktemp("home")))
        patch.setenv("COLUMNS", "80")
        return dict(answers(tmp_path_factory.mktemp("work").resolve()))


@pytest.mark.parametrize("name", CASES)
def test_an_answer_is_as_it_was(name, found):
    assert differs((FOLDER / f"{name}.txt").read_text(encoding="utf-8"), found[name]) == ""


def test_the_folder_holds_these_answers_and_no_others():
    assert {path.stem for path in FOLDER.iterdir()} == set(CASES)


def test_a_changed_word_is_seen_and_a_last_digit_is_not():
    assert differs("pad 7 mm, 2.8631 N\n", "pad 7 mm, 2.8632 N\n") == ""
    assert differs("pad 7 mm\n", "slab 7 mm\n") and differs("pad 7 mm\n", "pad 8 mm\n") and differs("a\n", "a\nb\n")

"""Whole answers are as they were; ``python -m tests.support.snapshots`` renews them after a change of words."""

from __future__ import annotations

import re

import pytest

from dummydesign.cli.text import LINES, WIDTH
from tests.support.snapshots import CASES, DETAILS, FOLDER, LONG, answers, differs


class Answers(dict):
    """Whole answers; the long ones are made when the first of them is asked for."""

    def __init__(self, folder):
        super().__init__(answers(folder, [name for name in CASES if name not in LONG]))
        self.folder = folder

    def __missing__(self, name):
        self.update(answers(self.folder, LONG))
        return self[name]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DUMMYDESIGN_HOME", str(tmp_path_factory.mktemp("home")))
        patch.setenv("COLUMNS", "80")
        yield Answers(tmp_path_factory.mktemp("work").resolve())


def each(names):
    return [pytest.param(name, marks=[pytest.mark.slow] * (name in LONG)) for name in names]


@pytest.mark.parametrize("name", each(CASES))
def test_an_answer_is_as_it_was(name, found):
    assert differs((FOLDER / f"{name}.txt").read_text(encoding="utf-8"), found[name]) == ""


@pytest.mark.parametrize("name", each(name for name in CASES if "help" not in name and not name.endswith("details")))
def test_an_answer_fits_one_screen(name, found):
    lines = found[name].partition(DETAILS)[0].splitlines()[1:-1]
    assert len([line for line in lines if not line.startswith("error: ")]) <= LINES
    assert [line for line in lines if len(line) > WIDTH and not line.startswith("error: ")] == []
    assert sum(line.startswith("WARNING") for line in lines) <= 4


NUMBERS = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")


@pytest.mark.parametrize(
    "name", each(["compare", "fit", "loop", "replay", "predict-shape", "tissues-show", "resins-show"])
)
def test_what_the_screen_says_stands_in_the_details_too(name, found):
    screen, _, details = found[name].partition(DETAILS)
    known = [float(one) for one in NUMBERS.findall(details)]
    for one in NUMBERS.findall(screen):
        digits = len(one.partition(".")[2])
        assert any(abs(float(one) - other) <= 0.51 * 10.0**-digits for other in known), one


def test_the_folder_holds_these_answers_and_no_others():
    assert {path.stem for path in FOLDER.iterdir()} == set(CASES)


def test_a_changed_word_is_seen_and_a_last_digit_is_not():
    assert differs("pad 7 mm, 2.8631 N\n", "pad 7 mm, 2.8632 N\n") == ""
    assert differs("pad 7 mm\n", "slab 7 mm\n") and differs("pad 7 mm\n", "pad 8 mm\n") and differs("a\n", "a\nb\n")

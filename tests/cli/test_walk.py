"""Every command line of README, of what answers name, and of the pages is typed as printed, in one folder.

The lab between the commands is ``tests/support/walk_lab.py``; ``python -m tests.support.walk`` prints the walk.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support import walk_lab
from tests.support.typed_lines import ROOT, TypedLine, complaints, lines_of_answer, lines_of_page, lines_of_screen
from tests.support.walk import Walk, asked, form

README = [one for one in lines_of_page((ROOT / "README.md").read_text(encoding="utf-8"), "README") if one.whole]
PAGES = sorted((ROOT / "docs").glob("*.md"))


@pytest.fixture
def walk(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    return Walk(tmp_path / "work")


def test_readme_goes_from_people_and_from_a_puck_to_a_corrected_pad():
    names = [line.words[0] for line in README]
    assert {"import", "fit", "tissues", "resins", "campaign", "compare", "on-person", "loop"} <= set(names)
    assert names.count("suggest") > 3 and all(complaints(line, ("my-finger", "my-batch")) == [] for line in README)


def test_a_line_that_fails_is_a_fault(walk):
    assert walk.go(TypedLine("page", "tissues show palm")).faults == []
    assert walk.go(TypedLine("page", "tissues show plam")).status == 2
    assert len(walk.faults) == 2 and "unknown tissue 'plam'" in walk.faults[0] and "did you mean" in walk.faults[1]


def test_what_was_typed_is_not_typed_again_in_another_order(walk):
    assert walk.go(TypedLine("page", "resins add-hardness --shore-00 30 --name soft")).faults == []
    assert walk.go(TypedLine("page", "resins add-hardness --name soft --shore-00 30")) is None
    assert form(TypedLine("page", "resins add-hardness --name hard --shore-00 40")) in walk.forms
    assert form(TypedLine("page", "resins add-hardness --name hard --shore-a 40")) not in walk.forms


def test_the_lab_presses_pucks_and_plans_as_its_formulas_say(tmp_path):
    walk_lab.press_puck(tmp_path / "puck.csv", 50.0, 30.0, 50.0, 15.5)
    time, depth, force = np.loadtxt(tmp_path / "puck.csv", delimiter=",", skiprows=1).T
    stress = 0.042 / 3.0 * (0.7**-2 - 0.7)
    assert depth[-1] == pytest.approx(9.0) and time[0] == 0.0
    assert force[-100:].mean() == pytest.approx(stress * np.pi * 25.0**2, rel=0.02)
    assert force.max() > 1.5 * force[-1]
    (tmp_path / "campaign.toml").write_text(
        "[pad]\nratio = 15.5\n[punch]\nside_mm = 14.0\n"
        '[[trial]]\nfile = "a.csv"\nthickness_mm = 5.0\nvelocity_mm_s = 10.0\nhold_s = 10.0\n'
        "target_force_N = 8.0\nunload = true\n",
        encoding="utf-8",
    )
    walk_lab.press_campaign(tmp_path / "campaign.toml")
    time, depth, force = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1).T
    held = (time > 9.0) & (time < 10.0)
    assert force[held].mean() == pytest.approx(8.0, rel=0.05) and depth[-1] < 0.0 and abs(force[-50:].mean()) < 0.1


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """README, what its answers name, and the pages."""
    folder = tmp_path_factory.mktemp("walk")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DUMMYDESIGN_HOME", str(folder / "home"))
        patch.setenv("DUMMYDESIGN_CACHE", str(folder / "cache"))
        walk = Walk(folder / "work")
        walk.read_me()
        for page in PAGES:
            walk.page(page)
        yield walk


@pytest.mark.slow
def test_readme_and_pages_run_as_printed_each_on_what_the_one_before_wrote(walked):
    assert {asked(line) for line in README} <= walked.typed
    assert walked.faults == []


@pytest.mark.slow
def test_what_json_says_to_type_is_what_the_screen_says(walked):
    pairs = []
    for answer in walked.answers:
        if isinstance(answer.told.get("next"), list):
            told = {asked(line) for line in lines_of_answer(answer.told["next"], "json")}
            shown = [line for line in lines_of_screen(answer.screen, "screen") if line.whole]
            pairs += [(line.text, asked(line) in told) for line in shown]
    assert len(pairs) > 3 and [text for text, known in pairs if not known] == []

"""`suggest --drive`: the predicted presses of the recommended pad on people, and the verdict of the same presses."""

import json

import pytest

from dummydesign.cli import run

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def designed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("design")
    words = [
        "suggest",
        "--tissue",
        "palm",
        "--shape",
        "slab",
        "--no-cad",
        "--no-verify",
        "--drive",
        "steady",
        "--out",
        str(folder / "o"),
        "--json",
    ]
    import contextlib
    import io

    with contextlib.redirect_stdout(io.StringIO()) as out:
        run(words)
    return json.loads(out.getvalue()), folder


def test_the_lowest_subject_s_factor_is_the_shortfall_of_the_verdict(designed):
    found, _ = designed
    presses = found["on_person"]["presses"]
    assert found["on_person"]["drive"] == "steady" and len(presses) == 6
    for press, row in zip(presses, found["recommendation"]["conditions"]):
        assert press["pad"]["peak_N"] == pytest.approx(row["peak_force_N"], rel=5e-3)
        low, high = row["target_peak_low_N"] / row["peak_force_N"], row["target_peak_high_N"] / row["peak_force_N"]
        assert press["factor_peak"] == pytest.approx([low, high], rel=1e-2)
    assert found["verdict"]["shortfall"]["quantity"] == "peak"
    assert max(press["factor_peak"][0] for press in presses) == pytest.approx(
        found["verdict"]["shortfall"]["central"], rel=1e-2
    )


def test_the_report_shows_each_press_on_people(designed):
    _, folder = designed
    page = (folder / "o" / "report.html").read_text(encoding="utf-8")
    assert page.count("<h2>On people, steady: Press") == 6


def test_a_bad_drive_is_refused_before_the_search(capsys):
    assert run(["suggest", "--tissue", "palm", "--drive", "mass:0"]) == 2
    assert capsys.readouterr().err.startswith("error: mass in kg")

"""``suggest --shape`` and ``predict --shape`` on the command line."""

import json
from pathlib import Path

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.design.search.shape_family import designable_kinds
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.report.page import figure_values
from tests.support.command_answer import answer

pytestmark = pytest.mark.slow

QUICK = ["--no-cad", "--no-verify"]


@pytest.fixture(scope="module")
def crowned(tmp_path_factory):
    """A crowned pad for the forefinger, with its report."""
    from contextlib import redirect_stdout
    from io import StringIO

    folder, text = tmp_path_factory.mktemp("crowned"), StringIO()
    with redirect_stdout(text):
        asked = ["--tissue", "forefinger", "--shape", "crowned", "--out", str(folder)]
        status = run(["suggest", *asked, *QUICK, "--json"])
    assert status == 0
    return folder, json.loads(text.getvalue())


@pytest.mark.slow
def test_a_crowned_pad_for_the_forefinger_has_at_most_a_third_of_the_slabs_misfit(crowned, capsys):
    run(["suggest", "--tissue", "forefinger", "--shape", "slab", *QUICK, "--json"])
    rows = {row["kind"]: row for row in (*crowned[1]["shapes"], *json.loads(capsys.readouterr().out)["shapes"])}
    assert set(rows) == {"slab", "crowned"}
    assert rows["crowned"]["misfit_rms_ln_force"] <= rows["slab"]["misfit_rms_ln_force"] / 3.0
    assert rows["crowned"]["share_below_5N"] > rows["slab"]["share_below_5N"]
    assert rows["crowned"]["depth_over_thickness"] <= 0.6


@pytest.mark.slow
def test_the_recommended_shape_can_be_cast_and_read_back(crowned):
    best = crowned[1]["recommendation"]
    shape = read_shape(best["shape"])
    shape.check(best["thickness_mm"])
    assert shape.name == "crowned" and str(shape) == best["shape"]
    near = best["from_first_touch"]
    assert near["exponent_at_N"]["1"] > 1.5
    assert near["misfit_rms_ln_force"] == crowned[1]["shapes"][-1]["misfit_rms_ln_force"]


@pytest.mark.slow
def test_alternatives_have_shapes_of_their_own_thickness(capsys):
    _, found = answer(capsys, "suggest", "--tissue", "thenar", "--force", "3,6", "--shape", "crowned", *QUICK)
    assert found["alternatives"]
    for other in found["alternatives"]:
        read_shape(other["shape"]).check(other["thickness_mm"])


@pytest.mark.slow
def test_the_report_shows_the_shapes_side_by_side_with_their_curves_as_csv(crowned):
    folder, _ = crowned
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Shapes side by side" in page
    rows = figure_values(folder / "report.csv")["shapes"]
    assert {(row["x_name"], row["y_name"]) for row in rows} == {("tissue_force_N", "force_ratio")}
    assert {row["series"].split(":")[0] for row in rows} >= {"aim", "crowned"}


@pytest.mark.slow
def test_a_shape_with_its_lengths_is_kept(capsys):
    status, found = answer(capsys, "suggest", "--tissue", "forefinger", "--shape", "crowned:20,2", *QUICK)
    assert status == (1 if found["verdict"]["light"] == "red" else 0)
    assert read_shape(found["recommendation"]["shape"]) == read_shape("crowned:20,2")


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ("crownd", "did you mean 'crowned'"),
        ("crowned:20", "needs height"),
        ("crowned:20,2,x", "not a number"),
        ("crowned:20,-1", "height = -1"),
        ("crowned:20,2,9,1", "no response table"),
        ("boned:20,3,5", "that of a sphere"),
    ],
)
def test_a_shape_that_is_none_is_one_line_and_status_2(shape, words, capsys):
    assert run(["suggest", "--tissue", "forefinger", "--shape", shape, *QUICK]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ") and error.count("\n") == 1 and words in error
    assert not list(Path().iterdir())


def test_a_shape_is_not_designed_with_a_calibration_of_a_slab(capsys):
    assert run(["suggest", "--tissue", "forefinger", "--shape", "crowned", "--calibration", "x.json", *QUICK]) == 2
    assert "calibration" in capsys.readouterr().err


def test_predict_takes_a_crowned_pad_from_its_table_and_starts_as_hertz_on_a_bonded_layer(capsys):
    """Sphere on an incompressible layer: E. K. Dimitriadis et al., Biophys. J. 82 (2002) 2798, equation 13."""
    pad = ["--young", "40", "--thickness", "5", "--shape", "crowned:20,2"]
    status, found = answer(capsys, "predict", *pad, "--depth", "0.005,0.01,0.02,0.05,0.5,1.0,1.5")
    assert status == 0 and found["fidelity"] == "table"
    depth = np.array([0.005, 0.01, 0.02, 0.05])
    x = np.sqrt(20.0 * depth) / 5.0
    layer = 1.0 + 1.133 * x + 1.283 * x**2 + 0.769 * x**3 + 0.0975 * x**4
    wanted = 16.0 / 9.0 * 0.04 * 20.0**0.5 * depth**1.5 * layer
    # The table states 2.8 % there.
    assert found["force_N"][:4] == pytest.approx(wanted, rel=6e-3)
    slope = 0.5 * x * (1.133 + 2.566 * x + 2.307 * x**2 + 0.39 * x**3) / layer
    assert found["local_exponent"][:4] == pytest.approx(1.5 + slope, rel=5e-3)
    assert all(low < high for low, high in zip(found["force_low_N"], found["force_high_N"]))


def test_predict_says_where_a_shape_has_no_table(capsys):
    pad = ["--young", "40", "--thickness", "8", "--depth", "1"]
    assert run(["predict", *pad, "--shape", "crowned:20,2,ridge=1"]) == 2
    assert "--fidelity 3d" in capsys.readouterr().err
    assert run(["predict", *pad, "--shape", "crowned:20,2", "--base", "sliding"]) == 2
    assert "--fidelity axisymmetric" in capsys.readouterr().err


def test_every_family_has_its_table():
    from dummydesign.design.search.shape_family import load_family

    assert all(load_family(kind).kind == kind for kind in designable_kinds())

"""A law of one's own, registered here alone, goes through fit, its report, tissues add and compare."""

import json

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from dummydesign.cli.entry import run
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.tissue import load_tissue
from dummydesign.tissue.model.maxwell_law import LAWS, MaxwellLaw, MotionResponse
from tests.support.refusal import raises_code

DEPTH_MM = 4.0


class OneTime(MaxwellLaw):
    """Arms that relax alike at every depth: e' = x' - r (4 mm)^2 e, arm force gamma x^2 e."""

    name = "one-time"
    words = "arms whose times do not depend on depth"
    reference = "made up for this test"
    elements = (3, 5)

    def drive(self, motion: Motion) -> MotionResponse:
        return OneTimeDrive(motion)


class OneTimeDrive(MotionResponse):
    def __init__(self, motion: Motion) -> None:
        self._x = np.maximum(np.asarray(motion.displacement_mm, float), 0.0)
        self._step = np.diff(np.asarray(motion.time_s, float), axis=-1)
        self.elastic = self._x**3

    def arm(self, rate: ArrayLike) -> NDArray:
        decay = np.asarray(rate, float)[..., None] * DEPTH_MM**2 * self._step
        gain = np.where(decay > 1e-12, -np.expm1(-decay) / np.maximum(decay, 1e-12), 1.0)
        stretch = linear_recurrence(np.exp(-decay), np.diff(self._x, axis=-1) * gain)
        response = np.zeros(np.broadcast_shapes(stretch.shape[:-1] + (1,), self._x.shape))
        response[..., 1:] = self._x[..., 1:] ** 2 * stretch
        return response


GAMMA1, GAMMA, DAMPER = 0.08, [0.05, 0.2], [0.9, 0.12]


@pytest.fixture
def law(monkeypatch):
    monkeypatch.setitem(LAWS, "one-time", OneTime())
    return LAWS["one-time"]


@pytest.fixture
def traces(law, tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    rng, names = np.random.default_rng(0), []
    for velocity in (10.0, 250.0):
        for depth in (3.5, 5.0):
            motion = ramp_and_hold(velocity, depth)
            time = np.union1d(np.arange(0.0, motion.time_s[-1], 0.004), motion.time_s[:90])
            x = np.interp(time, motion.time_s, motion.displacement_mm)
            force = law.force(Motion(time, x), GAMMA1, GAMMA, DAMPER) + rng.normal(0.0, 0.01, len(time))
            names.append(f"own_{velocity:g}_{depth:g}.csv")
            rows = np.column_stack([time, x, force])
            np.savetxt(tmp_path / names[-1], rows, delimiter=",", header="time_s,displacement_mm,force_N", comments="")
    return names


@pytest.mark.slow
def test_fit_finds_its_parameters_and_the_number_of_elements_it_may_have(traces, capsys):
    assert run(["fit", *traces, "--law", "one-time", "--mode", "joint", "--out", "own.toml", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert set(result["comparison"]) == {"3", "5"} and result["elements"] == 5
    found = [entry["value"] for entry in result["parameters"].values()]
    assert found == pytest.approx([GAMMA1, *GAMMA, *DAMPER], rel=0.05)
    assert result["rmse_N"] < 0.012
    assert run(["fit", *traces, "--json"]) == 0
    other = json.loads(capsys.readouterr().out)
    assert other["rmse_N"] > 3.0 * result["rmse_N"]  # the law in which times fall with depth does not describe them
    report = next(path for path in result["files"].values() if path.endswith("-report/report.html"))
    with open(report, encoding="utf-8") as stream:
        assert "arms whose times do not depend on depth" in stream.read()


@pytest.mark.slow
def test_a_tissue_of_it_is_written_read_and_compared_with(traces, capsys):
    assert run(["tissues", "add", "mine", *traces, "--law", "one-time"]) == 0
    assert load_tissue("mine").law == "one-time"
    capsys.readouterr()
    assert run(["compare", *traces, "--tissue", "mine", "--out", "out", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["law"] == "one-time"
    # the range of one subject has no width: what is inside agrees to the noise or 1 % of the steady force
    assert all(row["inside_hold_fraction"] > 0.95 for row in result["force_variation_range"])
    assert all(row["inside_rise_fraction"] > 0.95 for row in result["force_variation_range"][:2])
    gamma1 = result["parametric"]["gamma1_N_per_mm3"]
    assert gamma1["value"] == pytest.approx(gamma1["band_low"], rel=1e-4)


def test_what_the_law_does_not_offer_is_left_out_or_refused_in_words(traces, law, capsys):
    assert run(["fit", *traces, "--law", "one-time", "--elements", "7"]) == 2
    assert "elements = 7 is not one of 3, 5" in capsys.readouterr().err
    assert run(["tissues", "add", "mine", *traces, "--law", "one-time"]) == 0
    with raises_code("unsupported", "law"):
        law.stretch_rates(np.ones(1), np.ones((1, 2)))


def test_without_it_the_name_is_unknown(capsys):
    assert run(["fit", "x.csv", "--law", "one-time"]) == 2

"""A cast pad judged by its design: what a deviation costs follows the force law, and slips of the pen are refused."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.core.manifest import Question
from dummydesign.core.outputs import new_folder
from dummydesign.core.user_library import data_folder
from dummydesign.measurement.pad_record import read_record
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import acceptance_rows, gauge_points
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.record import Measured, judge, record_pad
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code

SPEC = mould_spec(10.0, 60.0, 50.0)
MASS = pour_plan(SPEC).pad_mass_g
EVEN = (10.0,) * 5


def limit(name, measured, spec=SPEC):
    return next(one for one in judge(measured, spec) if one.what.startswith(name))


def test_the_designed_pad_is_accepted_and_costs_no_force():
    record = record_pad(Measured(EVEN, MASS, SPEC.pour.young_kPa, 0.0, 0), SPEC)
    assert record.accepted and record.missed == () and record.force_percent == pytest.approx(0.0, abs=1e-9)
    assert record.thickness_mm == 10.0 and record.thickness_sd_mm == pytest.approx(0.05)


def test_force_follows_the_response_table_with_thickness_and_goes_in_proportion_with_the_modulus():
    from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
    from dummydesign.pad.tables.slab import load_table

    record = record_pad(Measured((10.4,) * 5, 1.04 * MASS, 1.1 * SPEC.pour.young_kPa), SPEC)
    law = load_table("bonded")
    force = [float(law.force(2.5, np.array([h]), 1.0, PUNCH_RADIUS_MM)[0]) for h in (10.0, 10.4)]
    assert record.force_percent == pytest.approx(100 * (1.1 * force[1] / force[0] - 1), rel=1e-6)
    assert force[1] < force[0] and not record.accepted


def test_error_of_the_thickness_is_that_of_a_place_not_gauged():
    record = record_pad(Measured((9.9, 10.0, 10.1, 10.0, 10.0), MASS, gauge_mm=0.0), SPEC)
    assert record.thickness_sd_mm == pytest.approx(np.std(record.thicknesses_mm, ddof=1) * np.sqrt(1 + 1 / 5))


def test_a_limit_is_missed_just_beyond_it_and_twice_beyond_means_casting_again():
    edge = SPEC.acceptance.thickness_percent / 100
    assert not limit("thickness, mean", Measured((10 * (1 + 0.99 * edge),) * 5, MASS)).missed
    past = limit("thickness, mean", Measured((10 * (1 + 1.01 * edge),) * 5, MASS))
    far = limit("thickness, mean", Measured((10 * (1 + 2.1 * edge),) * 5, MASS))
    assert past.missed and "record" in past.advice and far.missed and "cast again" in far.advice


def test_mass_that_the_thickness_explains_is_not_taken_for_air():
    assert "explains" in limit("mass", Measured((10.3,) * 5, 1.03 * MASS)).advice
    assert "air" in limit("mass", Measured(EVEN, 0.9 * MASS)).advice
    assert "outside" in limit("mass", Measured(EVEN, 1.1 * MASS)).advice


def answered(low, high):
    """The mould of an answer whose pad is usable between two moduli."""
    return replace(SPEC, pour=replace(SPEC.pour, usable_kPa=(low, high)))


def test_the_witness_is_judged_by_the_window_of_the_answer_and_by_nothing_without_one():
    """Drawn windows and batches: accepted is exactly what the answer calls usable."""
    rng, young = np.random.default_rng(4127), SPEC.pour.young_kPa
    for _ in range(40):
        low, high = young * np.exp(rng.uniform((-0.9, -0.3), (0.1, 0.9)))
        measured = Measured(EVEN, MASS, float(young * np.exp(rng.normal(0.0, 0.4))))
        assert record_pad(measured, answered(low, high)).accepted is bool(low <= measured.young_kPa <= high)
        alone = limit("modulus", measured)
        assert not alone.missed and alone.low is alone.high is None
        # what it does to the force is the same with and without a limit
        assert alone.force_percent == limit("modulus", measured, answered(low, high)).force_percent


def test_a_window_makes_no_other_mould_and_goes_through_its_file():
    spec = answered(20.8, 105.2)
    again = MouldSpec.from_dict(json.loads(spec.canonical()))
    assert spec.hash == SPEC.hash == again.hash and again.pour.usable_kPa == (20.8, 105.2)
    rows = {row[0]: row for one in (SPEC, spec) for row in acceptance_rows(one, pour_plan(one))}
    assert rows["modulus of the witness"][2] == "20.8 to 105 kPa"


def test_without_an_answer_the_sheet_states_what_batches_of_the_recipe_come_out_at_and_no_limit():
    resin = load_resin()
    for ratio in (14.4, 15.5, 17.0):
        spec, interval = mould_spec(10.0, 60.0, 50.0, ratio=ratio), resin.modulus_kPa(ratio)
        (row,) = (row for row in acceptance_rows(spec, pour_plan(spec)) if row[0] == "modulus of the witness")
        assert spec.pour.expected_kPa == (interval.low, interval.high)
        assert f"{interval.low:.3g} to {interval.high:.3g} kPa" in row[2] and row[2].startswith("no limit")


def test_a_preset_of_an_earlier_version_may_hold_a_fixed_limit_which_limits_nothing(tmp_path):
    text = (data_folder() / "molds" / "open.toml").read_text(encoding="utf-8").replace('name = "open"', 'name = "mine"')
    path = tmp_path / "mine.toml"
    path.write_text(text.replace("[acceptance]", "[acceptance]\nmodulus_percent = 10.0"), encoding="utf-8")
    spec = mould_spec(10.0, 60.0, 50.0, preset=str(path))
    assert not limit("modulus", Measured(EVEN, MASS, 1.3 * SPEC.pour.young_kPa), spec).missed


def test_level_costs_half_its_wedge_and_a_puck_or_an_untabulated_pad_no_known_force():
    tilt = np.degrees(np.arctan(0.6 / 60.0))
    cost = limit("level", Measured(EVEN, MASS, level_deg=float(tilt))).force_percent
    assert cost == pytest.approx(abs(limit("thickness, mean", Measured((10.3,) * 5, MASS)).force_percent), rel=0.01)
    puck = mould_spec(30.0, 50.0, 50.0, kind="puck")
    record = record_pad(Measured((30.0,) * 5, pour_plan(puck).pad_mass_g), puck)
    assert record.force_percent is None and record.accepted


@pytest.mark.parametrize(
    "given, code",
    [
        (Measured((10.0,) * 4, MASS), "not_enough_data"),
        (Measured((10.0, 10.0, 10.0, 10.0, 100.0), MASS), "out_of_range"),
        (Measured((10.0, 10.0, 10.0, 10.0, float("nan")), MASS), "out_of_range"),
        (Measured(EVEN, 1000.0 * MASS), "out_of_range"),
        (Measured(EVEN, MASS, 0.025), "out_of_range"),
        (Measured(EVEN, MASS, level_deg=-1.0), "out_of_range"),
        (Measured(EVEN, MASS, bubbles=-1), "out_of_range"),
    ],
)
def test_what_this_pad_cannot_have_is_refused_with_what_is_allowed(given, code):
    with raises_code(code):
        record_pad(given, SPEC)


@pytest.fixture
def folder(tmp_path):
    with new_folder(tmp_path / "m", Question("mold", {"specification": SPEC.hash})) as output:
        points = [point.to_dict() for point in gauge_points(SPEC)]
        content = {"hash": SPEC.hash, "spec": SPEC.to_dict(), "gauge_points": points}
        output.path("spec.json").write_text(json.dumps(content))
    return output.folder


def test_the_command_keeps_a_record_that_reads_back_and_names_what_is_missed(folder, capsys):
    words = ["mold", "record", str(folder), "--thickness", "10.5,10.4,10.5,10.4,10.5", "--mass", f"{MASS:.2f}"]
    assert cli.run([*words, "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    record = read_record(answer["files"]["record"])
    assert record.thicknesses_mm == (10.5, 10.4, 10.5, 10.4, 10.5) and not record.accepted
    assert answer["missed"] == list(record.missed) and answer["force_percent"] == record.force_percent
    assert cli.run(words) == 1
    text = capsys.readouterr().out
    assert "MISSED" in text and "not accepted" in text and "None" not in text


def test_weighed_masses_become_a_ratio_with_the_scale_s_error(folder, capsys):
    words = [
        "mold",
        "record",
        str(folder),
        "--thickness",
        "10,10,10,10,10",
        "--mass",
        f"{MASS:.2f}",
        "--json",
        "--modulus",
        f"{SPEC.pour.young_kPa:g}",
        "--modulus-error",
        "0.5",
    ]
    assert cli.run([*words, "--weighed", "polyol=200.0,isocyanate=30.3", "--scale", "0.1"]) == 0
    record = read_record(json.loads(capsys.readouterr().out)["files"]["record"])
    assert record.weighed_ratio == pytest.approx(15.15) and record.young_sd_kPa == 0.5
    # each mass is even within 0.1 g: variances add in the logarithm of the ratio
    assert record.weighed_ratio_sd / 15.15 == pytest.approx(0.1 / np.sqrt(3) * np.hypot(1 / 30.3, 1 / 200.0))
    for wrong in ("polyol=200.0", "polyol=200,isocyanate=30,water=1", "polyol=200,isocyanate=100", "polyol=a"):
        assert cli.run([*words, "--weighed", wrong]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_a_changed_specification_a_folder_without_one_and_text_for_numbers_are_one_line(folder, tmp_path, capsys):
    words = ["--thickness", "10,10,10,10,10", "--mass", f"{MASS:.2f}"]
    path = folder / "spec.json"
    path.write_text(path.read_text().replace('"draft_deg": 2.0', '"draft_deg": 3.0'))
    for arguments in ([str(folder), *words], [str(tmp_path), *words], [str(folder), "--thickness", "a", "--mass", "1"]):
        assert cli.run(["mold", "record", *arguments]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert not (folder / "record.json").exists()

"""A puck's compression curve becomes the modulus of a batch, and a resin of its own."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin_file import save_resin
from dummydesign.resin.puck_test.add_compression import loading
from tests.support.puck_history import frictionless, ramps, relaxed

YOUNG_KPA = 30.0


@pytest.fixture(scope="module")
def curve(tmp_path_factory):
    """A puck of 30 kPa between rough plates, solved by finite elements, touched 0.2 mm late, pressed and released."""
    depth = np.linspace(0.5, 13.0, 14)
    law = Yeoh(1.0)
    solved = solve_puck(Puck(30.0, YOUNG_KPA * 1e-3, 50.0, plates="friction:0.3", law=law), depth)
    place = np.concatenate([[0.0, 0.1, 0.2], 0.2 + solved.depth_mm])
    load = np.concatenate([[0.0, 0.0, 0.0], solved.force_N])
    fine = np.linspace(0.0, place[-1], 400)
    back = fine[::-1][1:]
    displacement = np.concatenate([fine, back])
    force = np.interp(displacement, place, load)
    force[len(fine) :] *= 0.8
    file = tmp_path_factory.mktemp("puck") / "puck.csv"
    rows = [f"{0.1 * k:.2f},{x:.5f},{f:.5f}" for k, (x, f) in enumerate(zip(displacement, force))]
    file.write_text("time_s,displacement_mm,force_N\n" + "\n".join(rows) + "\n")
    return file


def command(file, *more, diameter=50, height=30, ratio=15):
    words = ["resins", "add-compression", str(file), "--diameter", str(diameter), "--height", str(height)]
    return [*words, "--name", "batch", "--ratio", str(ratio), *more]


@pytest.mark.slow
def test_the_modulus_of_a_solved_puck_is_recovered_inside_its_interval(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    assert run(command(curve, "--json")) == 0
    answer = json.loads(capsys.readouterr().out)
    young = answer["young_kPa"]
    assert young["low"] <= YOUNG_KPA <= young["high"]
    # any friction counts: the median is off the middle of what one curve leaves open, by less than the interval says
    assert 0.8 < young["value"] / YOUNG_KPA < 1.2
    assert answer["rmse_N"] < 0.5
    assert answer["name"] == "batch"
    assert run(command(other_recording(curve, tmp_path, 1.0001), "--json", "--friction", "0.3")) == 0
    declared = json.loads(capsys.readouterr().out)
    assert declared["young_kPa"]["value"] == pytest.approx(YOUNG_KPA, rel=0.01)
    assert declared["contradictions"] == []
    for key in ("law", "friction"):
        assert key in answer
    monkeypatch.chdir(tmp_path)
    asked = ["suggest", "--tissue", "palm", "--resin", "batch", "--shape", "slab", "--no-cad", "--no-verify", "--json"]
    assert run(asked) in (0, 1)


def other_recording(curve, folder, factor=1.01, name="second.csv"):
    head, *rows = curve.read_text().splitlines()
    changed = [",".join([*row.split(",")[:2], f"{factor * float(row.split(',')[2]):.5f}"]) for row in rows]
    (folder / name).write_text("\n".join([head, *changed]) + "\n")
    return folder / name


@pytest.mark.slow
def test_a_second_puck_is_kept_beside_the_first(curve, tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    assert run(command(curve)) == 0
    assert run(command(other_recording(curve, tmp_path), ratio=15.2)) == 0
    assert [point.ratio for point in load_resin("batch").points] == [15.0, 15.2]


@pytest.mark.slow
def test_pucks_in_either_order_make_the_same_file_and_a_subset_of_known_presses_changes_nothing(
    curve, tmp_path, monkeypatch, capsys
):
    second = other_recording(curve, tmp_path)
    written = []
    for turn, files in enumerate(((curve, second), (second, curve))):
        monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / str(turn)))
        for file in files:
            assert run(command(file)) == 0
        path = tmp_path / str(turn) / "materials/resins/batch.toml"
        assert run(command(files[0])) == 0 and "nothing was changed" in capsys.readouterr().out
        written.append(path.read_bytes())
    assert written[0] == written[1]
    alone = next(point for point in load_resin("batch").points)
    assert load_resin("batch").modulus_kPa(15.0).high < alone.young_kPa.high


@pytest.mark.parametrize("factor", [1e-3, 0.1, 10.0])
def test_a_force_in_another_unit_is_refused_and_a_known_batch_is_kept(curve, tmp_path, monkeypatch, capsys, factor):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    kept = tmp_path / "materials/resins/batch.toml"
    kept.parent.mkdir(parents=True)
    save_resin(replace(load_resin(), name="batch"), kept)
    before = kept.read_bytes()
    assert run(command(other_recording(curve, tmp_path, factor), "--friction", "0.3", "--json")) == 2
    assert '"code": "implausible_unit"' in capsys.readouterr().out
    assert run(command(curve, ratio=40)) == 2 and run(command(curve, height=8)) == 2
    assert kept.read_bytes() == before


@pytest.mark.slow
def test_a_mass_that_contradicts_the_size_is_told_first(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    density = load_resin().property("density_g_per_cm3", 15.0).value
    right = density * 0.25 * np.pi * 5.0**2 * 3.0
    for mass, count in ((right, 0), (1.15 * right, 1)):
        assert (
            run(command(curve, "--mass", f"{mass:.2f}", "--json", "--resin", "polyurethane-nagoya", "--replace")) == 0
        )
        answer = json.loads(capsys.readouterr().out)
        assert len(answer["contradictions"]) == count
        assert [one["code"] for one in answer["warnings"][:count]] == ["contradiction"] * count


def same_resin(first, second):
    assert first.arms == second.arms and first.points == second.points and first.notes == second.notes
    assert {name: (q.value, q.low, q.high) for name, q in first.numbers.items()} == {
        name: (q.value, q.low, q.high) for name, q in second.numbers.items()
    }
    assert first.title == second.title and first.relaxation_ratio_ref == second.relaxation_ratio_ref


@pytest.mark.slow
def test_a_puck_added_twice_counts_once_also_under_another_name_of_its_file(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    assert run(command(curve)) == 0
    file = tmp_path / "materials/resins/batch.toml"
    before = file.read_bytes()
    copy = tmp_path / "copy.csv"
    copy.write_bytes(curve.read_bytes().replace(b"\n", b"\r\n"))
    capsys.readouterr()
    assert run(command(copy)) == 0 and "nothing was changed" in capsys.readouterr().out
    assert file.read_bytes() == before


@pytest.mark.slow
def test_a_mistyped_ratio_is_put_right_as_if_it_had_not_been_typed(curve, held, tmp_path, monkeypatch, capsys):
    second = other_recording(curve, tmp_path)

    def made(home, *ratios):
        monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / home))
        for file, ratio, size in ratios:
            assert run(command(file, ratio=ratio, diameter=size[0], height=size[1])) == 0
        return load_resin("batch")

    wide, narrow = (50, 30), (42, 28)
    right = made("a", (second, 15.2, wide), (held, 15, narrow))
    capsys.readouterr()
    wrong = made("b", (held, 16, narrow), (second, 15.2, wide), (held, 15, narrow))
    assert "had this puck at ratio 16, 42 x 28 mm; that point was replaced by ratio 15" in capsys.readouterr().out
    same_resin(right, wrong)
    assert [point.ratio for point in load_resin("batch").points] == [15.0, 15.2]


@pytest.mark.slow
def test_show_says_where_each_point_came_from(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    assert run(command(curve)) == 0
    capsys.readouterr()
    assert run(["resins", "show", "batch"]) == 0
    assert "point at ratio 15: 31.9 kPa" in (text := capsys.readouterr().out) and "50 x 30 mm puck, puck.csv" in text


@pytest.mark.slow
def test_points_of_a_resin_are_not_lost_silently(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    second = other_recording(curve, tmp_path)
    assert run(command(curve)) == 0
    base = ("--resin", "polyurethane-nagoya")
    assert run(command(second, *base, ratio=15.2)) == 2 and "leave --resin out" in capsys.readouterr().err
    assert run(command(second, "--replace", ratio=15.2)) == 2 and "--resin" in capsys.readouterr().err
    assert run(command(second, *base, "--replace", ratio=15.2)) == 0
    assert [point.ratio for point in load_resin("batch").points] == [15.2]


def test_a_built_in_name_updates_that_resin_and_says_what_it_hides(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    words = command(curve, "--json", ratio=20)
    words[words.index("batch")] = "ecoflex-00-30"
    assert run(words) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["base"] == "ecoflex-00-30"
    messages = [one["message"] for one in found["warnings"] if one["code"] == "shadows_built_in"]
    assert len(messages) == 1 and "hides the built-in" in messages[0]


@pytest.mark.slow
def test_a_loading_alone_says_nothing_of_relaxation_and_leaves_that_of_the_base(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    assert run(command(curve, "--json")) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["relaxation"] is None and [one["code"] for one in answer["warnings"]] == ["size_not_weighed"]
    assert load_resin("batch").arms == load_resin().arms


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    """A puck of 42 x 28 mm between frictionless plates, ramps and holds, arms 0.3 at 1.2 s and 0.15 at 10 s."""
    time, x = ramps((0.12, 0.25), 28.0, 2.0, 80.0)
    force = relaxed(time, YOUNG_KPA * frictionless(x / 28.0, 42.0, 2.0), ((1.2, 0.3), (10.0, 0.15)))
    force += 0.01 * np.random.default_rng(8).normal(size=len(time))
    file = tmp_path_factory.mktemp("held") / "held.csv"
    np.savetxt(
        file, np.column_stack([time, x, force]), delimiter=",", header="time_s,displacement_mm,force_N", comments=""
    )
    return file


@pytest.mark.slow
def test_holds_give_the_long_term_modulus_and_arms_that_go_into_the_resin(held, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    assert run(command(held, "--json", diameter=42, height=28)) == 0
    answer = json.loads(capsys.readouterr().out)
    young, found = answer["young_kPa"], answer["relaxation"]
    assert young["low"] <= YOUNG_KPA <= young["high"]
    assert len(found["holds"]) == 2 and set(found["comparison"]) == {"0", "1", "2", "3"}
    for arm, (tau, beta) in zip(found["prony"], ((1.2, 0.3), (10.0, 0.15)), strict=True):
        assert arm["tau_s"]["value"] == pytest.approx(tau, rel=0.1)
        assert arm["beta"]["value"] == pytest.approx(beta, rel=0.1)
    kept = load_resin("batch")
    assert kept.relaxation_ratio_ref == 15.0
    times = [arm.tau_s.value for arm in kept.arms]
    for arm in found["prony"]:
        assert any(abs(time / arm["tau_s"]["value"] - 1.0) < 1e-6 for time in times)
    assert any("0.03 s" in note and "40 s" in note for note in kept.notes)  # the arm that is kept, what was seen
    assert (
        run(
            [
                "predict",
                "--resin",
                "batch",
                "--ratio",
                "15",
                "--thickness",
                "15",
                "--force",
                "10",
                "--velocity",
                "10",
                "--json",
            ]
        )
        == 0
    )


def test_a_hold_too_deep_for_the_table_is_refused_with_what_to_do(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    time, x = ramps((0.57,), 28.0, 1.0, 30.0)
    file = tmp_path / "deep.csv"
    np.savetxt(
        file,
        np.column_stack([time, x, np.maximum(x, 0.0)]),
        delimiter=",",
        comments="",
        header="time_s,displacement_mm,force_N",
    )
    assert run(command(file, diameter=42, height=28)) == 2
    assert "holds at 16 mm; one must lie between 0.84 and 14 mm" in capsys.readouterr().err


def test_only_the_first_loading_counts():
    place, load = loading(np.array([0.0, 1.0, 1.0, 2.0, 1.5, 0.0]), np.array([0.0, 2.0, 4.0, 5.0, 1.0, 0.0]))
    assert place.tolist() == [0.0, 1.0, 2.0]
    assert load.tolist() == [0.0, 3.0, 5.0]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"height": 12}, "diameter over height = 4.167 is outside the allowed range 0.759 to 3.66"),
        ({"diameter": -5}, "diameter_mm"),
        ({"ratio": 40}, "ratio of polyurethane-nagoya = 40"),
    ],
)
def test_what_cannot_be_fitted_is_refused(curve, tmp_path, monkeypatch, capsys, change, says):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    assert run(command(curve, **change)) == 2
    assert says in capsys.readouterr().err
    assert not list(tmp_path.rglob("*.toml"))


@pytest.mark.slow
def test_a_trace_that_no_puck_would_give_is_doubted_and_a_puck_is_not(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    depth = np.linspace(0.0, 12.0, 400)
    rows = [f"{0.1 * k:.2f},{x:.5f},{0.01 * x**4:.5f}" for k, x in enumerate(depth)]
    (tmp_path / "pad.csv").write_text("time_s,displacement_mm,force_N\n" + "\n".join(rows) + "\n")
    codes = {}
    for file in (curve, tmp_path / "pad.csv"):
        assert run(command(file, "--json")) == 0
        codes[file.name] = [one["code"] for one in json.loads(capsys.readouterr().out)["warnings"]]
    assert "lack_of_fit" not in codes["puck.csv"] and "lack_of_fit" in codes["pad.csv"]


@pytest.mark.slow
def test_a_puck_whose_force_fails_on_the_way_is_doubted(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    head, *rows = curve.read_text().splitlines()
    for at in range(200, 260):
        time, x, force = rows[at].split(",")
        rows[at] = f"{time},{x},{0.6 * float(force):.5f}"
    (tmp_path / "loose.csv").write_text("\n".join([head, *rows]) + "\n")
    codes = {}
    for file in (curve, tmp_path / "loose.csv"):
        assert run(command(file, "--json")) == 0
        codes[file.name] = [one["code"] for one in json.loads(capsys.readouterr().out)["warnings"]]
    assert "not_explained" in codes["loose.csv"] and "not_explained" not in codes["puck.csv"]

"""tissues add and add-points: own traces make bands, points narrow what was inferred, faults are named."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.core.user_library import entries
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.measurement.trace import Trace, read_trace
from dummydesign.tissue import load_tissue
from dummydesign.tissue.adding import from_traces, people
from dummydesign.tissue.adding.from_points import next_measurement
from dummydesign.tissue.adding.observations import read_points
from dummydesign.tissue.model.maxwell_law import Parameters
from dummydesign.tissue.model.posterior import draws_path, read_draws, typical_subjects, weighted_quantile
from dummydesign.tissue.model.tissue import Subject
from dummydesign.tissue.model.tissue_file import KIND, tissue_toml
from tests.support.fung_people import PEOPLE, press
from tests.support.refusal import raises_code


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_presses(folder, name, gamma1, fall=0.5):
    """Two presses of one person; the dampers at 250 mm/s are ``fall`` times those at 10."""
    person = Parameters("ode", gamma1, (0.3 * gamma1, gamma1), ((10.0, (1.2, 0.1)), (250.0, (1.2 * fall, 0.1 * fall))))
    folder.mkdir(exist_ok=True)
    paths = []
    for v, f in ((10.0, 10.0), (250.0, 10.0), (10.0, 5.0), (250.0, 5.0)):
        motion = ramp_and_hold(v, float(np.cbrt(f / gamma1)))
        time = np.union1d(np.arange(0.0, motion.time_s[-1], 4e-3), motion.time_s[:90])
        time = np.unique(np.round(time, 7))
        x = np.interp(time, motion.time_s, motion.displacement_mm)
        rows = np.column_stack([time, x, person.force(Motion(time, x), v)])
        paths.append(folder / f"{name}_v{v:g}_f{f:g}.csv")
        np.savetxt(paths[-1], rows, delimiter=",", header="time_s,displacement_mm,force_N", comments="", fmt="%.12g")
    return [str(path) for path in paths]


def points(path, rows):
    path.write_text("subject,depth_mm,force_N\n" + "\n".join(",".join(str(c) for c in row) for row in rows) + "\n")
    return str(path)


def cubic(name, gamma1):
    return [(name, float(np.cbrt(f / gamma1)), f) for f in (5.0, 10.0, 15.0)]


def write_fung(folder, person, forces=(2.0, 10.0), speed=10.0):
    """Presses of a person who follows no cubic law, 4 ms apart."""
    names = []
    for force in forces:
        when, x, carried = press(person, force, speed)
        time = np.r_[np.arange(0.0, when[-1], 4e-3), when[-1]]
        rows = np.column_stack([time, np.interp(time, when, x), np.interp(time, when, carried)])
        names.append(str(folder / f"{person.name}_{force:g}.csv"))
        np.savetxt(names[-1], rows, delimiter=",", header="time_s,displacement_mm,force_N", comments="", fmt="%.9g")
    return names


def test_a_law_that_misses_a_persons_peaks_is_named_by_all_who_use_it_and_none_keeps_the_curves(home, capsys):
    """Answers gave ranges 20 % off what the same people measured, with no word after `tissues add`."""
    ada = PEOPLE[0]
    files = write_fung(home, ada)
    read = {"ada": [read_trace(Path(file)) for file in files]}
    made = people.tissue_of_fits("by-law", people.fit_people(read, "ode", "5", intervals=False))
    by_law = from_traces.tissue_folder("by-law") / "by-law.toml"
    by_law.write_text(tissue_toml(made), encoding="utf-8")
    code, _ = load_tissue("by-law").notice
    assert code == "law_does_not_follow"
    assert load_tissue("palm").notice is None
    assert run(["tissues", "add", "by-curves", *files, "--law", "none"]) == 0
    law, curves = (load_tissue(name).steady_depth_range([2.0, 10.0])[0] for name in ("by-law", "by-curves"))
    true = [ada.depth_mm(force) for force in (2.0, 10.0)]
    np.testing.assert_allclose(curves, true, rtol=0.01)
    assert np.abs(law / true - 1.0).max() > 0.05
    capsys.readouterr()
    assert run(["tissues", "add", "mixed", *files, str(by_law), "--law", "none", "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "inconsistent"


def test_a_person_without_a_hold_is_refused_by_name(home, capsys):
    when, x, force = press(PEOPLE[1], 5.0, 10.0)
    kept = when <= when[np.argmax(x >= x.max() - 1e-6)] + 0.3
    rows = np.column_stack([when, x, force])[kept]
    np.savetxt("ben_1.csv", rows, delimiter=",", header="time_s,displacement_mm,force_N", comments="", fmt="%.9g")
    for law in ("ode", "none"):
        assert run(["tissues", "add", "short", "ben_1.csv", "--law", law, "--json"]) == 2
        error = json.loads(capsys.readouterr().out)["error"]
        assert (error["code"], error["quantity"]) == ("not_enough_data", "hold_s") and "ben" in error["message"]


@pytest.mark.slow
def test_two_peoples_traces_make_a_tissue_with_dampers_per_speed(home, capsys):
    write_presses(home / "berta", "run", 0.12)
    anna = write_presses(home / "loose", "anna", 0.06)
    assert run(["tissues", "add", "clinic", "berta", *anna, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert [s["name"] for s in result["subjects"]] == ["anna", "berta"]
    tissue = load_tissue("CLINIC")
    assert tissue.origin == "user" and tissue.kinds == ("fitted",) and tissue.elements == 5
    band = tissue.bands["gamma1_N_per_mm3"]
    assert (band.low, band.value, band.high) == pytest.approx((0.06, 0.09, 0.12), rel=0.01)
    assert tissue.bands["c3_N_s_per_mm"]["10"].value == pytest.approx(0.1, rel=0.03)
    assert tissue.bands["c3_N_s_per_mm"]["250"].value == pytest.approx(0.05, rel=0.03)
    assert tissue.target("subject:anna").gamma1_N_per_mm3 == pytest.approx(0.06, rel=0.01)
    assert run(["tissues", "list"]) == 0 and "clinic" in capsys.readouterr().out


@pytest.mark.slow
def test_a_fit_written_by_fit_is_taken_as_a_subject_under_its_file_name(home, capsys):
    files = write_presses(home / "traces", "x", 0.08)
    assert run(["fit", *files, "--elements", "5", "--mode", "per-speed", "--out", "carla.toml"]) == 0
    assert {path.name for path in home.glob("carla*")} == {"carla.toml", "carla-report"}
    names = {path.name for path in (home / "carla-report").iterdir()}
    assert names == {"report.html", "report.csv", "residuals.csv", "residuals.png", "manifest.json"}
    assert run(["tissues", "add", "own", "carla.toml"]) == 0
    assert [s.name for s in load_tissue("own").subjects] == ["carla"]
    capsys.readouterr()
    assert run(["tissues", "add", "own2", "carla.toml", "carla.toml"]) == 2
    assert "is listed twice" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["add", "a/b", "x.csv"], "may hold letters"),
        (["add", "ok", "x.csv"], "'x.csv' is neither"),
        (["add", "ok", "."], "holds no trace"),
        (["add", "ok", ".", "--elements", "4"], "--elements 4"),
        (["add-points", "palm", "none.csv"], "does not exist"),
        ([], "needs an action"),
    ],
)
def test_bad_requests_are_one_line_and_status_2(home, capsys, arguments, said):
    assert run(["tissues", *arguments]) == 2
    message = capsys.readouterr().err
    assert said in message and message.count("\n") == 1
    assert not list((home / "home").rglob("*.toml"))


def test_points_of_a_person_replace_what_was_inferred_of_it_and_narrow_the_rest(home):
    before = load_tissue("palm")
    middle = before.subjects[2].parameters.gamma1_N_per_mm3
    path = points(home / "p.csv", cubic("Subj. 1", middle) + cubic("Subj. 2", 1.3 * middle))
    assert run(["tissues", "add-points", "palm", path]) == 0
    after = load_tissue("palm")
    assert after.origin == "user" and len(after.subjects) == 5
    measured = next(s for s in after.subjects if s.name == "Subj. 1").numbers["gamma1_N_per_mm3"]
    assert measured.kind == "digitised" and measured.value == pytest.approx(middle, rel=0.01)
    assert measured.low < middle < measured.high < 1.3 * measured.low
    assert "reading error 2 %" in measured.source

    def width(tissue):
        rest = [s.numbers["gamma1_N_per_mm3"] for s in tissue.subjects if s.name != "Subj. 1" and s.name != "Subj. 2"]
        return max(np.log(q.high / q.low) for q in rest)

    assert width(after) < width(before)


def test_a_second_file_of_points_keeps_the_persons_of_the_first(home):
    middle = load_tissue("thenar").subjects[2].parameters.gamma1_N_per_mm3
    run(["tissues", "add-points", "thenar", points(home / "a.csv", cubic("A", middle))])
    run(["tissues", "add-points", "thenar", points(home / "b.csv", cubic("B", 0.8 * middle))])
    both = load_tissue("thenar")
    run(["tissues", "add-points", "thenar", points(home / "c.csv", cubic("B", 0.8 * middle))])
    again = load_tissue("thenar")
    assert {"A", "B"} <= {s.name for s in both.subjects} and len(both.subjects) == 5
    assert again.bands["gamma1_N_per_mm3"].value == pytest.approx(both.bands["gamma1_N_per_mm3"].value, rel=1e-3)


def test_points_of_all_five_leave_no_inferred_gamma1(home, capsys):
    rows = [row for k in range(5) for row in cubic(f"S{k}", 0.05 * 1.3**k)]
    assert run(["tissues", "add-points", "palm", points(home / "p.csv", rows), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert {s["gamma1_N_per_mm3"]["kind"] for s in result["subjects"]} == {"digitised"}
    assert result["next_measurement"]["measurement"] != "steady_depth"
    assert result["after"]["gamma1_N_per_mm3"]["low"] == pytest.approx(0.05, rel=0.01)
    assert load_tissue("palm").bands["c2_N_s_per_mm"]["10"].kind == "inferred"


def test_points_far_out_are_said_not_averaged_away(home, capsys):
    assert run(["tissues", "add-points", "palm", points(home / "p.csv", cubic("odd", 80.0)), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert any(w["code"] == "points_contradict" for w in result["warnings"])
    odd = next(s for s in result["subjects"] if s["name"] == "odd")
    assert odd["gamma1_N_per_mm3"]["value"] == pytest.approx(80.0, rel=0.01)


def test_points_that_are_no_cube_widen_the_interval_and_are_said(home, capsys):
    line = [("S1", 5.0 * f / 10.0, f) for f in (2.0, 5.0, 10.0, 15.0)]
    assert run(["tissues", "add-points", "palm", points(home / "p.csv", line), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert any(w["code"] == "not_cubic" for w in result["warnings"])


@pytest.mark.parametrize(
    "text, code",
    [
        ("subject,depth_mm\nA,1\n", "missing"),
        ("subject,depth_mm,force_N\nA,x,1\n", "not_a_number"),
        ("subject,depth_mm,force_N\nA,1,-5\n", "out_of_range"),
        ("subject,depth_mm,force_N\nA,0.004,5\n", "out_of_range"),
        ("subject,depth_mm,force_N\n,1,5\n", "missing"),
        ("subject,depth_mm,force_N\n", "nothing_found"),
    ],
)
def test_bad_points_are_named_by_line(tmp_path, text, code):
    (tmp_path / "p.csv").write_text(text)
    with raises_code(code):
        read_points(tmp_path / "p.csv")


def test_own_errors_of_points_are_used_when_given(tmp_path):
    head = "subject,depth_mm,force_N,depth_error_mm,force_error_N\n"
    (tmp_path / "p.csv").write_text(head + "A,5,10,0.01,0.01\n")
    exact = read_points(tmp_path / "p.csv")[0]
    assert exact.deviation == pytest.approx(np.hypot(3 * 0.01 / 5, 0.001), rel=1e-6)
    assert "own errors" in exact.source


def test_the_shipped_subjects_are_those_of_the_shipped_draws():
    for site in ("palm", "thenar", "forefinger"):
        tissue = load_tissue(site)
        draws, weight = read_draws(draws_path(entries(KIND)[site].path))
        assert draws.shape == (400, 5, 7) and weight.sum() == pytest.approx(1.0, rel=1e-3)
        shipped = np.array([p.gamma1_N_per_mm3 for p in tissue.parameter_sets])
        # a thinned part of the draws that the file was made from: 3.5 standard errors of a median, 1.25 sd / sqrt(m)
        error = 3.5 * 1.2533 * np.log(np.sort(draws[..., 0], axis=1)).std(axis=0) / np.sqrt(len(draws))
        assert np.all(np.abs(np.log(typical_subjects(draws)[:, 0] / shipped)) < error)
        assert KIND in str(entries(KIND)[site].path)


def test_a_measurement_that_tells_nothing_is_ranked_last_and_the_only_telling_one_removes_most():
    draws, weight = read_draws(draws_path(entries(KIND)["palm"].path))
    same = draws.copy()
    # the same steady coefficients in all draws: their measurement cannot tell draws apart
    area = np.cbrt(10.0 / draws[..., :1]) ** 2
    times = draws[..., 3:] / (draws[..., [1, 1, 2, 2]] * area)
    same[..., :1] = np.median(draws[..., :1], axis=0)
    same[..., 1:3] = draws[..., 1:3] / draws[..., :1] * same[..., :1]
    same[..., 3:] = times * same[..., [1, 1, 2, 2]] * np.cbrt(10.0 / same[..., :1]) ** 2
    ranking = next_measurement(same, weight)["ranking"]
    assert ranking[-1]["measurement"] == "steady_depth" and ranking[-1]["variance_removed"] < 1e-6
    # and the same arms in all draws: the steady depth is all there is to know
    alike = draws.copy()
    alike[..., 1:3] = draws[..., :1] * np.array([0.2, 1.0])
    alike[..., 3:] = alike[..., [1, 1, 2, 2]] * area * np.array([2.0, 1.0, 0.1, 0.03])
    removed = {r["measurement"]: r["variance_removed"] for r in next_measurement(alike, weight)["ranking"]}
    # one person in the middle does not say how far the extremes lie
    assert removed["steady_depth"] > 0.5


def test_weighted_quantiles_equal_plain_ones_of_repeated_values():
    values, weight = np.array([3.0, 1.0, 2.0, 5.0]), np.array([1.0, 4.0, 2.0, 1.0])
    repeated = np.repeat(values, weight.astype(int))
    assert weighted_quantile(values, 0.5, weight) == pytest.approx(np.median(repeated), abs=0.6)
    even = np.random.default_rng(0).normal(size=5001)
    assert weighted_quantile(even, 0.3, np.ones(5001)) == pytest.approx(np.quantile(even, 0.3), abs=1e-3)


@pytest.mark.parametrize("name", ["a b", "../a", "", "-a", ".a", "a.toml", "con", "ä"])
def test_a_name_that_makes_no_file_is_refused_and_nothing_is_made(home, name):
    with raises_code("bad_name", "tissue"):
        from_traces.reserve(name, False)
    assert not (home / "home").exists()


def test_a_name_is_the_users_own_and_hides_that_of_the_library_with_a_warning(home):
    path, hidden = from_traces.reserve("hand-1", False)
    assert path == home / "home" / KIND / "hand-1.toml" and hidden == []
    assert from_traces.reserve("palm", False)[1] != []
    path.write_text("", encoding="utf-8")
    with raises_code("file_exists"):
        from_traces.reserve("hand-1", False)
    assert from_traces.reserve("hand-1", True)[0] == path


@pytest.mark.parametrize("elements", ["3", "5", "7", "4", "auto", "05"])
def test_subjects_share_one_number_of_elements(home, elements):
    if elements in ("3", "5", "7"):
        from_traces.reserve("hand", False, elements)
    else:
        with raises_code("unknown_name", "elements"):
            from_traces.reserve("hand", False, elements)


def test_traces_belong_to_the_folder_or_to_what_stands_before_the_first_dash(home):
    folder = home / "ann"
    folder.mkdir()
    with raises_code("nothing_found", "trace"):
        from_traces._sort_files([str(folder)])
    for path in (folder / "2.csv", folder / "1.csv", home / "bob_v10_1.csv", home / "bob_v250.csv", home / "ann_3.csv"):
        path.write_text("", encoding="utf-8")
    files = [str(folder), *(str(home / name) for name in ("bob_v10_1.csv", "ann_3.csv", "bob_v250.csv"))]
    subjects, groups = from_traces._sort_files(files)
    assert subjects == []
    assert {who: [path.name for path in paths] for who, paths in groups.items()} == {
        "ann": ["1.csv", "2.csv", "ann_3.csv"],
        "bob": ["bob_v10_1.csv", "bob_v250.csv"],
    }
    with raises_code("file_not_found", "trace"):
        from_traces._sort_files([str(home / "nobody.csv")])


@pytest.mark.parametrize(
    ("files", "subjects"),
    [
        (["all/anna_v10.csv", "all/bert_v10.csv", "all/anna_v250.csv"], {"anna": 2, "bert": 1}),
        (["all/anna/1.csv", "all/bert/1.csv", "all/bert/2.csv", "all/notes/readme.txt"], {"anna": 1, "bert": 2}),
        (["all/f05_v10.csv", "all/f10_v10.csv"], {"all": 2}),
        (["all/press_1.csv", "all/press_2.csv"], {"all": 2}),
        (["all/t13.5_v010.csv", "all/anna_v10.csv"], {"all": 2}),
    ],
)
def test_a_folder_of_several_people_makes_several_subjects_and_one_of_conditions_does_not(home, files, subjects):
    for name in files:
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).touch()
    _, groups = from_traces._sort_files([str(home / "all")])
    assert {who: len(paths) for who, paths in groups.items()} == subjects


def test_a_press_under_two_names_is_warned_of_over_all_people():
    time = np.linspace(0.0, 1.0, 50)
    own = Trace("a.csv", time, time, time**2)
    other = Trace("b.csv", time, 2.0 * time, time**2)
    assert people.copies_of({"ann": [own], "bob": [other]}) == []
    (warning,) = people.copies_of({"ann": [own], "bob": [other, replace(own, name="c.csv")]})
    assert warning["code"] == "same_press" and "bob: c.csv" in warning["message"] and "ann: a.csv" in warning["message"]


def test_subjects_are_ordered_by_their_stiffness_and_no_two_have_one_name(monkeypatch):
    def subject(name, gamma1):
        return Subject(name, Parameters("ode", gamma1, (0.1,), ((10.0, (1.0,)),)), {})

    monkeypatch.setattr(people, "subject_from_fit", subject)
    made = people.tissue_of_fits("hand", {"stiff": 0.3, "soft": 0.1}, [subject("middle", 0.2)])
    assert [one.name for one in made.subjects] == ["soft", "middle", "stiff"] and made.title == "3 subjects"
    assert people.tissue_of_fits("hand", {"one": 0.3}).title == "1 subject"
    with raises_code("duplicate", "subject"):
        people.tissue_of_fits("hand", {"Middle": 0.3}, [subject("middle", 0.2)])


def test_warnings_of_a_fit_bear_the_persons_name_and_copies_are_said_elsewhere():
    from types import SimpleNamespace

    rows = [{"code": "same_press", "message": "x"}, {"code": "at_bound", "message": "c2 is at its bound"}]
    fit = SimpleNamespace(result={"warnings": rows, "rmse_N": 0.1, "max_residual_N": 0.4, "other": 1})
    assert people.fit_warnings("ann", fit) == [{"code": "at_bound", "message": "ann: c2 is at its bound"}]
    assert people.fit_row("ann", "a.csv", fit) == {
        **{"subject": "ann", "from": "a.csv"},
        **{"rmse_N": 0.1, "max_residual_N": 0.4},
    }

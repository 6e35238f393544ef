"""The calls for scripts: lazy, the same answers as the command line, dicts and tables."""

import inspect
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from html import escape
from pathlib import Path

import numpy as np
import pytest

import dummydesign
from dummydesign.api.campaigns import check_campaign, plan_campaign
from dummydesign.cli.entry import parser_of, run
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.request import Request
from dummydesign.measurement.campaign_file import SetUp
from dummydesign.measurement.campaign_plan import PlanSettings
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue.model.maxwell_law import law_named
from tests.support.refusal import raises_code

ROOT = Path(__file__).parent.parent


def test_importing_the_package_imports_no_numerics():
    code = "import sys, dummydesign; dir(dummydesign); print(sorted({'numpy', 'scipy', 'pandas'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    with pytest.raises(AttributeError, match="no attribute 'suggests'"):
        _ = dummydesign.suggests


def plain(answer):
    """An answer as a reader of its JSON gets it."""
    return json.loads(json.dumps(answer.to_dict()))


def printed(capsys, *arguments, status=0):
    """What a command prints, without the head that says which command and version it was."""
    assert run([*arguments, "--json"]) == status
    found = json.loads(capsys.readouterr().out)
    assert found.pop("schema") and found.pop("version")
    return found


PALM = {"thickness_mm": (8, 16), "ratio": (15, 16), "shape": "slab"}
PALM_OPTIONS = [
    "suggest",
    "--tissue",
    "palm",
    "--thickness",
    "8:16",
    "--ratio",
    "15:16",
    "--shape",
    "slab",
    "--no-verify",
]


# a crown that is not red, so that its mould is made
USABLE = {"shape": "crowned:21.2,2,9.4", "thickness_mm": (4.5, 4.5), "ratio": (15.3, 15.5)}
USABLE_OPTIONS = ["suggest", "--tissue", "forefinger", "--shape", USABLE["shape"], "--thickness", "4.5:4.5"]
USABLE_OPTIONS += ["--ratio", "15.3:15.5", "--no-verify"]


@pytest.mark.slow
def test_suggest_is_the_answer_of_the_command(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = dummydesign.suggest("palm", **PALM, verify=False, cad=False, out="a")
    page = Path("a/report.html").read_text()
    mine = plain(answer)
    red = not answer.outcome.verdict.acceptable
    theirs = printed(capsys, *PALM_OPTIONS, "--no-cad", "--out", "a", status=int(red))
    assert not red or theirs.pop("error")["code"] == "no_acceptable_pad"
    assert mine == theirs
    assert Path("a/report.html").read_text() == page
    frame = answer.to_frame() if has_pandas() else None
    if frame is not None:
        assert frame["thickness_mm"][0] == mine["recommendation"]["thickness_mm"]
        assert len(frame) == 1 + len(mine["alternatives"]) and "scores.total" in frame


@pytest.mark.slow
def test_suggest_weighs_what_the_solids_hold_as_the_command_does(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mine = plain(dummydesign.suggest("forefinger", **USABLE, verify=False, out="a"))
    theirs = printed(capsys, *USABLE_OPTIONS, "--out", "a")
    for found in (mine, theirs):
        assert found["mold"].pop("seconds") > 0 and found["mold"].pop("memory_MB") > 0
    assert mine == theirs
    assert mine["recommendation"]["recipe"]["components"] == mine["mold"]["pour"]["components"]


@pytest.mark.slow
def test_without_cad_both_name_the_same_next_command_and_keep_the_recipe(capsys, tmp_path, monkeypatch):
    def broken(*_, **__):
        raise NoAnswerError("cad_unavailable", "libGL.so.1 is missing: apt install libgl1")

    monkeypatch.setattr("dummydesign.mold.client.make_mold", broken)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NoAnswerError, match="dummydesign mold --thickness") as caught:
        dummydesign.suggest("forefinger", **USABLE, verify=False, out="a")
    theirs = printed(capsys, *USABLE_OPTIONS, "--out", "a", status=1)
    error = theirs.pop("error")
    assert error == caught.value.to_dict()
    assert json.loads(json.dumps(caught.value.result)) == theirs


def test_whatif_is_the_answer_of_the_command_with_its_warnings(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = {"punch": "rectangle:20x10", "force_N": "5,15", "velocity_mm_s": 10}
    mine = plain(dummydesign.whatif("5:25:10", "14.5", **study, tissue="palm", out="a"))
    page = Path("a/report.html").read_text()
    options = ["--punch", "rectangle:20x10", "--force", "5,15", "--velocity", "10", "--tissue", "palm", "--out", "a"]
    theirs = printed(capsys, "whatif", "--thickness", "5:25:10", "--ratio", "14.5", *options)
    assert mine.pop("seconds") > 0 and theirs.pop("seconds") > 0
    assert mine == theirs
    assert {item["code"] for item in mine["warnings"]} == {"out_of_reach", "punch_as_circle"}
    assert all(escape(item["message"]) in page for item in mine["warnings"])
    assert Path("a/report.html").read_text() == page
    unwritten = dummydesign.whatif("5:25:10", "14.5", **study, tissue="palm").to_dict()
    assert unwritten["warnings"] == mine["warnings"] and unwritten["files"] == {}


COMMAND_OF = {
    "suggest": ["suggest", "--tissue", "palm"],
    "predict": ["predict", "--thickness", "5"],
    "whatif": ["whatif", "--thickness", "5"],
    "import_traces": ["import", "a.csv"],
    "fit": ["fit", "a.csv"],
    "compare": ["compare", "a.csv", "--tissue", "palm"],
    "on_person": ["on-person", "a.csv", "--tissue", "palm"],
    "calibrate": ["loop", "campaign"],
    "close_loop": ["loop", "campaign"],
    "replay": ["replay", "campaign", "--calibration", "c.json"],
    "make_mould": ["mold"],
    "record_pad": ["mold", "record", "m", "--thickness", "8,8,8,8,8", "--mass", "24"],
}
FOR_SCRIPTS = {"executor", "progress"}


@pytest.mark.parametrize("call", sorted({*dummydesign.CALLS} - {"load_resin", "load_tissue"}))
def test_every_call_has_the_defaults_and_all_options_of_its_command(call):
    name, *words = COMMAND_OF[call]
    options = vars(parser_of(name).parse_args(words))
    if name == "mold":
        assert options.pop("action") == {"make_mould": None, "record_pad": "record"}[call]
    if call == "record_pad":
        for key in set(vars(parser_of("mold").parse_args([]))) & set(options) - {"replace"}:
            del options[key]
    if call == "import_traces":
        assert options.pop("list") is False
    for parameter in inspect.signature(getattr(dummydesign, call)).parameters.values():
        if parameter.name in FOR_SCRIPTS:
            continue
        typed = options.pop(parameter.name)
        if parameter.default is not inspect.Parameter.empty:
            assert same(typed, parameter.default), parameter.name
    assert not options


def test_the_call_of_suggest_has_the_arguments_and_defaults_of_its_question():
    parameters = dict(inspect.signature(dummydesign.suggest).parameters)
    usual = {name: one.default for name, one in parameters.items()} | {"tissue": "palm"}
    assert Request.read(**usual) == Request("palm")
    assert set(parameters) - {field.name for field in fields(Request)} == {"pad", "out", "replace", "progress"}


def same(typed, default):
    """Whether an option's text means the default: numbers and lists may be typed."""
    if isinstance(typed, tuple) and isinstance(default, str):
        return "x".join(f"{one:g}" for one in typed) == default
    if isinstance(typed, str) and isinstance(default, (tuple, float)):
        return tuple(map(float, typed.split(","))) == (default if isinstance(default, tuple) else (default,))
    return (list(typed), []) == (list(default), []) if isinstance(default, tuple) else typed == default


@pytest.mark.slow
def test_fit_and_compare_are_the_answers_of_their_commands(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(5)
    for velocity, depth in ((10.0, 2.5), (10.0, 3.5), (250.0, 2.5)):
        motion = ramp_and_hold(velocity, depth, hold_s=5.0)
        time = np.arange(0.0, motion.time_s[-1], 0.002)
        exact = np.interp(time, motion.time_s, law_named("ode").force(motion, 0.3, [0.2], [0.2]))
        depths = np.interp(time, motion.time_s, motion.displacement_mm)
        rows = np.c_[time, depths, exact + rng.normal(0.0, 0.02, len(time))]
        head = "time_s,displacement_mm,force_N"
        np.savetxt(f"v{velocity:g}-{depth:g}.csv", rows, "%.5f", ",", header=head, comments="")
    names = sorted(path.name for path in Path().glob("*.csv"))
    mine = plain(dummydesign.fit(names, elements=3, out="mine.toml"))
    assert mine == printed(capsys, "fit", *names, "--elements", "3", "--out", "mine.toml")
    assert mine["files"]["tissue"] == "mine.toml" and mine["inputs"]["law"] == "ode"
    mine = plain(dummydesign.compare(names, "forefinger", out="held"))
    assert mine["verdict"]["light"] == "red"
    answer = printed(capsys, "compare", *names, "--tissue", "forefinger", "--out", "held", status=1)
    assert answer.pop("error")["code"] == "not_representative"
    assert mine == answer
    assert plain(dummydesign.compare(names, "forefinger"))["files"] == {}


def test_predict_is_the_answer_of_the_command_and_takes_numbers(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mine = plain(dummydesign.predict(5, young_kPa=25, depth_mm="0.5,1", prony="0.1:0.3", out="c.csv"))
    words = ["--young", "25", "--thickness", "5", "--depth", "0.5,1", "--prony", "0.1:0.3", "--out", "c.csv"]
    theirs = printed(capsys, "predict", *words)
    for found in (mine, theirs):
        found["solver"].pop("seconds")
    assert mine == theirs
    assert dummydesign.predict(5, young_kPa=25, depth_mm=[0.5, 1]).to_dict()["force_N"] == mine["force_N"]
    pressed = dummydesign.predict(5, resin="polyurethane-nagoya", ratio=15, force_N=5, velocity_mm_s=250).to_dict()
    assert pressed["steady_force_N"] == pytest.approx(5.0, rel=1e-3) and pressed["peak_force_N"] > 5.0


def has_pandas():
    try:
        import pandas  # noqa: F401
    except ImportError:
        return False
    return True


def test_whatif_takes_numbers_lists_and_text_alike(tmp_path):
    by_text = dummydesign.whatif("5:15:5", "15,16", force_N="5", velocity_mm_s=10)
    by_list = dummydesign.whatif([5, 10, 15], (15, 16), force_N=5, velocity_mm_s=[10.0])
    assert by_text.rows == by_list.rows and len(by_text.rows) == 6
    with ThreadPoolExecutor(2) as pool:
        assert dummydesign.whatif("5:15:5", "15,16", force_N=5, velocity_mm_s=10, executor=pool).rows == by_text.rows
    written = dummydesign.whatif("5:15:5", "15,16", force_N=5, velocity_mm_s=10, out=tmp_path)
    assert Path(written.files["rows"]).exists() and Path(written.files["report"]).exists()
    assert written.to_dict()["rows"] == [dict(row) for row in by_text.rows]
    if has_pandas():
        frame = by_text.to_frame()
        assert list(frame["thickness_mm"]) == [5.0, 5.0, 10.0, 10.0, 15.0, 15.0]
        assert frame["depth_mm_at_N.5"][0] == by_text.rows[0]["depth_mm_at_N"]["5"]


def test_tables_without_pandas_say_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with raises_code("program_missing", "pandas"):
        dummydesign.whatif(5).to_frame()


@pytest.mark.parametrize("values", ["", "a", [], [None], object()])
def test_what_is_not_numbers_is_refused(values):
    with pytest.raises(InputError, match="thickness in mm"):
        dummydesign.whatif(values)


def test_refusals_leave_no_folder(tmp_path):
    for call in (
        lambda: dummydesign.suggest("plam", out=tmp_path / "x"),
        lambda: dummydesign.whatif(5, 99, out=tmp_path / "x"),
        lambda: dummydesign.whatif(5, tissue="plam", out=tmp_path / "x"),
        lambda: dummydesign.whatif(5, tissue="palm", aim="avarage", out=tmp_path / "x"),
        lambda: dummydesign.whatif(5, workers=0, out=tmp_path / "x"),
    ):
        with pytest.raises(InputError):
            call()
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_answers_are_short_to_look_at_and_give_their_values_as_attributes():
    pressed = dummydesign.predict(10.0, young_kPa=30.0, depth_mm=[1.0, 2.0, 3.0])
    assert pressed.force_N.shape == (3,) and pressed.fidelity == "table"
    assert pressed.to_dict()["force_N"] == pressed.force_N.tolist()
    designed = dummydesign.suggest("forefinger", verify=False, shape="slab")
    rows = dummydesign.whatif(5)
    for answer in (pressed, designed, rows):
        assert repr(answer).startswith(f"{answer.call}(") and len(repr(answer)) < 1000
    assert designed.recommendation["thickness_mm"] == designed.design.thickness_mm
    with pytest.raises(AttributeError, match="peak"):
        _ = pressed.peak
    assert [row["depth_mm"] for row in pressed.records()] == [1.0, 2.0, 3.0]


def test_answers_of_designs_are_typed_and_show_the_screen_of_the_command():
    asked = {"thickness_mm": (16, 16), "ratio": "15:15.5", "shape": "slab", "verify": False}
    one = dummydesign.suggest("palm", **asked)
    plain_values = one.to_dict()
    assert one.verdict.level == plain_values["verdict"]["level"]
    assert one.design.thickness_mm == plain_values["recommendation"]["thickness_mm"] == 16.0
    assert one.shares.after_puck.usable == plain_values["shares"]["after_puck"]["usable"]
    assert one.outcome.best is one.design
    shown = one._repr_html_()
    assert shown.startswith("<pre>") and escape(plain_values["verdict"]["text"][:20]) in shown


def test_a_plan_and_its_state_in_a_notebook_are_what_the_commands_print(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    plan = plan_campaign("c", SetUp("c", 25.0), PlanSettings(pads_mm=(5.0,)), power=False)
    assert plan._repr_html_().startswith("<pre>PLAN") and repr(plan).startswith("plan_campaign(")
    assert run(["campaign", "check", "c"]) == 0
    state = check_campaign("c")
    assert state._repr_html_() == f"<pre>{escape(capsys.readouterr().out.strip())}</pre>"


def test_a_prediction_in_a_notebook_is_what_the_command_prints(capsys):
    assert run(["predict", "--young", "25", "--thickness", "5", "--depth", "0.5,1"]) == 0
    printed_text = capsys.readouterr().out.strip()
    answer = dummydesign.predict(5, young_kPa=25, depth_mm="0.5,1")
    assert answer._repr_html_() == f"<pre>{escape(printed_text)}</pre>"
    assert answer.force_N.tolist() == answer.to_dict()["force_N"]
    again = dummydesign.predict(5, young_kPa=25, depth_mm="0.5,1")
    assert answer == answer != again and len({answer, again}) == 2


@pytest.mark.slow
def test_force_curves_are_drawn_with_their_interval():
    axes = dummydesign.predict(10.0, young_kPa=30.0, depth_mm=[1.0, 2.0, 3.0]).plot()
    assert axes.get_xlabel() == "depth in mm"
    assert axes.lines[0].get_ydata() == pytest.approx([2.05, 4.40, 7.08], rel=0.01)
    with pytest.raises(InputError, match="which suggest has none of"):
        dummydesign.suggest("forefinger", verify=False, shape="slab").plot()


def test_tissues_and_resins_are_loaded_by_name():
    assert dummydesign.load_tissue("palm").name == "palm"
    assert dummydesign.load_resin("ecoflex-00-30").young_MPa(0.0) > 0.0
    assert dummydesign.close_loop is dummydesign.calibrate

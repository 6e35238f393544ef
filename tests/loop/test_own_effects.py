"""Effects of one's own: one file is enough for loop, replay and design; one that breaks the contract is told why."""

from __future__ import annotations

import json
import threading
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.core.errors import InputError
from dummydesign.loop import check_effect
from dummydesign.loop.effects import registry
from dummydesign.loop.effects.registry import (
    EFFECTS,
    installed_effects,
    known_effects,
    own_effects,
    read_effect,
)
from dummydesign.loop.model.forward_model import Active, BaseParameters, simulate
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

TOY = '''
"""A crust that is pushed in with the first half millimetre."""
import numpy as np

from dummydesign.loop import Effect, Parameter, wrap


class Crust(Effect):
    """Elastic force + E x size x (1 - exp(-depth / 0.5 mm)): a skin that yields at once, on every pad the same."""

    name = "crust"
    hook = "pad"
    belongs_to = "pad"
    shapes = ("slab",)
    parameters = (Parameter("skin_mm2", "mm2", 0.0, 0.0, 200.0, 5.0),)
    signature = "a step of force at contact that does not grow with depth"
    reference = "made up for a test"

    def law(self, law, values):
        def crusted(depth_mm, thickness_mm):
            return law(depth_mm, thickness_mm) + values["skin_mm2"] * -np.expm1(-np.maximum(depth_mm, 0.0) / 0.5)

        return wrap(law, crusted)
'''


@pytest.fixture
def toy(tmp_path):
    path = tmp_path / "crust.py"
    path.write_text(TOY)
    return path


@pytest.fixture
def broken(tmp_path):
    """A function that writes the toy with some of its text replaced and returns the file."""

    def make(old, new):
        assert old in TOY
        path = tmp_path / "broken.py"
        path.write_text(TOY.replace(old, new))
        return path

    return make


@pytest.fixture(scope="module")
def crusted(campaigns, plain, tmp_path_factory):
    """A campaign on pads with a crust: the trials of the generator, their forces made with the effect."""
    source, folder = campaigns("none", 401), tmp_path_factory.mktemp("crusted")
    file = folder / "crust.py"
    file.write_text(TOY)
    presses, law = plain
    base, rng = BaseParameters(0.03, (0.05, 1.5), (0.3, 0.2)), np.random.default_rng(11)
    force = simulate(presses, law, base, [Active(read_effect(file), {"skin_mm2": 12.0})])
    for trial, values in zip(presses.trials, presses.at_samples(force)):
        noise = rng.normal(0.0, 0.03, len(values))
        rows = zip(trial.trace.time_s, trial.trace.displacement_mm, np.round(values + noise, 2))
        text = "\n".join(f"{t:.4f},{x:.3f},{f:.2f}" for t, x, f in rows)
        (folder / trial.file).write_text("time_s,displacement_mm,force_N\n" + text + "\n")
    (folder / "campaign.toml").write_text((source / "campaign.toml").read_text())
    return folder


def asked(capsys, *words):
    status = cli.run([*map(str, words), "--json"])
    shown = capsys.readouterr()
    assert status == (1 if "no_acceptable_pad" in shown.out else 0), shown.err
    return json.loads(shown.out)


def refused(capsys, *words):
    assert cli.run(list(map(str, words))) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1
    assert "Traceback" not in shown.err
    return shown.err


@pytest.mark.slow
def test_an_effect_in_one_file_is_found_replayed_and_designed_with(crusted, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    own = ["--effect", crusted / "crust.py"]
    found = asked(capsys, "loop", crusted, "--out", tmp_path / "out", *own)
    assert [e["name"] for e in found["effects"]][:1] == ["crust"]
    size = found["effects"][0]["parameters"]["skin_mm2"]
    assert size["value"] == pytest.approx(12.0, rel=0.1) and size["low"] < size["value"] < size["high"]
    calibration = found["calibration_file"]
    predicted = asked(capsys, "replay", crusted, "--calibration", calibration, *own)
    # beyond the noise of the presses: on the same pads the base has the error of its law that imitates a crust
    own_N, base_N = (np.sqrt(predicted[name] ** 2 - 0.03**2) for name in ("rmse_N", "base_rmse_N"))
    assert predicted["effects"][:1] == ["crust"] and own_N < 0.5 * base_N
    wish = ["suggest", "--tissue", "forefinger", "--calibration", calibration, "--no-cad", "--no-verify"]
    data = json.loads((tmp_path / "out" / "calibration.json").read_text())
    with_it = asked(capsys, *wish, *own)["recommendation"]
    data["after"]["effects"] = []
    del data["posterior"]
    (tmp_path / "out" / "calibration.json").write_text(json.dumps(data))
    assert asked(capsys, *wish)["recommendation"] != with_it
    assert "crust" not in [effect.name for effect in known_effects()]


def test_a_calibration_with_an_effect_that_is_not_given_says_how_to_give_it(crusted, tmp_path, capsys, toy):
    from dummydesign.loop.calibration import Calibration, Model
    from dummydesign.loop.calibration_file import write_calibration

    with own_effects([toy]):
        active = (Active(effect_named("crust"), {"skin_mm2": 3.0}),)
    model = Model(BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2)), active, (("", 5.0),), np.zeros((3, 1)))
    pad = {"young_kPa_expected": 25.0, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    path = write_calibration(Calibration(model, model, "effect", {}, 0.03, pad), tmp_path / "c.json")
    assert "--effect FILE.py" in refused(capsys, "replay", crusted, "--calibration", path)


def test_the_toy_keeps_the_contract_and_is_known_only_while_it_is_asked_for(toy):
    assert check_effect(read_effect(toy)) == check_effect(type(read_effect(toy))) == ()
    with own_effects([toy]):
        assert effect_named("crust").belongs_to == "pad"
    assert "crust" not in names_known()


def names_known():
    return [effect.name for effect in known_effects() if effect not in EFFECTS]


def test_two_threads_each_know_only_their_own_effects(broken, tmp_path):
    """Both are inside their call at the same time; neither the other's name nor its effect of the same name counts."""
    both_inside = threading.Barrier(2, timeout=60)

    def call(name, size):
        path = tmp_path / name / "own.py"
        path.parent.mkdir()
        path.write_text(TOY.replace('"crust"', f'"{name}"').replace("200.0, 5.0", f"200.0, {size}"))
        with own_effects([path]):
            both_inside.wait()
            known = names_known()
            both_inside.wait()
            return known, effect_named(name).parameters[0].typical

    with ThreadPoolExecutor(2) as pool:
        first, second = pool.submit(call, "crust", 4.0), pool.submit(call, "skin", 6.0)
        assert first.result(120) == (["crust"], 4.0)
        assert second.result(120) == (["skin"], 6.0)
    assert names_known() == []


def test_two_threads_may_give_the_same_effect(toy):
    both_inside = threading.Barrier(2, timeout=60)

    def call():
        with own_effects([toy]):
            both_inside.wait()
            known = names_known()
            both_inside.wait()
            return known

    with ThreadPoolExecutor(2) as pool:
        for one in [pool.submit(call) for _ in range(2)]:
            assert one.result(120) == ["crust"]


def test_a_fault_names_the_file_it_is_in_where_two_files_have_one_name(tmp_path):
    """Files of the same name in two folders are two files; the first is the one that fails."""
    files = [tmp_path / name / "own.py" for name in ("a", "b")]
    for path, name in zip(files, ("crust", "skin")):
        path.parent.mkdir()
        path.write_text(TOY.replace('"crust"', f'"{name}"'))
    with pytest.raises(InputError) as caught, own_effects(files):
        effect_named("crust").law(lambda depth_mm, thickness_mm: 1 / 0, {"skin_mm2": 1.0})(1.0, 2.0)
    assert "effect 'crust'" in str(caught.value) and str(files[0]) in str(caught.value)


def test_a_later_call_knows_nothing_of_the_effects_of_an_earlier_one(toy):
    with own_effects([toy]):
        assert names_known() == ["crust"]
    assert names_known() == []
    with pytest.raises(RuntimeError), own_effects([toy]):
        raise RuntimeError("stopped")
    assert names_known() == []


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('name = "crust"', 'name = "Hard Crust"', "name = 'Hard Crust'"),
        ('hook = "pad"', 'hook = "pads"', "hook = 'pads' must be one of"),
        ('belongs_to = "pad"', 'belongs_to = "me"', "belongs_to = 'me' must be one of"),
        ('reference = "made up for a test"', "", "reference is empty"),
        ('"mm2", 0.0', '"", 0.0', "unit is empty"),
        ('Parameter("skin_mm2", "mm2"', 'Parameter("skin_mm", "m"', "its name ends in mm, its unit is m"),
        ("0.0, 0.0, 200.0, 5.0", "0.0, 1.0, 200.0, 5.0", "null = 0 must lie within"),
        ("0.0, 0.0, 200.0, 5.0", "0.0, 0.0, 4.0, 5.0", "typical or starting value 5 lies outside"),
        ("0.0, 0.0, 200.0, 5.0", "0.0, 0.0, float('inf'), 5.0", "must be finite"),
        ('shapes = ("slab",)', 'shapes = ("cone",)', "shapes = ('cone',)"),
        ('shapes = ("slab",)', 'needs = ("humidity",)', "needs 'humidity', which no campaign can declare"),
        ("0.0, 0.0, 200.0, 5.0", "'0', 0.0, 200.0, 5.0", "must be numbers"),
        ('shapes = ("slab",)', 'needs = "rest_s"', "needs = 'rest_s' must be a tuple of words"),
        ("def law(", "def lawful(", "it changes nothing"),
        ("return law(", "return (1 + 0j) * law(", "its force is complex"),
        ("return wrap(law, crusted)", "raise SystemExit(0)", "SystemExit: 0 (line 23 of broken.py)"),
        ('values["skin_mm2"]', 'values["skin"]', "KeyError: 'skin' (line 21 of broken.py)"),
        ('values["skin_mm2"] *', '(values["skin_mm2"] + 0.3) *', "towards null it leaves a step"),
        ('values["skin_mm2"] *', 'values["skin_mm2"] ** 0.5 *', "the slope of the force is not finite"),
        ("return law(", "return np.random.rand() * law(", "asked twice, it gives two forces"),
        ("return law(", "depth_mm *= 1.1; return law(", "towards null it leaves a step"),
        ("np.maximum(depth_mm, 0.0) / 0.5", "np.log(values['skin_mm2'] - 200.5)", "is not finite"),
        ("return wrap(law, crusted)", "return None", "TypeError: 'NoneType' object is not callable"),
    ],
)
def test_what_breaks_the_contract_is_said(broken, old, new, said):
    path = broken(old, new)
    try:
        read_effect(path)
    except InputError as problem:
        assert said in str(problem) and "broken.py" in str(problem)
    else:
        pytest.fail("taken without a word")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("import nowhere_to_be_found", "ModuleNotFoundError"),
        ("class Effect(:", "SyntaxError"),
        ("raise SystemExit(3)", "SystemExit"),
        ("x = 1", "must hold one class derived from dummydesign.loop.Effect, not none"),
        (TOY + "\n\nclass Other(Crust):\n    pass\n", "not Crust, Other"),
        (TOY.replace('"crust"', '"ageing"'), "effect 'ageing' is known already"),
    ],
)
def test_a_file_that_cannot_be_taken_ends_in_one_line_and_status_two(text, said, tmp_path, campaigns, capsys):
    path = tmp_path / "own.py"
    path.write_text(text)
    assert said in refused(capsys, "loop", campaigns("none", 401), "--out", tmp_path / "o", "--effect", path)


def test_a_missing_file_and_another_kind_of_file_are_refused(tmp_path, campaigns, capsys):
    words = ["loop", campaigns("none", 401), "--out", tmp_path / "o", "--effect"]
    assert "does not exist" in refused(capsys, *words, tmp_path / "nothing.py")
    (tmp_path / "own.txt").write_text(TOY)
    assert "must end in .py" in refused(capsys, *words, tmp_path / "own.txt")


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param("raise ZeroDivisionError('oh')", marks=pytest.mark.slow),
        "skin = np.nan",
        pytest.param("raise SystemExit(0)", marks=pytest.mark.slow),
        pytest.param("skin = np.random.rand()", marks=pytest.mark.slow),
        pytest.param("return 1j * law(depth_mm, thickness_mm)", marks=pytest.mark.slow),
        pytest.param("return law(depth_mm, thickness_mm)[:, 1:]", marks=pytest.mark.slow),
    ],
)
def test_an_effect_that_fails_only_on_this_campaign_ends_in_one_line(broken, fault, campaigns, tmp_path, capsys):
    """The reference presses have eight trials, the campaign more: the fault shows there only."""
    path = broken(
        "            return law(",
        f"            skin = 0.0\n            if len(depth_mm) > 8: {fault}\n            return skin + law(",
    )
    said = refused(capsys, "loop", campaigns("none", 401), "--out", tmp_path / "o", "--effect", path)
    assert "effect 'crust'" in said and ("breaks the contract" in said or "in line 22 of" in said)
    assert not (tmp_path / "o").exists()


def test_effects_of_other_packages_are_found_by_their_entry_point(toy, monkeypatch):
    monkeypatch.syspath_prepend(str(toy.parent))
    good = EntryPoint("crust", "crust:Crust", registry.GROUP)

    def installed(*entries):
        monkeypatch.setattr(registry, "entry_points", lambda group: [e for e in entries if e.group == group])
        installed_effects.cache_clear()
        return [effect.name for effect in known_effects()][-1]

    try:
        assert installed(good) == "crust"
        for value in ("crust:Nothing", "no_such:Crust"):
            entry = EntryPoint("bad", value, registry.GROUP)
            with raises_code("program_failed", "effect"):
                installed(entry)
        with raises_code("duplicate", "effect"):
            installed(good, EntryPoint("again", "crust:Crust", registry.GROUP))
    finally:
        monkeypatch.undo()
        installed_effects.cache_clear()


def test_the_example_keeps_the_contract():
    assert read_effect(Path(__file__).parents[2] / "examples" / "own_effect.py").name == "crust"

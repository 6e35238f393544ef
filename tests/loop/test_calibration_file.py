"""Calibration files: what is written is read, what is damaged is refused in words, whatever the damage."""

from __future__ import annotations

import copy
import json
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.core.errors import InputError
from dummydesign.design.calibrated import with_calibration
from dummydesign.loop.calibration import Calibration, Model
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.effects.registry import EFFECTS
from dummydesign.loop.model.forward_model import LAW_TERMS, Active, BaseParameters
from dummydesign.loop.model.material import widest_bounds
from dummydesign.loop.run import replay
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code

LOW, HIGH = widest_bounds(2)

JUNK = [
    None,
    True,
    0,
    -1,
    1e300,
    -1e-300,
    10**400,
    float("nan"),
    float("inf"),
    "",
    "junk",
    "\ud800",
    [],
    [[]],
    {},
    {"a": {}},
    [1, "2"],
    {"name": []},
    3.5,
    "5",
    [None],
    [[1.0, 2.0]],
    {"parameters": 1},
]


def made(active=None):
    base = BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2))
    if active is None:
        active = tuple(Active(one, {**one.null_values(), **size(one)}) for one in EFFECTS)
    after = Model(base, active, (("", 5.0), ("", 20.0)), np.random.default_rng(2).normal(0.0, 0.02, (LAW_TERMS, 2)))
    plain = Model(base, (), (("", 12.0),), np.zeros((LAW_TERMS, 1)))
    pad = {"young_kPa_expected": 25.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab", "contact": None}
    return Calibration(plain, after, "effect", {"rise": 0.05, "hold": 0.02}, 0.03, pad)


def size(one):
    first = one.parameters[0]
    return {first.name: first.null + first.typical}


def test_what_is_written_is_read_with_every_effect(tmp_path):
    path = write_calibration(made(), tmp_path / "c.json")
    again = read_calibration(path)
    assert again.after.active == made().after.active
    np.testing.assert_allclose(again.after.base.to_logs(), made().after.base.to_logs(), rtol=1e-12)
    assert again.base.pads == (("", 12.0),)
    np.testing.assert_array_equal(again.after.law, made().after.law)
    assert (again.pad, again.verdict, again.remainder_N) == (made().pad, "effect", {"rise": 0.05, "hold": 0.02})


def test_numbers_at_the_bounds_of_the_fit_are_read(tmp_path):
    for logs, end in ((LOW, "low"), (HIGH, "high")):
        active = tuple(Active(one, {p.name: getattr(p, end) for p in one.parameters}) for one in EFFECTS)
        model = Model(BaseParameters.from_logs(logs), active, (("", 5.0),), np.zeros((3, 1)))
        path = write_calibration(Calibration(model, model, "none", {}, 0.0, made().pad), tmp_path / "c.json")
        assert read_calibration(path).after.base.young_MPa == pytest.approx(np.exp(logs[0]))


def test_an_older_file_without_owners_and_set_up_is_read(tmp_path):
    path = write_calibration(made(), tmp_path / "c.json")
    data = json.loads(path.read_text())
    for entry in data["after"]["effects"]:
        assert entry.pop("belongs_to") in ("pad", "rig", "sensor")
    data["pad"] = {"base": "bonded"}
    path.write_text(json.dumps(data))
    del data["after"]["law_error"]["waves"]
    path.write_text(json.dumps(data))
    old = read_calibration(path)
    assert not old.after.law[3:].any()
    assert old.design_effects() == made().design_effects() and not old.on_pucks()


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (("after", "base", "tau_1_s"), "x", "after.base.tau_1_s = 'x' is not a finite number"),
        (("after", "base", "young_kPa"), -3, "after.base.young_kPa = -3 is outside the allowed range 0.2 to 20000"),
        (("after", "effects", 0, "name"), "offset", r"after.effects\[0\].name = 'offset' is not one of .*--effect"),
        (("after", "effects"), {}, "after.effects = dict is not a list"),
        (("after", "law_error", "thickness_mm"), [20, 5], "must hold thicknesses above 0 that rise"),
        (("base", "law_error", "level_slope_curve"), [[0.0]], "must hold 3 rows of 1 numbers"),
        (("pad", "base"), "friction:x", "pad.base = 'friction:x' is not one of bonded, sliding"),
        (("pad", "ratio"), 0, "pad.ratio = 0 must be above 0"),
        (("verdict",), "maybe", "verdict = 'maybe' is not one of effect, none, unexplained"),
    ],
)
def test_a_fault_is_named_with_its_place_and_what_is_allowed(place, value, said, tmp_path):
    path = write_calibration(made(), tmp_path / "c.json")
    data = json.loads(path.read_text())
    spot = data
    for key in place[:-1]:
        spot = spot[key]
    spot[place[-1]] = value
    path.write_text(json.dumps(data))
    with raises_code("malformed", "calibration"):
        read_calibration(path)


def test_an_effect_that_stands_twice_is_refused(tmp_path):
    path = write_calibration(made((made().after.active[0],) * 2), tmp_path / "c.json")
    with raises_code("malformed", "calibration"):
        read_calibration(path)


def spots(tree, path=()):
    """Paths of all entries."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    out = []
    for key, value in items:
        out += [(*path, key), *spots(value, (*path, key))]
    return out


def mutated(content: str, rng: np.random.Generator) -> bytes:
    """A calibration with one to three entries swapped, deleted, doubled or buried, or its text cut, torn or nested."""
    way = rng.integers(8)
    if way == 0:
        return content[: rng.integers(len(content))].encode()
    if way == 1:
        data = bytearray(content.encode())
        for _ in range(rng.integers(1, 6)):
            data[rng.integers(len(data))] = rng.integers(256)
        return bytes(data)
    tree = json.loads(content)
    for _ in range(rng.integers(1, 4)):
        places = spots(tree)
        *above, last = places[rng.integers(len(places))]
        parent = tree
        for key in above:
            parent = parent[key]
        junk = copy.deepcopy(JUNK[rng.integers(len(JUNK))])
        change = rng.integers(5)
        if change == 0:
            del parent[last]
        elif change == 1:
            parent[last] = [parent[last], junk]
        elif change == 2 and isinstance(parent[last], int | float):
            parent[last] *= float(rng.choice([-1.0, 0.0, 0.9, 1.1, 1e3, 1e-9]))
        elif change == 3 and isinstance(parent, list):
            parent.append(copy.deepcopy(parent[last]))
        else:
            parent[last] = junk
    text = json.dumps(tree)
    return (text if way < 7 else '{"schema":' + "[" * 100_000 + text).encode()


MUTATIONS, DESIGNED = 500, 3


@pytest.mark.slow
def test_every_damaged_file_is_refused_or_read_whole_and_nothing_else_happens(tmp_path):
    rng = np.random.default_rng(20)
    path = write_calibration(made(), tmp_path / "c.json")
    content, resin = path.read_text(), load_resin("polyurethane-nagoya")
    refused = read = 0
    for _ in range(MUTATIONS):
        path.write_bytes(mutated(content, rng))
        try:
            found = read_calibration(path)
        except InputError as problem:
            assert str(problem) and "\n" not in " ".join(str(problem).split())
            refused += 1
            continue
        assert isinstance(found, Calibration)
        write_calibration(found, path)
        assert read_calibration(path).after.active == found.after.active
        read += 1
        if read > DESIGNED:
            continue
        try:
            law = with_calibration(resin, str(path)).law
        except InputError:
            continue
        assert np.all(np.isfinite(law.force(1.0, np.array([5.0, 20.0]), 0.025, 7.9)))
    assert 0.5 * MUTATIONS < refused < MUTATIONS


@pytest.mark.parametrize(("change", "refused"), [(0.5, False), (-0.5, False), (0.505, True), (-0.505, True)])
def test_a_term_of_the_law_s_error_beyond_the_bound_of_the_fit_is_refused(tmp_path, change, refused):
    whole = made()
    table = np.array([[0.01, change], [0.0, 0.1], [-0.03, 0.0]])
    path = write_calibration(replace(whole, after=replace(whole.after, law=table)), tmp_path / "c.json")
    with raises_code("malformed", "calibration") if refused else nullcontext():
        read_calibration(path)


def test_commands_refuse_damaged_files_in_one_line_and_status_two(tmp_path, capsys):
    rng = np.random.default_rng(21)
    path = write_calibration(made(), tmp_path / "c.json")
    content, tried = path.read_text(), 0
    while tried < 40:
        path.write_bytes(mutated(content, rng))
        try:
            read_calibration(path)
            continue
        except InputError:
            tried += 1
        suggest = ["suggest", "--tissue", "forefinger", "--no-cad", "--no-verify"]
        for command in (["replay", str(tmp_path)], *([suggest] if tried < 5 else [])):
            assert cli.run([*command, "--calibration", str(path)]) == 2
            shown = capsys.readouterr()
            assert shown.out == "" and shown.err.startswith("error: calibration file") and shown.err.count("\n") == 1


def test_replay_refuses_pads_on_which_an_effect_has_no_value(campaigns):
    campaign = read_campaign(campaigns("none", 401))
    with raises_code("not_applicable", "effect"):
        replay(campaign, made())


@pytest.mark.parametrize("column", ["temperature_C", "age_days", "rest_s"])
def test_replay_refuses_a_campaign_that_does_not_declare_what_an_effect_needs(column, campaigns):
    campaign = read_campaign(campaigns("none", 401))
    silent = replace(campaign, trials=tuple(replace(trial, **{column: None}) for trial in campaign.trials))
    needy = [one for one in made().after.active if column in one.effect.needs]
    assert len(needy) == 1
    with raises_code("not_applicable", "effect"):
        replay(silent, made(tuple(needy)))
    assert np.isfinite(replay(campaign, made(tuple(needy))).total_rmse_N)

"""Shore hardness and modulus: closed forms, published values, the way there and back, and resins made of it."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.core.quantity import Quantity
from dummydesign.core.user_library import data_folder, user_folder
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.mold.model.preset import mould_spec
from dummydesign.resin import load_resin
from dummydesign.resin.describe import explain
from dummydesign.resin.from_hardness import add_hardness
from dummydesign.resin.model.hardness import CHANGE_00, expected_hardness, hardness_law
from dummydesign.resin.model.resin_file import KIND
from tests.support.refusal import raises_code


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))


def kPa(value, spread=1.1):
    return Quantity(value, value / spread, value * spread, "measured", "test")


def test_the_ball_is_pressed_as_hertz_says():
    """F = 4/3 E* sqrt(R) d^1.5 with E* = E / (1 - 0.25) is the force of the durometer's spring at its depth."""
    law = hardness_law()
    for shore in (10.0, 45.0, 80.0):
        depth, force = 2.54 * (1.0 - shore / 100.0), 0.203 + 0.00908 * shore
        young_MPa = 1e-3 * float(law.hertz_kPa(shore))
        assert 4.0 / 3.0 * young_MPa / 0.75 * math.sqrt(1.19) * depth**1.5 == pytest.approx(force)


def test_the_laws_of_shore_a_are_as_published():
    law, shore = hardness_law(), np.array([20.0, 50.0, 80.0])
    gent, kunz, qi = (one.young_kPa(shore) for one in law.laws_a)
    np.testing.assert_allclose(gent, 98.1 * (56 + 7.62336 * shore) / (0.137505 * (254 - 2.54 * shore)), rtol=1e-3)
    flat = 0.75 / (2 * 0.395 * 0.025) * (0.549 + 0.07516 * shore) / (100 - shore)
    np.testing.assert_allclose(kunz, 1e3 * flat, rtol=1e-3)
    np.testing.assert_allclose(qi, 1e3 * 10 ** (0.0235 * shore - 0.6403), rtol=1e-3)


def without(law, scale, left_out=None):
    """Mean and 95 % prediction of ln (E / law) for one more product, without one of the points."""
    from scipy.stats import t

    plain = {"00": law.hertz_kPa, "A": lambda shore: law.young_kPa(shore, "A") / law.factor["A"].value}[scale]
    logs = np.array([np.log(young.value / float(plain(shore))) for shore, young in law.known[scale]])
    logs = logs if left_out is None else np.delete(logs, left_out)
    half = t.ppf(0.975, len(logs) - 1) * logs.std(ddof=1) * math.sqrt(1 + 1 / len(logs))
    return np.exp(logs.mean() + half * np.array([0.0, -1.0, 1.0])).tolist()


@pytest.mark.parametrize("scale", ["00", "A"])
def test_the_factor_of_a_scale_and_its_scatter_follow_from_the_points(scale):
    law = hardness_law()
    factor = law.factor[scale]
    assert [factor.value, factor.low, factor.high] == pytest.approx(without(law, scale), rel=2e-3)


def test_every_known_product_is_inside_the_interval_of_its_hardness():
    law = hardness_law()
    for scale, known in law.known.items():
        for shore, young in known:
            stated = law.modulus(shore, scale)
            assert stated.low < young.value < stated.high
    # Vulkollan of Shore A 65: about 5 MPa (a supplier's page)
    assert law.modulus(65.0, "A").low < 5000.0 < law.modulus(65.0, "A").high


def test_soft_products_left_out_one_at_a_time_are_inside_the_interval_of_the_others():
    """All tests and data sheets of a product leave together; more than the laws' own scatter covers would fail."""
    law, inside = hardness_law(), []
    names = [young.source.split(":")[0].replace(" Medium", "") for _, young in law.known["A"]]
    for name in dict.fromkeys(names):
        own = [at for at, one in enumerate(names) if one == name]
        value, low, high = without(law, "A", own)
        moved = replace(law, factor={**law.factor, "A": Quantity(value, low, high, "fitted", "others")})
        for shore, young in (law.known["A"][at] for at in own):
            inside.append(moved.modulus(shore, "A").low < young.value < moved.modulus(shore, "A").high)
    assert len(inside) == 13 and sum(inside) >= 12


def test_a_soft_shore_a_is_kept_with_a_warning_that_the_scale_is_at_its_end():
    soft, firm, hard = (add_hardness(f"s{shore:g}", shore_a=shore) for shore in (20.0, 40.0, 41.0))
    assert [one["code"] for one in soft["warnings"]] == ["end_of_scale", "hardness_only"]
    assert [one["code"] for one in firm["warnings"]] == ["hardness_only"]
    assert [one["code"] for one in hard["warnings"]] == ["hardness_extrapolated", "hardness_only"]


def test_where_no_soft_product_supports_the_law_the_published_laws_are_inside_the_interval():
    law = hardness_law()
    for shore in (50.0, 70.0, 90.0):
        published = math.exp(np.mean([np.log(one.young_kPa(shore)) for one in law.laws_a]))
        assert law.modulus(shore, "A").low < published < law.modulus(shore, "A").high


def test_an_own_copy_of_an_earlier_version_is_valid_and_its_own_numbers_count():
    """It has the laws alone: what soft silicones say of them is that of the built-in file."""
    text, before = (data_folder() / "materials/hardness.toml").read_text(encoding="utf-8"), hardness_law()
    head, rest = text.split("[shore_a]")
    laws = rest[rest.index("[[shore_a.law]]") : rest.index("[[shore_a.point]]")]
    path = user_folder() / "materials" / "hardness.toml"
    path.parent.mkdir(parents=True)
    scatter = rest[rest.index("[scatter]") :]
    path.write_text(f"{head}[shore_a]\nlowest = 12.0\nhighest = 90.0\n{laws}\n{scatter}", encoding="utf-8")
    law = hardness_law()
    assert law.ranges["A"] == (12.0, 90.0) and law.sure_from_a == before.sure_from_a
    assert law.modulus(20.0, "A") == before.modulus(20.0, "A")


@pytest.mark.parametrize(("scale", "shores"), [("00", (8.0, 25.0, 50.0, 70.0)), ("A", (30.0, 40.0, 85.0))])
def test_a_hardness_comes_back_and_a_harder_material_is_stiffer(scale, shores):
    law = hardness_law()
    assert np.all(np.diff(law.young_kPa(np.linspace(0.0, 95.0, 50), scale)) > 0)
    for shore in shores:
        found = law.expected(kPa(float(law.young_kPa(shore, scale))))
        assert (found.scale, found.value) == (scale, pytest.approx(shore, abs=0.01))
        assert found.low < found.value < found.high


def test_scales_join_where_one_takes_over():
    law = hardness_law()
    young = float(law.young_kPa(CHANGE_00, "00"))
    assert law.expected(kPa(0.999 * young)).scale == "00" and law.expected(kPa(1.001 * young)).scale == "A"
    assert law.expected(kPa(1.001 * young)).value >= law.ranges["A"][0]


def test_an_uncertain_modulus_widens_the_reading_and_a_liquid_one_is_zero():
    law = hardness_law()
    sure, unsure = law.expected(kPa(60.0, 1.01)), law.expected(kPa(60.0, 3.0))
    assert unsure.low < sure.low and sure.high < unsure.high
    assert law.expected(kPa(1.0)).value == pytest.approx(0.0, abs=1e-6)


def test_a_fixed_mix_is_kept_with_one_ratio_and_can_be_designed_and_poured_with():
    made = add_hardness("gel", shore_00=30.0)
    resin = load_resin("gel")
    assert resin.ratio_min == resin.ratio_max == made["ratio"] and list(resin.ratios()) == [made["ratio"]]
    young = resin.modulus_kPa(made["ratio"])
    assert young.value == pytest.approx(made["young_kPa"]["value"])
    assert young.low == pytest.approx(made["young_kPa"]["low"], rel=0.1)
    assert young.high == pytest.approx(made["young_kPa"]["high"], rel=0.1)
    assert resin.log_slope(made["ratio"]) == 0.0 and len(explain(resin)["curve"]) == 1
    assert [one.mass_g for one in resin.recipe(made["ratio"], 50.0)] == [50.0]
    assert {arm.beta.kind for arm in resin.arms} == {"assumed"}
    inputs = read_problem(Request(tissue="forefinger", resin="gel", shape="slab"))
    assert list(inputs.ratio) == [made["ratio"]]
    pour = mould_spec(8.0, 60.0, 50.0, "open", resin, made["ratio"]).pour
    assert pour.hardness == expected_hardness(resin, made["ratio"]).text
    hard = expected_hardness(resin, made["ratio"])  # as sure as the value it is from: 5 points
    assert (hard.scale, hard.value) == ("00", pytest.approx(30.0, abs=0.1))
    assert 4.9 < hard.value - hard.low < 6.0 and 4.9 < hard.high - hard.value < 6.0
    with raises_code("out_of_range"):
        resin.ratio_for(0.5)


@pytest.mark.parametrize("base", ["polyurethane-nagoya", "ecoflex-00-30"])
def test_the_law_of_a_base_is_moved_to_the_modulus_at_its_reference(base):
    made = add_hardness("moved", shore_00=45.0, base=base)
    old, new = load_resin(base), load_resin("moved")
    at = old.central.get("ratio_ref", 0.0)
    assert 1e3 * new.young_MPa(at) == pytest.approx(made["young_kPa"]["value"])
    ratios = np.linspace(old.ratio_min, old.ratio_max, 9)
    shift = new.young_MPa(ratios) / old.young_MPa(ratios)
    np.testing.assert_allclose(shift, shift[0])
    for before, after in zip(old.arms, new.arms):
        assert after.beta.value == before.beta.value and after.beta.kind == "assumed"
        assert after.beta.low <= before.beta.low and after.beta.high >= before.beta.high


@pytest.mark.slow
def test_a_base_with_points_of_its_own_gives_its_law_alone():
    add_hardness("first", shore_00=45.0, base="polyurethane-nagoya")
    points = user_folder() / "points.toml"
    points.write_text(
        'base = "first"\nname = "batch"\n[[point]]\nratio = 15.0\nyoung_kPa = { value = 120.0, low = 118.0, '
        'high = 122.0, kind = "measured", source = "puck" }\n',
        encoding="utf-8",
    )
    assert run(["resins", "add", str(points)]) == 0
    made = add_hardness("second", shore_00=30.0, base="batch")
    resin = load_resin("second")
    assert not resin.points and resin.posterior is None
    assert 1e3 * resin.young_MPa(15.0) == pytest.approx(made["young_kPa"]["value"])


def test_a_fixed_modulus_over_a_range_of_ratios_is_refused():
    add_hardness("gel", shore_00=30.0)
    path = user_folder() / KIND / "gel.toml"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("ratio_max = 100.0", "ratio_max = 120.0"), encoding="utf-8")
    with raises_code("inconsistent"):
        load_resin("gel")


@pytest.mark.parametrize(
    ("given", "code", "quantity"),
    [
        ({"shore_00": 2.0}, "out_of_range", "shore_00"),
        ({"shore_00": 95.0}, "out_of_range", "shore_00"),
        ({"shore_00": math.nan}, "out_of_range", "shore_00"),
        ({"shore_a": 5.0}, "out_of_range", "shore_a"),
        ({"shore_a": 95.0}, "out_of_range", "shore_a"),
        ({}, "missing", "shore"),
        ({"shore_00": 20.0, "shore_a": 20.0}, "conflict", "shore"),
    ],
)
def test_what_is_no_hardness_of_a_soft_resin_is_refused(given, code, quantity):
    with raises_code(code, quantity):
        add_hardness("gel", **given)
    assert not (user_folder() / KIND / "gel.toml").exists()


def test_a_name_that_is_taken_is_kept_unless_it_is_to_be_replaced():
    add_hardness("gel", shore_00=30.0)
    with raises_code("file_exists", "resin"):
        add_hardness("gel", shore_00=40.0)
    add_hardness("gel", shore_00=40.0, replace_own=True)
    assert 1e3 * load_resin("gel").young_MPa(100.0) == pytest.approx(hardness_law().modulus(40.0, "00").value)


def test_on_the_command_line(capsys):
    assert run(["resins", "add-hardness", "--shore-00", "40", "--name", "gel", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["shore"] == {"scale": "00", "value": 40.0} and found["base"] is None
    assert found["young_kPa"]["low"] < 95.0 < found["young_kPa"]["high"]
    assert run(["resins", "show", "polyurethane-nagoya", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["curve"]
    assert all(row["hardness"]["low"] <= row["hardness"]["value"] <= row["hardness"]["high"] for row in rows)
    assert run(["resins", "add-hardness", "--shore-00", "3", "--name", "other", "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "out_of_range"

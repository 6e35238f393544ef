"""Entries of a calibration file: numbers at their bounds, damage of every kind, and how a value is shown."""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.loop.calibration import Calibration, Model, Posterior
from dummydesign.loop.calibration_file import _Entry, _Fault, _shown, read_calibration, write_calibration
from dummydesign.loop.model.forward_model import Active, BaseParameters, parameter_names
from dummydesign.loop.model.material import widest_bounds
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

LOW, HIGH = widest_bounds(2)


def test_a_number_lies_within_its_ends_and_a_millionth_of_their_range():
    for value in (2.0, 3.0, 6.0, 2, 2.0 - 3.9e-6, 6.0 + 3.9e-6):
        assert _Entry(value, "a").number(2.0, 6.0) == value
    for value in (2.0 - 4.1e-6, 6.0 + 4.1e-6, float("nan"), float("inf"), True, "3", None, 1e301):
        with pytest.raises(_Fault):
            _Entry(value, "a").number(2.0, 6.0)
    assert _Entry(9e299, "a").number(0.0) == 9e299
    with pytest.raises(_Fault):
        _Entry(-1e-9, "a").number(0.0)
    assert _Entry(1e-9, "a").positive() == 1e-9
    with pytest.raises(_Fault):
        _Entry(0.0, "a").positive()
    assert _Entry([1, 2.5], "a").numbers(0.0, 3.0) == [1.0, 2.5]


def test_a_value_is_shown_short_and_by_its_kind():
    assert _shown("ab") == "'ab'" and _shown(2.5) == "2.5" and _shown(True) == "True" and _shown([1]) == "list"
    assert len(_shown("x" * 58)) == 60 and _shown("x" * 58).endswith("'")
    assert len(_shown("x" * 59)) == 60 and _shown("x" * 59).endswith("...")
    assert _shown(2**63) == "a number of many digits" and _shown(2**62) == str(2**62)


def whole():
    active = (Active(effect_named("contact_offset"), {"offset_mm": 0.1}),)
    names = tuple(parameter_names(2, [active[0].effect]))
    cover = np.diag([0.01, 0.02, 0.03, 0.04, 0.05, 0.06]) ** 2
    cover[0, 1] = cover[1, 0] = 1e-4
    known = Posterior(names, np.arange(6.0), cover, (0.01, 0.02, 0.03))
    model = Model(BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2)), active, (("", 5.0), ("", 9.0)),
                  np.array([[0.01, 0.02], [0.0, -0.03], [0.04, 0.0]]), carried=0.25)  # fmt: skip
    pad = {
        "young_kPa_expected": 30.0,
        "resin": "r",
        "ratio": 15.0,
        "base": "bonded",
        "shape": "slab",
        "contact": "bonded",
        "usual_witness_kPa": 31.0,
    }
    return Calibration(model, model, "effect", {"hold": 0.02}, 0.03, pad, ("why",), known)


def test_all_of_a_calibration_comes_back(tmp_path):
    made = whole()
    again = read_calibration(write_calibration(made, tmp_path / "c.json"))
    assert (again.verdict, again.remainder_N, again.noise_floor_N) == ("effect", {"hold": 0.02}, 0.03)
    assert again.pad["usual_witness_kPa"] == 31.0 and again.pad["ratio"] == 15.0
    assert again.unexplained_because == ("why",)
    assert again.after.active[0].values == {"offset_mm": 0.1} and again.after.carried == 0.25
    np.testing.assert_array_equal(again.posterior.mean, made.posterior.mean)
    np.testing.assert_array_equal(again.posterior.covariance, made.posterior.covariance)
    assert again.posterior.pads == (0.01, 0.02, 0.03) and again.posterior.names == made.posterior.names


def damaged(tmp_path, change):
    path = write_calibration(whole(), tmp_path / "c.json")
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))
    return path


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d["posterior"]["covariance"][0].__setitem__(1, 2e-4),
        lambda d: d["posterior"]["covariance"][2].__setitem__(2, -1e-4),
        lambda d: [d["posterior"]["covariance"][a].__setitem__(b, 9e-4) for a, b in ((0, 1), (1, 0))],
        lambda d: d["posterior"]["covariance"].pop(),
        lambda d: d["posterior"]["mean"].pop(),
        lambda d: d["posterior"]["names"].reverse(),
        lambda d: d["after"]["law_error"]["thickness_mm"].reverse(),
        lambda d: d["after"]["law_error"]["thickness_mm"].__setitem__(0, 0.0),
        lambda d: d["after"]["law_error"]["level_slope_curve"].pop(),
        lambda d: d["after"]["law_error"]["level_slope_curve"][1].pop(),
        lambda d: d["after"]["law_error"].__setitem__("carried_to_other_pads", 1.1),
        lambda d: d["after"]["law_error"].__setitem__("shape", [""]),
        lambda d: d["after"]["base"].__setitem__("young_kPa", 1e3 * float(np.exp(HIGH[0])) * 1.01),
        lambda d: d["after"]["base"].__setitem__("tau_1_s", float(np.exp(LOW[1])) * 0.5),
        lambda d: d["after"]["effects"].append(d["after"]["effects"][0]),
        lambda d: d["after"]["effects"][0].__setitem__("name", "unheard_of"),
        lambda d: d.__setitem__("noise_floor_N", -0.1),
        lambda d: d.__setitem__("verdict", "perhaps"),
        lambda d: d["pad"].__setitem__("ratio", 0.0),
    ],
)
def test_damage_is_refused(tmp_path, change):
    with raises_code("malformed", "calibration"):
        read_calibration(damaged(tmp_path, change))


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d["after"]["base"].__setitem__("young_kPa", 1e3 * float(np.exp(HIGH[0]))),
        lambda d: d["after"]["base"].__setitem__("tau_1_s", float(np.exp(LOW[1]))),
        lambda d: d["after"]["law_error"].__setitem__("carried_to_other_pads", 1.0),
        lambda d: [d["posterior"]["covariance"][a].__setitem__(b, 1.99e-4) for a, b in ((0, 1), (1, 0))],
        lambda d: d.__setitem__("noise_floor_N", 0.0),
        lambda d: d.__setitem__("later", {"anything": 1}),
    ],
)
def test_what_is_at_a_bound_is_read(tmp_path, change):
    assert read_calibration(damaged(tmp_path, change)).posterior is not None


def test_levels_of_shapes_rise_each_on_its_own(tmp_path):
    crown = "crowned:radius=21.2,height=2,foot=9.4"

    def shapes(*names):
        return lambda d: d["after"]["law_error"].update(shape=list(names), thickness_mm=[9.0, 5.0])

    assert read_calibration(damaged(tmp_path, shapes("", crown))).after.pads == (("", 9.0), (crown, 5.0))
    with raises_code("malformed", "calibration"):
        read_calibration(damaged(tmp_path, shapes(crown, crown)))

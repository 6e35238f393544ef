"""A kept result is the computed one to the last bit, and its key tells questions apart."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import pytest

from dummydesign.core import cache
from dummydesign.pad.material.hyperelastic import Ogden, Yeoh
from tests.support.counted_solve import CountedSolve, entries

VALUE = {
    "force": np.array([[0.1 + 0.2, 1e-300, np.pi]]),
    "count": np.array([3, 4]),
    "none": np.array([]),
    "notes": ("a", "b\nc"),
    "solver": {"seconds": 1.5, "corner": {0.45: 1.0 / 3.0}},
    "stop": None,
    "gap": float("nan"),
}


def same(one, other):
    if isinstance(one, np.ndarray):
        return isinstance(other, np.ndarray) and one.dtype == other.dtype and np.array_equal(one, other)
    if isinstance(one, dict):
        return list(one) == list(other) and all(same(one[name], other[name]) for name in one)
    return type(one) is type(other) and (one == other or (one != one and other != other))


def test_a_kept_result_is_the_computed_one_to_the_last_bit(place):
    solve = CountedSolve(VALUE)
    fresh, kept = (cache.cached("test", {"depth": np.linspace(0.0, 1.0, 3)}, solve) for _ in range(2))
    assert solve.calls == 1
    assert same(fresh, VALUE) and same(kept, VALUE)


@pytest.mark.parametrize(
    "other",
    [
        {"a": 1.0000000000000002, "law": Yeoh(1.0)},
        {"a": 1.0, "law": Yeoh(1.0, 0.1)},
        {"a": 1.0, "law": Ogden([1], [2])},
        {"a": 1.0, "law": None},
        {"a": [1.0], "law": Yeoh(1.0)},
    ],
)
def test_other_inputs_are_another_entry(place, other):
    solve = CountedSolve()
    cache.cached("test", {"a": 1.0, "law": Yeoh(1.0)}, solve)
    cache.cached("test", other, solve)
    assert solve.calls == 2


def test_equal_inputs_in_another_order_and_form_are_the_same_entry(place):
    solve = CountedSolve()
    cache.cached("test", {"a": (1.0, 2.0), "b": -0.0}, solve)
    cache.cached("test", {"b": np.float64(0.0), "a": np.array([1.0, 2.0])}, solve)
    assert solve.calls == 1


@dataclass(frozen=True)
class ForeignLaw:
    """A law whose code this package does not know."""

    shear_MPa: float = 1.0


@pytest.mark.parametrize("number", [np.int64(3), np.float64(3.0), np.array([3]), np.bool_(True)])
def test_numbers_of_numpy_are_kept_as_those_of_python(place, number):
    calls = []
    for asked in (number, number.tolist()):
        cache.cached("numbers", {"one": asked}, lambda: calls.append(1) or {"x": 1.0})
    assert len(calls) == 1


@pytest.mark.parametrize("what", [ForeignLaw(), lambda r: r, object()])
def test_what_has_no_canonical_form_is_computed_each_time(place, what):
    solve = CountedSolve()
    for _ in range(2):
        cache.cached("test", {"law": what}, solve)
    assert solve.calls == 2 and not place.exists()


def test_an_error_is_passed_on_and_not_kept(place):
    def fail():
        raise ValueError("folded")

    for _ in range(2):
        with pytest.raises(ValueError, match="folded"):
            cache.cached("test", {"a": 1}, fail)
    assert not place.exists()


def test_an_entry_is_text_that_says_what_was_asked(place):
    cache.cached("test", {"law": Yeoh(1.0, 0.5)}, CountedSolve())
    (path,) = entries(place)
    _, asked, value = path.read_text().split("\n")
    assert json.loads(asked)["inputs"] == {"law": {"Yeoh": {"shear_MPa": 1.0, "c2_MPa": 0.5}}}
    assert json.loads(value)["values"] == [["force", 2.5]]


def test_a_prediction_from_the_cache_is_the_fresh_one_and_serves_other_moduli(place, monkeypatch):
    """A puck by elements: the second time nothing is solved, seconds and counts are those of the solve."""
    from dummydesign.pad.axisymmetric import puck
    from dummydesign.pad.pad_under_punch import Puck
    from dummydesign.pad.predict import predict_static

    def pressed(young_MPa):
        return predict_static(Puck(30.0, young_MPa, 50.0), [3.0, 6.0], "axisymmetric").to_dict()

    fresh = pressed(0.03)
    monkeypatch.setattr(puck, "compress", None)
    assert json.dumps(pressed(0.03)) == json.dumps(fresh)
    assert pressed(0.06)["force_N"] == pytest.approx(2.0 * np.array(fresh["force_N"]), rel=1e-12)
    assert len(entries(place)) == 1

"""Rows of pads whose force is a power of depth, in closed form: tables, solved pads, limits, columns."""

from __future__ import annotations

import csv
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.scoring.press_simulation import DEPTH_SHARE, SAMPLES, PadBatch, SlabCurves
from dummydesign.design.sweep.rows import (
    SOLVED_SHARES,
    Task,
    _errors,
    _limits,
    _plain,
    _solved,
    columns_of_rows,
    empty_row,
    empty_rows,
    key_of,
    rows_of,
    work,
    write_rows,
)
from dummydesign.design.sweep.spec import Study

POWER, SCALE = 1.7, 40.0
THICKNESS, RATIO, YOUNG = np.array([10.0, 20.0, 10.0]), np.array([15.0, 15.0, 16.0]), np.array([0.03, 0.03, 0.05])


def task(**more):
    given = {
        "fidelity": "table",
        "punch": "square:14",
        "condition": "bonded",
        "base": "bonded",
        "radius_mm": 7.9,
        "thickness_mm": THICKNESS,
        "ratio": RATIO,
        "young_MPa": YOUNG,
        "tau_s": (0.1,),
        "beta": np.full((3, 1), 0.5),
        "forces_N": (5.0, 10.0, 20.0),
        "velocities_mm_s": (10.0, 250.0),
    }
    return Task(**{**given, **more})


def slabs_of(limit=(5.0, 8.0)):
    limit = np.array(limit)
    depth = limit[:, None] * np.linspace(0.0, 1.0, SAMPLES)
    curves = SlabCurves(np.array([10.0, 20.0]), limit, SCALE * depth**POWER)
    return PadBatch(curves, np.array([0, 1, 0]), YOUNG, (0.1,), np.full((3, 1), 0.5))


def test_rows_of_a_power_law_have_its_depths_exponents_and_stiffnesses():
    made = rows_of(task(), slabs_of(), lambda depth: 0.01 * depth)
    assert [key_of(row)[-2:] for row in made] == [(10.0, 15.0), (20.0, 15.0), (10.0, 16.0)]
    for row, young, h in zip(made, YOUNG, THICKNESS):
        depths = {}
        for name, force in (("5", 5.0), ("10", 10.0), ("20", 20.0)):
            depth = (force / (SCALE * young)) ** (1.0 / POWER)
            limit = 5.0 if h == 10.0 else 8.0
            if depth > limit:
                assert row["depth_mm_at_N"][name] is None and row["exponent_at_N"][name] is None
                continue
            depths[name] = depth
            assert row["depth_mm_at_N"][name] == pytest.approx(depth, rel=1e-4)
            assert row["depth_over_thickness_at_N"][name] == pytest.approx(depth / h, rel=1e-4)
            assert row["exponent_at_N"][name] == pytest.approx(POWER, rel=1e-3)
            assert row["stiffness_N_per_mm_at_N"][name] == pytest.approx(POWER * force / depth, rel=1e-3)
        assert row["force_error_percent"] == pytest.approx(max(depths.values()), rel=1e-4)
        assert row["young_kPa"] == pytest.approx(1e3 * young) and "score" not in row
        # the arm of a tenth of a second holds half of the relaxed force more, the more the faster
        slow, fast = row["peak_over_steady"]["10"], row["peak_over_steady"]["250"]
        assert 1.05 < slow < fast < 1.5


def test_a_row_that_stops_early_names_the_first_force_and_the_depth_it_would_need():
    slabs = slabs_of((2.0, 8.0))
    depth = np.array([[1.0, np.nan, np.nan], [1.0, 2.0, 3.0], [np.nan] * 3])
    told = _limits(slabs, depth, (5.0, 20.0, 10.0))
    assert told == [
        "10 N needs more than 2.00 mm (0.20 of the thickness)",
        None,
        "5 N needs more than 2.00 mm (0.20 of the thickness)",
    ]


def test_the_error_of_a_row_is_the_largest_of_the_forces_that_are_reached():
    depth = np.array([[1.0, 3.0, np.nan], [np.nan] * 3, [2.0, 1.0, 1.5]])
    found = _errors(depth, lambda at: np.where(at > 2.5, 0.004, 0.01 * at))
    assert found[[0, 2]] == pytest.approx([1.0, 2.0]) and np.isnan(found[1])
    assert np.isnan(_errors(depth, lambda at: np.full_like(at, np.nan))).all()
    assert _plain(np.array([[1.0, np.nan]])) == [[1.0, None]] and _plain(np.array([[2.0]])) == [[2.0]]


def test_rows_without_values_have_every_column():
    one = empty_row(task(), 1, "why")
    assert one["limit"] == "why" and one["thickness_mm"] == 20.0 and one["force_error_percent"] is None
    assert one["peak_over_steady"] == {"10": None, "250": None}
    assert set(one["depth_mm_at_N"].values()) == {None} and len(empty_rows(task(), "x")) == 3
    scored = empty_row(task(targets=SimpleNamespace()), 0, "why")
    assert set(scored["score"].values()) == {0.0}


def curve_of(limit, power=POWER):
    """A solved pad of unit modulus: SCALE d^power, 2 % off."""
    return SimpleNamespace(
        limit_mm=limit,
        force=lambda depth: SCALE * np.asarray(depth) ** power,
        relative_error=lambda depth: 0.02 + 0.0 * np.asarray(depth),
    )


@pytest.mark.parametrize("power", [1.0, 1.7])
def test_a_pad_that_is_solved_has_rows_of_its_curve_and_its_power_before_the_first_depth(monkeypatch, power):
    from dummydesign.pad import force_source

    asked = []

    def curve(pad, fidelity, deepest, wanted):
        asked.append((pad, deepest, wanted))
        return curve_of(99.0, power)

    monkeypatch.setattr(force_source, "elastic_curve", curve)
    one = task(fidelity="axisymmetric", thickness_mm=np.full(3, 10.0), forces_N=(0.01, 5.0, 20.0))
    made = _solved(one)
    pad, deepest, wanted = asked[0]
    assert deepest == wanted[-1] == pytest.approx(10.0 * DEPTH_SHARE) and len(wanted) == len(SOLVED_SHARES)
    assert pad.thickness_mm == 10.0 and pad.young_MPa == 1.0 and pad.sides_mm is None
    for row, young in zip(made, YOUNG):
        for name, force in (("0.01", 0.01), ("5", 5.0), ("20", 20.0)):
            depth = (force / (SCALE * young)) ** (1.0 / power)
            if depth < 10.0 * DEPTH_SHARE:
                assert row["depth_mm_at_N"][name] == pytest.approx(depth, rel=1e-2)
        assert row["exponent_at_N"]["5"] == pytest.approx(power, rel=2e-3)
        assert row["force_error_percent"] == pytest.approx(2.0)


def test_a_solve_that_stopped_ends_the_rows_there_and_one_of_two_depths_has_none(monkeypatch):
    from dummydesign.pad import force_source

    shares = 10.0 * SOLVED_SHARES
    one = task(fidelity="axisymmetric", thickness_mm=np.full(3, 10.0))
    for count, known in ((6, True), (3, True), (2, False)):
        monkeypatch.setattr(force_source, "elastic_curve", lambda *_, count=count: curve_of(shares[count - 1]))
        made = _solved(one)
        assert (made[0]["limit"] == "could not be solved to a useful depth") is not known
        if count == 6:
            assert f"more than {shares[5]:.2f} mm" in made[0]["limit"]

    def fails(*_):
        raise NoAnswerError("no_convergence", "stopped")

    monkeypatch.setattr(force_source, "elastic_curve", fails)
    assert [row["limit"] for row in _solved(one)] == ["stopped"] * 3


def test_corners_are_known_of_a_square_punch_with_a_fillet_alone(monkeypatch):
    from dummydesign.pad import force_source

    asked = []
    monkeypatch.setattr(force_source, "elastic_curve", lambda pad, *_: asked.append(pad.sides_mm) or curve_of(9.0))
    for punch, edge in (("square:14", 0.5), ("square:14", 0.0), ("rectangle:20x10", 0.5)):
        _solved(task(fidelity="axisymmetric", thickness_mm=np.full(3, 10.0), punch=punch, edge_radius_mm=edge))
    assert asked == [(14.0, 14.0), None, None]


def test_rows_are_the_same_one_at_a_time_and_together():
    """By the table of slabs, pads of two thicknesses, and of two kinds of shapes."""
    whole = work(task())
    for index, row in enumerate(whole):
        assert work(task().take(np.array([index]))) == [row]
    shapes = "layered:top=3,modulus_ratio=0.3", "crowned:radius=21.2,height=2,foot=9.4"
    mixed = task(shapes=shapes, shape=np.array([0, 1, 1]), thickness_mm=np.array([10.0, 5.0, 5.0]))
    made = work(mixed)
    for index, row in enumerate(made):
        (alone,) = work(mixed.take(np.array([index])))
        # a crown's stated error holds the difference of two forces, in which their last digits are seen
        error = alone["force_error_percent"]
        assert alone | {"force_error_percent": row["force_error_percent"]} == row
        assert error == pytest.approx(row["force_error_percent"], rel=1e-9)
    assert [row["shape"].split(":")[0] for row in made] == ["layered", "crowned", "crowned"]
    assert all(row["depth_mm_at_N"]["5"] for row in made)
    # a stiffer resin is pressed less deep, and by the modulus alone
    depth = [row["depth_mm_at_N"]["5"] for row in made[1:]]
    assert depth[1] < depth[0]


def test_a_table_that_does_not_hold_a_pad_and_a_pad_that_cannot_be_cast_say_so():
    shapes = ("crowned:radius=21.2,height=2,foot=9.4", "crowned:radius=90,height=0.4,foot=8.5")
    made = work(task(shapes=shapes, shape=np.array([0, 0, 1]), thickness_mm=np.array([2.1, 5.0, 5.0])))
    assert made[0]["limit"] and made[0]["depth_mm_at_N"]["5"] is None
    assert made[1]["depth_mm_at_N"]["5"] is not None
    assert made[2]["depth_mm_at_N"]["5"] is None or made[2]["limit"] is None


def test_a_line_has_the_values_of_its_row_in_full(tmp_path):
    study = Study(
        (10.0, 20.0), (15.0, 16.0), (("square:14", 7.9),), forces_N=(5.0, 10.0, 20.0), velocities_mm_s=(10.0, 250.0)
    )
    made = rows_of(task(), slabs_of((2.0, 8.0)), lambda depth: 0.01 * depth)
    written = write_rows(tmp_path, study, {}, made).read_text(encoding="utf-8").splitlines()
    head, columns = written[0].split(","), list(columns_of_rows(study))
    for row, line in zip(made, written[1:], strict=True):
        fields = dict(zip(columns, next(csv.reader([line])), strict=True))
        for force, depth in row["depth_mm_at_N"].items():
            assert fields[f"depth_mm_at_{force}_N"] == ("" if depth is None else repr(depth))
        assert float(fields["young_kPa"]) == row["young_kPa"] and fields["limit"] == (row["limit"] or "")
    assert head == columns and len(set(columns)) == len(columns)


def test_a_task_keeps_the_designs_that_are_taken():
    part = replace(task(), shapes=("a", "b"), shape=np.array([0, 1, 1])).take(np.array([2, 0]))
    assert part.thickness_mm.tolist() == [10.0, 10.0] and part.young_MPa.tolist() == [0.05, 0.03]
    assert [part.shape_of(index) for index in (0, 1)] == ["b", "a"] and part.beta.shape == (2, 1)
    assert part.keys == (["5", "10", "20"], ["10", "250"])

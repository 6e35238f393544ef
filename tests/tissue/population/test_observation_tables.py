"""Tables of points and curves as other programs write them: encoding, separator, decimal sign, names and units."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.tissue.adding.observations import force_unit_fault, read_curves, read_points
from tests.support.refusal import raises_code

DEPTHS = np.array([0.8, 1.85, 2.9, 3.95, 5.0])


def gamma1(folder, head, factor=(1.0, 1.0), separator=",", decimal=".", encoding="utf-8", quote=""):
    lines = [head]
    for depth in DEPTHS:
        values = (f"{depth * factor[0]:.6f}", f"{0.06 * depth**3 * factor[1]:.6f}")
        lines.append(separator.join(["A", *(f"{quote}{value.replace('.', decimal)}{quote}" for value in values)]))
    (folder / "p.csv").write_bytes("\n".join([*lines, ""]).encode(encoding))
    (one,) = read_points(folder / "p.csv")
    return float(np.exp(one.log_gamma1))


@pytest.mark.parametrize(
    ("head", "factor"),
    [
        ("subject,depth_mm,force_N", (1.0, 1.0)),
        ("Subject,Depth (cm),Force (mN)", (0.1, 1e3)),
        ("subject,depth_m,force_gf", (1e-3, 1 / 9.80665e-3)),
        ("Proband,Eindringtiefe [um],Kraft [kN]", (1e3, 1e-3)),
        ("Person,Indentation in mm,Load_N", (1.0, 1.0)),
    ],
)
def test_names_and_units_of_points_are_read(tmp_path, head, factor):
    assert gamma1(tmp_path, head, factor) == pytest.approx(0.06, rel=1e-3)


@pytest.mark.parametrize(
    "form",
    [
        {"separator": ";", "decimal": ","},
        {"separator": ";"},
        {"separator": "\t", "decimal": ",", "encoding": "utf-16"},
        {"decimal": ",", "quote": '"'},
        {"encoding": "utf-8-sig"},
        {"separator": " "},
    ],
)
def test_any_separator_decimal_sign_and_encoding_is_read(tmp_path, form):
    head = "subject,depth_mm,force_N".replace(",", form.get("separator", ","))
    assert gamma1(tmp_path, head, **form) == pytest.approx(0.06, rel=1e-6)


@pytest.mark.parametrize("factor", [1e3, 1 / 9.80665e-3, 1e-3])
def test_forces_that_no_hand_carries_are_refused(tmp_path, factor):
    with raises_code("implausible_unit", "force_N"):
        gamma1(tmp_path, "subject,depth_mm,force_N", (1.0, factor))


def test_the_unit_is_named_that_leads_to_a_hand_and_two_where_both_do():
    grams, both = (force_unit_fault(np.array([5.0]), np.array([force])) for force in (2204.0, 7500.0))
    assert "gf" in grams and "mN" not in grams
    assert "gf" in both and "mN" in both
    assert force_unit_fault(np.array([1.4, 5.0]), np.array([10.0, 7.5])) == ""


def test_a_column_without_a_unit_and_numbers_of_two_readings_are_refused(tmp_path):
    with raises_code("missing", "force_N"):
        gamma1(tmp_path, "subject,depth_mm,force")
    (tmp_path / "p.csv").write_text("subject;depth_mm;force_N\nA;1,250;1,100\nA;2,250;5,100\n", encoding="utf-8")
    with raises_code("not_a_number"):
        read_points(tmp_path / "p.csv")


def test_curves_may_state_their_speed_in_another_unit(tmp_path):
    time = np.linspace(0.0, 2.0, 60)
    depth = np.minimum(10.0 * time, 5.0)
    rows = [f"a;0,6;{t:.4f};{x:.4f};{60.0 * x**3:.4f}".replace(".", ",") for t, x in zip(time, depth)]
    head = "Subject;Speed (cm/s);Time (s);Depth (mm);Force (mN)"
    (tmp_path / "c.csv").write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    (curve,) = read_curves(tmp_path / "c.csv")
    assert curve.velocity_mm_s == pytest.approx(6.0) and curve.force_N.max() == pytest.approx(7.5, rel=1e-4)

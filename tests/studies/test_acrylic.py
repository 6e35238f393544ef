"""The study of the acrylic: its law at both ends of time, and what a fit gets back."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studies import acrylic

ROOT = Path(__file__).parents[2]
VALUES = (40.0, 2.0, 1.5, 60.0, 0.5, 1.7, 0.3)


def made(largest, rate, values=VALUES):
    up = np.linspace(1.0, largest, 120)
    curve = acrylic.curve_of(largest, rate, np.r_[up, up[-2:40:-1]], np.zeros(len(up) + len(up[-2:40:-1])))
    return replace(curve, stress_kPa=acrylic.stress_kPa(curve, values))


def elastic(stretch, young=40.0, alpha=1.7):
    return young * 2.0 / (3.0 * alpha) * (stretch ** (alpha - 1.0) - stretch ** (-0.5 * alpha - 1.0))


def test_times_follow_from_the_rate():
    curve = made(2.0, 0.05)
    assert curve.time_s[-1] == pytest.approx((1.0 + (2.0 - curve.stretch[-1])) / 0.05)


def test_very_fast_the_arms_are_springs_and_very_slow_they_are_gone():
    fast, slow = made(2.0, 1e4, (*VALUES[:6], 0.0)), made(2.0, 1e-5, (*VALUES[:6], 0.0))
    assert fast.stress_kPa == pytest.approx(3.0 * elastic(fast.stretch), rel=1e-3, abs=1e-6)
    assert slow.stress_kPa[1:] == pytest.approx(elastic(slow.stretch)[1:], rel=0.02, abs=0.02)


def test_the_times_go_with_the_power_of_the_rate():
    shifted = (VALUES[0], 2.0 * (5.0 / 3.0) ** -0.3, 1.5, 60.0 * (5.0 / 3.0) ** -0.3, 0.5, 1.7, 0.0)
    assert made(2.0, 0.05).stress_kPa == pytest.approx(made(2.0, 0.05, shifted).stress_kPa)
    assert made(2.0, 0.03).stress_kPa == pytest.approx(made(2.0, 0.03, (*VALUES[:6], 0.0)).stress_kPa)


def test_a_fit_of_two_rates_gets_the_law_back_and_predicts_a_third():
    values = acrylic.fitted([made(3.0, 0.01), made(3.0, 0.05)], True, True)
    assert values == pytest.approx(VALUES, rel=0.02)
    other = made(2.0, 0.03)
    assert acrylic.rms(acrylic.stress_kPa(other, values) - other.stress_kPa) < 1e-3 * other.stress_kPa.max()


def test_the_scatter_is_the_standard_deviation_of_curves_of_one_rate():
    one = made(2.0, 0.03)
    curves = [replace(one, stress_kPa=factor * one.stress_kPa) for factor in (1.0, 1.2, 1.5)]
    assert acrylic.scatter(curves) == pytest.approx(np.std(np.log([1.0, 1.2, 1.5]), ddof=1))


def test_the_page_has_the_rows_of_its_table():
    with (ROOT / acrylic.ROWS).open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    text = (ROOT / acrylic.PAGE.path).read_text(encoding="utf-8")
    assert {row["model"] for row in rows} == {*acrylic.MODELS, acrylic.NETWORK}
    for model in (*acrylic.MODELS, acrylic.NETWORK):
        own = [float(row["rms_over_peak"]) for row in rows if row["model"] == model and row["fitted"] == "False"]
        line = next(line for line in text.splitlines() if line.startswith(f"| {model} |"))
        assert len(own) == 9 and f" {100 * acrylic.rms(own):.1f} % " in line

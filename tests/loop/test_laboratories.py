"""Laboratories that press with laws of their own: they take nothing of the package, and their laws are right."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

from benchmarks.accuracy import laboratories
from benchmarks.accuracy.laboratory_figures import USABLE
from benchmarks.accuracy.laboratory_pad import press
from benchmarks.accuracy.laboratory_press import Person, maxwell, motion

FILES = sorted(Path(laboratories.__file__).parent.glob("laborator*.py"))


def test_laboratories_import_nothing_of_the_package():
    assert len(FILES) == 5
    for path in FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [one.name for one in node.names] if isinstance(node, ast.Import) else []
            assert not [name for name in names if name.split(".")[0] == "dummydesign"], path.name


def test_a_ramp_of_a_maxwell_arm_is_its_closed_form():
    t = np.linspace(0.0, 2.0, 41)
    force = maxwell(t, 3.0 * t, [(0.4, 0.7)])
    assert force == pytest.approx(3.0 * t + 3.0 * 0.7 * 0.4 * -np.expm1(-t / 0.4), rel=1e-9)


@pytest.mark.parametrize("power", [None, 3.0])
def test_a_person_that_is_held_long_has_the_steady_force_of_the_first_spring(power):
    person = Person((0.08, 0.05, 0.08), (1.2, 0.03), power)
    t, x = motion(10.0, 5.0, 60.0)
    assert person.force(t, x)[-1] == pytest.approx(0.08 * 5.0**3, rel=1e-3)


def test_a_thick_pad_is_near_the_half_space_and_stiffer():
    """incompressible half-space: F = 8/3 a E d, glued or not; the base stiffens by about 1.1 a/h"""
    curve = press(40.0, 2.0, None, np.array([0.02]), cell=0.25)
    over = curve.area_mm2[-1] / (8.0 / 3.0 * 2.0 * 0.02)
    assert 1.0 < over < 1.12


@pytest.mark.slow
@pytest.mark.parametrize("yeoh", [0.0, 0.08])
def test_the_law_of_a_crown_is_near_that_of_the_package(yeoh):
    from dummydesign.api.predictions import predict

    depth = 11.0 * np.array([0.2, 0.3, 0.4])
    own = press(11.0, 8.0, (2.5, 3.5, 7.9), 11.0 * 0.4 * np.linspace(0.0, 1.0, 33)[1:], yeoh, 0.45)
    other = predict(
        11.0,
        young_kPa=1000.0,
        shape="crowned:2.5,3.5,7.9",
        punch="round:16",
        depth_mm=depth.tolist(),
        fidelity="axisymmetric",
        law=f"yeoh:{yeoh / 2.0}" if yeoh else "neo-hookean",
    ).to_dict()
    force = np.array(other["force_N"])
    assert np.interp(depth, *own) == pytest.approx(force, rel=0.02)


@pytest.mark.slow
def test_one_laboratory_goes_the_whole_way(tmp_path):
    """nothing undeclared: people, puck, pad and loop by the command line, without an error or a question"""
    row = laboratories.run(6200, 0, tmp_path)
    assert "stopped" not in row and "asked" not in row and row["broken"] == [] and not row["put"]
    assert row["puck"]["low"] <= row["puck"]["true_kPa"] <= row["puck"]["high"]
    assert (row["light_after_puck"] in USABLE) == row["truth"]["usable"] == (row["compare"] in USABLE)
    assert row["loop"]["verdict"] == "none" and row["loop"]["inside"] and row["loop"]["held"]
    assert row["next_error"] <= row["next_error_before"] + 0.02

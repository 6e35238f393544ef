"""The range in which people were pressed: of the fitted presses, or of the protocol where none is known."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.accuracy.fit_coverage import GAMMA1
from benchmarks.accuracy.fit_coverage import press as pressed_person
from dummydesign.core.quantity import Quantity
from dummydesign.person.drives import read_drive
from dummydesign.person.on_person import on_person
from dummydesign.tissue.fitting.fit import fit_traces
from dummydesign.tissue.model.subject import FITTED, PRESSED
from dummydesign.tissue.model.tissue import Tissue
from dummydesign.tissue.model.tissue_file import load_tissue, tissue_toml
from tests.support.refusal import raises_code
from tests.support.robot_presses import by_path, command, gel_pad, sampled

FORCES_N = (3.0, 8.0)


@pytest.fixture(scope="module")
def presses():
    return [pressed_person(v, np.cbrt(force / GAMMA1)) for v in (10.0, 250.0) for force in FORCES_N]


@pytest.fixture(scope="module")
def tissue(presses, tmp_path_factory):
    from dummydesign.tissue.fitting.fit import subject_from_fit

    subject = subject_from_fit("anna", fit_traces(presses, 5, mode="per-speed", intervals=False))
    path = tmp_path_factory.mktemp("own") / "anna.toml"
    path.write_text(tissue_toml(Tissue("anna", "anna", "ode", (subject,), (), (), "file")), encoding="utf-8")
    return load_tissue(str(path))


def pushed(depth, velocity=100.0):
    path, speed, end = command(velocity, depth, 3.0, 0.1 * depth / velocity)
    return sampled(by_path(gel_pad(), path, speed, end, -0.6 / velocity, 20001))


@pytest.mark.slow
def test_a_fit_keeps_the_range_of_its_presses_and_a_file_gives_it_back(presses, tissue):
    found = tissue.subjects[0].pressed
    depths = [np.cbrt(force / GAMMA1) for force in FORCES_N]
    assert list(found) == [*PRESSED, FITTED] and {found[name].kind for name in PRESSED} == {"measured"}
    # the law is the one that made the presses
    assert (found[FITTED].low, found[FITTED].high) == pytest.approx((1.0, 1.0), abs=0.02)
    assert (found["depth_mm"].low, found["depth_mm"].high) == pytest.approx(depths, rel=2e-3)
    # the slow arm still carries a little after 10 s
    assert found["steady_force_N"].low == pytest.approx(FORCES_N[0], rel=0.05)
    assert found["steady_force_N"].high == pytest.approx(FORCES_N[1], rel=0.05)
    assert found["peak_force_N"].high == pytest.approx(max(trace.force_N.max() for trace in presses), rel=1e-2)
    assert tissue.to_dict()["subjects"][0]["pressed"]["depth_mm"]["value"] == pytest.approx(np.mean(depths), rel=2e-3)


@pytest.mark.slow
def test_a_press_is_beyond_where_the_fitted_presses_end_not_where_the_protocol_does(tissue):
    deepest = tissue.subjects[0].pressed["depth_mm"].high
    bare = replace(tissue, subjects=tuple(replace(one, pressed={}) for one in tissue.subjects))
    protocol = np.cbrt(15.0 / GAMMA1)
    between = 0.5 * (deepest + protocol)
    assert deepest * 1.1 < between < protocol / 1.1
    for depth, own, assumed in ((0.9 * deepest, False, False), (between, True, False), (1.2 * protocol, True, True)):
        for one, wanted in ((tissue, own), (bare, assumed)):
            beyond = on_person([pushed(depth)], one, read_drive("position")).presses[0].beyond
            assert any(row.quantity == "depth_mm" for row in beyond) == wanted, (depth, one is tissue)


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("pressed.depth_mm", "pressed.depth", "malformed"),
        ("pressed.depth_mm = {", "pressed.depth_mm = 1.0 #", "malformed"),
        ("pressed.", "press.", "unknown_key"),
    ],
)
def test_a_range_that_is_not_whole_is_refused(tmp_path, old, new, code):
    pressed = {name: Quantity(2.0, 1.0, 3.0, "measured", "a press") for name in PRESSED}
    anna = replace(load_tissue("palm").subjects[0], pressed=pressed)
    path, text = tmp_path / "odd.toml", tissue_toml(Tissue("anna", "anna", "ode", (anna,), (), (), "file"))
    path.write_text(text, encoding="utf-8")
    assert load_tissue(str(path)).subjects[0].pressed == pressed
    path.write_text(text.replace(old, new), encoding="utf-8")
    with raises_code(code):
        load_tissue(str(path))

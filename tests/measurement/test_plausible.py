"""Units are doubted where a press cannot be, and proposed only where the press read with them is plausible."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.importing.read import import_files
from dummydesign.measurement.trace import impossible, press_quantities, units_that_fit
from tests.support.refusal import raises_code

TIME = np.arange(0.0, 12.0, 0.01)
X = np.clip(2.0 * (TIME - 1.0), -1.0, 5.0)
FORCE = 0.06 * np.maximum(X, 0.0) ** 3


def test_quantities_of_an_ideal_stop_are_those_of_its_motion():
    found = press_quantities(TIME, X, FORCE)
    assert found["speed_mm_s"] == pytest.approx(2.0) and found["depth_mm"] == pytest.approx(5.0)
    assert found["stop_mm_s2"] == pytest.approx(2.0**2 / (2.0 * 0.1), rel=1e-6) and impossible(found) is None


@pytest.mark.parametrize(
    ("role", "scale", "key", "fitting"),
    [
        ("time", 1e-3, "stop_mm_s2", "s"),
        ("displacement", 1e3, "depth_mm", "mm"),
        ("force", 1e3, "force_N", "mN"),
        ("force", 1e-4, "force_N", "kN"),
        ("force", 1.0 / 9.80665e-3 * 5.0, "force_N", "gf"),
    ],
)
def test_another_unit_is_seen_and_those_that_fit_are_named(role, scale, key, fitting):
    press = [
        scale * column if name == role else column
        for name, column in (("time", TIME), ("displacement", X), ("force", FORCE))
    ]
    assert impossible(press_quantities(*press))[0] == key
    factor = {"time": 1e-3, "displacement": 1e3}.get(role, 1.0)
    assert fitting in units_that_fit(role, *press, factor=factor)


def written(folder, header, *columns):
    np.savetxt(folder / "a.csv", np.stack(columns, axis=1), fmt="%.6f", delimiter=",", header=header, comments="")
    return [folder / "a.csv"]


@pytest.mark.parametrize("scale", [1.0, 0.2])
def test_a_header_that_says_milliseconds_where_no_machine_moves_so_is_asked_about(tmp_path, scale):
    with raises_code("needs_decision", "units") as asked:
        import_files(written(tmp_path, "t (msec),x (mm),F (N)", scale * TIME, X, FORCE))
    assert "--units time=s " in str(asked.value)


@pytest.mark.parametrize(("unit", "scale"), [("uN", 100.0), ("N", 500.0)])
def test_a_force_beyond_the_range_is_named_and_its_unit_not_contradicted(tmp_path, unit, scale):
    with raises_code("needs_decision", "units") as asked:
        import_files(written(tmp_path, f"t (s),x (mm),F ({unit})", TIME, X, scale * FORCE))
    assert "0.03 to 2000 N" in str(asked.value) and "force=mN" not in str(asked.value)
    assert "force=kN" not in str(asked.value)

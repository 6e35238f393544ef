"""Trace files: what is accepted, and that each fault is named with file, line and cure."""

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.trace import read_trace
from tests.support.refusal import raises_code

TIME = np.arange(20) * 0.01
DEPTH = np.linspace(-0.5, 4.0, 20)
FORCE = np.clip(DEPTH, 0, None) ** 2


def _write(folder, time=TIME, depth=DEPTH, force=FORCE, header="time_s,displacement_mm,force_N"):
    path = folder / "press.csv"
    rows = "\n".join(f"{t:.9g},{x:.9g},{f:.9g}" for t, x, f in zip(time, depth, force))
    path.write_text(f"{header}\n{rows}\n", encoding="utf-8")
    return path


def test_columns_are_found_in_any_order_with_extras_blank_lines_and_a_byte_order_mark(tmp_path):
    path = tmp_path / "press.csv"
    rows = "\n".join(f"x,{f},{t},{x}\n" for t, x, f in zip(TIME, DEPTH, FORCE))
    path.write_text("\ufeffnote, force_N ,time_s,displacement_mm\r\n" + rows, encoding="utf-8")
    trace = read_trace(path)
    assert np.allclose(trace.time_s, TIME) and np.allclose(trace.displacement_mm, DEPTH)
    assert np.allclose(trace.force_N, FORCE) and trace.name == "press.csv"


@pytest.mark.parametrize(
    "change, code",
    [
        ({"depth": DEPTH / 1000}, "implausible_unit"),
        ({"depth": DEPTH * 1000}, "implausible_unit"),
        ({"force": FORCE * 1000}, "implausible_unit"),
        ({"force": FORCE / 1000}, "implausible_unit"),
        ({"time": TIME * 1000}, "implausible_unit"),
        ({"force": -FORCE}, "out_of_range"),
        ({"depth": -DEPTH - 0.5}, "out_of_range"),
        ({"force": 0 * FORCE}, "nothing_found"),
        ({"time": np.r_[TIME[:5], TIME[4:19]]}, "malformed"),
        ({"time": TIME[:5]}, "not_enough_data"),
        ({"header": "time_s,displacement_m,force_N"}, "missing"),
        ({"header": "time_s;displacement_mm;force_N"}, "missing"),
        ({"header": "a,b,c"}, "missing"),
    ],
)
def test_wrong_units_signs_times_and_headers_are_named(tmp_path, change, code):
    with raises_code(code):
        read_trace(_write(tmp_path, **change))


@pytest.mark.parametrize(
    "line, code",
    [("0.05,abc,1", "not_a_number"), ("0.05,1", "malformed"), ("0.05,nan,1", "out_of_range")],
)
def test_a_bad_cell_is_named_by_line_and_column(tmp_path, line, code):
    path = tmp_path / "press.csv"
    path.write_text(f"time_s,displacement_mm,force_N\n0,0,0\n{line}\n")
    with raises_code(code):
        read_trace(path)


def test_plain_files_are_read_at_once_to_the_same_numbers(tmp_path):
    path = _write(tmp_path)
    plain = read_trace(path)
    path.write_text(path.read_text().replace("\n0.01,", '\n"0.01",'))
    quoted = read_trace(path)
    for name in ("time_s", "displacement_mm", "force_N"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(quoted, name))


def test_files_that_cannot_be_read_are_named(tmp_path):
    with raises_code("file_not_found", "trace"):
        read_trace(tmp_path / "none.csv")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00t")
    with raises_code("file_unreadable", "trace"):
        read_trace(tmp_path / "bytes.csv")
    (tmp_path / "empty.csv").write_text("")
    with raises_code("missing", "time_s"):
        read_trace(tmp_path / "empty.csv")


def test_a_fast_approach_from_far_above_the_surface_is_no_sign_error(tmp_path):
    depth = np.r_[np.linspace(-25.0, 2.0, 10), np.full(10, 2.0)]
    force = np.where(depth > 0, 3.0, 0.0)
    assert read_trace(_write(tmp_path, depth=depth, force=force)).displacement_mm.max() == 2.0


@pytest.mark.parametrize(
    "change",
    [
        {"header": "Time_s,displacement_mm,force_N"},
        {"header": "Zeit [s];Weg [mm];Kraft [N]"},
        {"force": -FORCE},
        {"depth": DEPTH * 1000},
    ],
)
def test_a_file_in_another_form_says_how_to_bring_it_in(tmp_path, change):
    path = _write(tmp_path, **change)
    with pytest.raises(InputError, match="import it first: dummydesign import ") as caught:
        read_trace(path)
    assert str(path) in str(caught.value)


def test_a_quasi_static_press_with_a_sample_every_second_and_a_half_is_read(tmp_path):
    time = np.arange(80) * 1.5
    depth = time * 10.0 / 60.0
    assert len(read_trace(_write(tmp_path, time=time, depth=depth, force=5.0 * depth)).time_s) == 80


def test_a_long_hold_that_is_sampled_seldom_is_no_sign_of_milliseconds(tmp_path):
    time = np.r_[np.arange(20) * 0.05, 2.0 + np.arange(400) * 5.0]
    depth = np.minimum(5.0 * time, 4.0)
    assert read_trace(_write(tmp_path, time=time, depth=depth, force=2.0 * depth)).time_s[-1] > 1900


def test_several_presses_in_one_file_are_refused_and_not_read_as_one_long_hold(tmp_path):
    time = np.arange(900) * 0.01
    depth = np.clip(8.0 * np.sin(2 * np.pi * time / 3.0), -1.0, 4.0)
    with raises_code("malformed", "trace"):
        read_trace(_write(tmp_path, time=time, depth=depth, force=2.0 * np.maximum(depth, 0.0)))


def _slow_press(step_s, speed_mm_s=0.02, depth_mm=4.0):
    """A quasi-static press without a hold and the way back, as saved every ``step_s``."""
    time = np.arange(0.0, 2.0 * depth_mm / speed_mm_s, step_s)
    depth = depth_mm - np.abs(speed_mm_s * time - depth_mm) - 0.1
    return {"time": time, "depth": depth, "force": np.clip(depth, 0.0, None) * 1.5}


def test_a_declared_speed_settles_whether_a_slow_press_is_in_seconds(tmp_path):
    path = _write(tmp_path, **_slow_press(1.5))
    with raises_code("implausible_unit", "time_s"):
        read_trace(path)
    assert read_trace(path, 0.02).time_s[1] == 1.5
    with raises_code("implausible_unit", "time_s"):
        read_trace(path, 20.0)


def test_a_pad_that_pulls_harder_than_it_was_pressed_is_data(tmp_path):
    time = np.arange(0.0, 4.0, 0.01)
    depth = np.where(time < 2.0, -1.0 + 2.5 * time, np.where(time < 3.0, 4.0, 4.0 - 10.0 * (time - 3.0)))
    force = np.where(depth > 0, 1.0 * np.clip(depth, 0, None), 0.0)
    force = np.where((time > 3.0) & (depth < 0.3) & (depth > -0.4), -9.0, force)
    trace = read_trace(_write(tmp_path, time, depth, force))
    assert trace.force_N.min() == -9.0 and trace.force_N.max() == 4.0
    for wrong in (
        {"force": -force, "depth": depth},
        {"force": force, "depth": -depth},
        {"force": -force, "depth": -depth},
    ):
        with raises_code("out_of_range"):
            read_trace(_write(tmp_path, time, wrong["depth"], wrong["force"]))


def test_noise_on_the_way_to_a_weak_press_is_not_a_wrong_sign(tmp_path):
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 1.0, 0.001)
    depth = np.minimum(-25.0 + 250.0 * time, 0.4)
    force = np.clip(depth, 0.0, None) + rng.normal(0.0, 0.05, len(time))
    for sign in (1.0, -1.0):
        force[3] = 0.3 * sign
        assert read_trace(_write(tmp_path, time, depth, force)).force_N.max() > 0.3


def test_a_pad_that_pulls_many_times_harder_than_it_was_pressed_is_data(tmp_path):
    time = np.linspace(0.0, 4.0, 2001)
    x = np.where(time < 2.0, time, 4.0 - 2.0 * (time - 2.0)) - 0.5
    force = np.where(x > 0, 2.0 * x, np.where((time > 2.0) & (x > -1.0), -60.0, 0.0))
    rows = "\n".join(f"{a:.4f},{b:.4f},{c:.4f}" for a, b, c in zip(time, x, force))
    (tmp_path / "t.csv").write_text(f"time_s,displacement_mm,force_N\n{rows}\n")
    assert read_trace(tmp_path / "t.csv").force_N.min() == -60.0


def test_a_slow_press_is_doubted_until_it_is_said_that_its_time_is_in_seconds(tmp_path, capsys):
    """A press of ten minutes sampled every five seconds: the doubt names the option, and the option settles it."""
    from dummydesign import cli

    time = np.arange(0.0, 900.0, 5.0)
    x = np.minimum(0.002 * time - 0.05, 0.6)
    rows = "\n".join(f"{a:.2f},{b:.4f},{max(6.0 * b, 0.0):.4f}" for a, b in zip(time, x))
    (tmp_path / "t05.csv").write_text(f"time_s,displacement_mm,force_N\n{rows}\n")
    with raises_code("implausible_unit", "time_s"):
        read_trace(tmp_path / "t05.csv")
    assert read_trace(tmp_path / "t05.csv", 0.002).time_s[-1] == 895.0
    assert cli.run(["import", str(tmp_path / "t05.csv"), "--out", str(tmp_path / "out")]) == 2
    assert "--units time=s" in capsys.readouterr().err
    assert cli.run(["import", str(tmp_path / "t05.csv"), "--units", "time=s", "--out", str(tmp_path / "out")]) == 0
    (made,) = (tmp_path / "out").glob("*.csv")
    assert read_trace(made).time_s[-1] == pytest.approx(895.0)


def test_a_folder_in_place_of_a_trace_is_named_as_one(tmp_path):
    with raises_code("file_unreadable", "trace"):
        read_trace(tmp_path)

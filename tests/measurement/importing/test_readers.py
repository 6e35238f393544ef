"""Forms in which loggers and programs write a recording: each reads as the plain table of the same samples."""

from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.decisions import ImportLog, QuestionError, Settings
from dummydesign.measurement.importing.read import import_files
from dummydesign.measurement.importing.times import join_steps, unwrap
from tests.support.machine_presses import recording
from tests.support.refusal import raises_code

DRAWS = [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (2, 3))]
HEAD = "time_s,position_mm,force_N"


@dataclasses.dataclass
class Drawn:
    """A recording on an even grid of 200 Hz, a start in time, and what draws the rest."""

    time: np.ndarray
    x: np.ndarray
    force: np.ndarray
    stops: tuple[int, int]
    draw: np.random.Generator


def drawn(seed):
    draw = np.random.default_rng([seed, 62])
    made = recording(seed, velocity_mm_s=float(draw.choice([2.0, 5.0, 10.0])), hold_s=4.0, filtered=False, unload=True)
    time = np.arange(0.0, made.time_s[-1], 0.005)
    x, force = (np.interp(time, made.time_s, column) for column in (made.displacement_mm, made.force_N))
    deep = np.flatnonzero(x > 0.99 * x.max())
    return Drawn(time, x, force, (int(deep[0]) + 2, int(deep[-1]) - 2), draw)


def table(head, *columns):
    cells = [[cell if isinstance(cell, str) else f"{cell:.6f}" for cell in column] for column in columns]
    return "\n".join([head, *map(",".join, zip(*cells)), ""])


def read(folder, text, **settings):
    (folder / "a.csv").write_text(text, encoding="utf-8")
    imported, _ = import_files([folder / "a.csv"], Settings(**settings))
    return imported[0].presses, [one["code"] for one in imported[0].warnings]


def alike(folder, one, text, time_s=2e-6, rows=None, **settings):
    """Read a text and hold that it gives the press of the plain table; its warnings beyond those of the plain one."""
    keep = slice(None) if rows is None else rows
    (plain,), usual = read(folder, table(HEAD, one.time[keep], one.x[keep], one.force[keep]))
    (press,), codes = read(folder, text, **settings)
    assert len(press.time_s) == len(plain.time_s)
    assert np.max(np.abs(press.time_s - plain.time_s)) <= time_s
    assert press.displacement_mm == pytest.approx(plain.displacement_mm, abs=2e-3)
    assert press.force_N == pytest.approx(plain.force_N, abs=2e-2)
    assert press.summary.hold_s == pytest.approx(plain.summary.hold_s, abs=0.02)
    return [code for code in codes if code not in usual]


@pytest.mark.parametrize("seed", DRAWS)
@pytest.mark.parametrize("empty", ["NaN", "null", "nan", ""])
def test_quantities_in_rows_of_their_own_whatever_marks_the_other_cell(tmp_path, seed, empty):
    one = drawn(seed)
    rarer = int(one.draw.integers(2, 4))
    force = [f"{f:.6f}" if at % rarer == 0 else empty for at, f in enumerate(one.force)]
    assert alike(tmp_path, one, table(HEAD, one.time, one.x, force), rows=slice(None, None, rarer)) == []


@pytest.mark.parametrize("seed", DRAWS)
@pytest.mark.parametrize("late", [1, 2])
def test_rows_before_both_sources_run_are_left_out_with_a_warning(tmp_path, seed, late):
    one = drawn(seed)
    count = int(one.draw.integers(10, 40))
    columns = [[f"{value:.6f}" for value in column] for column in (one.time, one.x, one.force)]
    columns[late][:count] = ["null"] * count
    assert alike(tmp_path, one, table(HEAD, *columns), rows=slice(count, None)) == ["begins_later"]


@pytest.mark.parametrize("empty", ["NaN", "overflow", ""])
def test_a_reading_that_is_lost_within_the_recording_is_refused(tmp_path, empty):
    one = drawn(1)
    force = [f"{f:.6f}" for f in one.force]
    force[one.stops[0] : one.stops[0] + 3] = [empty] * 3
    with raises_code("missing", "cell"):
        read(tmp_path, table(HEAD, one.time, one.x, force))


def test_rows_without_a_time_are_refused(tmp_path):
    one = drawn(1)
    time = [f"{t:.6f}" if at > 20 else "" for at, t in enumerate(one.time)]
    with raises_code("missing", "cell"):
        read(tmp_path, table(HEAD, time, one.x, one.force))


def pandas_form(second):
    days, rest = divmod(round(second * 1e6), 86_400_000_000)
    clock = f"{rest // 3_600_000_000:02d}:{rest // 60_000_000 % 60:02d}:{rest % 60_000_000 / 1e6:09.6f}"
    return f"{days} days {'+' if days < 0 else ''}{clock}"


DURATIONS = {
    "pandas": pandas_form,
    "MATLAB": lambda second: f"{second:.6f} sec",
    "ISO": lambda second: f"{'-' if second < 0 else ''}PT{int(abs(second) // 60)}M{abs(second) % 60:.6f}S",
    "clock": lambda second: f"{'-' if second < 0 else ''}00:{int(abs(second) // 60):02d}:{abs(second) % 60:09.6f}",
}


@pytest.mark.parametrize("seed", DRAWS)
@pytest.mark.parametrize("form", DURATIONS)
def test_durations_are_seconds_before_and_after_their_zero(tmp_path, seed, form):
    one = drawn(seed)
    begin = float(one.draw.uniform(-3.0, 1.0)) if form != "clock" else -float(one.draw.uniform(0.1, 0.9)) * one.time[-1]
    stamps = [DURATIONS[form](second) for second in one.time + begin]
    assert alike(tmp_path, one, table("elapsed,position_mm,force_N", stamps, one.x, one.force), 5e-6) == []


@pytest.mark.parametrize("seed", DRAWS)
def test_steps_whose_time_begins_again_are_one_press(tmp_path, seed):
    one = drawn(seed)
    ends = [0, *one.stops, len(one.time)]
    if one.draw.integers(2):
        ends.insert(1, int(one.draw.integers(20, one.stops[0] // 3)))
    own = np.concatenate([one.time[a:b] - one.time[a] for a, b in pairwise(ends)])
    step = np.concatenate([np.full(b - a, number) for number, (a, b) in enumerate(pairwise(ends), 1)])
    text = table("Step,Step time [s],Position [mm],Force [N]", step.astype(str), own, one.x, one.force)
    assert alike(tmp_path, one, text) == []
    blocks = "Filename\tpress.tri\n"
    for number, (a, b) in enumerate(pairwise(ends)):
        blocks += f"\n[step]\nStep name\tAxial {number}\nNumber of points\t{b - a}\n"
        blocks += "Variables\tStep time\tPosition\tAxial force\n\ts\tmm\tN\n"
        rows = zip(own[a:b], one.x[a:b], one.force[a:b])
        blocks += "".join(f"Data point\t{t:.6f}\t{x:.6f}\t{f:.6f}\n" for t, x, f in rows)
    assert alike(tmp_path, one, blocks) == []


def test_a_part_that_jumps_is_not_joined():
    time, ramp = np.tile(np.arange(50) * 0.02, 2), np.r_[np.zeros(20), np.linspace(0.0, 1.0, 30)]
    halves = ((0, 50), (50, 100))
    log = ImportLog("a.csv")
    assert join_steps(time, np.r_[ramp, ramp], np.r_[ramp, ramp + 0.5], halves, log)[1] == halves
    joined, one = join_steps(time, np.r_[ramp, ramp[::-1]], np.r_[ramp, ramp[::-1]], halves, log)
    assert one == ((0, 100),) and np.allclose(np.diff(joined), 0.02)


@pytest.mark.parametrize("seed", DRAWS)
@pytest.mark.parametrize(
    ("head", "period_s", "count_s"),
    [
        ("t_us", 2.0**32 * 1e-6, 1e-6),
        ("t_ms", 2.0**16 * 1e-3, 1e-3),
        ("time_s", 2.0**32 * 1e-6, 1e-6),
        ("time", 3600.0, 0.0),
    ],
)
def test_a_clock_that_runs_over_at_any_moment_goes_on(tmp_path, seed, head, period_s, count_s):
    one = drawn(seed)
    counted = np.mod(one.time + period_s - float(one.draw.uniform(0.05, 0.95)) * one.time[-1], period_s)
    if head == "time":
        stamps = [f"{int(second // 60):02d}:{second % 60:06.3f}" for second in counted]
    elif head == "time_s":
        stamps = [f"{second:.6f}" for second in counted]
    else:
        stamps = [str(round(second / count_s)) for second in counted]
    digit = {"t_ms": 1e-3, "time": 1e-3}.get(head, 2e-6)
    assert alike(tmp_path, one, table(f"{head},position_mm,force_N", stamps, one.x, one.force), 1.1 * digit) == []


def test_time_that_only_begins_again_is_no_clock_that_runs_over():
    time = np.r_[np.arange(0.0, 65.0, 0.01), np.arange(0.0, 65.0, 0.01)]
    log = ImportLog("a.csv")
    assert unwrap(time, 1.0, log) is time and log.decisions == []


@pytest.mark.parametrize("seed", DRAWS)
def test_starred_values_and_stray_rows_are_left_out_with_a_warning(tmp_path, seed):
    one = drawn(seed)
    at = int(one.draw.integers(*one.stops))
    force = [f"{f:.6f}" for f in one.force]
    force[at : at + 3] = [f"{f + 8.0:.6f}*" for f in one.force[at : at + 3]]
    kept = np.delete(np.arange(len(force)), range(at, at + 3))
    assert alike(tmp_path, one, table(HEAD, one.time, one.x, force), rows=kept) == ["excluded_values"]
    lines = table(HEAD, one.time, one.x, one.force).split("\n")
    lines.insert(at, f"{one.draw.uniform(0, 99):.2f}")
    assert alike(tmp_path, one, "\n".join(lines)) == ["stray_row"]


def test_a_table_of_one_row_a_reading_says_that_it_must_be_pivoted(tmp_path):
    one = drawn(0)
    rows = [
        f"{t:.3f},{field},{value:.4f},{unit}"
        for t, x, f in zip(one.time, one.x, one.force)
        for field, value, unit in (("position", x, "mm"), ("force", f, "N"))
    ]
    with raises_code("malformed", "table") as caught:
        read(tmp_path, "\n".join(["time,field,value,unit", *rows, ""]))
    assert "pivot" in str(caught.value)


@pytest.mark.parametrize("seed", DRAWS)
def test_a_force_that_is_later_by_the_delay_given_is_brought_back(tmp_path, seed):
    one = drawn(seed)
    delay = float(one.draw.uniform(-0.05, 0.05))
    late = np.interp(one.time - delay, one.time, one.force)
    (plain,), _ = read(tmp_path, table(HEAD, one.time, one.x, one.force))
    (press,), _ = read(tmp_path, table(HEAD, one.time, one.x, late), delay=delay)
    assert press.summary.depth_mm == pytest.approx(plain.summary.depth_mm, rel=0.02)
    assert press.summary.peak_force_N == pytest.approx(plain.summary.peak_force_N, rel=0.03)
    assert press.summary.hold_s == pytest.approx(plain.summary.hold_s, abs=0.05)


def test_a_force_that_rises_after_the_stop_asks_until_the_delay_is_given(tmp_path):
    one = drawn(3)
    delay = one.time[one.stops[0]]
    text = table(HEAD, one.time, one.x, np.interp(one.time - delay, one.time, one.force))
    with raises_code("needs_decision", "delay"):
        read(tmp_path, text)
    (press,), _ = read(tmp_path, text, delay=delay)
    (plain,), _ = read(tmp_path, table(HEAD, one.time, one.x, one.force))
    assert press.summary.depth_mm == pytest.approx(plain.summary.depth_mm, rel=0.02)


@pytest.mark.parametrize("name", ["Impulse [N*s]", "force_N*s", "impulse_Ns", "Moment [N·mm]", "moment_Nm"])
def test_a_product_of_force_is_proposed_neither_as_force_nor_as_time(tmp_path, name):
    one = drawn(0)
    with raises_code("missing", "force"):
        read(tmp_path, table(f"time_s,position_mm,{name}", one.time, one.x, one.force))


@pytest.mark.parametrize("name", ["desired_pose_z [mm]", "O_T_EE_d_z [mm]", "goal position [mm]", "pose_d_z_mm"])
def test_a_desired_pose_is_no_displacement(tmp_path, name):
    one = drawn(0)
    with raises_code("missing", "displacement"):
        read(tmp_path, table(f"time_s,{name},force_N", one.time, one.x, one.force))


def test_each_file_in_doubt_has_its_reason_and_equal_ones_share_it(tmp_path):
    one = drawn(0)
    columns = one.time, one.x, one.force
    for name, head in (("a", HEAD), ("b", "t,x,y"), ("c", "t,x,y"), ("d", "time_s,position_mm,force_V")):
        (tmp_path / f"{name}.csv").write_text(table(head, *columns), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        import_files([tmp_path])
    message = str(caught.value)
    assert message.startswith("b.csv: ") and "b.csv, c.csv" in message and "d.csv (force" in message
    assert "--units force=N" in message and "the other file can be read" in message
    assert isinstance(caught.value, QuestionError)

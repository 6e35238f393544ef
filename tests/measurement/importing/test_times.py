"""Time of several columns, of a rate, of two bases; equal times and rows out of order."""

from __future__ import annotations

import datetime

import numpy as np
import pytest

from dummydesign.measurement.importing import times as module
from dummydesign.measurement.importing.columns import Column
from dummydesign.measurement.importing.decisions import ImportLog, Settings
from dummydesign.measurement.importing.table import columns_of
from dummydesign.measurement.importing.vocabulary import roles_of_name, split_name
from tests.support.refusal import raises_code

STEP = 0.004
TIME = np.arange(1500) * STEP
WAY = np.interp(TIME, [0.5, 1.1, 4.1, 4.7], [-1.0, 5.0, 5.0, -1.0])
FORCE = 0.06 * np.maximum(WAY, 0.0) ** 3


def text(head, *columns):
    cells = [[cell if isinstance(cell, str) else f"{cell:.6f}" for cell in column] for column in columns]
    return "\n".join([head, *(";".join(row) for row in zip(*cells)), ""])


def read(head, *columns, **settings):
    log = ImportLog("a.csv", Settings(**settings))
    return columns_of(text(head, *columns), log), log


def off(found):
    """Largest errors of time, displacement and force; the time from the first sample. [s, mm, N]"""
    return [
        float(np.max(np.abs(own - true)))
        for own, true in ((found.time_s - found.time_s[0], TIME), (found.displacement_mm, WAY), (found.force_N, FORCE))
    ]


@pytest.mark.parametrize(
    ("names", "size"),
    [
        ("secs;nsecs", 10**9),
        ("header.stamp.secs;header.stamp.nsecs", 10**9),
        ("sec;nanosec", 10**9),
        ("Sekunden;us", 10**6),
        ("Time [s];Milliseconds", 1000),
    ],
)
def test_seconds_and_their_fraction_are_one_time(names, size):
    counts = np.rint((TIME + 0.35) * size).astype(int)
    whole, part = ([str(one) for one in column] for column in np.divmod(counts, size))
    found, log = read(f"{names};Weg [mm];Kraft [N]", whole, part, WAY, FORCE)
    assert max(off(found)) < 2e-6
    assert any("fraction" in one.why for one in log.decisions)


def test_a_clock_and_its_milliseconds_are_one_time_over_midnight():
    begin = datetime.datetime(2025, 1, 1, 23, 59, 57, 250000)
    stamps = [begin + datetime.timedelta(seconds=float(second)) for second in TIME]
    clock, part = [f"{one:%H:%M:%S}" for one in stamps], [str(one.microsecond // 1000) for one in stamps]
    found, _ = read("Uhrzeit;ms;Weg [mm];Kraft [N]", clock, part, WAY, FORCE)
    assert max(off(found)) < 2e-6


def test_compact_iso_times_are_read():
    begin = datetime.datetime(2025, 1, 1, 23, 59, 57, 250000)
    stamps = [f"{begin + datetime.timedelta(seconds=float(second)):%Y%m%dT%H%M%S.%f}Z" for second in TIME]
    assert max(off(read("time_utc;Weg [mm];Kraft [N]", stamps, WAY, FORCE)[0])) < 2e-6


@pytest.mark.parametrize(
    "form", ["%d-%b-%Y %H:%M:%S.%f", "%m/%d/%Y %I:%M:%S.%f %p", "%H:%M:%S:%f", "%d %B %Y %H:%M:%S,%f"]
)
def test_clocks_with_and_without_dates_are_read(form):
    begin = datetime.datetime(2025, 1, 31, 23, 59, 57, 250000)
    stamps = [f"{begin + datetime.timedelta(seconds=float(second)):{form}}" for second in TIME]
    assert max(off(read("Timestamp;Weg [mm];Kraft [N]", stamps, WAY, FORCE)[0])) < 2e-6


def test_minutes_beside_seconds_are_one_time():
    minutes, seconds = np.divmod(TIME + 57.0, 60.0)
    found, _ = read("min;s;Weg [mm];Kraft [N]", [f"{one:.0f}" for one in minutes], seconds, WAY, FORCE)
    assert max(off(found)) < 2e-6


def test_the_same_time_in_two_units_is_one_and_a_file_may_be_written_from_its_end():
    assert max(off(read("Time (ms);Time (s);Weg [mm];Kraft [N]", 1e3 * TIME, TIME, WAY, FORCE)[0])) < 2e-6
    assert max(off(read("Time (s);Weg [mm];Kraft [N]", TIME[::-1], WAY[::-1], FORCE[::-1])[0])) < 2e-6


@pytest.mark.parametrize("lag", [-0.3, 0.02, 0.5])
@pytest.mark.parametrize(
    "names", ["Time Load [s];Load [N];Time Position [s];Position [mm]", "t [s];Load [N];t [s];Position [mm]"]
)
def test_two_time_bases_are_aligned_by_interpolation(names, lag):
    """The position is sampled at moments of its own: its time is the truth of each sample."""
    own = TIME + lag
    found, log = read(names, TIME, FORCE, own, np.interp(own, TIME, WAY))
    inside = (TIME >= own[0]) & (TIME <= own[-1])
    assert np.allclose(found.time_s, TIME[inside]) and np.allclose(found.force_N, FORCE[inside], atol=1e-6)
    assert np.max(np.abs(found.displacement_mm - WAY[inside])) < 10.0 * STEP
    assert [one["code"] for one in log.warnings] == ["two_time_bases"]


def test_a_channel_that_is_shorter_than_the_other_ends_without_a_fault():
    end = 1200
    own = [f"{second:.6f}" for second in TIME[:end]] + [""] * (len(TIME) - end)
    way = [f"{x:.6f}" for x in WAY[:end]] + [""] * (len(TIME) - end)
    found, _ = read("t [s];Load [N];t [s];Position [mm]", TIME, FORCE, own, way)
    assert len(found.time_s) == end and np.allclose(found.displacement_mm, WAY[:end], atol=1e-6)
    way[100] = ""
    with raises_code("missing", "cell"):
        read("t [s];Load [N];t [s];Position [mm]", TIME, FORCE, own, way)


def test_quantities_in_rows_of_their_own_are_brought_together_and_single_gaps_are_refused():
    way = [f"{x:.6f}" if at % 2 else "" for at, x in enumerate(WAY)]
    force = [f"{one:.6f}" if not at % 2 else "" for at, one in enumerate(FORCE)]
    found, _ = read("Zeit [s];Weg [mm];Kraft [N]", TIME, way, force)
    assert np.allclose(found.time_s, TIME[2::2]) and np.allclose(found.force_N, FORCE[2::2], atol=1e-6)
    assert np.max(np.abs(found.displacement_mm - WAY[2::2])) < 10.0 * STEP
    with raises_code("missing", "cell"):
        read("Zeit [s];Weg [mm];Kraft [N]", TIME, [f"{x:.6f}" if at != 700 else "" for at, x in enumerate(WAY)], FORCE)


@pytest.mark.parametrize("line", ["Acquisition rate :;250.0;[Hz]", "Abtastrate: 0,25 kHz", "Sampling interval;0,004;s"])
def test_a_rate_above_the_table_stands_for_the_time(line):
    found, _ = read(f"{line}\n\nWeg [mm];Kraft [N]", WAY, FORCE)
    assert max(off(found)) < 2e-6


def test_a_rate_that_is_given_stands_for_the_time_and_does_not_contradict_it():
    assert max(off(read("Weg [mm];Kraft [N]", WAY, FORCE, rate=250.0)[0])) < 2e-6
    with raises_code("missing", "time"):
        read("Weg [mm];Kraft [N]", WAY, FORCE)
    with raises_code("inconsistent", "rate"):
        read("Zeit [s];Weg [mm];Kraft [N]", TIME, WAY, FORCE, rate=500.0)


def test_a_counter_keeps_the_time_of_rows_that_were_lost():
    kept = np.delete(np.arange(len(TIME)), np.r_[200:230, 900])
    found, _ = read("sample;Weg [mm];Kraft [N]", kept.astype(str), WAY[kept], FORCE[kept], rate=250.0)
    assert np.allclose(found.time_s, TIME[kept], atol=1e-6)


@pytest.mark.parametrize("digit", [0.01, 0.1, 1.0])
@pytest.mark.parametrize("cut", [0.0, 0.5])
def test_coarse_times_of_even_samples_are_spread_to_a_sample(digit, cut):
    """Cut off or rounded: each change of the time falls within one sample of its digit."""
    coarse = np.floor((TIME + 1e-9) / digit + cut) * digit
    found, _ = read("Zeit [s];Weg [mm];Kraft [N]", coarse, WAY, FORCE)
    assert off(found)[0] < 1.5 * STEP and np.all(np.diff(found.time_s) > 0)


@pytest.mark.parametrize("seed", range(6))
def test_a_rate_that_an_import_shows_gives_the_same_times_when_it_is_typed(seed):
    draw = np.random.default_rng([seed, 7])
    even = TIME * float(draw.uniform(0.7, 1.5))
    coarse = np.floor(even * 10.0) / 10.0 + float(draw.choice([0.0, 12.3]))
    found, log = read("Zeit [s];Weg [mm];Kraft [N]", coarse, WAY, FORCE)
    (shown,) = (one.value.split()[-2] for one in log.decisions if one.what == "equal times")
    typed, _ = read("Zeit [s];Weg [mm];Kraft [N]", coarse, WAY, FORCE, rate=float(shown))
    np.testing.assert_allclose(typed.time_s - typed.time_s[0], found.time_s - found.time_s[0], atol=1e-9)


def test_samples_that_arrive_in_packets_are_spread():
    ends = np.unique(np.r_[np.cumsum(np.random.default_rng(4).integers(2, 8, 400)), len(TIME)])
    ends = ends[ends <= len(TIME)] - 1
    arrival = TIME[ends[np.searchsorted(ends, np.arange(len(TIME)))]]
    found, _ = read("Zeit [s];Weg [mm];Kraft [N]", arrival, WAY, FORCE)
    assert off(found)[0] < 1.5 * STEP + (ends[0] + 1) * STEP


def test_uneven_samples_with_coarse_times_are_spread_with_a_warning_or_refused():
    moments = np.cumsum(np.random.default_rng(3).exponential(STEP, len(TIME)))
    way = np.interp(moments, TIME, WAY)
    found, log = read("Zeit [s];Weg [mm];Kraft [N]", np.floor(moments / 0.05) * 0.05, way, FORCE)
    assert np.max(np.abs(found.time_s - moments)) < 0.1 and "coarse_time" in {one["code"] for one in log.warnings}
    with raises_code("malformed", "time_s"):
        read("Zeit [s];Weg [mm];Kraft [N]", np.floor(moments), way, FORCE)


def test_rows_twice_are_left_out_and_rows_with_the_time_of_another_are_kept():
    twice = np.sort(np.r_[np.arange(len(TIME)), np.arange(10, 1400, 11)])
    found, log = read("Zeit [s];Weg [mm];Kraft [N]", TIME[twice], WAY[twice], FORCE[twice])
    assert max(off(found)) < 2e-6 and "repeated rows" in {one.what for one in log.decisions}
    late = TIME.copy()
    late[200::50] = TIME[199::50][: len(late[200::50])]
    assert max(off(read("Zeit [s];Weg [mm];Kraft [N]", late, WAY, FORCE + 1e-5 * np.arange(len(TIME)))[0])[:2]) < 2e-6


@pytest.mark.parametrize("order", [[301, 300], [303, 302, 301, 300]])
def test_rows_out_of_order_are_sorted_where_they_fit(order):
    rows = np.r_[:300, order, 300 + len(order) : len(TIME)]
    found, log = read("Zeit [s];Weg [mm];Kraft [N]", TIME[rows], WAY[rows], FORCE[rows])
    assert max(off(found)) < 2e-6 and "rows sorted by time" in {one.what for one in log.decisions}


def test_a_single_wrong_time_is_refused_and_not_sorted_elsewhere():
    wrong = TIME.copy()
    wrong[700] = 0.5 * (TIME[300] + TIME[301])
    with raises_code("malformed", "time_s"):
        read("Zeit [s];Weg [mm];Kraft [N]", wrong, WAY, FORCE)


def test_a_time_that_a_clock_beside_it_contradicts_is_asked_for():
    begin = datetime.datetime(2025, 1, 1, 12)
    clock = [f"{begin + datetime.timedelta(seconds=10 * float(second)):%H:%M:%S.%f}" for second in TIME]
    with raises_code("needs_decision", "columns"):
        read("Uhrzeit;Zeit [s];Weg [mm];Kraft [N]", clock, TIME, WAY, FORCE)


def column(index, title, kind="number"):
    name, unit = split_name(title)
    return Column(index, title, kind, roles_of_name(name), unit)


MINUTES, SECONDS = column(0, "min"), column(1, "s")


@pytest.mark.parametrize(
    ("part", "composed"),
    [
        (np.arange(180.0) % 60.0, True),
        (np.minimum(np.arange(180.0) % 60.0, 58.0), True),
        (np.arange(180.0), False),  # beyond a minute
        (np.full(180, 30.0), False),  # never begins again
    ],
)
def test_seconds_are_a_part_of_minutes_where_they_begin_again_with_each(part, composed):
    whole = np.repeat([57.0, 58.0, 59.0], 60)
    found = module.compose_time([MINUTES, SECONDS], {0: whole, 1: part})
    assert (found is not None) is composed
    if found:
        assert found.parts == (MINUTES, SECONDS)
        np.testing.assert_allclose(found.seconds, 60.0 * (whole - 57.0) + part)


def test_a_part_in_a_larger_unit_and_a_whole_that_is_not_whole_are_no_time_of_two():
    whole, part = np.repeat([57.0, 58.0, 59.0], 60), np.arange(180.0) % 60.0
    assert module.compose_time([MINUTES], {0: whole, 1: part}) is None
    assert module.compose_time([MINUTES, SECONDS], {0: whole + 0.25, 1: part}) is None
    assert module.compose_time([MINUTES, column(1, "h")], {0: whole, 1: part}) is None


@pytest.mark.parametrize(("rate", "right"), [(239.0, True), (237.0, False), (262.0, True), (264.0, False)])
def test_a_rate_may_differ_from_the_time_by_a_twentieth_of_its_length(rate, right):
    """Of 250 Hz: 238.1 and 263.2 Hz are the ends."""
    time = column(0, "Zeit [ms]")
    values = {0: 1e3 * TIME}
    if right:
        module.check_rate(rate, [time], values, ImportLog("a.csv"))
    else:
        with raises_code("inconsistent", "rate"):
            module.check_rate(rate, [time], values, ImportLog("a.csv"))
    # a column that goes back is no time that contradicts it
    module.check_rate(rate, [time], {0: values[0][::-1]}, ImportLog("a.csv"))


@pytest.mark.parametrize(
    ("counts", "read"),
    [([3, 4, 5, 8, 9], [0, 1, 2, 5, 6]), ([1, 3, 5, 7, 9], [0, 1, 2, 3, 4]), ([1, 2, 2.5, 3, 4], [0, 1, 2, 3, 4])],
)
def test_a_counter_counts_by_one_and_in_whole_numbers(counts, read):
    counter = column(0, "sample")
    assert counter.counts
    log = ImportLog("a.csv")
    found = module.time_by_rate([counter], {0: np.array(counts, float)}, 5, 100.0, "so", log)
    np.testing.assert_allclose(found, np.array(read) / 100.0)


@pytest.mark.parametrize(
    ("titles", "places"),
    [
        (("Time Load [s]", "Load [N]", "Time Position [s]", "Position [mm]"), {"displacement": 2, "force": 0}),
        (("t [s]", "Load [N]", "t [s]", "Position [mm]"), {"displacement": 2, "force": 0}),
        (("Load [N]", "t [s]", "Position [mm]", "t [s]"), {"displacement": 3, "force": 1}),
        (("t [s]", "Load [N]", "Position [mm]"), {}),
    ],
)
def test_each_quantity_has_the_time_of_its_name_or_the_nearest_one(titles, places):
    columns = [column(at, title) for at, title in enumerate(titles)]
    chosen = {
        "displacement": next(one for one in columns if "Position [" in one.title and "Time" not in one.title),
        "force": next(one for one in columns if one.title.startswith("Load")),
    }
    times = [one for one in columns if one.unit.kind == "time"]
    assert {role: one.index for role, one in module.find_bases(chosen, times).items()} == places


def test_two_clocks_that_share_half_of_the_recording_are_aligned_and_less_are_refused():
    for lag, fine in ((2.9, True), (3.1, False)):
        log = ImportLog("a.csv")
        if fine:
            shared, x = module.align(TIME, TIME + lag, WAY, FORCE, log)
            assert shared.sum() == np.sum(TIME >= lag)
            np.testing.assert_allclose(x[shared], np.interp(TIME[shared], TIME + lag, WAY))
        else:
            with raises_code("inconsistent", "time_s"):
                module.align(TIME, TIME + lag, WAY, FORCE, log)


def test_clocks_that_never_meet_or_are_the_same_leave_the_rows_as_they_are():
    for lag in (0.0, 0.9e-3 * STEP, 50.0, -50.0):
        log = ImportLog("a.csv")
        both, x = module.align(TIME, TIME + lag, WAY, FORCE, log)
        assert both.all() and x is WAY and log.warnings == []
    log = ImportLog("a.csv")
    assert module.align(TIME, TIME + 1.1e-3 * STEP, WAY, FORCE, log)[1] is not WAY
    assert [one["code"] for one in log.warnings] == ["two_time_bases"]


def test_a_clock_that_stands_is_refused_by_its_time():
    time = TIME.copy()
    time[500] = time[499]
    with raises_code("malformed", "time_s") as caught:
        module.align(TIME, time, WAY, FORCE, ImportLog("a.csv"))
    assert f"{time[499]:.6g} s" in str(caught.value)


@pytest.mark.parametrize(("kept", "enough"), [(20, True), (19, False)])
def test_rows_of_their_own_need_twenty_of_each_quantity(kept, enough):
    rows = np.linspace(0, len(TIME) - 1, kept).astype(int)
    x = np.full(len(TIME), np.nan)
    x[rows] = WAY[rows]
    if enough:
        inside, filled = module.align(TIME, TIME, x, FORCE, ImportLog("a.csv"))
        assert inside.all()
        np.testing.assert_allclose(filled, np.interp(TIME, TIME[rows], WAY[rows]))
    else:
        with raises_code("missing", "cell"):
            module.align(TIME, TIME, x, FORCE, ImportLog("a.csv"))


def in_order(time, repeats=(), breaks=()):
    log = ImportLog("a.csv")
    found = module.rows_in_order(np.asarray(time, float), set(repeats).__contains__, breaks, np.arange(len(time)), log)
    return *found, log


def test_rows_in_order_stay_and_a_moved_row_goes_back_to_its_place():
    order, time, ranges, log = in_order(TIME)
    assert ranges == ((0, len(TIME)),) and log.decisions == [] and np.array_equal(order, np.arange(len(TIME)))
    moved = np.r_[TIME[:100], TIME[101:110], TIME[100], TIME[110:]]
    order, time, ranges, log = in_order(moved)
    np.testing.assert_array_equal(time, TIME)
    np.testing.assert_array_equal(moved[order], TIME)
    assert [one.what for one in log.decisions] == ["rows sorted by time"]


def test_a_row_that_fits_nowhere_is_refused():
    wrong = TIME.copy()
    wrong[100] = TIME[50] + 0.5 * STEP
    with raises_code("malformed", "time_s"):
        in_order(wrong)


def test_a_row_that_repeats_the_one_before_is_left_out_and_an_equal_time_is_spread():
    twice = np.insert(TIME, 101, TIME[100])
    order, time, _, _ = in_order(twice, repeats=[101])
    np.testing.assert_array_equal(time, TIME)
    assert 101 not in order
    order, time, _, log = in_order(twice)
    assert len(time) == len(twice) and np.all(np.diff(time) > 0.0) and log.warnings == []
    # a quarter of the rows alike: the time is coarse
    order, time, _, log = in_order(np.floor(TIME / (5.0 * STEP) + 1e-9) * 5.0 * STEP)
    np.testing.assert_allclose(time, TIME, atol=2.0 * STEP)


@pytest.mark.parametrize(("rows", "count"), [(10, 2), (9, 1)])
def test_a_time_that_begins_again_after_ten_rows_is_another_recording(rows, count):
    time = np.r_[TIME[:rows], TIME[:200]]
    if count == 2:
        assert in_order(time)[2] == ((0, rows), (rows, rows + 200))
    else:
        with raises_code("malformed", "time_s"):
            in_order(time)


def test_text_in_the_file_parts_recordings_that_go_back_a_little():
    """Without the text a row that goes back by half of the recording fits nowhere."""
    time = np.r_[TIME[:200], TIME[100:300]]
    assert in_order(time, breaks=[200])[2] == ((0, 200), (200, 400))
    with raises_code("malformed", "time_s"):
        in_order(time)

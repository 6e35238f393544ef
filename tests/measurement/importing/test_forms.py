"""What is nearly a table: LabVIEW files, serial monitors, units in cells, specimens, padding, containers."""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.decisions import ImportLog, NoTableError, QuestionError, Settings
from dummydesign.measurement.importing.decoding import decode
from dummydesign.measurement.importing.forms import specimens
from dummydesign.measurement.importing.layout import find_layout
from dummydesign.measurement.importing.read import import_files, learned, load_profile, save_profile
from dummydesign.measurement.importing.table import columns_of
from dummydesign.measurement.importing.vocabulary import sampling_rate_in
from tests.support.refusal import raises_code

TIME = np.arange(600) * 0.01
WAY = np.interp(TIME, [0.5, 1.1, 4.1, 4.7], [-1.0, 5.0, 5.0, -1.0])
FORCE = 0.06 * np.maximum(WAY, 0.0) ** 3 + 1e-3 * np.sin(40.0 * TIME)


def rows(*columns, separator=";", form="{:.6f}"):
    return [separator.join(form.format(value) for value in row) for row in zip(*columns)]


def read(lines, **settings):
    log = ImportLog("a.txt", Settings(**settings))
    return columns_of("\n".join([*lines, ""]), log), log


def check(found, atol=1e-6):
    assert np.allclose(found.time_s - found.time_s[0], TIME, atol=atol)
    assert np.allclose(found.displacement_mm, WAY, atol=1e-6) and np.allclose(found.force_N, FORCE, atol=1e-6)


def labview(columns, decimal=".", unit=("Newton", "Micrometer")):
    several, gap = columns == "Multi", ["\t"] if columns == "Multi" else [""]
    head = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Separator\tTab",
        f"Decimal_Separator\t{decimal}",
        f"X_Columns\t{columns}",
        "Date\t2025/11/19",
        "***End_of_Header***\t",
        "\t",
        "Channels\t2",
        f"Samples\t600{gap[0]}\t600",
        f"Y_Unit_Label\t{unit[0]}{gap[0]}\t{unit[1]}\t",
        f"X_Dimension\tTime{gap[0]}\tTime",
        f"X0\t0{decimal}0{gap[0]}\t0{decimal}0",
        f"Delta_X\t0{decimal}01{gap[0]}\t0{decimal}01",
        "***End_of_Header***\t\t",
        f"X_Value\tForce\t{'X_Value' + gap[0] if several else ''}Position\tComment",
    ]
    way = 1e3 * WAY
    parts = {"One": (TIME, FORCE, way), "Multi": (TIME, FORCE, TIME, way), "No": (FORCE, way)}
    body = rows(*parts[columns], separator="\t", form="{:.9f}")
    return [*head, *(("\t" if columns == "No" else "") + line.replace(".", decimal) for line in body)]


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_the_three_forms_of_labview_files_are_read_alike(columns, decimal):
    check(read(labview(columns, decimal))[0])


def test_a_labview_file_without_units_asks_for_them_and_its_lines_are_those_of_the_file():
    with raises_code("needs_decision", "units"):
        read(labview("One", unit=("", "")))
    lines = labview("One")
    lines[100] = lines[100].replace("0", "x", 1)
    with raises_code("not_a_number", "cell") as fault:
        read(lines)
    assert ":101:" in str(fault.value)


@pytest.mark.parametrize("prefix", ["{} -> ", "[{}] ", "{} → ", "[2025-11-19 {}] "])
@pytest.mark.parametrize("separator", [",", "\t", " "])
def test_the_time_of_arrival_before_a_line_is_a_column(prefix, separator):
    body = rows(WAY, FORCE, separator=separator)
    clock = [f"14:03:{20 + second:06.3f}" for second in TIME]
    lines = [prefix.format("14:03:19.900") + separator.join(["Position_mm", "Force_N"])]
    check(read([*lines, *(prefix.format(one) + line for one, line in zip(clock, body))])[0])


@pytest.mark.parametrize("form", ["{:.6f} s;{:.6f} mm;{:.6f} N", "{:.6f}s;{:.6f}mm;{:.6f}N"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_units_in_the_cells_are_read(form, decimal):
    body = [form.format(*row).replace(".", decimal) for row in zip(TIME, WAY, FORCE)]
    check(read(["Zeit;Weg;Kraft", *body])[0])


def test_a_letter_of_status_is_no_unit_and_two_rates_are_none():
    lines = [f"{a:.3f};{b:.6f};N;{c:.6f}" for a, b, c in zip(TIME, WAY, FORCE)]
    check(read(["Zeit [s];Weg [mm];Status;Kraft [N]", *lines])[0])
    with raises_code("missing", "time"):
        read(["Sample rate A: 100 Hz", "Sample rate B: 200 Hz", "", "Weg [mm];Kraft [N]", *rows(WAY, FORCE)])


def test_a_gauge_that_changes_its_unit_is_followed():
    cells = [f"{1e3 * one:.4f} mN" if abs(one) < 0.9 else f"{one:.7f} N" for one in FORCE]
    lines = [f"{a:.3f} s;{b:.6f} mm;{c}" for a, b, c in zip(TIME, WAY, cells)]
    check(read(["Zeit;Weg;Kraft", *lines])[0])


def test_units_that_stand_in_columns_of_their_own_are_those_of_the_numbers_before_them():
    check(read([f"{a:.3f} s {b:.6f} mm {c:.6f} N" for a, b, c in zip(TIME, WAY, FORCE)])[0])


@pytest.mark.parametrize(("separator", "titles"), [(",", "1 _ 1,,,1 _ 2,,"), ("\t", "1 _ 1,,,1 _ 2,,"), (";", "")])
def test_specimens_side_by_side_are_tests_of_their_own(tmp_path, separator, titles):
    end = 550
    second = rows(TIME[:end], 0.5 * FORCE[:end], WAY[:end], separator=separator)
    second += [separator * 2] * (len(TIME) - end)
    head = [titles, "Time,Force,Disp.,Time,Force,Disp.", "s,N,mm,s,N,mm"]
    lines = [line.replace(",", separator) for line in head if line]
    lines += [one + separator + other for one, other in zip(rows(TIME, FORCE, WAY, separator=separator), second)]
    path = tmp_path / "two.csv"
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    read, _ = import_files([path])
    names = ["1 _ 1", "1 _ 2"] if titles else ["specimen 1", "specimen 2"]
    assert [one.sheet for one in read] == names and [len(one.presses[0].time_s) for one in read] == [len(TIME), end]
    peaks = [one.presses[0].summary.peak_force_N for one in read]
    assert peaks[1] == pytest.approx(0.5 * peaks[0], rel=0.01)
    only = import_files([path], Settings(sheets=names[1]))[0]
    assert len(only) == 1 and only[0].presses[0].summary.peak_force_N == pytest.approx(peaks[1])


def test_columns_given_by_number_and_names_that_do_not_repeat_are_one_table():
    text = "Time,Force,Disp.,Time,Force,Disp.\n"
    assert list(specimens(text, ImportLog("a", Settings(columns={"force": "2"})))) == [""]
    assert list(specimens("Time,Force,Disp.,Time,Force,Temp\n", ImportLog("a"))) == [""]


def test_zero_bytes_at_the_end_are_left_out_with_a_warning_and_within_refused():
    log = ImportLog("a")
    assert decode(b"a;b\n1;2\n1;" + bytes(5000), log) == "a;b\n1;2\n"
    assert [one["code"] for one in log.warnings] == ["padded"]
    with raises_code("file_unreadable", "file"):
        decode(b"a;b\n1;\x002\n", ImportLog("a"))


def zipped(name):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as packed:
        packed.writestr(name, "x")
    return data.getvalue()


@pytest.mark.parametrize(
    ("data", "named"),
    [
        (zipped("content.xml"), ".ods"),
        (zipped("a.npy"), ".npz"),
        (zipped("a.txt"), "ZIP"),
        (b"PAR1\x15", "Parquet"),
        (b"MATLAB 5.0 MAT-file, Platform", ".mat"),
        (b"\x93NUMPY\x01\x00v", ".npy"),
        (b"TDSm\x0e\x00", "TDMS"),
        (b"\x89HDF\r\n\x1a\n", "HDF5"),
        (json.dumps({"force": [1, 2]}).encode(), "JSON"),
        (b"\xd0\xcf\x11\xe0\xa1", ".xls"),
        (b"<html><table>", "web page"),
        (b"#ROSBAG V2.0\n", "ROS bag"),
    ],
)
def test_a_known_container_is_refused_by_its_name(data, named):
    with raises_code("file_unreadable", "file") as fault:
        decode(data, ImportLog("a"))
    assert named in str(fault.value)


@pytest.mark.parametrize("separator", [",", " ", "\t"])
def test_labelled_values_are_columns_by_their_labels(separator):
    lines = [
        f"Time_s:{a:.3f}{separator}Position_mm:{b:.6f}{separator}Force_N:{c:.6f}" for a, b, c in zip(TIME, WAY, FORCE)
    ]
    check(read(["ready", *lines])[0])


def test_values_of_a_preamble_are_no_names():
    lines = ["Test : Tempo 1;600,00000;mm/min", "Foo;Bar;Baz", "(s);(mm);(N)", *rows(TIME, WAY, FORCE)]
    assert find_layout("\n".join([*lines, ""]), ImportLog("a")).names == ("Foo", "Bar", "Baz")
    lines[1:1] = ["Operator;Smith;Jones", ""]
    assert find_layout("\n".join([*lines, ""]), ImportLog("a")).names == ("Foo", "Bar", "Baz")


def test_a_profile_reads_the_next_file_of_the_machine(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    for name, speed, length, factor in (("a.csv", "600,0", "mm", 1.0), ("b.csv", "300,0", "um", 1e3)):
        lines = [f'Tempo 1;"{speed}";mm/min', "", f"Godzina [s];Przemieszczenie [{length}];Obciążenie [N]"]
        lines += [one.replace(".", ",") for one in rows(TIME, factor * WAY, FORCE)]
        (tmp_path / name).write_text("\n".join([*lines, ""]), encoding="utf-8")
    save_profile("machine", learned(Settings(), import_files([tmp_path / "a.csv"])[0]))
    settings = load_profile("machine")
    assert settings.columns == {"time": "Godzina", "displacement": "Przemieszczenie", "force": "Obciążenie"}
    press = import_files([tmp_path / "b.csv"], settings)[0][0].presses[0]
    assert press.summary.depth_mm == pytest.approx(5.0, abs=0.01)


@pytest.mark.parametrize(
    ("head", "units"),
    [
        ("Time (s);Strain (%);Load (N)", {"displacement": "0.3mm"}),
        ("Time (s);Compressive strain (mm/mm);Compressive stress (kPa)", {"displacement": "30mm", "force": "1N"}),
    ],
)
def test_strain_and_stress_ask_for_height_and_area_and_the_answer_reads_them(head, units):
    with pytest.raises(QuestionError) as asked:
        read([head, *rows(TIME, WAY, FORCE)])
    text = str(asked.value)
    assert asked.value.quantity == "columns" and all(f"{role}={size}" in text for role, size in units.items())
    names = head.split(";")
    columns = {role: names[("time", "displacement", "force").index(role)] for role in units}
    found, _ = read([head, *rows(TIME, WAY, FORCE)], columns=columns, units=units)
    assert np.allclose(found.displacement_mm, WAY * float(units["displacement"].removesuffix("mm")), atol=1e-4)


def test_two_columns_without_a_time_name_what_reads_them():
    with raises_code("missing") as fault:
        read(rows(WAY, FORCE, separator=","))
    assert "add-points" in str(fault.value)
    with pytest.raises(NoTableError):
        read(["hello", "world"])


@pytest.mark.parametrize(
    ("line", "rate"),
    [
        ("Sample rate: 500 Hz", 500.0),
        ("サンプリング周波数,2,kHz", 2000.0),
        ("Intervalo de muestreo;2;ms", 500.0),
        ("Rate;10.00;mm/s", None),
        ("Sample 12", None),
        ("Sampling 500 Hz and 2 kHz", None),
        ("Sampling filter cut-off 50 Hz", None),
    ],
)
def test_a_sampling_rate_is_a_number_with_its_unit(line, rate):
    assert sampling_rate_in(line) == rate


def test_every_file_in_doubt_is_named_and_how_many_are_not(tmp_path):
    for name in ("good.csv", "better.csv"):
        np.savetxt(
            tmp_path / name, np.c_[TIME, WAY, FORCE], delimiter=",", header="time_s,position_mm,force_N", comments=""
        )
    (tmp_path / "short.csv").write_text("time_s,displacement_mm,force_N\n0,0,0\n1,1,1\n", encoding="utf-8")
    (tmp_path / "words.csv").write_text("hello\n", encoding="utf-8")
    (tmp_path / "torn.csv").write_text("time_s,displacement_mm,force_N\n0,0,0\n1,1,\n2,2,2\n", encoding="utf-8")

    def refused(*names):
        with pytest.raises(InputError) as caught:
            import_files([tmp_path / name for name in names])
        return str(caught.value)

    every = refused("good.csv", "short.csv", "better.csv", "words.csv", "torn.csv")
    assert every.startswith("short.csv: ") and "3 files" in every and "other 2" in every
    assert all(f"{name}.csv" in every for name in ("short", "words", "torn")) and "good.csv" not in every
    alone = refused("good.csv", "short.csv")
    assert alone.count("short.csv") == 1 and "files" not in alone
    assert "other" not in refused("short.csv", "torn.csv")

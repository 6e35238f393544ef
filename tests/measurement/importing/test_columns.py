"""Which column is what, in which unit; and the questions where a file does not say."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.user_library import data_folder, read_toml
from dummydesign.measurement.importing import columns as module
from dummydesign.measurement.importing.decisions import ImportLog, Settings
from dummydesign.measurement.importing.table import columns_of
from dummydesign.measurement.importing.vocabulary import find_unit, roles_of_name, scaled_unit, split_name, words_of
from tests.support.refusal import raises_code

TIME = np.arange(400) * 0.01
WAY = np.clip(-1.0 + 2.0 * TIME, -1.0, 4.0)
FORCE = np.where(WAY > 0, WAY**2 * (0.8 + 0.2 * np.exp(-np.maximum(TIME - 2.5, 0))), 0.0) + 0.001 * np.sin(40 * TIME)


def read(tmp_path, head, columns=(TIME, WAY, FORCE), settings=None, separator=";"):
    rows = [separator.join(cell if isinstance(cell, str) else f"{cell:.6f}" for cell in row) for row in zip(*columns)]
    path = tmp_path / "press.csv"
    path.write_text("\n".join([*([head] if head else []), *rows]) + "\n", encoding="utf-8")
    log = ImportLog(path.name, settings or Settings())
    return columns_of(path.read_text(encoding="utf-8"), log), log


def close(found):
    assert np.allclose(found.time_s - found.time_s[0], TIME, atol=2e-6)
    assert np.allclose(found.displacement_mm, WAY, atol=1e-5) and np.allclose(found.force_N, FORCE, atol=1e-5)


@pytest.mark.parametrize(
    ("text", "name", "unit", "kind"),
    [
        ("Zeit [s]", "Zeit", "s", "time"),
        ("Weg in mm", "Weg", "mm", "length"),
        ("Time_s", "Time", "s", "time"),
        ("t/s", "t", "s", "time"),
        ("Kraft (kN)", "Kraft", "kN", "force"),
        ("変位（mm）", "変位", "mm", "length"),
        ("Prüfzeit in ms", "Prüfzeit", "ms", "time"),
        ("Déplacement (µm)", "Déplacement", "um", "length"),
        ("Elapsed Time (sec)", "Elapsed Time", "sec", "time"),
        ("mm", "", "mm", "length"),
        ("Load [gf]", "Load", "gf", "force"),
        ("Stress (MPa)", "Stress", "MPa", "other"),
        ("Force", "Force", None, None),
        ("Kanal M", "Kanal M", None, None),
    ],
)
def test_a_name_is_parted_from_its_unit(text, name, unit, kind):
    found_name, found = split_name(text)
    assert found_name == name
    assert (found.text, found.kind) == (unit, kind) if unit else found is None


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("Prüfzeit", "time"),
        ("Temps", "time"),
        ("Durée", "time"),
        ("経過時間", "time"),
        ("timestamp", "time"),
        ("Standardweg", "displacement"),
        ("Traversenweg absolut", "displacement"),
        ("Enfoncement", "displacement"),
        ("押込み深さ", "displacement"),
        ("Compressive extension", "displacement"),
        ("actual_TCP_pose_z", "displacement"),
        ("Standardkraft", "force"),
        ("Charge", "force"),
        ("試験力", "force"),
        ("Axial Force", "force"),
        ("Fz", "force"),
        ("Kraft Sollwert", "other"),
        ("Load cell temperature", "other"),
        ("Stress", "other"),
        ("Geschwindigkeit", "other"),
        ("応力", "other"),
        ("Cycle elapsed time", "time"),
    ],
)
def test_names_in_four_languages_say_their_role(name, role):
    assert roles_of_name(name) == {role}


def test_units_that_differ_by_a_capital_are_kept_apart():
    assert find_unit("mN").factor == 1e-3 and find_unit("MN") is None and find_unit("mn") is None
    assert find_unit("MM").factor == 1.0 and find_unit("KN").factor == 1e3 and find_unit("Sec").factor == 1.0
    assert find_unit("kgf").factor == pytest.approx(9.80665) and find_unit("lbf").factor == pytest.approx(4.448222)
    assert scaled_unit("0.002s", "time").factor == 0.002 and scaled_unit("5 um", "length").factor == pytest.approx(5e-3)
    assert scaled_unit("mm", "force") is None and scaled_unit("-1s", "time") is None


@pytest.mark.parametrize(
    ("head", "scale"),
    [
        ("Zeit [ms];Weg [m];Kraft [kN]", (1e3, 1e-3, 1e-3)),
        ("Zeit [min];Weg [µm];Kraft [cN]", (1 / 60, 1e3, 1e2)),
        ("time (h);depth (in);load (lbf)", (1 / 3600, 1 / 25.4, 1 / 4.4482216152605)),
    ],
)
def test_stated_units_are_brought_to_s_mm_and_newton(head, scale):
    rows = [values * factor for values, factor in zip((TIME, WAY, FORCE), scale)]
    lines = [";".join(f"{cell:.12f}" for cell in row) for row in zip(*rows)]
    close(columns_of("\n".join([head, *lines]) + "\n", ImportLog("a.csv")))


def test_a_unit_row_may_be_in_another_order_than_ours(tmp_path):
    found, _ = read(tmp_path, "Axial Force;Time;Axial Displacement\nN;Sec;mm", (FORCE, TIME, WAY))
    close(found)


@pytest.mark.parametrize("head", ["Zeit;Weg;Kraft", "Zeit [s];Weg [mm];Kraft", "Zeit [s];Weg [mm];Kraft [V]"])
def test_a_unit_that_is_not_stated_is_asked_for(tmp_path, head):
    with raises_code("needs_decision", "units"):
        read(tmp_path, head)
    found, _ = read(tmp_path, head, settings=Settings(units={"time": "s", "displacement": "mm", "force": "N"}))
    close(found)


def test_a_unit_given_against_the_header_is_taken_with_a_warning(tmp_path):
    found, notes = read(tmp_path, "Zeit [s];Weg [mm];Kraft [N]", settings=Settings(units={"force": "mN"}))
    assert np.allclose(found.force_N, FORCE / 1e3, atol=1e-6)
    assert [warning["code"] for warning in notes.warnings] == ["unit_overridden"]


def test_without_names_and_units_nothing_is_guessed_but_the_answer_is_shown(tmp_path):
    with raises_code("needs_decision", "columns"):
        read(tmp_path, "", (WAY, TIME, FORCE))
    units = {"time": "s", "displacement": "mm", "force": "N"}
    found, notes = read(tmp_path, "", (WAY, TIME, FORCE), Settings(units=units))
    close(found)
    why = {decision.what: decision.why for decision in notes.decisions}
    assert "always rises" in why["time column"] and "stands still" in why["displacement column"]


def test_a_name_and_a_unit_that_agree_outweigh_a_unit_alone(tmp_path):
    other = 20.0 + 0.1 * np.sin(TIME)
    found, _ = read(tmp_path, "Zeit [s];Kanal 7 [N];Weg [mm];Kraft [N]", (TIME, other, WAY, FORCE))
    close(found)


def test_commanded_values_stress_and_strain_are_not_taken(tmp_path):
    head = "Zeit [s];Weg Sollwert [mm];Weg [mm];Kraft [N];Spannung [MPa];Dehnung [%]"
    found, _ = read(tmp_path, head, (TIME, np.minimum(WAY * 1.2, 4.0), WAY, FORCE, FORCE / 196, WAY / 15))
    close(found)


def test_two_columns_that_differ_are_asked_for_and_equal_ones_are_not(tmp_path):
    head = "Zeit [s];Weg [mm];Traversenweg [mm];Kraft [N]"
    found, notes = read(tmp_path, head, (TIME, WAY, 300.0 - WAY, FORCE))
    close(found)
    assert any("hold the same" in decision.why for decision in notes.decisions)
    with raises_code("needs_decision", "columns"):
        read(tmp_path, head, (TIME, WAY, WAY + 0.02 * FORCE, FORCE))
    settings = Settings(columns={"displacement": "Traversenweg"})
    found, _ = read(tmp_path, head, (TIME, WAY + 0.02 * FORCE, WAY, FORCE), settings)
    close(found)


def test_the_axis_that_is_pressed_along_is_taken_and_a_lone_other_one_too(tmp_path):
    head = "Zeit [s];x [mm];y [mm];z [mm];fx [N];fy [N];fz [N]"
    still = np.zeros(len(TIME))
    found, _ = read(tmp_path, head, (TIME, still + 1, still + 2, WAY, 0.02 * FORCE, 0.03 * FORCE, FORCE))
    close(found)
    found, _ = read(tmp_path, "t [s];x [mm];fx [N]", (TIME, WAY, FORCE))
    close(found)


def test_the_same_name_twice_is_asked_for_by_number(tmp_path):
    head = "Zeit [s];Weg [mm];Kraft [N];Zeit [s];Weg [mm];Kraft [N]"
    columns = (TIME, WAY, FORCE, TIME, 1.1 * WAY, 1.3 * FORCE)
    with raises_code("needs_decision", "columns"):
        read(tmp_path, head, columns)
    found, _ = read(tmp_path, head, columns, Settings(columns={"displacement": "2", "force": "3"}))
    close(found)


@pytest.mark.parametrize(
    ("columns", "code"),
    [
        ({"force": "Kraftt"}, "unknown_name"),
        ({"force": "9"}, "unknown_name"),
        ({"force": "2", "displacement": "2"}, "duplicate"),
        ({"force": "Notiz"}, "not_a_number"),
    ],
)
def test_a_column_that_is_not_there_is_refused(tmp_path, columns, code):
    head = "Zeit [s];Weg [mm];Kraft [N];Notiz"
    with raises_code(code):
        read(tmp_path, head, (TIME, WAY, FORCE, ["ok"] * len(TIME)), Settings(columns=columns))


def test_two_columns_are_no_press(tmp_path):
    with raises_code("missing", "force"):
        read(tmp_path, "Zeit [s];Weg [mm]", (TIME, WAY))


@pytest.mark.parametrize(
    ("begin", "factor"), [(1763561000.0, 1.0), (1763561000.0, 1e3), (1763561000.0, 1e6), (45980.5 * 86400, 1 / 86400)]
)
def test_times_that_count_from_1970_or_1900_show_their_unit(tmp_path, begin, factor):
    stamps = [f"{(begin + second) * factor:.{10 if factor < 1 else 4}f}" for second in TIME]
    found, _ = read(tmp_path, "timestamp;Weg [mm];Kraft [N]", (stamps, WAY, FORCE))
    assert np.allclose(found.time_s - found.time_s[0], TIME, atol=1e-4)


def test_clock_times_need_no_unit(tmp_path):
    stamps = [f"19.11.2025 14:02:{11 + second:09.6f}" for second in TIME]
    found, _ = read(tmp_path, "Zeitstempel;Weg [mm];Kraft [N]", (stamps, WAY, FORCE))
    close(found)


def test_a_time_that_stands_or_goes_back_is_named_by_its_line(tmp_path):
    time = TIME.copy()
    time[100] = time[98]
    with raises_code("malformed", "time_s"):
        read(tmp_path, "Zeit [s];Weg [mm];Kraft [N]", (time, WAY, FORCE))


def test_a_row_that_stands_twice_is_taken_once(tmp_path):
    twice = np.sort(np.r_[np.arange(len(TIME)), 50, 51])
    found, notes = read(tmp_path, "Zeit [s];Weg [mm];Kraft [N]", (TIME[twice], WAY[twice], FORCE[twice]))
    close(found)
    assert "repeated rows" in {decision.what for decision in notes.decisions}


def test_a_time_that_begins_again_begins_another_recording(tmp_path):
    found, _ = read(tmp_path, "Zeit [s];Weg [mm];Kraft [N]", (np.r_[TIME, TIME], np.r_[WAY, WAY], np.r_[FORCE, FORCE]))
    assert found.recordings == ((0, len(TIME)), (len(TIME), 2 * len(TIME)))


def test_every_word_of_the_data_file_can_be_found_and_no_unit_stands_twice():
    content, _ = read_toml(data_folder() / "materials" / "machine-words.toml")
    words = {word for languages in content["words"].values() for text in languages.values() for word in text.split()}
    assert [word for word in words if words_of(word) != [word]] == []
    names = [name for factors in content["units"].values() for text in factors.values() for name in text.split()]
    assert len(names) == len(set(names)) and all(find_unit(name).text == name for name in names)


def column(index, title, unit=None, kind="number"):
    name, stated = split_name(title)
    return module.Column(index, title, kind, roles_of_name(name), find_unit(unit) if unit else stated)


def chosen(role, columns, values, **settings):
    log = ImportLog("a.csv", Settings(**settings))
    candidates = module.find_candidates(columns, timeless=True, log=log)[role]
    return module.choose_one(role, candidates, values, log), log.decisions[-1].why


@pytest.mark.parametrize(("share", "same"), [(0.9e-4, True), (1.1e-4, False)])
def test_two_columns_are_one_where_they_differ_by_less_than_a_ten_thousandth_of_their_range(share, same):
    columns = [column(0, "Weg [mm]"), column(1, "Traversenweg [mm]"), column(2, "Kraft [N]")]
    other = WAY.copy()
    other[100] += share * np.ptp(WAY)
    values = {0: WAY, 1: 7.0 - other, 2: FORCE}
    if same:
        found, why = chosen("displacement", columns, values)
        assert found is columns[0] and "hold the same" in why
    else:
        with raises_code("needs_decision", "columns"):
            chosen("displacement", columns, values)


def test_the_same_way_in_two_units_is_one_and_a_channel_that_stands_is_no_rival():
    columns = [column(0, "Weg [mm]"), column(1, "Traversenweg [m]"), column(2, "Kraft [N]"), column(3, "Fz [N]")]
    values = {0: WAY, 1: WAY / 1e3, 2: np.zeros_like(FORCE), 3: FORCE}
    assert chosen("displacement", columns, values)[0] is columns[0]
    assert chosen("force", columns, values)[0] is columns[3]
    with raises_code("needs_decision", "columns"):
        chosen("displacement", columns, {**values, 1: WAY})


@pytest.mark.parametrize(
    ("title", "unit", "role"),
    [("Load", "V", "force"), ("Kanal 7", "N", "force"), ("Position", "deg", None), ("Time Load", "N", None)],
)
def test_a_unit_speaks_for_a_column_without_a_name_and_against_one_of_another_kind(title, unit, role):
    own = column(0, title, unit)
    for kind in ("time", "displacement", "force"):
        assert (module._rank(own, kind) > 0) is (kind == role)


@pytest.mark.parametrize(
    ("titles", "settings", "option"),
    [
        (("Strain [%]", "Force [N]"), {}, "displacement=0.3mm"),
        (("Strain [mm/mm]", "Force [N]"), {}, "displacement=30mm"),
        (("Way [mm]", "Stress [kPa]"), {}, "force=1N"),
        (("Strain [%]", "Stress [MPa]"), {}, "displacement=0.3mm,force=1000N"),
    ],
)
def test_strain_and_stress_need_the_height_and_the_area_of_the_specimen(titles, settings, option):
    """One count is its unit times the size: 1 % of 30 mm, 1 kPa on 1000 mm2."""
    columns = [column(0, "Time [s]"), *(column(at, title) for at, title in enumerate(titles, 1))]
    with raises_code("needs_decision", "columns") as caught:
        module.find_candidates(columns, False, ImportLog("a.csv", Settings(**settings)))
    assert f"--units {option} (" in str(caught.value)


def test_one_column_has_one_meaning():
    way, force = column(0, "Weg [mm]"), column(1, "Kraft [N]")
    module.check_apart({"displacement": way, "force": force}, ImportLog("a.csv"))
    with raises_code("needs_decision", "columns"):
        module.check_apart({"displacement": way, "force": way}, ImportLog("a.csv"))


@pytest.mark.parametrize(
    ("begin", "length", "unit"),
    [
        (9.5e8, 10.0, "s"),
        (9.3e8, 10.0, None),  # before the year 2000
        (2.2e9, 86399.0, "s"),
        (2.2e9, 86401.0, None),  # longer than a day
        (1.7e12, 1e4, "ms"),
        (1.7e15, 1e7, "us"),
        (1.7e18, 1e10, "ns"),
        (36501.0, 0.001, "d"),
        (36499.0, 0.001, None),
    ],
)
def test_a_time_shows_its_unit_by_its_size_alone_within_these_years(begin, length, unit):
    found = module._absolute(begin + length * np.linspace(0.0, 1.0, 11), ImportLog("a.csv"))
    assert (found and found.text) == unit


def test_factors_are_those_of_header_rate_and_user_in_that_order_of_weight():
    time, way, force = column(0, "Zeit"), column(1, "Weg [cm]"), column(2, "Kraft [N]")
    values = {"time": np.arange(5.0), "displacement": WAY, "force": FORCE}
    both = {"time": time, "displacement": way, "force": force}
    log = ImportLog("a.csv", Settings(rate=250.0, units={"force": "kgf"}))
    found = module.find_factors(both, values, log)
    assert found == pytest.approx({"time": 0.004, "displacement": 10.0, "force": 9.80665})
    assert [one["code"] for one in log.warnings] == ["unit_overridden"]
    same = ImportLog("a.csv", Settings(rate=250.0, units={"force": "N"}))
    module.find_factors(both, values, same)
    assert same.warnings == []
    with raises_code("unknown_unit", "units"):
        module.find_factors(both, values, ImportLog("a.csv", Settings(rate=250.0, units={"force": "mm"})))
    with raises_code("needs_decision", "units"):
        module.find_factors(both, values, ImportLog("a.csv"))


@pytest.mark.parametrize(("held", "certain"), [(0.02, True), (0.005, False)])
def test_the_position_is_what_stands_near_its_end_and_a_short_stand_leaves_doubt(held, certain):
    """Three per cent of the samples within 2 % of the farthest value, of which an even ramp has 2 %."""
    count = 1000
    stand = int(held * count)
    way = np.r_[np.linspace(0.0, 5.0, count - stand), np.full(stand, 5.0)]
    force = np.where(np.arange(count) < count - stand, way**3, 125.0 * np.exp(-np.linspace(0.0, 3.0, count)))
    columns = [column(0, ""), column(1, ""), column(2, "")]
    values = {0: force, 1: np.arange(count) * 0.01, 2: way}
    log = ImportLog("a.csv", Settings(units={"time": "s", "displacement": "mm", "force": "N"}))
    roles = ("time", "displacement", "force")
    if certain:
        found = module.choose_by_behaviour(columns, {}, roles, values, log)
        assert {role: one.index for role, one in found.items()} == {"time": 1, "displacement": 2, "force": 0}
    else:
        with raises_code("missing", "displacement"):
            module.choose_by_behaviour(columns, {}, roles, values, log)


@pytest.mark.parametrize(
    ("name", "true"), [("true_stress_kPa", True), ("True stress [MPa]", True), ("stress_kPa", False)]
)
def test_the_advice_on_a_true_stress_is_to_export_the_force(name, true, tmp_path):
    with pytest.raises(InputError) as caught:
        read(tmp_path, f"time_s;displacement_mm;{name}")
    assert ("section at that strain" in str(caught.value)) == true

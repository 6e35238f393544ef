"""Resin files: schema and physics checks name file, line, key and value; what is written reads back."""

import dataclasses
import tomllib

import numpy as np
import pytest

from dummydesign.core import datafiles as library
from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin_writer import save_resin
from dummydesign.resin.update.modulus import Point, update_resin
from dummydesign.resin.update.rows import add_resin

BUILT_IN = library.data_folder() / "materials" / "resins" / "polyurethane-nagoya.toml"


def changed(tmp_path, old, new, count=1):
    text = BUILT_IN.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, count), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ratio_step = 0.1", "ratio_stepp = 1", r"mine\.toml:9: unknown key .* did you mean 'ratio_step'"),
        ('law = "gel_point"', 'law = "gel"', r"mine\.toml:\d+: unknown law of the modulus 'gel'"),
        ("ratio_max = 20.0", "ratio_max = 12.0", "ratio_min < ratio_max"),
        ("ratio_min = 14.0", "ratio_min = 12.0", "gel point"),
        ('parts = "ratio"', "parts = 15.0", "exactly one"),
        ('parts = "ratio"', "parts = -2", "must be a number above 0"),
        ("schema = 1", "schema = 2", "schema = 2"),
        ("ratio_ref = 15.0", "ratio_ref = 40.0", "ratio_ref = 40.0 is outside"),
        ("value = 0.03, low = 0.03", "value = 0.03, low = -0.03", "must be above 0"),
        ("beta = { value = 1.09, low = 0.80", "beta = { value = 1.09, low = -0.80", "must be at least 0"),
        ("value = 25.0", "value = 12.0", "low <= value <= high"),
        ('kind = "measured"', 'kind = "guessed"', "kind 'guessed'"),
        ("[property.pot_life_min]", "[property.potlife]", "unknown key 'potlife'"),
        ('name = "polyurethane-nagoya"', "", "'name' is missing"),
    ],
)  # fmt: skip
def test_a_wrong_file_is_refused_with_its_reason(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message):
        load_resin(str(changed(tmp_path, old, new)))


def test_a_number_without_source_is_refused(tmp_path):
    text = BUILT_IN.read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith('source = "percolation'))
    with pytest.raises(InputError, match="lacks source"):
        load_resin(str(changed(tmp_path, line, "")))


def test_names_have_any_case_and_near_misses_are_suggested():
    assert load_resin("POLYURETHANE-Nagoya").name == "polyurethane-nagoya"
    with pytest.raises(InputError, match="did you mean 'polyurethane-nagoya'"):
        load_resin("polyurethan-nagoya")


def test_a_written_resin_reads_back_the_same(tmp_path):
    base = load_resin()
    point = Point(15.0, Quantity(30.0, 28.0, 32.5, "measured", 'my "puck", 50 mm \\ plates'))
    resin = dataclasses.replace(update_resin(base, [point], "mine"), origin="file")
    again = load_resin(str(save_resin(resin, tmp_path / "mine.toml")))
    assert again.to_dict() == resin.to_dict()
    np.testing.assert_array_equal(again.draw(100, 1).young_MPa(15.5), resin.draw(100, 1).young_MPa(15.5))


def test_a_whole_resin_file_is_kept_in_the_users_folder_and_wins(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    _, path = add_resin(changed(tmp_path, "value = 25.0", "value = 30.0"))
    assert path.parent == tmp_path / "home" / "materials" / "resins"
    assert load_resin().young_MPa(15.0) == pytest.approx(0.030)
    assert not list(path.parent.glob(".*"))


def test_points_make_a_resin_of_their_own(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    points = tmp_path / "batch-7.toml"
    points.write_text(
        '[[point]]\nratio = 15.0\nyoung_kPa = {value = 31.0, low = 29.0, high = 33.0, kind = "measured", '
        'source = "own puck test"}\n',
        encoding="utf-8",
    )
    resin, _ = add_resin(points)
    assert resin.name == "batch-7"
    found = load_resin("batch-7")
    assert found.modulus_kPa(15.0).value == pytest.approx(31.0, abs=0.7)
    assert tomllib.loads((tmp_path / "home/materials/resins/batch-7.toml").read_text())["point"][0]["ratio"] == 15.0


def test_a_name_that_would_leave_the_folder_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    path = changed(tmp_path, 'name = "polyurethane-nagoya"', 'name = "../escape"')
    with pytest.raises(InputError, match="cannot be a file name"):
        add_resin(path)
    assert not (tmp_path / "home").exists()


def test_points_outside_the_range_are_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    path = tmp_path / "p.toml"
    path.write_text(
        "[[point]]\nratio = 30.0\n"
        'young_kPa = {value = 31.0, low = 29.0, high = 33.0, kind = "measured", source = "x"}\n'
    )
    with pytest.raises(InputError, match="ratio of polyurethane-nagoya = 30"):
        add_resin(path)

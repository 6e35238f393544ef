"""Resin files: schema and physics checks name file, line, key and value; what is written reads back."""

import dataclasses
import tomllib

import numpy as np
import pytest

from dummydesign.core import user_library
from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import Point
from dummydesign.resin.model.resin_file import save_resin
from dummydesign.resin.update import add_resin, update_resin
from tests.support.refusal import raises_code

BUILT_IN = user_library.data_folder() / "materials" / "resins" / "polyurethane-nagoya.toml"


def changed(tmp_path, old, new, count=1):
    text = BUILT_IN.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, count), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("ratio_step = 0.1", "ratio_stepp = 1", "unknown_key"),
        ('law = "gel_point"', 'law = "gel"', "unknown_name"),
        ("ratio_max = 20.0", "ratio_max = 12.0", "inconsistent"),
        ("ratio_min = 14.0", "ratio_min = 12.0", "inconsistent"),
        ('parts = "ratio"', "parts = 15.0", "inconsistent"),
        ('parts = "ratio"', "parts = -2", "malformed"),
        ("schema = 1", "schema = 2", "unsupported"),
        ("ratio_ref = 15.0", "ratio_ref = 40.0", "out_of_range"),
        ("value = 0.03, low = 0.03", "value = 0.03, low = -0.03", "out_of_range"),
        ("beta = { value = 1.09, low = 0.80", "beta = { value = 1.09, low = -0.80", "out_of_range"),
        ("value = 25.0", "value = 12.0", "inconsistent"),
        ('kind = "measured"', 'kind = "guessed"', "unknown_name"),
        ("[property.pot_life_min]", "[property.potlife]", "unknown_key"),
        ('name = "polyurethane-nagoya"', "", "missing"),
    ],
)
def test_a_wrong_file_is_refused_with_its_reason(tmp_path, old, new, code):
    with raises_code(code):
        load_resin(str(changed(tmp_path, old, new)))


def test_a_number_without_source_is_refused(tmp_path):
    text = BUILT_IN.read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith('source = "percolation'))
    with raises_code("missing", "exponent.source"):
        load_resin(str(changed(tmp_path, line, "")))


def test_names_have_any_case_and_near_misses_are_suggested():
    assert load_resin("POLYURETHANE-Nagoya").name == "polyurethane-nagoya"
    with raises_code("unknown_name", "resin"):
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


@pytest.mark.slow
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
    with raises_code("bad_name", "resin"):
        add_resin(path)
    assert not (tmp_path / "home").exists()


def test_points_outside_the_range_are_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    path = tmp_path / "p.toml"
    path.write_text(
        "[[point]]\nratio = 30.0\n"
        'young_kPa = {value = 31.0, low = 29.0, high = 33.0, kind = "measured", source = "x"}\n'
    )
    with raises_code("out_of_range", "ratio"):
        add_resin(path)


# Products as they are sold and the units that their data sheets use.
SLIPS = [
    ("density_g_per_cm3", (0.85, 1.8), 1e-3),
    ("density_g_per_cm3", (0.85, 1.8), 0.1198264),
    ("density_g_per_cm3", (0.85, 1.8), 0.01601846),
    ("viscosity_Pa_s", (0.3, 60.0), 1e-3),
    ("pot_life_min", (6.0, 120.0), 1 / 60),
    ("cure_time_h", (3.0, 48.0), 1 / 60),
    ("young_kPa", (6.0, 400.0), 1e3),
    ("young_kPa", (6.0, 400.0), 1e-3),
]


def fixed_resin(path, source="data sheet", **typed):
    """A resin of one mix; ``typed`` replaces its numbers."""
    numbers = {"density_g_per_cm3": 1.05, "viscosity_Pa_s": 3.0, "young_kPa": 60.0, "pot_life_min": 20.0}
    numbers |= {"cure_time_h": 16.0} | typed

    def row(key):
        ends = f"value = {numbers[key]!r}, low = {0.9 * numbers[key]!r}, high = {1.1 * numbers[key]!r}"
        return f'{key} = {{ {ends}, kind = "assumed", source = "{source}" }}\n'

    head = 'schema = 1\nname = "own"\nratio_meaning = "B per 100 A by weight"\nratio_min = 100.0\nratio_max = 100.0\n'
    none = 'softness_exponent = { value = 0.0, low = 0.0, high = 0.0, kind = "assumed", source = "one mix" }\n'
    path.write_text(
        f'{head}[[component]]\nname = "mix"\nparts = "ratio"\n{row("density_g_per_cm3")}{row("viscosity_Pa_s")}'
        f'[modulus]\nlaw = "fixed"\n{row("young_kPa")}[relaxation]\nratio_ref = 100.0\n{none}'
        f"[property]\n{row('pot_life_min')}{row('cure_time_h')}"
    )
    return path


@pytest.mark.parametrize(("key", "span", "size"), SLIPS)
def test_a_number_in_another_unit_is_asked_with_the_number_that_was_meant(key, span, size, tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    rng = np.random.default_rng(20261128)
    for true in np.exp(rng.uniform(*np.log(span), 12)).tolist():
        add_resin(fixed_resin(tmp_path / "r.toml", **{key: true}), True)
        path = fixed_resin(tmp_path / "r.toml", **{key: true / size})
        with pytest.raises(InputError) as caught:
            add_resin(path, True)
        assert caught.value.code == "implausible_unit" and caught.value.quantity == key
        assert f"{true:.4g} " in str(caught.value)


def test_a_source_that_names_the_unit_settles_an_unusual_number_but_no_density(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    add_resin(fixed_resin(tmp_path / "r.toml", "data sheet, 420 min", pot_life_min=420.0))
    with raises_code("implausible_unit"):
        add_resin(fixed_resin(tmp_path / "r.toml", "data sheet, 1060 g/cm3", density_g_per_cm3=1060.0), True)
    with raises_code("implausible_unit"):
        load_resin(str(fixed_resin(tmp_path / "r.toml", density_g_per_cm3=8.85)))

"""A ratio by volume is weighed by density, one of the mix by what is left; what is not declared is refused."""

import dataclasses

import numpy as np
import pytest

from dummydesign.core import user_library
from dummydesign.core.errors import InputError
from dummydesign.mold.files.pour_sheet import pour_sheet
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import batch_of, pour_plan
from dummydesign.mold.pour.record import Measured, weighed_ratio
from dummydesign.mold.pour.warnings import pour_warnings
from dummydesign.resin import load_resin
from dummydesign.resin.model.modulus_laws import BY_VOLUME, RATIO_BY, RATIO_PER, ratio_words, read_ratio_meaning
from dummydesign.resin.model.resin_file import save_resin
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

TEXT = (user_library.data_folder() / "materials" / "resins" / "polyurethane-nagoya.toml").read_text(encoding="utf-8")
MEANING = next(line for line in TEXT.splitlines() if line.startswith("ratio_meaning"))
TITLE = next(line for line in TEXT.splitlines() if line.startswith("title"))


def file_with(folder, meaning, more="", title=TITLE):
    path = folder / "mine.toml"
    path.write_text(TEXT.replace(MEANING, f'ratio_meaning = "{meaning}"\n{more}').replace(TITLE, title), "utf-8")
    return str(path)


def declared(folder, by, per="others"):
    return load_resin(file_with(folder, "B per 100 A", f'ratio_by = "{by}"\nratio_per = "{per}"'))


def with_densities(resin, fixed, varied):
    """The resin with drawn densities of its two liquids."""
    liquids = []
    for liquid, value in zip(resin.liquids, (fixed, varied)):
        density = dataclasses.replace(liquid.density_g_per_cm3, value=value, low=0.9 * value, high=1.1 * value)
        liquids.append(dataclasses.replace(liquid, density_g_per_cm3=density))
    return dataclasses.replace(resin, liquids=tuple(liquids))


@pytest.mark.parametrize(
    "wording",
    [
        "B per 100 A by volume",
        "B per 100 A by vol.",
        "B per 100 A (v/v)",
        "B per 100 A, V:V",
        "ml B per 100 ml A",
        "B per 100 A in mL",
        "volumetric parts B per 100 A",
        "B per 100 A vol/vol",
        "Vol.-Teile B per 100 Teile A",
        "Volumenteile B per 100 A",
        "en volume B per 100 A",
        "B per 100 cm3 of A",
        "B cc per 100 cc A",
        "体積比 B/A 100",
        "B per 100 A, parts pbv",
        "cups of B per 100 cups of A",
        "litres of B per 100 litres of A",
        "B per 100 A by weight or volume",
    ],
)
def test_volume_in_any_usual_words_is_refused_until_it_is_declared(tmp_path, wording):
    with raises_code("missing", "ratio_by"):
        load_resin(file_with(tmp_path, wording))
    by_volume = load_resin(file_with(tmp_path, wording, 'ratio_by = "volume"'))
    assert by_volume.ratio_by == "volume" and "by volume" in by_volume.ratio_meaning


@pytest.mark.parametrize(
    "wording",
    [
        "B per 100 A by weight",
        "thinner per 100 A+B by weight",
        "B per 100 A",
        "g of B per 100 g of A",
        "B per 100 A w/w",
        "phr of involved filler",
        "B per 100 of the volatile A by mass",
        "parts of mixed resin, A and B as the supplier says",
    ],
)
def test_older_files_by_weight_are_read_as_before(tmp_path, wording):
    resin = load_resin(file_with(tmp_path, wording))
    assert (resin.ratio_by, resin.ratio_per, resin.ratio_meaning) == ("weight", "others", wording)
    assert resin.recipe(15.0, 115.0)[1].mass_g == pytest.approx(15.0)


def test_volume_in_the_title_alone_is_asked_about(tmp_path):
    with raises_code("missing", "ratio_by"):
        load_resin(file_with(tmp_path, "B per 100 A", title='title = "Gel, 1A:1B by volume"'))


@pytest.mark.parametrize(
    ("meaning", "more", "code"),
    [
        ("B per 100 A by weight", 'ratio_by = "volume"', "inconsistent"),
        ("B per 100 A by volume", 'ratio_by = "weight"', "inconsistent"),
        ("g of B per 100 ml of A", "", "unsupported"),
        ("B per 100 A, w/v", 'ratio_by = "weight"', "unsupported"),
        ("B in % of the mix by weight", "", "missing"),
        ("B in 100 of the total by weight", "", "missing"),
        ("B per 100 A", 'ratio_by = "mass"', "unknown_name"),
    ],
)
def test_contradictions_and_other_meanings_are_refused(tmp_path, meaning, more, code):
    with raises_code(code):
        load_resin(file_with(tmp_path, meaning, more))


def test_a_hundred_to_eighty_five_by_volume_is_78_6_by_weight(tmp_path):
    resin = dataclasses.replace(with_densities(declared(tmp_path, "volume"), 1.06, 0.98), ratio_max=90.0)
    a, b = (one.mass_g for one in resin.recipe(85.0, 64.5))
    assert 100 * b / a == pytest.approx(78.585, abs=1e-3) and (round(a, 1), round(b, 1)) == (36.1, 28.4)


def test_drawn_recipes_hold_the_declared_ratio(tmp_path):
    """By volume: measured volumes are as the ratio. Of the mix: the share is. Both give the ratio back."""
    rng = np.random.default_rng()
    for by in ("weight", "volume"):
        for per in ("others", "mix"):
            base = declared(tmp_path, by, per)
            for _ in range(25):
                densities, ratio = rng.uniform(0.7, 2.0, 2), rng.uniform(base.ratio_min, base.ratio_max)
                resin = with_densities(base, *densities)
                masses = {one.name: one.mass_g for one in resin.recipe(ratio, rng.uniform(1.0, 900.0))}
                fixed, varied = np.array(list(masses.values())) / (densities if by == "volume" else 1.0)
                of = fixed + varied if per == "mix" else fixed
                assert 100 * varied / of == pytest.approx(ratio, rel=1e-12)
                assert resin.ratio_of(masses) == pytest.approx(ratio, rel=1e-12)


def test_what_is_declared_is_written_and_read_again(tmp_path):
    resin = declared(tmp_path, "volume", "mix")
    again = load_resin(str(save_resin(dataclasses.replace(resin, name="again"), tmp_path / "again.toml")))
    assert (again.ratio_by, again.ratio_per, again.ratio_meaning) == ("volume", "mix", "B per 100 A, by volume")
    words = load_resin(file_with(tmp_path, "B per 100 A by weight or volume", 'ratio_by = "weight"'))
    assert load_resin(str(save_resin(words, tmp_path / "both.toml"))).ratio_by == "weight"


def test_the_sheet_gives_grams_and_millilitres_whose_ratio_is_stated(tmp_path):
    rng = np.random.default_rng()
    for _ in range(4):
        resin = with_densities(declared(tmp_path, "volume"), *rng.uniform(0.8, 1.6, 2))
        spec = mould_spec(rng.uniform(4.0, 12.0), 90.0, 70.0, resin=resin, ratio=16.0)
        plan = pour_plan(spec)
        mix = batch_of(spec, spec.pour, plan).mix
        fixed, varied = mix.volumes_ml
        assert mix.ratio == pytest.approx(100 * varied / fixed, rel=1e-9) == pytest.approx(16.0, rel=0.01)
        text = sheet_text(pour_sheet(spec, plan, pour_warnings(spec, plan)))
        assert "mix, ml" in text and f"| {fixed:.1f} |" in text and "by volume" in text
        again = MouldSpec.from_dict(spec.to_dict())
        assert again.pour == spec.pour and again.hash == spec.hash


def test_weights_of_a_poured_pad_are_read_in_the_resins_own_ratio(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    resin = dataclasses.replace(with_densities(declared(tmp_path, "volume"), 1.3, 0.8), name="heavy")
    folder = tmp_path / "materials" / "resins"
    folder.mkdir(parents=True)
    save_resin(resin, folder / "heavy.toml")
    spec = mould_spec(8.0, 90.0, 70.0, resin="heavy", ratio=16.0)
    weighed = {name: 500 * share for name, share in spec.pour.components}
    measured = Measured((8.0,) * 5, 20.0, weighed_g=weighed)
    assert weighed_ratio(measured, spec)[0] == pytest.approx(16.0)


def test_moulds_by_weight_keep_their_specification():
    spec = mould_spec(8.0, 60.0, 50.0)
    assert not {"ratio_by", "ratio_per", "component_densities_g_per_cm3", "assumed"} & set(spec.to_dict()["pour"])


class Top(dict):
    """The lines of a resin file that the meaning is read from."""

    def string(self, key, choices=()):
        assert not choices or self[key] in choices
        return self[key]

    def fault(self, key, words, code, allowed=None):
        return InputError(f"{key} {words}", code, key, None, allowed)


@pytest.mark.parametrize("by", RATIO_BY)
@pytest.mark.parametrize("per", RATIO_PER)
def test_what_is_declared_is_taken_and_volume_is_put_in_words_once(by, per):
    for text in ("B per 100 A", f"B per 100 A, {BY_VOLUME}" if by == "volume" else "B per 100 A by weight"):
        meaning, own_by, own_per = read_ratio_meaning(Top(ratio_meaning=text, ratio_by=by, ratio_per=per))
        assert (own_by, own_per) == (by, per)
        assert meaning.count(BY_VOLUME) == (by == "volume")


def test_silence_is_weight_to_the_others():
    assert read_ratio_meaning(Top(ratio_meaning="B per 100 A")) == ("B per 100 A", "weight", "others")


@pytest.mark.parametrize(
    ("text", "more", "also", "quantity", "code"),
    [
        ("B per 100 A by volume", {}, "", "ratio_by", "missing"),
        ("B per 100 A", {}, "two parts by volume", "ratio_by", "missing"),
        ("B per 100 A by weight", {}, "two parts by volume", None, None),
        ("B per 100 A by weight", {"ratio_by": "volume"}, "", "ratio_by", "inconsistent"),
        ("B per 100 A by volume", {"ratio_by": "weight"}, "", "ratio_by", "inconsistent"),
        ("B per 100 A by volume or weight", {"ratio_by": "weight"}, "", None, None),
        ("B, % of the mix", {}, "", "ratio_per", "missing"),
        ("B in 100 parts of the mix", {}, "", "ratio_per", "missing"),
        ("B in 100 parts of the mix", {"ratio_per": "others"}, "", None, None),
        ("% of B per 100 A", {}, "", None, None),
        ("g of B per 100 ml of A", {"ratio_by": "weight"}, "", "ratio_meaning", "unsupported"),
        ("g/ml", {}, "", "ratio_meaning", "unsupported"),
        ("volatile B per 100 A", {}, "", None, None),
    ],
)
def test_words_that_leave_the_meaning_open_are_refused_by_their_quantity(text, more, also, quantity, code):
    top = Top(ratio_meaning=text, **more)
    if quantity is None:
        assert read_ratio_meaning(top, also)[0].startswith(text)
    else:
        with raises_code(code, quantity):
            read_ratio_meaning(top, also)


def test_words_name_what_the_ratio_is_measured_by_once():
    assert ratio_words("B per 100 A", "weight") == "B per 100 A, by weight"
    assert ratio_words("g of B per 100 g of A", "weight") == "g of B per 100 g of A"
    assert ratio_words("B per 100 A", "volume") == "B per 100 A, by volume"
    assert ratio_words("ml B per 100 ml A", "volume") == "ml B per 100 ml A"

"""Specification, presets, layout and refusals: everything that is decided before CAD is loaded."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.user_library import find
from dummydesign.mold.cad.label import (
    KNOWN,
    label_bars,
    label_corners,
    label_text,
    letter_bars,
    text_length_mm,
)
from dummydesign.mold.model.layout import cavity_volume_mm3, layout, pad_scale
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.model.validate import validate
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.refusal import raises_code


def test_specification_survives_json(open_spec, lidded_spec):
    for spec in (open_spec, lidded_spec):
        again = MouldSpec.from_dict(json.loads(spec.canonical()))
        assert again == spec and again.hash == spec.hash


def test_hash_tells_any_two_different_specifications_apart(open_spec):
    others = [
        replace(open_spec, pad=replace(open_spec.pad, thickness_mm=8.5)),
        replace(open_spec, pour=replace(open_spec.pour, ratio=15.1)),
        replace(open_spec, machines=replace(open_spec.machines, bed_x_mm=221.0)),
    ]
    assert len({spec.hash for spec in (open_spec, *others)}) == 4


def test_scale_is_shrinkage_alone_when_cured_at_room_temperature(open_spec):
    cold = replace(open_spec, pour=replace(open_spec.pour, cure_temperature_C=open_spec.pour.room_temperature_C))
    shrink = cold.pour.shrinkage_percent / 100
    assert pad_scale(cold) * (1 - shrink) == pytest.approx(1.0, rel=1e-15)


def test_pad_returns_to_nominal_size_through_heat_cure_and_cooling(open_spec):
    pour, silicone = open_spec.pour, open_spec.silicone
    warmer = pour.cure_temperature_C - pour.room_temperature_C
    assert warmer > 0
    hot_cavity = pad_scale(open_spec) * (1 + silicone.expansion_per_K * warmer)
    cured_hot = hot_cavity * (1 - pour.shrinkage_percent / 100)
    assert cured_hot / (1 + pour.resin_expansion_per_K * warmer) == pytest.approx(1.0, rel=1e-14)


def test_pour_covers_cavity_and_sums_exactly(open_spec):
    plan = pour_plan(open_spec)
    density = open_spec.pour.density_g_per_cm3 * 1e-3
    assert plan.pad_mass_g == pytest.approx(cavity_volume_mm3(open_spec) * density)
    assert plan.batch_mass_g == pytest.approx(sum(mass for _, mass in plan.components), abs=1e-9)
    assert plan.batch_mass_g - open_spec.pour.film_loss_g > plan.fill_mass_g > plan.pad_mass_g
    names = [name for name, _ in plan.components]
    assert names == ["polyol", "isocyanate"]
    masses = dict(plan.components)
    assert masses["isocyanate"] / masses["polyol"] == pytest.approx(0.15, abs=0.1 / masses["polyol"])


def test_small_batches_and_level_are_warned_of(open_spec):
    codes = {item["code"] for item in pour_warnings(open_spec, pour_plan(open_spec))}
    assert {"level", "meniscus", "small_batch"} <= codes
    fine = replace(open_spec, machines=replace(open_spec.machines, balance_resolution_g=0.01))
    assert "small_batch" not in {item["code"] for item in pour_warnings(fine, pour_plan(fine))}


@pytest.mark.parametrize("draft", [0.0, 0.3, 2.0])
def test_wall_is_nowhere_thinner_than_asked(lidded_spec, draft):
    spec = replace(lidded_spec, pad=replace(lidded_spec.pad, draft_deg=draft, thickness_mm=30.0))
    plan = layout(spec)
    drawn_in = (plan.top.length_mm - plan.bottom.length_mm) / 2 * plan.land_mm / plan.height_mm
    at_land = (plan.top.length_mm - plan.opening.length_mm) / 2
    at_floor = plan.top.length_mm / 2 - drawn_in - plan.floor_outline.length_mm / 2
    assert min(at_land, at_floor) >= spec.body.wall_mm - 1e-9


def test_keys_have_no_half_turn_symmetry(lidded_spec):
    keys = {(round(key.x_mm, 6), round(key.y_mm, 6)) for key in layout(lidded_spec).keys}
    turned = {(-x, -y) for x, y in keys}
    assert len(keys & turned) == 2 and len(keys) == 4


def test_label_holds_the_hash_and_stays_on_the_land(open_spec, lidded_spec):
    for spec in (open_spec, lidded_spec, mould_spec(20), mould_spec(20, preset="lidded")):
        plan, text = layout(spec), label_text(spec)
        assert spec.hash[:4] in text
        low = min(min(bar.y0_mm, bar.y1_mm) for bar in label_bars(spec)) - spec.body.label_stroke_mm
        high = max(max(bar.y0_mm, bar.y1_mm) for bar in label_bars(spec)) + spec.body.label_stroke_mm
        assert -plan.top.width_mm / 2 < low and high < -plan.opening.width_mm / 2


def test_tiny_lands_get_the_short_label():
    assert label_text(mould_spec(5, 20, 20)) == "T5" or "#" in label_text(mould_spec(5, 20, 20))


def test_every_letter_is_drawn_inside_its_box_and_no_two_look_alike():
    seen = {}
    for letter in KNOWN.replace(" ", ""):
        bars = letter_bars(letter, 6.0, 0.8, (0.0, 0.0))
        strokes = frozenset(
            frozenset([(round(b.x0_mm, 6), round(b.y0_mm, 6)), (round(b.x1_mm, 6), round(b.y1_mm, 6))]) for b in bars
        )
        assert strokes and strokes not in seen.values(), letter
        for bar in bars:
            assert -1e-9 <= min(bar.x0_mm, bar.x1_mm) and max(bar.x0_mm, bar.x1_mm) <= 4 + 1e-9
            assert -1e-9 <= min(bar.y0_mm, bar.y1_mm) and max(bar.y0_mm, bar.y1_mm) <= 6 + 1e-9
        seen[letter] = strokes
    assert text_length_mm("88", 6.0) == pytest.approx(9.6)


def test_the_letters_stand_in_their_order_centred_on_the_land():
    spec = mould_spec(5)
    height, (letters, corners) = spec.body.label_height_mm, zip(*label_corners(spec))
    assert "".join(letters) == label_text(spec)
    lefts = [x for x, _ in corners]
    assert [b - a for a, b in pairwise(lefts)] == pytest.approx([5.6 / 6 * height] * (len(lefts) - 1))
    assert lefts[0] + lefts[-1] + 4 / 6 * height == pytest.approx(0.0, abs=1e-9)
    assert {y for _, y in corners} == {layout(spec).label_y_mm - height / 2}


BAD = [
    ({"thickness_mm": 2.9}, "thickness_mm"),
    ({"thickness_mm": 30.1}, "thickness_mm"),
    ({"thickness_mm": math.nan}, "thickness_mm"),
    ({"thickness_mm": math.inf}, "thickness_mm"),
    ({"thickness_mm": 5, "length_mm": 10}, "length_mm"),
    ({"thickness_mm": 5, "length_mm": 400}, "printer bed"),
    ({"thickness_mm": 5, "width_mm": -3}, "width_mm"),
    ({"thickness_mm": 5, "ratio": 60}, "ratio"),
    ({"thickness_mm": 5, "ratio": math.nan}, "ratio"),
    ({"thickness_mm": 5, "preset": "lided"}, "did you mean 'lidded'"),
    ({"thickness_mm": 5, "preset": "gone.toml"}, "does not exist"),
    ({"thickness_mm": 5, "resin": "treacle"}, "resin"),
    ({"thickness_mm": 5, "kind": "banana"}, "shape"),
    ({"thickness_mm": 5, "parameters": (("0", 3.0),)}, "takes no parameters"),
    ({"thickness_mm": 30, "kind": "puck", "length_mm": 50, "width_mm": 40}, "diameter"),
    ({"thickness_mm": 5, "length_mm": 40, "width_mm": 40, "preset": "lidded"}, "length_mm"),
]


@pytest.mark.parametrize("given, named", BAD)
def test_bad_input_is_refused_with_its_name(given, named):
    with pytest.raises(InputError, match=named) as caught:
        mould_spec(**given)
    assert "\n" not in str(caught.value)


CHANGES = [
    ("pad", {"edge_radius_mm": 6.0}, "edge_radius_mm"),
    ("pad", {"draft_deg": -2.0}, "draft_deg"),
    ("pad", {"corner_radius_mm": 0.2, "edge_radius_mm": 0.0}, "corner_radius_mm"),
    ("body", {"wall_mm": 3.0}, "wall_mm"),
    ("body", {"label_depth_mm": 9.0}, "label_depth_mm"),
    ("body", {"freeboard_mm": 3.0}, "freeboard_mm"),
    ("closure", {"gutter_radius_mm": 4.0}, "gutter"),
    ("closure", {"key_shift_mm": 0.0}, "key_shift_mm"),
    ("closure", {"sprue_large_mm": 30.0}, "sprue_large_mm"),
    ("box", {"flange_mm": 3.0}, "flange_mm"),
    ("pour", {"degas": "mould"}, "open mould"),
    ("pour", {"pot_life_min": 5.0}, "pot life"),
    ("pour", {"density_g_per_cm3": math.nan}, "density_g_per_cm3"),
    ("machines", {"shelf_x_mm": 50.0}, "oven shelf"),
    ("machines", {"printer_height_mm": 10.0}, "printer"),
]


@pytest.mark.parametrize("table, change, named", CHANGES)
def test_combinations_that_cannot_be_made_are_refused(lidded_spec, table, change, named):
    spec = replace(lidded_spec, **{table: replace(getattr(lidded_spec, table), **change)})
    with pytest.raises(InputError, match=named):
        validate(spec)


def test_a_pad_too_large_is_told_how_large_it_may_be():
    with raises_code("cannot_be_made", "printer_bed") as caught:
        mould_spec(20, 300, 120)
    words = str(caught.value).split("a pad of ")[1].split(" mm")[0]
    length, width = (float(word) for word in words.split(" x "))
    mould_spec(20, length, width)


def test_mould_with_collar_must_fit_the_vacuum_chamber(open_spec):
    inside = replace(open_spec, pour=replace(open_spec.pour, degas="mould"))
    validate(inside)
    small = replace(inside, machines=replace(inside.machines, chamber_diameter_mm=60.0))
    with raises_code("cannot_be_made", "vacuum_chamber"):
        validate(small)


def test_preset_file_faults_are_named_with_file_and_key(tmp_path):
    text = find("molds", "mould preset", "open").path.read_text(encoding="utf-8")
    faults = [
        (text.replace("wall_mm = 12.0", "wal_mm = 12.0"), "wal_mm"),
        (text.replace("wall_mm = 12.0", "wall_mm = 'thick'"), "wall_mm"),
        (text.replace("floor_mm = 10.0\n", ""), "floor_mm"),
        (text.replace('kind = "assumed"', 'kind = "guessed"', 1), "guessed"),
        (text.replace("platinum_a20", "platinum_a2O"), "did you mean"),
        (text + "\n[box\n", "not valid TOML"),
        (text.replace("[process]", "[progress]"), "progress"),
    ]
    for index, (content, named) in enumerate(faults):
        path = tmp_path / f"mine{index}.toml"
        path.write_text(content, encoding="utf-8")
        with pytest.raises(InputError, match=named):
            mould_spec(5, preset=str(path))
    (tmp_path / "good.toml").write_text(text, encoding="utf-8")
    assert mould_spec(5, preset=str(tmp_path / "good.toml")).body.wall_mm == 12.0


def test_every_number_from_outside_has_its_source(open_spec):
    assert len(open_spec.sources) >= 12
    assert all(": " in source for source in open_spec.sources)


def test_nothing_heavy_is_loaded_to_refuse_or_to_weigh():
    code = (
        "import sys\n"
        "from dummydesign.mold.model.preset import mould_spec\n"
        "from dummydesign.mold.pour.plan import pour_plan\n"
        "import dummydesign.mold.client\n"
        "pour_plan(mould_spec(5))\n"
        "print([m for m in ('cadquery', 'OCP', 'vtk', 'vtkmodules', 'pyvista', 'trimesh', 'matplotlib', 'ezdxf') "
        "if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"

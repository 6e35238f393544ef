"""Every printed part fits the bed as it lies, and the pad that is advised instead does."""

import re
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.user_library import data_folder
from dummydesign.mold.checks.process import check_process
from dummydesign.mold.model.layout import Outline
from dummydesign.mold.model.layout import bed_spare_mm as spare_of
from dummydesign.mold.model.preset import mould_spec, read_preset
from dummydesign.mold.model.printed_parts import MOST_OVERHANG_MM2, lying_words, part_title, printed_parts
from dummydesign.mold.model.spec import MouldSpec, read_kind
from dummydesign.mold.pour.plan import pour_plan
from tests.support.mould_checks import shape_spec
from tests.support.refusal import raises_code

PRESETS = ("open", "lidded", "printed")


def on_bed(preset, x_mm, y_mm, height_mm=300.0, shrinkage_percent=0.0):
    """A preset whose printer has this bed, without margin."""
    used = read_preset(preset)
    fit = replace(used.machines.fit, shrinkage_percent=shrinkage_percent)
    machines = replace(
        used.machines, bed_x_mm=x_mm, bed_y_mm=y_mm, printer_height_mm=height_mm, bed_margin_mm=0.0, fit=fit
    )
    return replace(used, machines=machines)


def bed_spare_mm(part, spec):
    return spare_of(spec.machines, part.outline, part.height_mm)


def test_the_tray_of_the_reported_pad_is_refused():
    with raises_code("cannot_be_made", "printer_bed") as caught:
        mould_spec(5.0, 158.0, 158.0)
    assert "tray" in str(caught.value) and caught.value.value[1] == pytest.approx(220.35, abs=0.01)


def test_drawn_pads_fit_with_every_part_or_are_refused_with_a_pad_that_does():
    rng = np.random.default_rng()
    refused = made = 0
    for _ in range(15):
        preset = on_bed(
            str(rng.choice(PRESETS)),
            *rng.uniform(130.0, 320.0, 2),
            rng.uniform(40.0, 300.0),
            float(rng.choice([0.0, 0.7])),
        )
        length, width = np.round(rng.uniform(60.0, 280.0, 2), 1)
        thickness = round(rng.uniform(4.0, 14.0), 1)
        try:
            spec = mould_spec(thickness, length, width, preset)
        except InputError as problem:
            refused += 1
            hit = re.search(r"a pad of (\S+) x (\S+) mm fits", str(problem))
            if hit is None:
                continue
            advised = float(hit[1]), float(hit[2])
            assert advised[0] <= length and advised[1] <= width
            spec = mould_spec(thickness, *advised, preset)
        made += 1
        for part in printed_parts(spec):
            assert bed_spare_mm(part, spec) >= 0.0
        fits = next(check for check in check_process(spec, pour_plan(spec), []) if check.id == "fits_printer")
        assert fits.status == "pass" and fits.value == min(bed_spare_mm(part, spec) for part in printed_parts(spec))
    assert refused and made


def test_the_advised_pad_cannot_be_made_larger_on_the_bed():
    rng = np.random.default_rng()
    for preset in ("open", "printed"):
        x, y = rng.uniform(150.0, 260.0, 2)
        with pytest.raises(InputError) as caught:
            mould_spec(6.0, 279.0, 278.0, on_bed(preset, x, y))
        hit = re.search(r"a pad of (\S+) x (\S+) mm fits", str(caught.value))
        length, width = float(hit[1]), float(hit[2])
        with pytest.raises(InputError):
            mould_spec(6.0, length + 1.0, width + 1.0, on_bed(preset, x, y))


def test_a_rounded_rectangle_fits_a_circle_when_every_point_of_it_does_however_it_lies():
    """The largest distance between two points of the outline, by points on its four arcs."""
    rng = np.random.default_rng(71)
    for _ in range(30):
        long, wide = rng.uniform(20.0, 200.0, 2)
        radius = rng.uniform(0.0, 0.5) * min(long, wide)
        turn = np.linspace(0.0, np.pi / 2, 400)
        x, y = long / 2 - radius + radius * np.cos(turn), wide / 2 - radius + radius * np.sin(turn)
        assert Outline(long, wide, radius).spare_mm((250.0,)) == pytest.approx(
            250.0 - 2.0 * np.hypot(x, y).max(), abs=1e-3
        )


def round_bed(preset, diameter_mm):
    """A preset whose printer has a round bed, without margin."""
    used = on_bed(preset, diameter_mm, diameter_mm)
    return replace(used, machines=replace(used.machines, bed_diameter_mm=diameter_mm))


def test_drawn_pads_fit_a_round_bed_with_every_part_or_are_refused_with_a_pad_that_does():
    rng = np.random.default_rng(72)
    refused = made = advised = 0
    for _ in range(40):
        preset = round_bed(str(rng.choice(PRESETS)), rng.uniform(150.0, 360.0))
        length, width = np.round(rng.uniform(60.0, 250.0, 2), 1)
        try:
            spec = mould_spec(6.0, length, width, preset)
        except InputError as problem:
            refused += 1
            hit = re.search(r"a pad of (\S+) x (\S+) mm fits", str(problem))
            if hit is None:
                continue
            advised += 1
            smaller = float(hit[1]), float(hit[2])
            for more in ((1.0, 0.0), (0.0, 1.0)):
                larger = tuple(min(a + b, asked) for a, b, asked in zip(smaller, more, (length, width)))
                if larger != smaller and all(a + b == c for a, b, c in zip(smaller, more, larger)):
                    with pytest.raises(InputError):
                        mould_spec(6.0, *larger, preset)
            spec = mould_spec(6.0, *smaller, preset)
        made += 1
        for part in printed_parts(spec):
            assert bed_spare_mm(part, spec) >= 0.0 and part.outline.diagonal_mm <= preset.machines.bed_diameter_mm
    assert refused > 10 and made > 20 and advised > 0.8 * refused


def test_a_round_bed_takes_less_than_its_square_and_more_than_the_square_inside_it():
    length, width = 150.0, 120.0
    across = max(part.outline.diagonal_mm for part in printed_parts(mould_spec(6.0, length, width)))
    mould_spec(6.0, length, width, round_bed("open", across + 0.01))
    with raises_code("cannot_be_made", "printer_bed"):
        mould_spec(6.0, length, width, round_bed("open", across - 0.01))
    mould_spec(6.0, length, width, on_bed("open", across - 0.01, across - 0.01))
    with raises_code("cannot_be_made", "printer_bed"):
        mould_spec(6.0, length, width, on_bed("open", across / 2**0.5, across / 2**0.5))


def test_a_machine_states_a_round_bed_or_two_sides_and_a_file_without_one_keeps_its_hash(tmp_path):
    text = (data_folder() / "molds/machines/workshop.toml").read_text(encoding="utf-8")
    sides = "bed_x_mm = 220.0\nbed_y_mm = 220.0\n"
    path, preset = tmp_path / "round.toml", tmp_path / "mine.toml"
    path.write_text(text.replace(sides, "bed_diameter_mm = 230.0\n"), encoding="utf-8")
    open_text = (data_folder() / "molds/open.toml").read_text(encoding="utf-8")
    preset.write_text(re.sub('machines = ".*"', 'machines = "round.toml"', open_text), encoding="utf-8")
    spec = mould_spec(6.0, 60.0, 50.0, str(preset))
    assert spec.machines.bed_mm == (220.0,)
    assert MouldSpec.from_dict(spec.to_dict()) == spec
    assert "bed_diameter_mm" not in mould_spec(6.0, 60.0, 50.0).to_dict()["machines"]
    for given, code in (
        (sides + "bed_diameter_mm = 230.0\n", "unknown_key"),
        ("bed_diameter_mm = 0\n", "out_of_range"),
    ):
        path.write_text(text.replace(sides, given), encoding="utf-8")
        with raises_code(code):
            mould_spec(6.0, 60.0, 50.0, str(preset))


def test_a_pad_that_fits_turned_is_advised_to_be_turned():
    with raises_code("cannot_be_made", "printer_bed") as caught:
        mould_spec(5.0, 120.0, 150.0, "lidded")
    assert "turned by 90 degrees, 150 x 120 mm, it fits" in str(caught.value)
    mould_spec(5.0, 150.0, 120.0, "lidded")
    with raises_code("cannot_be_made", "printer_bed") as caught:
        mould_spec(5.0, 158.0, 158.0)
    assert "turned" not in str(caught.value) and "a pad of " in str(caught.value)


def test_a_part_taller_than_the_printer_is_refused():
    tallest = max(part.height_mm for part in printed_parts(mould_spec(12.0, 80.0, 60.0)))
    mould_spec(12.0, 80.0, 60.0, on_bed("open", 300.0, 300.0, tallest + 0.01))
    with raises_code("cannot_be_made", "printer_height_mm"):
        mould_spec(12.0, 80.0, 60.0, on_bed("open", 300.0, 300.0, tallest - 0.01))


def test_the_sheet_names_the_lower_side_of_every_printed_part():
    for spec in (
        mould_spec(8.0, 60.0, 50.0, preset="printed"),
        mould_spec(8.0, 70.0, 60.0, preset="lidded"),
        shape_spec("layered:3,0.4", 8.0),
        shape_spec("boned:20,6", 15.0),
    ):
        words = lying_words(spec)
        assert all(f"{part_title(part.name, spec.is_printed)}: {part.down}" in words for part in printed_parts(spec))


CASES = [
    ("open", "slab", {}),
    ("open", "slab", {"count": 2}),
    ("open", "crowned:12,2,8", {}),
    ("open", "layered:3,0.4", {}),
    ("open", "boned:20,4", {}),
    ("open", "slab", {"degas": "mould"}),
    ("open", "slab", {"face_sheet_mm": 3.0}),
    ("open", "puck", {}),
    ("lidded", "slab", {}),
    ("printed", "slab", {}),
    ("printed", "crowned:12,2,8", {}),
    ("printed", "layered:3,0.4", {}),
    ("printed", "boned:20,4", {}),
    ("printed", "slab", {"count": 3}),
    ("open", "crowned:radius=12,height=1.5,foot=6,sites_along=2,pitch_along=30", {}),
]


def drawn_spec(preset, shape, given):
    """A mould of drawn size; ``degas`` is set into it, a puck is round."""
    rng = np.random.default_rng()
    thickness, length, width = rng.uniform(8.0, 13.0), *rng.uniform(58.0, 95.0, 2)
    given, kind = dict(given), read_kind(shape)
    if "count" in given:  # several stand side by side on the bed
        length, width = rng.uniform(58.0, 62.0), rng.uniform(63.0, 67.0)
    degas = given.pop("degas", None)
    if kind[0] == "puck":
        width = length
    spec = mould_spec(thickness, length, width, preset, kind=kind[0], parameters=kind[1], **given)
    return spec if degas is None else replace(spec, pour=replace(spec.pour, degas=degas))


@pytest.mark.slow
@pytest.mark.parametrize(("preset", "shape", "given"), CASES)
def test_outlines_are_those_of_the_solids_and_nothing_hangs(preset, shape, given):
    from dummydesign.mold.cad.build import build
    from dummydesign.mold.checks.files import overhang_mm2
    from dummydesign.mold.files.meshes import lying, tessellate

    spec = drawn_spec(preset, shape, given)
    made = build(spec)
    parts = {part.name: part for part in printed_parts(spec)}
    assert set(parts) == {name for name, part in made.parts.items() if part.is_printed}
    for name, part in parts.items():
        mesh = lying(tessellate(made.parts[name].solid), part.turned)
        low, high = mesh.bounds
        assert low[2] == pytest.approx(0.0, abs=1e-9)
        assert (high - low)[:2] == pytest.approx((part.outline.length_mm, part.outline.width_mm), abs=0.06), name
        assert high[2] == pytest.approx(part.height_mm, abs=0.06), name
        hanging, other = overhang_mm2(mesh), overhang_mm2(lying(mesh, True))
        assert hanging <= MOST_OVERHANG_MM2, (name, hanging)
        # The other way up is never better.
        assert hanging <= other + 1e-6, (name, hanging, other)
        assert part.outline.spare_mm(spec.machines.bed_mm) >= 0.0
        # On a round bed the outline's circle holds all of the part.
        assert 2.0 * np.hypot(*(mesh.vertices - (low + high) / 2)[:, :2].T).max() <= part.outline.diagonal_mm + 0.06

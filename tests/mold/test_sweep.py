"""All five shapes in the three presets from 3 to 30 mm: sound solids, a second reader, drawings, order of the sheet."""

from __future__ import annotations

from itertools import product

import pytest

from dummydesign.mold.checks import solids as check
from dummydesign.mold.checks.files import volumes_by_gmsh
from dummydesign.mold.checks.solids import check_shape
from dummydesign.mold.files.drawing_sheet import TEXT_MM
from dummydesign.mold.files.part_drawings import part_views, sheets
from dummydesign.mold.files.step import step_text
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.steps import order_faults, pour_steps
from tests.mold.files.test_drawings import meeting
from tests.support.mould_checks import failed, shape_spec
from tests.support.refusal import raises_code

THICKNESSES = (3.0, 5.0, 12.5, 20.0, 30.0)
PRESETS = ("open", "lidded", "printed")
ONE_OPENING = ("layered", "boned")


def shapes(h):
    """A pad of each kind that a thickness can have."""
    return {
        "slab": "slab",
        "crowned": f"crowned:12,{min(0.3 * h, 5):g}",
        "layered": f"layered:{0.5 * h:g},0.4",
        "boned": f"boned:20,{0.3 * h:g}",
    }


SWEEP = [(kind, preset, h) for h, preset in product(THICKNESSES, PRESETS) for kind in shapes(h)]
MADE = [one for one in SWEEP if not (one[0] in ONE_OPENING and one[1] == "lidded")]


def test_only_layers_and_bones_under_a_lid_are_refused():
    for kind, preset, h in SWEEP:
        if (kind, preset, h) in MADE:
            shape_spec(shapes(h)[kind], h, preset=preset)
        else:
            with raises_code("conflict", "preset"):
                shape_spec(shapes(h)[kind], h, preset=preset)


@pytest.mark.slow
def test_the_sheet_of_every_mould_keeps_the_order_of_its_steps():
    for kind, preset, h in MADE:
        spec = shape_spec(shapes(h)[kind], h, preset=preset)
        assert order_faults(pour_steps(spec, pour_plan(spec))) == [], (kind, preset, h)


@pytest.mark.slow
@pytest.mark.parametrize("kind, preset, h", MADE)
def test_every_mould_is_sound_its_drawings_readable_and_its_step_read_by_another_program(kind, preset, h, tmp_path):
    from dummydesign.mold.cad.build import build

    made = build(shape_spec(shapes(h)[kind], h, preset=preset))
    assert failed([*check.check_solids(made), *check_shape(made)]) == []
    views = part_views(made)
    for paper in ("A3", "A4"):
        for name, drawing in sheets(made, views, "2026-01-01", paper).items():
            assert meeting(drawing) == [], (paper, name, meeting(drawing))
            assert min(text.height for text in drawing.texts) >= TEXT_MM
    text = step_text(list(made.parts.values()), "assembly", "sweep")
    (tmp_path / "assembly.step").write_text(text, encoding="ascii")
    volumes = volumes_by_gmsh(tmp_path / "assembly.step")
    if volumes is not None:
        own = sorted(part.solid.Volume() for part in made.parts.values())
        assert sorted(volumes) == pytest.approx(own, rel=1e-6)

"""Files of the moulds of shaped pads: STEP, drawings, the cut across a ridge."""

from __future__ import annotations

import pytest

from dummydesign.mold.cad.build import cavity_solid
from tests.support.mould_checks import shape_spec


@pytest.mark.slow
def test_steps_of_spacer_and_carrier_do_not_depend_on_what_was_written_before(layered, boned):
    from dummydesign.mold.files import step

    for made, name in ((layered, "spacer"), (layered, "layer_base"), (boned, "carrier"), (boned, "pad")):
        first = step.step_text([made.parts[name]], name, "test")
        assert step.step_text([made.parts[name]], name, "test") == first


@pytest.mark.slow
def test_curved_faces_survive_step(crowned, boned, tmp_path):
    from dummydesign.mold.files import step

    for made, name in ((crowned, "pad"), (crowned, "mould"), (boned, "carrier"), (boned, "pad")):
        path = tmp_path / f"{name}.step"
        path.write_text(step.step_text([made.parts[name]], name, "test"), encoding="ascii")
        (again,) = step.read_step(path)
        assert again.valid and again.volume_mm3 == pytest.approx(made.solid(name).Volume(), rel=1e-9)


@pytest.mark.slow
def test_drawings_dimension_the_curve_and_stay_on_paper(crowned, layered, boned):
    from dummydesign.mold.files.part_drawings import part_views, sheets

    heights = {
        "crowned": crowned.plan.face_mm,
        "layered": layered.plan.interface_mm,
        "boned": 9.0 * boned.plan.scale,
    }
    for made in (crowned, layered, boned):
        paper = sheets(made, part_views(made))["mould"]
        assert any(d.vertical and d.value == pytest.approx(heights[made.spec.pad.kind]) for d in paper.dimensions)
        assert any(str(made.spec.pad.kind) in text.words for text in paper.texts)
        for d in paper.dimensions:
            axis = 1 if d.vertical else 0
            assert abs(d.end[axis] - d.start[axis]) / paper.scale == pytest.approx(d.value, abs=1e-9)
        for x, y in (point for line in paper.lines for point in line.points):
            assert 0 <= x <= paper.size[0] and 0 <= y <= paper.size[1]


def test_section_across_a_ridge_shows_its_profile():
    from dummydesign.mold.files import part_drawings as projection

    spec = shape_spec("crowned:10,2,0,1", 8.0)
    loops = projection.cut(cavity_solid(spec.pad), across=True).loops
    low = [(y, z) for y, z in loops[0] if z < spec.pad.face_height_mm - 1e-6]
    assert len(low) > 20
    for y, z in low:
        assert z == pytest.approx(float(spec.pad.shape.drop_mm(0.0, y)), abs=1e-6)

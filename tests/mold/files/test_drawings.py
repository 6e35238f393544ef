"""Drawings: true to scale on their paper, no text on another, what is measured is what is drawn."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from itertools import combinations, pairwise
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dummydesign.core.errors import InputError
from dummydesign.mold.cad.parts import material_of
from dummydesign.mold.files import part_drawings as projection
from dummydesign.mold.files.drawing_layout import SCALES, Measure, Title, View, arrange, hatch, lay_out_view, wrapped
from dummydesign.mold.files.drawing_sheet import PAPERS, TEXT_MM, Drawing, Line, to_dxf, to_pdf, to_svg
from dummydesign.mold.files.part_drawings import part_views, sheets
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.printed_parts import printed_parts
from dummydesign.mold.model.spec import read_kind
from tests.support.mould_checks import shape_spec
from tests.support.pdf_paths import contents, pages_mm, paths_mm

TITLE = Title("project", "part", "plastic", "ISO 2768-m", "ABCD1234", "2026-01-01", "1 of 1")


def meeting(drawing):
    """Pairs of texts whose boxes meet, and texts outside the frame."""
    (w, h), boxes = drawing.size, [(text.words, text.box) for text in drawing.all_texts]
    pairs = [(a, b) for (a, p), (b, q) in combinations(boxes, 2)
             if p[0] < q[2] and q[0] < p[2] and p[1] < q[3] and q[1] < p[3]]  # fmt: skip
    outside = [a for a, box in boxes if min(box[0], box[1]) < 10 or box[2] > w - 10 or box[3] > h - 10]
    return pairs + outside + crossed(drawing)


def crossed(drawing):
    """Numbers of dimensions that a line of another dimension goes through."""
    lines = [(one, line) for one in drawing.dimensions for line in one.marks()[0]]
    found = []
    for one in drawing.dimensions:
        x0, y0, x1, y1 = np.array(one.text.box) + (0.15, 0.15, -0.15, -0.15)
        for other, ((a, b), (c, d)) in lines:  # along x or y
            if other is not one and max(a, c) > x0 and min(a, c) < x1 and max(b, d) > y0 and min(b, d) < y1:
                found.append((one.text.words, other.text.words))
    return found


def sound(made, paper):
    for name, drawing in sheets(made, part_views(made), "2026-01-01", paper).items():
        assert meeting(drawing) == [], (name, meeting(drawing))
        assert drawing.dimensions and min(text.height for text in drawing.texts) >= TEXT_MM
        words = " ".join(text.words for text in drawing.texts)
        drafted = name in ("pad", "mould", "master", "frame", "lid")
        draft = [f"raft {made.spec.pad.draft_deg:g} deg"] * drafted
        for wanted in (made.spec.hash, "ISO 2768-m", "project", "2026-01-01", paper, *draft):
            assert wanted in words, (name, wanted)
        for d in drawing.dimensions:
            axis = int(d.vertical)
            on_paper = drawing.scale * d.enlarged
            assert abs(d.end[axis] - d.start[axis]) / on_paper == pytest.approx(d.value, abs=1e-9)
        for x, y in (point for line in drawing.lines for point in line.points):
            assert 0 <= x <= drawing.size[0] and 0 <= y <= drawing.size[1]


@pytest.mark.slow
@pytest.mark.parametrize("paper", [pytest.param("A3", marks=pytest.mark.slow), "A4"])
def test_every_part_has_a_drawing_without_texts_on_each_other(open_parts, crowned, paper):
    for made in (open_parts, crowned):
        sound(made, paper)
    assert set(sheets(open_parts, part_views(open_parts))) == set(open_parts.parts)


@pytest.mark.slow
@pytest.mark.parametrize(
    "shape, thickness, preset",
    [
        *(("slab", t, preset) for t in (3.0, 5.0, 12.5, 20.0, 30.0) for preset in ("open", "lidded")),
        ("crowned:10,2", 5.0, "lidded"),
        ("crowned:10,2,0,1", 12.5, "open"),
        ("layered:8,0.4", 20.0, "open"),
        ("boned:20,6", 12.5, "open"),
        ("boned:20,6,0,1", 30.0, "open"),
        ("crowned:10,2", 3.5, "open"),
        ("boned:20,6", 15.0, "printed"),
        ("crowned:10,2,6,0,2,1,25", 5.0, "open"),
    ],
)
def test_drawings_are_sound_for_every_shape_preset_and_thickness(shape, thickness, preset):
    from dummydesign.mold.cad.build import build

    made = build(shape_spec(shape, thickness, preset=preset))
    for paper in ("A3", "A4"):
        sound(made, paper)


def test_a_hundred_millimetres_are_a_hundred_millimetres_on_the_page():
    sheet = Drawing("line", 1.0, "A3", [Line(((50.0, 60.0), (150.0, 60.0)), "outline"),
                                        Line(((50.0, 60.0), (50.0, 160.0)), "outline")])  # fmt: skip
    data = to_pdf([sheet], "test")
    assert pages_mm(data)[0] == pytest.approx((420.0, 297.0), abs=0.01)
    (content,) = contents(data)
    # lines, not the edge of the paper
    lengths = [math.dist(*run) for run in paths_mm(content) if len(run) == 2]
    assert lengths == pytest.approx([100.0, 100.0], abs=0.001)


@pytest.mark.parametrize("paper", ["A3", pytest.param("A4", marks=pytest.mark.slow)])
def test_a_part_is_on_its_page_in_the_scale_that_the_title_says(open_parts, paper):
    drawing = sheets(open_parts, part_views(open_parts), paper=paper)["tray"]
    (content,) = contents(to_pdf([drawing], "test"))
    box = open_parts.solid("tray").BoundingBox()
    sides = {round(float(np.ptp(run[:, 0])), 2) for run in paths_mm(content)}
    assert any(abs(side - drawing.scale * box.xlen) < 0.02 for side in sides)
    said = f"{drawing.scale:g}:1" if drawing.scale >= 1 else f"1:{1 / drawing.scale:g}"
    assert any(text.words.startswith(said) for text in drawing.texts)


@pytest.mark.slow
def test_a_crowned_pad_shows_foot_and_tip_with_their_dimensions(crowned):
    pad, shape = crowned.spec.pad, dict(crowned.spec.pad.shape.parameters)
    drawing = sheets(crowned, part_views(crowned))["pad"]
    found = [(d.vertical, d.value) for d in drawing.dimensions]
    assert (True, pytest.approx(pad.thickness_mm, abs=1e-3)) in found
    assert (True, pytest.approx(pad.thickness_mm - pad.face_height_mm, abs=1e-3)) in found
    assert (False, pytest.approx(2 * shape["foot"], abs=0.01)) in found


@pytest.mark.slow
def test_hole_patterns_have_number_diameter_and_distances(open_parts):
    box = open_parts.spec.box
    (rims,) = projection.holes(open_parts.solid("master"))
    assert len(rims.places) == 8 and rims.diameters_mm == (box.bolt_hole_mm,)
    drawing = sheets(open_parts, part_views(open_parts))["master"]
    assert f"8 x Ø{box.bolt_hole_mm:g}" in [text.words for text in drawing.texts]
    values = [d.value for d in drawing.dimensions]
    for axis in (0, 1):
        for reach in {round(abs(at[axis]), 3) for at in rims.places} - {0.0}:
            assert any(value == pytest.approx(2 * reach, abs=2e-3) for value in values)


def test_the_keys_of_a_lid_have_number_diameter_and_distances(lidded_parts):
    drawing = sheets(lidded_parts, part_views(lidded_parts))["lid"]
    plan, key = lidded_parts.plan, lidded_parts.spec.lid.key_radius_mm
    assert f"4 x SØ{2 * key:g}" in [text.words for text in drawing.texts]
    shown = {round(d.value, 2) for d in drawing.dimensions}
    pair, shifted = 2 * plan.keys[0].x_mm, abs(plan.keys[3].x_mm)
    assert {round(pair, 2), round(shifted, 2), round(2 * plan.keys[0].y_mm, 2)} <= shown


def drawn_papers(rng):
    """Drawings of every part of a drawn mould with their titles and notes; of the views only a square."""
    while True:
        preset, kind = rng.choice(["open", "lidded", "printed"]), rng.choice(["slab", "crowned", "layered", "boned"])
        height, foot = rng.uniform(0.6, 4.0), rng.uniform(3.0, 12.0)
        sizes = {"layered": (rng.uniform(2.0, 6.0), rng.uniform(0.2, 2.0)), "boned": (rng.uniform(8, 30), height)}
        sizes |= {"slab": (), "crowned": (foot**2 / height * rng.uniform(0.2, 0.6), height, foot)}
        given = ",".join(f"{one:.6g}" for one in sizes[kind])
        if kind == "crowned" and rng.random() < 0.5:
            typed = [f"{name}={one:.6g}" for name, one in zip(("radius", "height", "foot"), sizes[kind])]
            along, across = map(int, rng.integers(1, 5, 2))
            pitch = 2.0 * foot + rng.uniform(1.0, 9.0, 2)
            typed += [f"sites_along={along}", f"sites_across={across}"]
            typed += [f"pitch_along={pitch[0]:.5g}"] * (along > 1) + [f"pitch_across={pitch[1]:.5g}"] * (across > 1)
            given = ",".join(typed)
        try:
            kind, parameters = read_kind(f"{kind}:{given}" if given else kind)
            size = np.round((rng.uniform(8.0, 30.0), *rng.uniform(40.0, 160.0, 2)), 1).tolist()
            spec = mould_spec(*size, preset=str(preset), kind=kind, parameters=parameters)
        except InputError:
            continue
        names = ["pad", "mould", *(part.name for part in printed_parts(spec))]
        kinds = {"pad": "resin", "mould": "rigid" if spec.is_printed else "silicone"}
        parts = {
            name: SimpleNamespace(
                material=material_of(spec, kinds.get(name, "rigid")), is_printed=kinds.get(name, "rigid") == "rigid"
            )
            for name in dict.fromkeys([*names, *(["lid"] if preset == "lidded" else [])])
        }
        bone = True if kind == "boned" else None
        made = SimpleNamespace(spec=spec, plan=layout(spec), parts=parts, with_bone=bone)
        square = View("section", ((((0.0, 0.0), (50.0, 0.0), (50.0, 50.0), (0.0, 50.0), (0.0, 0.0)), "cut"),))
        return [
            one for paper in ("A3", "A4") for one in sheets(made, {key: [square] for key in parts}, "", paper).values()
        ]


def notes_in_their_frame(seed, count):
    """No text of the drawn moulds on another, over the title block or outside of the frame; none raw."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        for drawing in drawn_papers(rng):
            assert meeting(drawing) == []
            w, block = drawing.size[0], (drawing.size[0] - 10 - 180, 10 + 32)
            for text in drawing.texts:
                x0, y0, x1, y1 = text.box
                in_block = x0 >= block[0] and y1 <= block[1]
                assert in_block or x1 <= block[0] or y0 >= block[1], text.words
                assert x1 <= w - 10 and "sites_along=" not in text.words and "radius=" not in text.words


def test_notes_of_drawn_moulds_stay_in_their_frame_and_off_the_title_block():
    notes_in_their_frame(91, 12)


@pytest.mark.slow
def test_notes_of_five_hundred_drawn_moulds_stay_in_their_frame_and_off_the_title_block():
    notes_in_their_frame(92, 500)


def test_a_boss_is_no_hole_and_seams_are_not_drawn():
    import cadquery as cq

    plate = cq.Workplane().box(40, 40, 5)
    holed = plate.faces(">Z").workplane().hole(6.0).val()
    bossed = plate.faces(">Z").workplane().circle(3.0).extrude(4.0).val()
    assert [hole.words for hole in projection.holes(holed)] == ["1 x Ø6"] and projection.holes(bossed) == []
    cone = cq.Workplane().circle(5.0).workplane(offset=6.0).circle(3.0).loft().val()
    for run, _ in projection.edges_from_above(cone):
        radii = [math.hypot(x, y) for x, y in run]
        assert max(radii) - min(radii) < 1e-6


@pytest.mark.slow
def test_section_outline_encloses_the_area_of_the_cut(open_parts, lidded_parts):
    import cadquery as cq

    for made, name in ((open_parts, "mould"), (lidded_parts, "lid"), (lidded_parts, "lid_master")):
        solid = made.solid(name)
        face = cq.Face.makePlane(1000, 1000, cq.Vector(), cq.Vector(0, 1, 0)).intersect(solid)
        loops = projection.cut(solid).loops
        area = sum(abs(sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise(loop))) / 2 for loop in loops)
        assert area == pytest.approx(face.Area(), rel=1e-3), name


def test_hatching_fills_the_inside_only():
    square, hole = [(0, 0), (40, 0), (40, 40), (0, 40), (0, 0)], [(10, 10), (30, 10), (30, 30), (10, 30), (10, 10)]
    pieces = hatch([square, hole], 0.5)
    assert sum(math.dist(a, b) for a, b in pieces) * 0.5 == pytest.approx(40**2 - 20**2, rel=0.01)
    for a, b in pieces:
        x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
        assert 0 <= x <= 40 and 0 <= y <= 40 and not (10 < x < 30 and 10 < y < 30)


def test_dimensions_of_one_side_never_share_a_place():
    square = (((0.0, 0.0), (50.0, 0.0), (50.0, 20.0), (0.0, 20.0), (0.0, 0.0)), "cut")
    measures = [Measure((25.0 - x, 20.0), (25.0 + x, 20.0), "above") for x in (1.0, 1.5, 2.0, 10.0, 20.0, 25.0)]
    measures += [Measure((50.0, 0.0), (50.0, y), "right") for y in (0.5, 1.0, 1.5, 19.0, 20.0)]
    for paper in PAPERS:
        drawing = arrange([View("view", (square,), tuple(measures))], TITLE, ["a note"], paper)
        assert meeting(drawing) == [] and len(drawing.dimensions) == len(measures)


@given(
    half=st.floats(2.0, 120.0),
    high=st.floats(1.0, 40.0),
    scale=st.sampled_from(SCALES[2:]),
    widths=st.lists(st.floats(0.3, 1.0), max_size=4),
    levels=st.lists(st.floats(0.05, 0.95), max_size=3),
)
def test_no_number_stands_on_a_number_or_a_dimension_line_however_narrow_the_view(half, high, scale, widths, levels):
    """Numbers without room between their arrows stand beyond them: right of a width, above a height."""
    outline = ((-half, 0.0), (half, 0.0), (half, high), (-half, high), (-half, 0.0))
    across = [Measure((-half * w, high), (half * w, high), "above") for w in widths]
    across += [Measure((-half * w, 0.0), (half * w, 0.0), "below") for w in widths]
    up = [Measure((half, 0.0), (half, high * z), "right") for z in levels]
    up.append(Measure((-half, 0.0), (-half, high), "left"))
    placed = lay_out_view(View("section", ((outline, "cut"),), (*across, *up)), scale)
    found = placed.dimensions
    for one, other in ((a, b) for a in found for b in found if a is not b):
        x0, y0, x1, y1 = one.text.box
        for (px, py), (qx, qy) in [*other.marks()[0][2:], ((other.text.box[:2]), (other.text.box[2:]))]:
            clear = max(px, qx) <= x0 or min(px, qx) >= x1 or max(py, qy) <= y0 or min(py, qy) >= y1
            assert clear, (one.text.words, other.text.words)


def test_a_number_beside_its_arrows_stands_clear_of_the_lines_up_to_dimensions_further_out():
    outline = ((-50.0, 0.0), (50.0, 0.0), (50.0, 20.0), (-50.0, 20.0), (-50.0, 0.0))
    measures = [Measure((0.0, 20.0), (5.0, 20.0), "above"), Measure((-40.0, 20.0), (10.2, 20.0), "above")]
    short, _ = lay_out_view(View("section", ((outline, "cut"),), tuple(measures)), 1.0).dimensions
    assert short.text.box[2] < 0.0
    alone = lay_out_view(View("section", ((outline, "cut"),), tuple(measures[:1])), 1.0).dimensions[0]
    assert alone.text.box[0] > 5.0


def test_long_names_are_cut_and_notes_wrapped_so_that_they_stay_in_their_cells():
    square = (((0.0, 0.0), (50.0, 0.0), (50.0, 20.0), (0.0, 20.0), (0.0, 0.0)), "cut")
    title = Title("a long project " * 20, "part " * 30, "plastic " * 30, "ISO 2768-m", "ABCD", "2026-01-01", "1 of 1")
    for paper in PAPERS:
        assert meeting(arrange([View("view", (square,))], title, ["note " * 60], paper)) == []
        assert meeting(arrange([View("view", (square,))], title, ["crowned:radius=21.2," * 20], paper)) == []


def test_only_a_word_that_is_longer_than_its_line_is_cut():
    rng = np.random.default_rng(20261128)
    for _ in range(20):
        notes = [" ".join("abcdefghij"[: rng.integers(1, 10)] for _ in range(60)) for _ in range(3)]
        assert " ".join(wrapped(notes, float(rng.uniform(60.0, 250.0)))) == " ".join(notes)


def test_a_pad_of_several_crowns_has_no_raw_parameters_in_its_title():
    sites = (("sites_along", 3.0), ("sites_across", 2.0), ("pitch_along", 25.0), ("pitch_across", 40.0))
    sizes = (("radius", 21.2), ("height", 2.0), ("foot", 9.4), *sites)
    assert mould_spec(4.5, 100.0, 80.0, kind="crowned", parameters=sizes).pad.title == "crowned pad 100 x 80 x 4.5 mm"


@pytest.mark.slow
def test_drawings_are_wellformed_and_equal_for_equal_parts(open_parts):
    import io

    import ezdxf

    drawing = sheets(open_parts, part_views(open_parts))["mould"]
    root = ElementTree.fromstring(to_svg(drawing))
    assert root.get("width") == "420mm"
    text = to_dxf([drawing])
    document = ezdxf.read(io.StringIO(text))
    assert not document.audit().errors and len(document.modelspace().query("DIMENSION")) >= 5
    assert text == to_dxf([drawing]) and to_pdf([drawing], "a") == to_pdf([drawing], "a")


def test_the_order_of_the_lines_does_not_change_the_dxf():
    from dummydesign.mold.files.drawing_sheet import LAYERS, Drawing, Line, to_dxf

    lines = [Line(((0.0, float(i)), (10.0, 5.0)), layer) for i in range(3) for layer in list(LAYERS)[:2]]
    assert to_dxf([Drawing("t", 1.0, lines=lines)]) == to_dxf([Drawing("t", 1.0, lines=lines[::-1])])


@pytest.mark.slow
def test_the_dxf_is_the_same_in_processes_that_hash_differently():
    code = (
        "import sys, hashlib; from dummydesign.mold.files.drawing_sheet import Drawing, Line, to_dxf; "
        "sheet = Drawing('t', 1.0, lines=[Line(((0.0, 0.0), (1.0, 1.0)), 'cut')]); "
        "print(hashlib.sha256(to_dxf([sheet, sheet]).encode()).hexdigest())"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("1", "2", "4", "5")
    }
    assert len(found) == 1


def drawn_sheet(rng):
    """A rectangle of drawn size with its dimensions and an enlarged detail, on a drawn paper."""
    from dummydesign.mold.files.drawing_layout import Measure, View

    length, width = (round(float(side), 2) for side in 10 ** rng.uniform(1.2, 2.6, 2))
    corners = ((0.0, 0.0), (length, 0.0), (length, width), (0.0, width), (0.0, 0.0))
    measures = (Measure(corners[0], corners[1], "below"), Measure(corners[0], corners[3], "left"))
    small = ((0.0, 0.0), (length / 20, 0.0), (length / 20, width / 20), (0.0, 0.0))
    detail = View("detail A", ((small, "cut"),), (Measure(small[0], small[1], "below"),), enlarged=True)
    view = View("top", ((corners, "outline"),), measures)
    return arrange([view, detail], TITLE, [], str(rng.choice(["A3", "A4"]))), length, width


def test_a_dxf_has_the_parts_side_by_side_at_full_size_and_each_sheet_as_a_layout():
    """Read by ezdxf: lengths in model space are the parts', dimensions measure them, the viewports have the scale."""
    import io

    import ezdxf

    scales = set()
    for seed in np.random.default_rng().integers(0, 2**32, 6):
        rng = np.random.default_rng(seed)
        drawn = [drawn_sheet(rng) for _ in range(2)]
        scales |= {drawing.scale for drawing, *_ in drawn}
        document = ezdxf.read(io.StringIO(to_dxf([drawing for drawing, *_ in drawn])))
        assert not document.audit().errors and document.layout_names() == ["Model", "1 part", "2 part"]
        model, lines = document.modelspace(), document.modelspace().query("LWPOLYLINE")
        ends = sorted(
            [min(xs), max(xs), min(ys), max(ys)] for line in lines for xs, ys in [list(zip(*line.get_points("xy")))]
        )
        assert len(ends) == 2 and ends[0][1] < ends[1][0]
        found = sorted(d.get_measurement() for d in model.query("DIMENSION"))
        assert found == pytest.approx(sorted(side for _, *sides in drawn for side in sides), abs=1e-6)
        assert not model.query("TEXT")
        for number, ((drawing, length, width), (x0, x1, y0, y1)) in enumerate(zip(drawn, ends), 1):
            page = document.layout(f"{number} part")
            assert (x1 - x0, y1 - y0) == pytest.approx((length, width), abs=1e-6)
            assert all(d.dxf.text in ("", "<>") for d in [*model.query("DIMENSION"), *page.query("DIMENSION")])
            (detail,) = page.query("DIMENSION")
            assert detail.get_measurement() * detail.override().get("dimlfac") == pytest.approx(length / 20, abs=1e-6)
            assert len(page.query("TEXT")) == len(drawing.texts)
            view = next(one for one in page.query("VIEWPORT") if one.dxf.id != 1)
            assert view.dxf.height / view.dxf.view_height == pytest.approx(drawing.scale)
            # A point of the model is seen where the sheet has it.
            x, y = (drawing.scale * (at - middle) for at, middle in zip((x0, y0), view.dxf.view_center_point))
            at = (x + view.dxf.center[0], y + view.dxf.center[1])
            first = next(line for line in drawing.lines if line.of_part).points
            assert at == pytest.approx((min(x for x, _ in first), min(y for _, y in first)), abs=1e-6)
    assert len(scales) > 1

"""Plots: places, ticks, CSV, maps and solids hold the values they are given."""

import base64
import math
import re
import struct
import xml.etree.ElementTree as xml
import zlib

import numpy as np
import pytest

from dummydesign.mold.files.solid_view import Shown, box, pack, read_view, view_page
from dummydesign.report.plot import COLUMNS, HEIGHT, WIDTH, Axis, Plot, colours, png_uri, round_step, span
from dummydesign.report.plot_layers import Band, Bars, Cells, Dots, Ellipse, Line, edges, thin


def plot(*layers, **more):
    return Plot("name", "title", "words", "x [mm]", "y [N]", "x_mm", "y_N", layers, **more)


@pytest.mark.parametrize("log", [False, True])
def test_an_axis_puts_its_ends_at_its_ends_and_keeps_order(log):
    axis = Axis("x", 0.01, 10.0, 50.0, 400.0, log)
    assert axis.position(0.01) == pytest.approx(50.0) and axis.position(10.0) == pytest.approx(400.0)
    places = [axis.position(value) for value in (0.02, 0.3, 1.0, 7.0)]
    assert places == sorted(places)
    assert all(0.01 <= value <= 10.0 for value, _ in axis.ticks())


def test_a_logarithmic_axis_gives_each_decade_the_same_room():
    axis = Axis("x", 0.001, 10.0, 0.0, 400.0, True)
    assert [axis.position(value) for value, _ in axis.ticks()] == pytest.approx([0, 100, 200, 300, 400])


@pytest.mark.parametrize("step", [1e-7, 0.013, 0.2, 1.0, 3.3, 7.1, 999.0])
def test_steps_are_round_and_not_smaller(step):
    found = round_step(step)
    assert step * (1 - 1e-9) <= found <= 2.5 * step
    assert float(f"{found:.2g}") == pytest.approx(found)


def test_the_span_holds_everything_and_is_never_empty():
    assert span([1.0, math.nan, 3.0])[0] < 1.0 < 3.0 < span([1.0, 3.0])[1]
    assert span([2.0, 5.0], from_zero=True)[0] == 0.0
    for values in ([], [4.0], [0.0], [math.nan]):
        low, high = span(values)
        assert high > low


def test_a_line_passes_through_its_points_and_breaks_where_one_is_missing():
    drawn = plot(Line("a", [0, 1, 2, 3, 4], [0, 1, math.nan, 3, 4])).svg()
    path = re.search(r'class="line main"[^>]* d="([^"]+)"', drawn)[1]
    assert path.count("M") == 2 and path.count("L") == 2
    points = [tuple(map(float, pair)) for pair in re.findall(r"[ML]([\d.]+) ([\d.]+)", path)]
    steps = np.diff([x for x, _ in points])
    assert steps[0] == pytest.approx(steps[2], abs=0.2)
    assert all(0 <= x <= WIDTH and 0 <= y <= HEIGHT for x, y in points)


def test_all_layers_draw_valid_svg_with_words():
    layers = (
        Line("l", [0, 1], [0, 1]),
        Dots("d", [0.5], [0.5]),
        Band("b", [0, 1], [0, 0], [1, 2]),
        Band("s", [0, 1], [0, 0], [1, 2], sideways=True),
        Ellipse("e", 0.5, 0.5, 0.1, 0.2),
        Cells("c", [0, 1, 2], [0, 1], np.arange(6.0).reshape(2, 3) / 6),
        Cells("uneven", [0, 1, 5], [0, 1], np.array([[0.1, 0.2, math.nan], [0.3, 0.4, 0.5]])),
    )
    for chosen in (layers, (Bars("bars", ["p", "q & r"], [-1, -2], [1, 0]),)):
        figure = plot(*chosen)
        tree = xml.fromstring(figure.svg().replace("href=", "xlink="))
        assert tree.find("title").text == "title" and tree.find("desc").text == "words"
        assert "nan" not in figure.svg()
        xml.fromstring(f"<p>{figure.legend()}</p>")


def test_the_csv_holds_every_value_that_is_drawn():
    x, y = np.linspace(0, 1, 1000), np.linspace(5, 6, 1000) ** 2
    figure = plot(Line("a", x, y), Band("b", [0.0, 1.0], [2.0, 3.0], [4.0, 5.0]), Dots("c", [7.0], [math.nan]))
    rows = [dict(zip(COLUMNS, row)) for row in figure.rows()]
    assert {(row["figure"], row["x_name"], row["y_name"]) for row in rows} == {(figure.name, "x_mm", "y_N")}
    line = [row for row in rows if row["series"] == "a"]
    assert len(line) == 1000
    assert [float(row["y"]) for row in line] == pytest.approx(y.tolist(), rel=1e-5)
    assert [(r["x"], r["low"], r["high"]) for r in rows if r["series"] == "b"] == [("0", "2", "4"), ("1", "3", "5")]
    assert list(rows[-1].values())[4:] == ["7", "", "", ""]


def test_thinning_keeps_ends_and_extremes():
    x = np.geomspace(1e-4, 10.0, 5000)
    y = np.exp(-((np.log(x) + 3) ** 2) * 40)
    for log in (False, True):
        kept_x, kept_y = thin(x, log, y)
        assert len(kept_x) <= 245 and kept_x[0] == x[0] and kept_x[-1] == x[-1]
        assert kept_y.max() == y.max()
        assert np.all(np.diff(kept_x) > 0)


def test_a_map_image_holds_the_colours_of_its_values():
    share = np.array([[0.0, 0.5, 1.0], [math.nan, 0.2, 0.8]])
    content = base64.b64decode(png_uri(share).split(",")[1])
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    size, place, data = None, 8, b""
    while place < len(content):
        length, kind = struct.unpack(">I4s", content[place : place + 8])
        body = content[place + 8 : place + 8 + length]
        assert struct.unpack(">I", content[place + 8 + length : place + 12 + length])[0] == zlib.crc32(kind + body)
        size = struct.unpack(">II", body[:8]) if kind == b"IHDR" else size
        data += body if kind == b"IDAT" else b""
        place += 12 + length
    assert size == (3, 2)
    pixels = np.frombuffer(zlib.decompress(data), np.uint8).reshape(2, 13)[:, 1:].reshape(2, 3, 4)[::-1]
    assert pixels[1, 0, 3] == 0 and np.all(pixels[0, :, 3] == 255)
    assert np.abs(pixels[0, :, :3] - colours(share[0])).max() <= 0.5


def test_colours_grow_lighter_so_that_they_can_be_told_without_colour():
    light = colours(np.linspace(0, 1, 50)) @ [0.2126, 0.7152, 0.0722]
    assert np.all(np.diff(light) > 0)


def test_cells_stand_around_their_values():
    assert edges(np.array([1.0, 2.0, 4.0])).tolist() == [0.5, 1.5, 3.0, 5.0]
    assert edges(np.array([3.0])).tolist() == [2.5, 3.5]


def volume(triangles):
    return float(np.einsum("ij,ij->i", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])).sum() / 6)


def test_a_box_is_closed_and_seen_from_outside():
    assert volume(box(150.0, 120.0, 11.5)) == pytest.approx(150.0 * 120.0 * 11.5)


def test_packed_triangles_come_back_within_a_step():
    triangles = box(150.0, 120.0, 11.5)
    packed = pack(triangles, (1, 1, 1), 0.0)
    steps = np.frombuffer(base64.b64decode(packed["triangles"]), "<u2").reshape(-1, 3, 3)
    low, high = np.array(packed["low"]), np.array(packed["high"])
    assert np.abs(low + (high - low) * steps / 65535 - triangles).max() < 150 / 65535


def test_a_view_is_read_again_and_without_one_there_are_no_parts(tmp_path):
    ball = box(20.0, 30.0, 8.0)
    page = tmp_path / "assembly.html"
    page.write_text(view_page([Shown(name, ball, (1, 1, 1)) for name in ("pad, tested face up", "frame")], "t", ""))
    (parts,) = read_view(page).items()
    assert parts[0] == "pad, tested face up" and np.abs(parts[1] - ball).max() < 30 / 65535
    for content in ("", 'id="view-data">[{"name": "pad"}]</script>', 'id="view-data">nonsense</script>'):
        page.write_text(content)
        assert read_view(page) == {}
    assert read_view(tmp_path / "none.html") == {}

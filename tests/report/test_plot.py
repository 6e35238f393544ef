"""Plots: page and CSV hold the values they are given; solids as well."""

import base64
import gzip
import hashlib
import math
from html import unescape

import numpy as np
import pytest

from dummydesign.mold.files.solid_view import Shown, box, pack, read_view, view_page
from dummydesign.report.page import Section, page
from dummydesign.report.plot import COLUMNS, MOST_POINTS, PLOTLY, Plot, Series, plots_html, thin
from tests.support.drawn_plots import figures_of


def plot(*series, name="name", **more):
    return Plot(name, "title", "words", "x [mm]", "y [N]", "x_mm", "y_N", series, **more)


def test_the_csv_holds_every_value_and_the_page_the_same_numbers():
    x, y = np.linspace(0, 1, 1000), np.linspace(5, 6, 1000) ** 2
    band = Series.band("b", [0.0, 1.0], [2.0, 3.0], [4.0, 5.0])
    over = Series.band("s", [0.0, 1.0], [2.0, 3.0], [4.0, 5.0], sideways=True)
    figure = plot(Series.line("a", x, y), band, over, Series.dots("c", [7.0], [math.nan]))
    rows = [dict(zip(COLUMNS, row)) for row in figure.rows()]
    assert {(row["figure"], row["x_name"], row["y_name"]) for row in rows} == {(figure.name, "x_mm", "y_N")}
    line = [row for row in rows if row["series"] == "a"]
    assert len(line) == 1000
    assert [float(row["y"]) for row in line] == pytest.approx(y.tolist(), rel=1e-5)
    assert [(r["x"], r["low"], r["high"]) for r in rows if r["series"] == "b"] == [("0", "2", "4"), ("1", "3", "5")]
    assert [(r["x"], r["y"], r["low"]) for r in rows if r["series"] == "s"] == [("", "0", "2"), ("", "1", "3")]
    assert list(rows[-1].values())[4:] == ["7", "", "", ""]
    curve, low, high, left, right, dots = figures_of(figure.html())["name"]["data"]
    table = {float(row["x"]): float(row["y"]) for row in line}
    assert len(curve["x"]) > 0.9 * MOST_POINTS and all(table[a] == b for a, b in zip(curve["x"], curve["y"]))
    assert (low["x"], low["y"], high["y"], high["fill"]) == ([0.0, 1.0], [2.0, 3.0], [4.0, 5.0], "tonexty")
    assert (left["y"], left["x"], right["x"], right["fill"]) == ([0.0, 1.0], [2.0, 3.0], [4.0, 5.0], "tonextx")
    assert (dots["x"], dots["y"]) == ([7.0], [None])


def test_a_map_bars_and_an_ellipse_are_in_page_and_csv():
    value = np.array([[0.1, 0.2, math.nan], [0.3, 0.4, 0.5]])
    cells, ellipse = Series.map("c", [0, 1, 5], [0, 1], value), Series.ellipse("e", 3.0, 0.5, 2.0, 0.25)
    figure = plot(cells, ellipse, Series.words("beside", 1.0, 1.0))
    rows = [row[1:2] + row[4:] for row in figure.rows()]
    assert rows[1] == ["c", "1", "0", "0.2", "0.2"] and rows[2] == ["c", "5", "0", "", ""]
    assert rows[-2:] == [["e", "", "0.5", "1", "5"], ["e", "3", "", "0.25", "0.75"]]
    heat, ring, words = figures_of(figure.html())["name"]["data"]
    assert heat["z"] == [0.1, 0.2, None, 0.3, 0.4, 0.5] and heat["x"] == [0.0, 1.0, 5.0, 0.0, 1.0, 5.0]
    assert [min(ring["x"]), max(ring["x"]), min(ring["y"]), max(ring["y"])] == [1.0, 5.0, 0.25, 0.75]
    assert words["text"] == ["beside"]
    figure = plot(Series.bars(["p", "q & r"], [-1, -2], [1, 0]))
    assert [row[1:2] + row[6:] for row in figure.rows()] == [["p", "-1", "1"], ["q & r", "-2", "0"]]
    drawn = figures_of(figure.html())["name"]
    (bars,) = drawn["data"]
    ends = [(base, base + wide) for base, wide in zip(bars["base"], bars["x"])]
    assert ends == [(-1.0, 1.0), (-2.0, 0.0)] and bars["y"][0] > bars["y"][1]
    assert drawn["layout"]["yaxis"]["ticktext"] == ["p", "q & r"]
    assert drawn["layout"]["yaxis"]["tickvals"] == bars["y"]


def test_a_figure_to_scale_has_the_shape_of_what_it_shows():
    figure = plot(Series.line("a", [0, 40], [0, 10]), x_range=(0.0, 40.0), y_range=(0.0, 10.0), to_scale=True)
    assert figures_of(figure.html())["name"]["layout"]["yaxis"]["scaleanchor"] == "x"
    assert "aspect-ratio:720/236" in figure.html()


def test_a_logarithmic_axis_takes_its_ends_as_logarithms():
    figure = plot(Series.line("a", [0.01, 10], [0, 10]), log_x=True, x_range=(0.01, 10.0), y_range=(0.0, 12.0))
    layout = figures_of(figure.html())["name"]["layout"]
    assert layout["xaxis"]["range"] == pytest.approx([-2.0, 1.0]) and layout["yaxis"]["range"] == [0.0, 12.0]


def test_no_band_is_drawn_where_there_is_one_subject():
    one = plot(Series.band("subjects", [0, 1], [2, 3], [2, 3]), Series.line("pad", [0, 1], [2, 3]))
    assert [trace["name"] for trace in figures_of(one.html())["name"]["data"]] == ["pad"]
    assert "subjects" not in one.html() and len(list(one.rows())) == 4


def test_a_grid_has_one_legend_where_marks_mean_the_same():
    pads = [plot(Series.line("pad", [0, 1], [k, 1]), Series.dots("measured", [0], [1]), name=str(k)) for k in (1, 2)]
    assert plots_html(pads).count('class="key"') == 2 and plots_html(pads).index("key") < plots_html(pads).index(
        "plots"
    )
    other = plot(Series.line("another pad", [0, 1], [0, 1]), name="3")
    text = plots_html([*pads, other])
    assert text.count('class="key"') == 5 and text.index('class="plots"') < text.index('class="key"')


def test_words_of_a_file_cannot_leave_their_attribute():
    names = ('<b>"&', "it's", "</script>")
    figure = plot(*(Series.line(name, [0, 1], [0, 1]) for name in names), name='"><img src=x>')
    text = figure.html()
    assert "<b>" not in text and "<img" not in text and "</script" not in text
    ((name, drawn),) = figures_of(text).items()
    assert name == '"><img src=x>' and [trace["name"] for trace in drawn["data"]] == [*names]
    assert unescape(text).count("</script>") == 2


def test_a_page_has_plotly_once_when_it_has_a_plot_and_unpacked_it_is_what_was_published():
    line = Series.line("a", [0, 1], [0, 1])
    two = page("t", "", [Section("s", plots=[plot(line), plot(line, name="other")])])
    assert two.count("plotsRead = true") == two.count('id="plotly"') == 1
    assert "plotsRead" not in page("t", "", [Section("s", "words")])
    packed = two.partition('id="plotly">')[2].partition("<")[0]
    code = gzip.decompress(base64.b64decode(packed))
    assert code == gzip.decompress(PLOTLY.read_bytes()) and b"plotly.js (cartesian - minified) v4.1.1" in code[:100]
    published = "79542150855a52c567260e3137095dbe2b744e6d702a5cabe67da246942fba7a"
    assert hashlib.sha256(code).hexdigest() == published
    assert "MIT License" in PLOTLY.with_name("plotly-LICENSE").read_text()


def test_thinning_keeps_ends_and_extremes():
    x = np.geomspace(1e-4, 10.0, 5000)
    y = np.exp(-((np.log(x) + 3) ** 2) * 40)
    for log in (False, True):
        kept_x, kept_y = thin(x, log, y)
        assert len(kept_x) <= MOST_POINTS + 5 and kept_x[0] == x[0] and kept_x[-1] == x[-1]
        assert kept_y.max() == y.max()
        assert np.all(np.diff(kept_x) > 0)


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

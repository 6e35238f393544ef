"""Reports in a real browser: no error, no request, readable on a phone; and what they hold without one."""

import json
import re
from html.parser import HTMLParser

import pytest

from dummydesign.cli.entry import run
from dummydesign.report.page import Section, figure_values, page
from tests.support.browser import visit
from tests.support.drawn_plots import figures_of

PHONE = 390


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """One report of each command: {name: folder}."""
    folders = {name: tmp_path_factory.mktemp(name) for name in ("suggest", "whatif")}
    assert run(
        [
            "suggest",
            "--tissue",
            "palm",
            "--shape",
            "slab",
            "--no-cad",
            "--no-verify",
            "--out",
            str(folders["suggest"]),
        ]
    ) in (0, 1)
    assert (
        run(
            [
                "whatif",
                "--thickness",
                "5:20:5",
                "--ratio",
                "15:17:0.5",
                "--tissue",
                "palm",
                "--out",
                str(folders["whatif"]),
            ]
        )
        == 0
    )
    return folders


def text_of(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["suggest", "whatif"])
def test_a_report_opens_without_errors_and_asks_nothing_of_the_outside(made, name, tmp_path):
    seen = visit((made[name] / "report.html").as_uri(), tmp_path)
    assert seen.console == [] and seen.requests == []
    assert len(seen.dom) > 20_000


@pytest.mark.slow
def test_a_page_that_does_either_is_found_out(tmp_path):
    bad = page("bad", "", [Section("x", html='<img alt="" src="http://127.0.0.1:9/x.png">')], scripts=["nothing();"])
    (tmp_path / "bad.html").write_text(bad)
    seen = visit((tmp_path / "bad.html").as_uri(), tmp_path)
    assert any("nothing is not defined" in line for line in seen.console)
    assert any("Content Security Policy" in line for line in seen.console)
    free = bad.replace("Content-Security-Policy", "x-none")
    (tmp_path / "free.html").write_text(free)
    (tmp_path / "again").mkdir()
    assert visit((tmp_path / "free.html").as_uri(), tmp_path / "again").requests == ["http://127.0.0.1:9/x.png"]


@pytest.mark.parametrize("name", ["suggest", "whatif"])
@pytest.mark.slow
def test_nothing_is_wider_than_a_phone_and_figures_fill_it(made, name, tmp_path):
    measure = (
        "document.title = JSON.stringify({width: innerWidth, page: document.scrollingElement.scrollWidth,"
        "plots: [...document.querySelectorAll('div.plot')].map((s) => Math.round(s.getBoundingClientRect().width))});"
    )
    # a window of a browser is at least 500 wide, a frame is not
    measure += "parent.document.title = document.title;"
    inner = text_of(made[name]).replace("</body>", f"<script>{measure}</script></body>")
    (tmp_path / "inner.html").write_text(inner, encoding="utf-8")
    outer = tmp_path / "outer.html"
    outer.write_text(f'<iframe src="inner.html" width="{PHONE}" height="800" style="border:0"></iframe>')
    seen = visit(outer.as_uri(), tmp_path, "--allow-file-access-from-files", "--disable-web-security")
    found = json.loads(re.search("<title>(.*?)</title>", seen.dom)[1])
    assert found["width"] == PHONE and found["page"] <= PHONE
    assert len(found["plots"]) >= 4 and min(found["plots"]) > 0.85 * PHONE


class Outline(HTMLParser):
    """Attributes of elements by name, and the order of open and close."""

    def __init__(self):
        super().__init__()
        self.found, self.open = {}, []

    def handle_starttag(self, tag, attrs):
        self.found.setdefault(tag, []).append(dict(attrs))
        if tag not in ("meta", "input", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_startendtag(self, tag, attrs):
        self.found.setdefault(tag, []).append(dict(attrs))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["suggest", "whatif"])
def test_figures_have_words_units_and_are_closed(made, name):
    text = text_of(made[name])
    outline = Outline()
    outline.feed(text)
    assert outline.open == []
    plots = [a for a in outline.found["div"] if a.get("class") == "plot"]
    assert len(plots) >= 4 and all(a["role"] == "img" and len(a["aria-label"]) > 10 for a in plots)
    assert not [a for tag in outline.found.values() for a in tag if str(a.get("src", "")).startswith("http")]
    figures = figures_of(text)
    assert len(figures) == len(plots)
    titles = (figure["layout"][f"{side}axis"]["title"]["text"] for figure in figures.values() for side in "xy")
    labels = {title for title in titles if title}
    assert {"depth [mm]", "thickness [mm]"} & labels
    assert all("[" in label or label.startswith(("ratio", "local", "d ln F")) for label in labels)


@pytest.mark.slow
def test_the_report_says_what_the_answer_says(made):
    text = text_of(made["suggest"])
    for part in (
        "polyol",
        "isocyanate",
        "Steady force",
        "Force over time",
        "Score over ratio",
        "Recipe",
        "Sources",
        "inferred or assumed",
    ):
        assert part in text


@pytest.mark.slow
@pytest.mark.parametrize("name", ["suggest", "whatif"])
def test_every_figure_has_its_csv_with_numbers(made, name):
    figures = figure_values(made[name] / "report.csv")
    assert len(figures) == text_of(made[name]).count("<figure") and len(figures) >= (11 if name == "suggest" else 3)
    for rows in figures.values():
        assert len({(row["x_name"], row["y_name"]) for row in rows}) == 1
        assert all(any(is_number(row[key]) for key in ("x", "y", "low", "high")) for row in rows)
    assert not list(made[name].glob(".*"))


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


@pytest.mark.slow
def test_the_csv_of_the_steady_curve_is_the_answer(made):
    figure = figure_values(made["suggest"] / "report.csv")["steady"]
    rows = [row for row in figure if row["series"] == "recommended pad"]
    assert (rows[0]["x_name"], rows[0]["y_name"]) == ("depth_mm", "force_N")
    forces = [float(row["y"]) for row in rows]
    assert forces[0] < 0.2 and forces[-1] == 15.0
    known = [float(row["x"]) for row in rows if row["x"]]
    assert known == sorted(known) and len(known) > 30


def test_text_from_outside_cannot_become_markup():
    made = page("<b>", "a & b", [Section("<i>", "<script>")], [("<1>", "x")], [{"code": "", "message": "<u>"}], ["<a>"])
    body = made.split("</style>")[1]
    for bad in ("<b>", "<i>", "<script>", "<1>", "<u>", "<a>"):
        assert bad not in body.replace("<b>&lt;1&gt;</b>", "")

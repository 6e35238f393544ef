"""What commands say stands on pages in the words of pages: no option and no command, but where one is to be copied."""

from __future__ import annotations

import ast
import json
import random
import re
from pathlib import Path

import pytest

pytest.importorskip("nicegui", reason="no NiceGUI here: pip install nicegui")

import dummydesign
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.studio.markup import PAGES, STEPS, filled, in_page_words, page_path, verbatim
from tests.support import lab_project as lab
from tests.support.studio import browser, live, opened, running, settled, unfold
from tests.support.studio import test_id as by

PACKAGE = Path(dummydesign.__file__).parent
COMMANDS = sorted({command.partition(" ")[0] for command in PAGES})
TYPED = re.compile(
    rf"(?<![\w-])--[a-z]|\bdummydesign ({'|'.join(COMMANDS)})\b|'({'|'.join(COMMANDS)})( [^']*)?'|project\.toml"
)
"""Words that are typed on a command line."""
ROOMS = ("design", "geometry", "loop", "measurement", "mold", "pad", "person", "report", "resin", "tissue")
PATHS = ("", "measured", "tissue", "design", "resin", "mould", "cast", "campaign", "learn")
TEXTS = """() => { const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
    while (walk.nextNode()) { const text = walk.currentNode;
        if (!text.parentElement.closest('.command, code, pre, script, style')) found.push(text.textContent.trim()); }
    return found.filter(Boolean); }"""


UNFOLD = (
    """() => document.querySelectorAll('.q-expansion-item--collapsed > * > .q-item').forEach((one) => one.click())"""
)


def sentences(path):
    """Texts of a module with words of the command line; what is put in is a number. Documentation is none."""
    text = path.read_text(encoding="utf-8")
    nodes = list(ast.walk(ast.parse(text))) if TYPED.search(text) else []
    inner = {part for one in nodes if isinstance(one, ast.JoinedStr | ast.Expr) for part in ast.iter_child_nodes(one)}
    for one in nodes:
        if isinstance(one, ast.JoinedStr):
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else "7" for part in one.values)
        elif isinstance(one, ast.Constant) and isinstance(one.value, str) and one not in inner:
            yield one.value


def test_every_sentence_of_a_command_has_words_for_pages():
    paths = sorted(path for room in ROOMS for path in (PACKAGE / room).rglob("*.py"))
    every = [text for path in paths for text in sentences(path) if " " in text and TYPED.search(text)]
    left = [text for text in every if TYPED.search(in_page_words(text)) and "var(--" not in text]
    assert len(every) > 150 and left == []


@pytest.mark.parametrize("seed", range(20))
def test_a_drawn_command_in_a_sentence_is_the_page_that_does_it(seed):
    draw = random.Random(seed)
    command = draw.choice(sorted(PAGES))
    path, rest = (
        page_path(command.split()),
        draw.choice(["", " --shape crowned:20,2,9 --out a-b", " a/*.csv", " NAME X"]),
    )
    before, after = (
        draw.choice(["use ", "read it: ", "(", "or "]),
        draw.choice(["", "; then go on", ", or not", ". Go"]),
    )
    said = draw.choice([f"'dummydesign {command}{rest}'", f"'{command}{rest}'", f"dummydesign {command}{rest}"])
    words = f"the page '{STEPS[path]}'" if path else "the command line"
    assert in_page_words(f"{before}{said}{after}") == f"{before}{words}{after}"


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        ("a flat pad; '--shape auto' looks for others", "a flat pad; 'Shapes to search: auto' looks for others"),
        ("outside the table; use --fidelity 3d", "outside the table; 'Solve this pad'"),
        ("'a' was kept (--replace overwrites)", "'a' was kept"),
        ('choose a tissue (tissue = "..." in project.toml), or go on', "choose a tissue, or go on"),
        ("give the edge, such as --edge-radius 0.7", "give the edge, such as edge radius 0.7"),
        ("press-a--b.csv is a name, 'palms' too", "press-a--b.csv is a name, 'palms' too"),
    ],
)
def test_a_remedy_is_named_as_the_page_names_it(said, shown):
    assert in_page_words(said) == shown
    assert str(filled("{}", said)) == str(verbatim(shown)) and str(filled("{}", verbatim(said))) == str(verbatim(said))


SAID = "first '--shape auto', or 'dummydesign resins show X'; use --fidelity 3d, --edge-radius 1 (tissues add)"


def poisoned(value):
    """An answer of a command in which every sentence ends with words of the command line."""
    if isinstance(value, dict):
        keep = ("command", "file", "files", "inputs", "shape", "tissue", "resin", "verdict", "light", "level", "name")
        return {key: one if key in keep else poisoned(one) for key, one in value.items()}
    if isinstance(value, list):
        return [poisoned(one) for one in value]
    return f"{value}; {SAID}" if isinstance(value, str) and " " in value else value


@pytest.mark.slow
def test_no_page_has_words_of_the_command_line_where_none_is_to_be_copied(tmp_path):
    root = lab.lab_project(tmp_path / "thumb")
    for path in root.glob(f"*/*/{MANIFEST}"):
        path.write_text(json.dumps(poisoned(json.loads(path.read_text(encoding="utf-8")))), encoding="utf-8")
    warned = {"warnings": [{"code": "a", "message": SAID}] * 6}
    mould = ["mold", "--thickness", "6", "--preset", "open", "--resin", lab.RESIN, "--ratio", "15"]
    part = {"name": f"polyol; {SAID}", "mass_g": 1.0}
    lab.job(root, 1, "mould", [*mould, "--out", "moulds/mould_t6"], {**lab.weighed(part), **warned}, 0)
    lab.job(root, 2, "loop", ["loop", "campaigns/first"], {}, 2, SAID)
    lab.job(root, 3, "import", ["import", "measured/a.csv"], {}, 2, SAID)
    lab.job(root, 4, "puck", ["resins", "add-compression", "a.csv"], {}, 2, SAID)
    draw = random.Random(20261129)
    pads = ["slab", "crowned:20,2,9", "layered:4,1.5", "boned:20.57,2.2,9.3", "wavy", "crowned:1,99,1", "ribbed:4,8"]
    asked = [
        f"design?shape={draw.choice(pads)}&tissue={draw.choice(['palm', 'thenar', 'forefinger'])}"
        f"&thickness_mm={draw.uniform(2, 35):.1f}&ratio={draw.uniform(13, 21):.1f}"
        f"&punch={draw.choice(['square:14', 'round:16', 'square:3', 'ball:20'])}"
        f"&aim={draw.choice(['average', 'safe-side'])}"
        for _ in range(12)
    ]
    seen, bad = 0, []
    with (
        running(root, tmp_path / "home") as studio,
        browser(viewport={"width": 1280, "height": 900}) as page,
    ):
        page.goto(studio.address)
        for path in [*PATHS, *asked, "learn?campaign=campaigns/first", "mould?shape=slab&thickness_mm=6&ratio=15"]:
            page.goto(f"{studio.home}{path}")
            live(page)
            settled(page)
            for _ in range(2):  # a part that is opened may hold others
                page.evaluate(UNFOLD)
                settled(page)
            texts = page.evaluate(TEXTS)
            seen += sum("Shapes to search: auto" in text for text in texts)
            bad += [(path, text) for text in texts if TYPED.search(text)]
        # the log of a command is the command's own
        opened(page, (studio, root), "")
        unfold(page, "jobs")
        page.locator(f"{by('log')} summary").first.click()
        assert SAID in page.locator(by("log")).first.inner_text()
    assert bad == [] and seen > 5

"""HTML of the studio's pages: whatever is put into it is escaped, a number, or HTML of our own."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import dummydesign.studio
from dummydesign.studio.markup import filled, joined

STUDIO = Path(dummydesign.studio.__file__).parent
TEMPLATES = {"html", "filled", "joined"}
"""Functions whose first argument is HTML of our own; their values are escaped."""
OF_REPORTS = {"html", "keys_html", "plots_html", "whole_glossary", "join"}
"""Functions that return HTML of the reports."""


def _ours(one: ast.expr) -> bool:
    """Whether it is a literal, a constant of a module, or the template that ``html`` itself was given."""
    return isinstance(one, ast.Constant) or (isinstance(one, ast.Name) and (one.id.isupper() or one.id == "template"))


def unsafe(code: str) -> list[str]:
    """What may be put into HTML as it is: templates that are no literals, and text that is called HTML."""
    found = []
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Call) and node.args:
            name, first = getattr(node.func, "id", ""), node.args[0]
            if isinstance(first, ast.IfExp):
                first = ast.Tuple([first.body, first.orelse])
            literal = all(map(_ours, getattr(first, "elts", [first])))
            if name in TEMPLATES and not (literal or isinstance(first, ast.Starred)):
                found.append(ast.unparse(node))
            made = getattr(getattr(first, "func", None), "id", getattr(getattr(first, "func", None), "attr", ""))
            if name == "Markup" and not literal and made not in OF_REPORTS and ast.unparse(first) != "text":
                found.append(ast.unparse(node))
    return found


@pytest.mark.parametrize("path", sorted(STUDIO.rglob("*.py")), ids=lambda path: path.stem)
def test_what_is_put_into_html_is_escaped(path):
    if path.name != "markup.py":
        assert unsafe(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("put", ["html(f'<p>{name}</p>')", "html('<p>' + name)", "Markup(name)", "filled(name, 1)"])
def test_what_is_not_escaped_is_found(put):
    assert len(unsafe(f"def show(name):\n    {put}\n")) == 1


def test_values_are_escaped_and_html_of_our_own_is_not():
    inner = filled("<b>{}</b>", "<script>")
    assert str(filled("<p title='{}'>{}</p>", "'\" onclick=1", inner)) == (
        "<p title='&#39;&#34; onclick=1'><b>&lt;script&gt;</b></p>"
    )
    assert str(joined("<li>{:.1f} {}</li>", [(1.25, "<"), (2.0, inner)])) == (
        "<li>1.2 &lt;</li><li>2.0 <b>&lt;script&gt;</b></li>"
    )


@pytest.mark.parametrize("name", ["a\\x.csv", 'b"c', "d\\", "e\nf", "<b>", "g' :onclick=1"])
def test_a_name_is_the_label_of_its_buttons_whatever_letters_it_has(name, monkeypatch):
    pytest.importorskip("nicegui", reason="no NiceGUI here: pip install nicegui")
    from nicegui import ui
    from nicegui.client import Client
    from nicegui.page import page

    from dummydesign.studio import file_actions

    monkeypatch.setattr(file_actions, "undo_bar", lambda studio: None)
    client = Client(page(""), request=None)
    with client:
        file_actions.manage(Path(), f"designs/{name}", "design")
    given = [dict(one.props) for one in client.elements.values() if isinstance(one, ui.button)]
    client.delete()
    assert {one["data-name"] for one in given} == {name}
    assert all(set(one) >= {"aria-label", "data-test", "outline", "dense"} and "onclick" not in one for one in given)
    assert {one["aria-label"] for one in given} == {f"{word} the design {name}" for word in ("Delete",)}

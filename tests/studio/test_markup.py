"""HTML of the studio's pages: whatever is put into it is escaped, a number, or HTML of our own."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import dummydesign.studio

STUDIO = Path(dummydesign.studio.__file__).parent
ESCAPES = {"escape", "page_link", "file_link", "marked", "address", "len"}
"""Functions that return HTML, or text without a sign that HTML knows."""
OURS = {
    "_list",
    "html",
    "plots_html",
    "table_html",
    "whole_glossary",
    "style",
    "strftime",
    "plots_js",
    "keys_html",
    "verdict_html",
    "replace",
    "sub",
    "_file",
}
"""Functions that put HTML or words of our own together."""
NUMBERS = {"left", "low", "high", "number", "done", "passed"}
CONSTANTS = {"key", "stage", "kind", "line", "title", "short", "name"}
"""Arguments and loop variables that only our own code fills."""


def safe(value: ast.expr, known: dict[str, list[ast.expr]], seen: frozenset[str] = frozenset()) -> bool:
    """Whether what an expression gives can be put into HTML."""

    def same(one: ast.expr) -> bool:
        return safe(one, known, seen)

    match value:
        case ast.Constant() | ast.Compare():
            return True
        case ast.JoinedStr():
            return all(_part_safe(part, known, seen) for part in value.values)
        case ast.IfExp():
            return same(value.body) and same(value.orelse)
        case ast.BinOp():
            return same(value.left) and same(value.right)
        case ast.BoolOp():
            return all(map(same, value.values))
        case ast.List() | ast.Tuple():
            return all(map(same, value.elts))
        case ast.Subscript(slice=ast.Slice()):
            return same(value.value)
        case ast.GeneratorExp() | ast.ListComp():
            return same(value.elt)
        case ast.Attribute():
            return value.attr.isupper() or value.attr.endswith("written")
        case ast.Call():
            name = getattr(value.func, "id", getattr(value.func, "attr", ""))
            return name in ESCAPES | OURS or (name == "join" and all(map(same, value.args)))
        case ast.Name():
            if value.id.isupper() or value.id in NUMBERS | CONSTANTS:
                return True
            bound = known.get(value.id, [])
            return value.id in seen or (bool(bound) and all(safe(one, known, seen | {value.id}) for one in bound))
    return False


def _part_safe(part: ast.expr, known: dict[str, list[ast.expr]], seen: frozenset[str]) -> bool:
    if not isinstance(part, ast.FormattedValue):
        return True
    kind = "".join(str(one.value) for one in part.format_spec.values) if part.format_spec else ""
    return kind[-1:] in tuple("fgd") or safe(part.value, known, seen)


def bound_names(function: ast.AST) -> dict[str, list[ast.expr]]:
    """What each name of a function is set to, or is added to it."""
    known: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign | ast.AugAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            for target in targets:
                pairs = [(target, node.value)]
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = list(zip(target.elts, node.value.elts))
                for name, value in pairs:
                    if isinstance(name, ast.Name):
                        known.setdefault(name.id, []).append(value)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "append":
            if isinstance(node.func.value, ast.Name):
                known.setdefault(node.func.value.id, []).extend(node.args)
    return known


def unsafe(code: str) -> list[str]:
    """Values that are put into HTML as they are."""
    found = []
    for function in ast.walk(ast.parse(code)):
        if not isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        known = bound_names(function)
        for text in ast.walk(function):
            if isinstance(text, ast.JoinedStr) and any(
                "<" in str(getattr(part, "value", "")) for part in text.values if isinstance(part, ast.Constant)
            ):
                found += [ast.unparse(part) for part in text.values if not _part_safe(part, known, frozenset())]
    return found


@pytest.mark.parametrize("path", sorted(STUDIO.rglob("*.py")), ids=lambda path: path.stem)
def test_what_is_put_into_html_is_escaped(path):
    assert unsafe(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("put", ["one.why", "answer[0]", "light", "str(one)", "b.join(rows)", "a + escape(b)"])
def test_what_is_not_escaped_is_found(put):
    code = f"def show(answer):\n light = answer['verdict']\n rows = [one.why]\n html(f'<p>{{{put}}}</p>')\n"
    assert len(unsafe(code)) == 1
    assert unsafe(code.replace(put + "}}", "escape(x)}}").replace(f"{{{put}}}", "{escape(x)}")) == []


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
        file_actions.manage(Path(), f"designs/{name}", "design", lambda old, new: None)
    given = [dict(one.props) for one in client.elements.values() if isinstance(one, ui.button)]
    client.delete()
    assert {one["data-name"] for one in given} == {name}
    assert all(set(one) >= {"aria-label", "data-test", "outline", "dense"} and "onclick" not in one for one in given)
    assert {one["aria-label"] for one in given} == {f"{word} the design {name}" for word in ("Rename", "Delete")}

"""The list of errors, docs/errors.md, from the package's own sources: ``python -m studies.errors``."""

from __future__ import annotations

import ast
import tomllib
from functools import cache
from pathlib import Path

from dummydesign.core.files import write_text

PACKAGE = Path(__file__).resolve().parents[1] / "dummydesign"
DOCUMENT = Path("docs") / "errors.md"
FIRST_ARGUMENT = {"InputError": 1, "QuestionError": 1, "NoTableError": 1, "NoAnswerError": 0}
"""Classes of errors, and which of their arguments, from 0, is the code."""
MEANINGS = tomllib.loads((PACKAGE / "core" / "errors.toml").read_text(encoding="utf-8"))
CODES: dict[str, str] = MEANINGS["wrong_input"] | MEANINGS["no_answer"]
HEAD = """# Errors

An error is one line on standard error. With `--json` it is also printed as
`{"error": {"code", "quantity", "value", "allowed", "message"}}`. In Python it is a `dummydesign.core.errors.InputError`
or `NoAnswerError` with the same attributes. Codes never change; messages may.

A quantity is an option without its dashes, a key of a file, or a number with its unit.
"""


@cache
def raised(package: Path = PACKAGE) -> tuple[dict[str, set[str]], list[str]]:
    """Quantities by code, as far as they stand in the sources; and places where an error has no code or no quantity."""
    quantities: dict[str, set[str]] = {code: set() for code in CODES}
    bare = []
    for path in sorted(package.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
                continue
            if node.func.id in ("unwritable", "writing"):
                last = node.args[-1]
                quantities["file_unwritable"] |= {str(last.value)} if isinstance(last, ast.Constant) else set()
            at = FIRST_ARGUMENT.get(node.func.id)
            if at is None or any(isinstance(one, ast.Starred) for one in node.args):
                continue
            named = {word.arg: word.value for word in node.keywords}
            code = named.get("code", node.args[at] if len(node.args) > at else None)
            behind = 3 if node.func.id == "NoAnswerError" else at + 1
            quantity = named.get("quantity", node.args[behind] if len(node.args) > behind else None)
            if code is None or quantity is None:
                bare.append(f"{path.relative_to(package)}:{node.lineno}")
                continue
            names = [
                one.value
                for one in ast.walk(quantity)
                if isinstance(one, ast.Constant) and isinstance(one.value, str) and one.value
            ]
            for one in ast.walk(code):
                if isinstance(one, ast.Constant) and isinstance(one.value, str):
                    whole = isinstance(quantity, ast.Constant | ast.IfExp)
                    quantities.setdefault(one.value, set()).update(str(name) for name in names if whole)
    return quantities, bare


def document() -> str:
    """Text of docs/errors.md."""
    parts = [HEAD]
    for title, codes in (
        ("Wrong input: exit status 2", MEANINGS["wrong_input"]),
        ("No acceptable answer: exit status 1", MEANINGS["no_answer"]),
    ):
        rows = [f"| `{code}` | {CODES[code]} |" for code in codes]
        parts.append("\n".join([f"## {title}\n", "| code | meaning |", "|---|---|", *rows, ""]))
    return "\n".join(parts)


def main() -> None:
    """Write the page into the repository one stands in."""
    write_text(DOCUMENT, document())
    print(f"{DOCUMENT}: {len(CODES)} codes")


if __name__ == "__main__":
    main()

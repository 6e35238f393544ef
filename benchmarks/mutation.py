"""How many small faults the default tests catch: ``python -m benchmarks.mutation --count 40 --seed 1 --out FILE``.

Lines are drawn at random from core, pad, loop and design; in each, one sign, limit or index is changed (``+`` to
``-``, ``<`` to ``>=``, a number by a tenth, an index by one), and the default tests run until one fails: those that
import the module first, then those of its room, then all others but those of mould and studio. A fault that no test
sees is printed. Each line of the file is one mutant.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOMS = ("core", "pad", "loop", "design")
SIGNS: dict[type[ast.operator], tuple[str, type[ast.operator]]] = {
    ast.Add: ("+", ast.Sub), ast.Sub: ("-", ast.Add), ast.Mult: ("*", ast.Div), ast.Div: ("/", ast.Mult),
}  # fmt: skip
LIMITS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
}  # fmt: skip


def mutants(path: Path) -> Iterator[tuple[int, str, str]]:
    """Line, kind and new text of the file of every change that can be made to it."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    hidden = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.Raise | ast.JoinedStr | ast.ImportFrom | ast.AnnAssign) or _is_docstring(node)
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if not isinstance(node, ast.expr) or id(node) in hidden or node.lineno != node.end_lineno:
            continue
        for kind, changed in changes(node):
            yield node.lineno, kind, _replaced(text, node, changed)


def _is_docstring(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def changes(node: ast.AST) -> Iterator[tuple[str, str]]:
    """Kind and source text of each change of one expression."""
    if isinstance(node, ast.BinOp) and type(node.op) in SIGNS and not isinstance(node.left, ast.Constant | ast.List):
        new = SIGNS[type(node.op)][1]()
        yield "sign", f"({ast.unparse(ast.BinOp(node.left, new, node.right))})"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "sign", ast.unparse(node.operand)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in LIMITS:
        new_op = LIMITS[type(node.ops[0])]()
        yield "limit", f"({ast.unparse(ast.Compare(node.left, [new_op], node.comparators))})"
    elif isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant) and type(node.slice.value) is int:
        moved = ast.Subscript(node.value, ast.Constant(node.slice.value + 1), ast.Load())
        yield "index", ast.unparse(moved)
    elif isinstance(node, ast.Constant) and type(node.value) is float and node.value not in (0.0, 1.0):
        yield "limit", repr(1.1 * node.value)


def _replaced(text: str, node: ast.expr, new: str) -> str:
    lines = text.splitlines(keepends=True)
    line = lines[node.lineno - 1].encode()
    lines[node.lineno - 1] = (line[: node.col_offset] + new.encode() + line[node.end_col_offset :]).decode()
    return "".join(lines)


def draw(repository: Path, count: int, seed: int) -> list[tuple[str, int, str, str]]:
    """Draw lines, then one change in each: file, line, kind and new text."""
    found: dict[tuple[str, int], list[tuple[str, int, str, str]]] = {}
    for room in ROOMS:
        for path in sorted((repository / "dummydesign" / room).rglob("*.py")):
            name = path.relative_to(repository).as_posix()
            for line, kind, text in mutants(path):
                found.setdefault((name, line), []).append((name, line, kind, text))
    chance = random.Random(seed)
    return [chance.choice(found[place]) for place in chance.sample(sorted(found), count)]


def caught_by(repository: Path, mutant: tuple[str, int, str, str], limit_s: float) -> dict[str, object]:
    """Run the tests on a copy with the change in it; which test failed first, or none."""
    name, line, kind, text = mutant
    with tempfile.TemporaryDirectory(prefix="mutant-") as place:
        copy = Path(place) / "tree"
        tracked = subprocess.run(["git", "ls-files"], cwd=repository, capture_output=True, text=True, check=True)
        for file in tracked.stdout.splitlines():
            (copy / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(repository / file, copy / file)
        before = (copy / name).read_text(encoding="utf-8").splitlines()[line - 1].strip()
        (copy / name).write_text(text, encoding="utf-8")
        after = text.splitlines()[line - 1].strip()
        near, room, others = tests_of(
            copy, name, [one for one in tracked.stdout.splitlines() if one.startswith("tests/")]
        )
        begun = time.perf_counter()
        failed = ""
        for files in (near, room, others):
            if not files:
                continue
            words = [sys.executable, "-m", "pytest", "-n", "0", "-x", "-p", "no:cacheprovider", "--no-header", *files]
            try:
                done = subprocess.run(words, cwd=copy, capture_output=True, text=True, timeout=limit_s,
                                      env={**_environment(), "PYTHONPATH": str(copy)})  # fmt: skip
                if done.returncode:
                    rows = [one for one in done.stdout.splitlines() if one.startswith(("FAILED", "ERROR"))]
                    failed = rows[0] if rows else f"status {done.returncode}"
            except subprocess.TimeoutExpired:
                failed = "time ran out"
            if failed:
                break
    return {"file": name, "line": line, "kind": kind, "before": before, "after": after, "caught": failed,
            "seconds": round(time.perf_counter() - begun, 1)}  # fmt: skip


def tests_of(copy: Path, name: str, tracked: list[str]) -> tuple[list[str], list[str], list[str]]:
    """Test files that import the module, the others of its room, and the rest but for mould and studio."""
    module = name.removesuffix(".py").replace("/", ".")
    parent, _, last = module.rpartition(".")
    taken = re.compile(rf"{re.escape(module)}\b|from {re.escape(parent)} import [^\n]*\b{last}\b")
    files = [one for one in tracked if Path(one).name.startswith("test_") and one.endswith(".py")]
    near = [one for one in files if taken.search((copy / one).read_text(encoding="utf-8"))]
    room = [one for one in files if one.startswith(f"tests/{name.split('/')[1]}/") and one not in near]
    left = [one for one in files if one not in near and one not in room]
    return near, room, [one for one in left if one.split("/")[1] not in ("mold", "studio")]


def _environment() -> dict[str, str]:
    return {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}


def main() -> None:
    """Draw mutants, run the tests on each, print the rate."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repository", type=Path, default=Path(__file__).resolve().parent.parent)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=900.0, help="seconds of tests before a mutant counts as caught")
    parser.add_argument("--out", type=Path, required=True, help="rows; mutants in it are not run again")
    options = parser.parse_args()
    rows = [json.loads(line) for line in options.out.read_text().splitlines()] if options.out.exists() else []
    known = {(row["file"], row["line"]) for row in rows}
    for mutant in draw(options.repository, options.count, options.seed):
        if mutant[:2] not in known:
            rows.append(caught_by(options.repository, mutant, options.limit))
            with options.out.open("a", encoding="utf-8") as out:
                out.write(json.dumps(rows[-1]) + "\n")
    missed = [row for row in rows if not row["caught"]]
    print(f"{len(rows) - len(missed)} of {len(rows)} caught")
    for row in missed:
        print(f"{row['file']}:{row['line']} {row['kind']}: {row['before']} -> {row['after']}")


if __name__ == "__main__":
    main()

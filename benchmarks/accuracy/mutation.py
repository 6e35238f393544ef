"""How many small faults the default tests catch.

``python -m benchmarks.accuracy.mutation --record LINES`` runs the default tests but those of mould and studio once
under coverage.py (``pip install coverage``, also in commands that tests start) and keeps which test runs which line.
``python -m benchmarks.accuracy.mutation --lines LINES --count 40 --seed 1 --out FILE`` then draws lines at random from
core, pad, loop and design; in each, one sign, limit or index is changed (``+`` to ``-``, ``<`` to ``>=``, a number by a
tenth, an index by one). The tests that run the line follow until one fails: of files that import the module first, then
the quickest, at last the other tests of these files (for what they share). A line outside functions runs at import: it
is seen by every test that runs a line of its module or of one that imports it. A test that fails counts only when it
passes without the change. A fault that no test sees is printed. Each line of FILE is one mutant.
"""

from __future__ import annotations

import argparse
import ast
import functools
import gc
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
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOMS = ("core", "pad", "loop", "design")
LEFT_OUT = ("tests/mold", "tests/studio")
SIGNS: dict[type[ast.operator], tuple[str, type[ast.operator]]] = {
    ast.Add: ("+", ast.Sub),
    ast.Sub: ("-", ast.Add),
    ast.Mult: ("*", ast.Div),
    ast.Div: ("/", ast.Mult),
}
LIMITS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}


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
    candidates: dict[tuple[str, int], list[tuple[str, int, str, str]]] = {}
    for room in ROOMS:
        for path in sorted((repository / "dummydesign" / room).rglob("*.py")):
            name = path.relative_to(repository).as_posix()
            for line, kind, text in mutants(path):
                candidates.setdefault((name, line), []).append((name, line, kind, text))
    chance = random.Random(seed)
    return [chance.choice(candidates[where]) for where in chance.sample(sorted(candidates), count)]


@dataclass(frozen=True)
class Lines:
    """Which tests run which line: ``ran[file][line]`` are places in ``tests``, ``seconds`` the time of each test."""

    tests: list[str]
    seconds: list[float]
    ran: dict[str, dict[str, list[int]]]

    def of(self, copy: Path, name: str, line: int) -> set[int]:
        """Tests that run the line; of a line outside functions, those that run its module or one that takes it."""
        tree = ast.parse((copy / name).read_text(encoding="utf-8"))
        inside = {
            one
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef)
            for one in range(node.body[0].lineno, 1 + (node.end_lineno or 0))
        }
        if line in inside:
            return set(self.ran.get(name, {}).get(str(line), ()))
        takers = [name, *importers(copy, name, sorted(self.ran))]
        return {one for taker in takers for ran in self.ran.get(taker, {}).values() for one in ran}

    def batches(self, copy: Path, name: str, line: int) -> Iterator[list[int]]:
        """Tests in the order in which they are tried: quick files of the module first."""
        chosen = self.of(copy, name, line)
        files: dict[str, list[int]] = {}
        for number, test in enumerate(self.tests):
            files.setdefault(test.split("::")[0], []).append(number)
        near = set(importers(copy, name, list(files)))
        cost = {file: sum(self.seconds[one] for one in places if one in chosen) for file, places in files.items()}
        batch: list[int] = []
        size_s = 10.0
        tried = [one for one in files if chosen.intersection(files[one])]
        for file in sorted(tried, key=lambda one: (one not in near, cost[one])):
            batch += [one for one in files[file] if one in chosen]
            if sum(self.seconds[one] for one in batch) > size_s:
                yield batch
                batch, size_s = [], 4.0 * size_s
        yield batch
        # what tests of a file share (fixtures, caches) is run by the first of them alone
        yield [one for file in tried or sorted(near) for one in files.get(file, ()) if one not in chosen]


def importers(copy: Path, name: str, files: list[str]) -> list[str]:
    """Those of the files that import a module."""
    module = name.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    parent, _, last = module.rpartition(".")
    taken = re.compile(rf"{re.escape(module)}\b|from {re.escape(parent)} import [^\n]*\b{last}\b")
    return [one for one in files if one != name and taken.search((copy / one).read_text(encoding="utf-8"))]


class Copy:
    """The tracked files of a repository in a folder of their own, where changes do no harm."""

    def __init__(self, repository: Path, folder: Path) -> None:
        self.folder = folder
        tracked = subprocess.run(["git", "ls-files"], cwd=repository, capture_output=True, text=True, check=True)
        for file in tracked.stdout.splitlines():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(repository / file, folder / file)

    def pytest(self, words: list[str], limit_s: float | None = None, **more: str) -> str:
        """What pytest prints; one process, the drawn examples the same each time."""
        env = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "CI": "1", **more}
        env["PYTHONPATH"] = os.pathsep.join((str(self.folder), str(Path(__file__).parent)))
        listed = self.folder.with_suffix(".args")
        listed.write_text("".join(f"{word}\n" for word in words), encoding="utf-8")
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-n",
            "0",
            "-p",
            "no:cacheprovider",
            "--no-header",
            "-rfE",
            "--tb=no",
            *(["-p", "mutation"] if more else []),
            f"@{listed}",
        ]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=limit_s, env=env)
        return done.stdout if done.returncode != 4 else f"{done.stdout}\nERROR {done.stderr.strip()[-300:]}"


def caught_by(copy: Copy, lines: Lines, mutant: tuple[str, int, str, str]) -> dict[str, object]:
    """Run the tests of a line with the change in it; which test failed first, or none."""
    name, line, kind, text = mutant
    path = copy.folder / name
    whole = path.read_text(encoding="utf-8")
    begun = time.perf_counter()
    failed, count, doubtful = "", 0, []
    for batch in lines.batches(copy.folder, name, line):
        left = list(batch)
        while left and not failed:
            limit_s = 120.0 + 10.0 * sum(lines.seconds[one] for one in left)
            path.write_text(text, encoding="utf-8")
            try:
                seen = copy.pytest(["-x", *(lines.tests[one] for one in left)], limit_s)
            except subprocess.TimeoutExpired:
                seen = f"FAILED {limit_s:.0f} s without an end"
            finally:
                path.write_text(whole, encoding="utf-8")
            rows = [one for one in seen.splitlines() if one.startswith(("FAILED", "ERROR"))]
            gone = re.search(r"not found: \S*/tree/(\S+)", rows[0]) if rows else None
            if gone:  # its name has a number of the module that was changed
                left = [one for one in left if lines.tests[one].partition("[")[0] != gone[1].partition("[")[0]]
                continue
            if not rows:
                break
            index = next((one for one in left if f" {lines.tests[one]} " in f"{rows[0]} "), None)
            if index is None or " passed" in copy.pytest([lines.tests[index]], 600.0):
                failed = rows[0]
            else:
                doubtful.append(lines.tests[index])
                left.remove(index)
        count += len(batch)
        if failed:
            break
    return {
        "file": name,
        "line": line,
        "kind": kind,
        "before": whole.splitlines()[line - 1].strip(),
        "after": text.splitlines()[line - 1].strip(),
        "caught": failed,
        "tests": count,
        "doubtful": doubtful,
        "seconds": round(time.perf_counter() - begun, 1),
    }


def record(repository: Path, out: Path) -> None:
    """Run the default tests under coverage.py and write which test runs which line, and how long each takes."""
    import coverage

    with tempfile.TemporaryDirectory(prefix="lines-") as folder:
        copy = Copy(repository, Path(folder) / "tree")
        rooms = "".join(f"    {copy.folder}/dummydesign/{room}/*\n" for room in ROOMS)
        config = Path(folder) / "coveragerc"
        config.write_text(
            f"[run]\nparallel = true\ndata_file = {folder}/data\ncontext = ${{MUTATION_TEST-}}\n"
            f"disable_warnings = no-data-collected\ninclude =\n{rooms}"
        )
        words = ["tests", *(f"--ignore={one}" for one in LEFT_OUT)]
        seen = copy.pytest(words, COVERAGE_PROCESS_START=str(config), MUTATION_SECONDS=f"{folder}/seconds.json")
        print("\n".join(seen.splitlines()[-20:]))
        seconds = json.loads(Path(folder, "seconds.json").read_text())
        tests = list(seconds)
        places = {test: number for number, test in enumerate(tests)}
        whole = coverage.CoverageData(f"{folder}/whole")
        for part in sorted(Path(folder).glob("data.*")):
            data = coverage.CoverageData(str(part))
            data.read()
            whole.update(data)
        ran: dict[str, dict[str, list[int]]] = {}
        for file in sorted(whole.measured_files()):
            contexts = whole.contexts_by_lineno(file)
            ran[Path(file).relative_to(copy.folder).as_posix()] = {
                str(line): sorted({places[one] for one in those if one in places}) for line, those in contexts.items()
            }
    out.write_text(json.dumps({"tests": tests, "seconds": list(seconds.values()), "ran": ran}), encoding="utf-8")


_begun: dict[str, float] = {}
_taken: dict[str, float] = {}
_failed: set[str] = set()


def pytest_runtest_logstart(nodeid: str) -> None:
    """As a plugin of pytest, while lines are recorded: name the test, forget what tests of other files kept."""
    import coverage

    if nodeid.split("::")[0] not in {one.split("::")[0] for one in list(_begun)[-1:]}:
        for one in gc.get_objects():
            if isinstance(one, functools._lru_cache_wrapper) and str(one.__module__).startswith("dummydesign"):
                one.cache_clear()
    os.environ["MUTATION_TEST"] = nodeid
    current = coverage.Coverage.current()
    if current is not None:
        current.switch_context(nodeid)
    _begun[nodeid] = time.perf_counter()


def pytest_runtest_logreport(report: Any) -> None:
    """Keep which tests do not pass: they show nothing."""
    if report.outcome != "passed":
        _failed.add(report.nodeid)


def pytest_runtest_logfinish(nodeid: str) -> None:
    """Keep how long the test took."""
    _taken[nodeid] = round(time.perf_counter() - _begun[nodeid], 3)


def pytest_sessionfinish() -> None:
    """Write the seconds of the tests that passed."""
    kept = {test: taken for test, taken in _taken.items() if test not in _failed}
    Path(os.environ["MUTATION_SECONDS"]).write_text(json.dumps(kept), encoding="utf-8")


def main() -> None:
    """Record lines, or draw mutants, run the tests on each and print the rate."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repository", type=Path, default=Path(__file__).resolve().parents[2])
    parser.add_argument("--record", type=Path, help="write which test runs which line, and stop")
    parser.add_argument("--lines", type=Path, help="the file of --record")
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="rows; mutants in it are not run again")
    options = parser.parse_args()
    if options.record:
        record(options.repository, options.record)
        return
    if not (options.lines and options.out):
        parser.error("--lines and --out, or --record")
    lines = Lines(**json.loads(options.lines.read_text(encoding="utf-8")))
    rows = [json.loads(line) for line in options.out.read_text().splitlines()] if options.out.exists() else []
    known = {(row["file"], row["line"]) for row in rows}
    with tempfile.TemporaryDirectory(prefix="mutant-") as folder:
        copy = Copy(options.repository, Path(folder) / "tree")
        for mutant in draw(options.repository, options.count, options.seed):
            if mutant[:2] not in known:
                rows.append(caught_by(copy, lines, mutant))
                with options.out.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(rows[-1]) + "\n")
    missed = [row for row in rows if not row["caught"]]
    print(f"{len(rows) - len(missed)} of {len(rows)} caught")
    for row in missed:
        print(f"{row['file']}:{row['line']} {row['kind']}: {row['before']} -> {row['after']}")


if __name__ == "__main__":
    main()

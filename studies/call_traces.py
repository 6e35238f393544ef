"""The ways of a design, a campaign and a slider through the modules: ``python -m studies.call_traces``.

They are written into docs/architecture.md. Each way is a run of the package that is watched: a row is the first call
of a function, indented by how deep in the package it was called; ``--words`` adds the first line of its docstring.
"""

from __future__ import annotations

import argparse
import contextlib
import inspect
import io
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

from studies.marked_page import MarkedPage

PAGE = MarkedPage(Path("docs") / "architecture.md", "<!-- ways: begin -->", "<!-- ways: end -->")
PACKAGE = Path(__file__).resolve().parents[1] / "dummydesign"
CAMPAIGN = PACKAGE.parent / "examples" / "campaign"
QUIET = ("core.", "cli.progress")
"""Modules whose calls say nothing of the way."""


@dataclass(frozen=True)
class Step:
    """A function that a way goes through, how deep in the package, and what it does in one line."""

    depth: int
    module: str
    function: str
    words: str


def watch(call: Callable[[], Any], most: int) -> tuple[list[Step], int]:
    """First calls of the package's functions, as deep as gives ``most`` rows, and the number of modules they ran in."""
    steps: dict[tuple[str, str], Step] = {}
    modules: set[str] = set()
    folder = str(PACKAGE)
    depth = 0

    def see(frame: FrameType, event: str, _: object) -> None:
        nonlocal depth
        code = frame.f_code
        if (
            not code.co_filename.startswith(folder)
            or code.co_name.startswith("<")
            or not code.co_flags & inspect.CO_OPTIMIZED
        ):
            return
        depth += (event == "call") - (event == "return")
        if event == "call":
            module = frame.f_globals["__name__"].removeprefix("dummydesign.")
            modules.add(module)
            name = code.co_name
            if not name.startswith("_") and not module.startswith(QUIET):
                steps.setdefault((module, name), Step(depth, module, name, _words(frame)))

    sys.setprofile(see)
    try:
        call()
    finally:
        sys.setprofile(None)
    deepest = max((d for d in range(1, 9) if sum(step.depth <= d for step in steps.values()) <= most), default=1)
    return [step for step in steps.values() if step.depth <= deepest], len(modules)


def _words(frame: FrameType) -> str:
    text = inspect.cleandoc(frame.f_code.co_consts[0] or "") if isinstance(frame.f_code.co_consts[0], str) else ""
    return text.splitlines()[0].rstrip(".") if text else ""


def table(steps: list[Step], words: bool) -> str:
    """Steps as lines of code, on request with what each says of itself."""
    rows = [(f"{'  ' * (step.depth - 1)}{step.module}.{step.function}", words * step.words) for step in steps]
    width = min(58, max(len(name) for name, _ in rows))
    lines = [f"{name:<{width}}  {words}".rstrip() for name, words in rows]
    return "\n".join(["```text", *(line if len(line) <= 140 else f"{line[:137]}..." for line in lines), "```", ""])


def design(folder: Path) -> None:
    """Run ``suggest --tissue forefinger --shape slab`` without mould."""
    from dummydesign import suggest

    suggest("forefinger", shape="slab", cad=False, verify=False, out=folder / "design")


def campaign(folder: Path) -> None:
    """Run ``loop`` on the example campaign."""
    from dummydesign import calibrate

    calibrate(CAMPAIGN, out=folder / "campaign")


def slider(_: Path) -> None:
    """Evaluate one pad as a slider of the studio does."""
    from dummydesign.design.pad_evaluator import PadEvaluator
    from dummydesign.design.problem import read_problem
    from dummydesign.design.request import Request
    from dummydesign.geometry.shape_registry import read_shape

    PadEvaluator(read_problem(Request(tissue="forefinger"))).evaluate(read_shape("slab"), 10.0, 15.5)


WAYS = (("a design", design), ("a campaign", campaign), ("a slider", slider))


def main(arguments: list[str] | None = None) -> None:
    """Write the ways into docs/architecture.md of the repository one stands in."""
    parser = argparse.ArgumentParser(prog="python -m studies.call_traces", description=__doc__)
    parser.add_argument("--repository", type=Path, default=Path("."), help="folder that holds docs/")
    parser.add_argument("--rows", type=int, default=12, help="functions of each way at most")
    parser.add_argument("--words", action="store_true", help="first line of each function's docstring beside it")
    options = parser.parse_args(arguments)
    PAGE.read(options.repository)
    parts = []
    with tempfile.TemporaryDirectory() as folder:
        for name, run in WAYS:
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                run(Path(folder))  # so that imports are no part of the way
                steps, count = watch(partial(run, Path(folder)), options.rows)
            parts.append(f"### The way of {name}: {count} modules\n\n{table(steps, options.words)}")
    PAGE.write(options.repository, "\n".join(parts))
    print(f"{PAGE.path}: {len(WAYS)} ways")


if __name__ == "__main__":
    main()

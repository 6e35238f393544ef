"""The ways of a design, a campaign and a slider through the modules: ``python -m studies.call_traces``.

They are written into docs/architecture.md. Each way is a run of the package that is watched: a row is the first call
of a function, indented by how deep in the package it was called; ``--words`` adds the first line of its docstring.

It also prints the forms that a question takes on its way to the answer, and how often they climb back. A *form* is a
kind of value that functions of the rooms in ``LAYERS`` are given or return and that holds, in its own fields or items,
at least three values of the question (as typed, as read, or by the names of its fields), two of the recommended pad's
shape, thickness and ratio, or another form. A class of these rooms is one form, so are ``Namespace``, lists of words
and JSON. A dict, or the arguments of one function, is told by its keys: one whose keys are all in another's is the
same form, and one that lies inside another dict is a part of it. A *climb* is a function that returns a form to a
caller in a room above its own, counted once for each function and form.
"""

from __future__ import annotations

import argparse
import contextlib
import inspect
import io
import sys
import tempfile
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, is_dataclass
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

QUESTION = {
    "hold": ("11.37", 11.37),
    "deceleration": ("31234.5", 31234.5),
    "pad": ("151x121", (151.0, 121.0)),
    "force": ("5.1,9.9,15.2", (5.1, 9.9, 15.2)),
    "velocity": ("11,240", (11.0, 240.0)),
}
"""Options of the watched question, typed and read: values that occur nowhere else."""
PAD = ("crowned:radius=2.4,height=3.5,foot=7.8", 11.0, 15.3)
"""The pad that is asked for: shape, thickness and ratio."""
MARKS = {value: option for option, values in QUESTION.items() for value in values}
NAMED = {"base": "bonded", "edge_radius_mm": 0.0, "preset": "open", "punch": "square:14", "aim": "average"}
"""Fields of the question that keep their defaults; only their names tell them."""
CORE = ("core.manifest", "core.outputs", "core.serialise")
LAYERS = ("cli", "api", "design", "design.assessment", "design.search", "design.scoring", *CORE)
"""Rooms of the way of a question, from the top down."""
MANY = 100
"""Items from which a list is data."""


def room_of(module: str) -> int:
    """Place of a module's room in ``LAYERS``; -1 elsewhere."""
    within = [n for n, room in enumerate(LAYERS) if f"{module}.".startswith(f"dummydesign.{room}.")]
    return max(within, key=lambda n: len(LAYERS[n]), default=-1)


class Forms:
    """Watches a run of ``suggest``: its forms, where each was first seen, and its climbs."""

    def __init__(self, pad: tuple[str, float, float]) -> None:
        self.pad, self.first, self.climbs = pad, dict[Hashable, str](), set[tuple[str, Hashable]]()
        self.parts, self.known = set[frozenset[str]](), dict[int, tuple[Any, Hashable]]()

    def see(self, frame: FrameType, event: str, result: Any) -> None:
        """Take what a function of these rooms is given or returns."""
        room, name = room_of(module := _module(frame)), frame.f_code.co_qualname
        if event not in ("call", "return") or room < 0 or name.endswith("__init__"):  # not yet filled
            return
        name = name.partition(".<locals>")[0]  # a comprehension is part of its function
        where, given = f"{module.removeprefix('dummydesign.')}.{name}", list(frame.f_locals.values())
        if event == "call" and len({_mark(value) for value in given} - {None}) >= 3:
            self.first.setdefault(frozenset(frame.f_locals), where)
        caller = frame.f_back
        while caller and not _is_of_a_room_above_core(caller):  # a wrapper hands on what it is given
            caller = caller.f_back
        for form in (form for value in (given if event == "call" else [result]) for form in self._within(value)):
            self.first.setdefault(form, where)
            if event == "return" and caller and 0 <= room_of(_module(caller)) < room:
                self.climbs.add((where, form if isinstance(form, str) else "dict"))

    def form_of(self, value: Any) -> Hashable:
        """The form that a value is; None for one that is none."""
        if isinstance(value, str):
            return "JSON" if value[:1] == "{" and all(typed in value for typed in ("11.37", "31234.5")) else None
        if id(value) not in self.known or isinstance(value, dict):
            self.known[id(value)] = value, None  # it may hold itself
            self.known[id(value)] = value, self._told(value)
        return self.known[id(value)][1]

    def _told(self, value: Any) -> Hashable:
        own = _items(value)
        held = [form for item in own.values() if not isinstance(item, str) for form in self._within(item)]
        plain = {key: item for key, item in own.items() if isinstance(item, str | float) or hasattr(item, "parameters")}
        marks = {_mark(item) for item in own.values()} | {key for key in plain if NAMED.get(key) == plain[key]}
        of_pad = {str(item) for item in plain.values()} & {str(one) for one in self.pad}
        if len(marks - {None}) < 3 and len(of_pad) < 2 and not held:
            return None
        if isinstance(value, dict):
            self.parts |= {form for form in held if isinstance(form, frozenset)}
            return frozenset(map(str, value))
        if isinstance(value, list | tuple):
            return "words" if len(marks - {None}) >= 3 else None
        return (
            type(value).__name__ if room_of(type(value).__module__) >= 0 or type(value) is argparse.Namespace else None
        )

    def _within(self, item: Any) -> Iterable[Hashable]:
        several = (
            item if isinstance(item, list | tuple) and not (item and isinstance(item[0], str | float)) else (item,)
        )
        return filter(None, map(self.form_of, several[:MANY]))

    def count(self) -> list[str]:
        """Names of the forms, in the order in which they were first seen, each with its place."""
        dicts = [form for form in self.first if isinstance(form, frozenset)]
        outer = [form for form in dicts if form not in self.parts and not any(form < other for other in dicts)]
        return [
            f"{'dict' if isinstance(form, frozenset) else form} ({where})"
            for form, where in self.first.items()
            if isinstance(form, str) or form in outer
        ]


def _module(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__"))


def _is_of_a_room_above_core(frame: FrameType) -> bool:
    return _module(frame).startswith("dummydesign.") and not _module(frame).startswith("dummydesign.core.")


def _mark(value: Any) -> str | None:
    """The option of the question that a value is of, as typed or read."""
    value = tuple(value) if isinstance(value, list) and len(value) < 4 else value
    return MARKS.get(value) if isinstance(value, str | float | int | tuple) and _hashes(value) else None


def _hashes(value: Any) -> bool:
    return not isinstance(value, tuple) or all(isinstance(one, str | float | int) for one in value)


def _items(value: Any) -> dict[str, Any]:
    """Own fields or items of a value, by name."""
    if isinstance(value, dict):
        return {str(key): item for key, item in value.items()}
    if isinstance(value, list | tuple):
        return {str(n): item for n, item in enumerate(value)} if len(value) < MANY else {}
    named = isinstance(value, argparse.Namespace) or (is_dataclass(value) and not isinstance(value, type))
    return dict(getattr(value, "__dict__", {})) if named else {}


def watch_forms(folder: Path) -> Forms:
    """Ask ``suggest`` on the command line for one pad of the palm, and watch."""
    from dummydesign.cli.entry import run
    from dummydesign.geometry.shape_registry import read_shape

    shape, thickness, ratio = PAD
    words = ["suggest", "--tissue", "palm", "--shape", shape, "--no-cad", "--no-verify", "--json"]
    words += ["--thickness", f"{thickness:g}:{thickness:g}", "--ratio", f"{ratio:g}:{ratio:g}"]
    words += [word for option, (typed, _) in QUESTION.items() for word in (f"--{option}", typed)]
    forms = Forms((str(read_shape(shape)), thickness, ratio))
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        sys.setprofile(forms.see)
        try:
            run([*words, "--out", str(folder / "forms")])
        finally:
            sys.setprofile(None)
    return forms


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
        forms = watch_forms(Path(folder))
    PAGE.write(options.repository, "\n".join(parts))
    print(f"{PAGE.path}: {len(WAYS)} ways")
    print(f"from question to answer: {len(forms.count())} forms, {len(forms.climbs)} climbs back")
    if options.words:
        print("\n".join([*forms.count(), *sorted(f"climb: {form} from {where}" for where, form in forms.climbs)]))


if __name__ == "__main__":
    main()

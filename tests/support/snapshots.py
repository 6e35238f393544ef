"""About thirty whole answers as people see them: ``python -m tests.support.snapshots`` renews ``tests/snapshots``.

Words may change with any commit: renew, and read what changed with ``git diff``. Numbers are compared to 1e-3, since
other machines round otherwise.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from dummydesign.cli.entry import _render_of
from tests.support.answer_inputs import make_inputs

RENDER_OF = _render_of
DETAILS = "\n==== --details\n"
FOLDER = Path(__file__).resolve().parents[1] / "snapshots"
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w]|\.\d)")
SUGGEST = "suggest --tissue forefinger --shape slab --no-cad --no-verify"
CASES = {
    "help": "--help",
    "suggest-help": "suggest --help",
    "resins-list": "resins list",
    "resins-show": "resins show ecoflex-00-30",
    "tissues-list": "tissues list",
    "tissues-show": "tissues show palm",
    "predict-depth": "predict --young 25 --thickness 7 --depth 0.5,1,2",
    "predict-press": "predict --young 25 --thickness 5 --force 12 --velocity 250 --hold 2 --prony 0.08:0.4,2:0.2",
    "predict-shape": "predict --young 25 --thickness 10 --depth 0.5,2,4 --shape crowned:10,2",
    "predict-mass": "predict --ratio 15.4 --thickness 8 --drive mass:0.3 --velocity 150 --out hit.csv",
    "predict-bottoms": "predict --ratio 15.4 --thickness 8 --drive mass:5 --velocity 250",
    "fit": "fit in/press_0.csv in/press_1.csv in/press_2.csv in/press_3.csv --out tissue.toml",
    "compare": "compare in/press_0.csv in/press_1.csv in/press_2.csv in/press_3.csv --tissue forefinger --out compared",
    "on-person": "on-person in/press_0.csv in/press_2.csv --tissue forefinger --drive steady --out people",
    "suggest": f"{SUGGEST} --out slab",
    "suggest-details": f"{SUGGEST} --out slab --details --replace",
    "suggest-crowned": "suggest --tissue forefinger --shape crowned --no-cad --no-verify --out crowned",
    "suggest-palm": "suggest --tissue palm --shape slab --no-cad --no-verify --out palm",
    "suggest-none": f"{SUGGEST} --thickness 28:30 --ratio 14:14.2 --out none",
    "whatif": "whatif --thickness 4:20:4 --ratio 14,15.5,17 --out study",
    "import": "import in/press_0.csv --out traces",
    "campaign-new": "campaign new planned --young 25",
    "campaign-check": "campaign check planned",
    "loop": "loop in/campaign --out learned",
    "replay": "replay in/campaign --calibration learned/calibration.json",
    "tissues-add-points": "tissues add-points palm in/points.csv",
    "resins-add": "resins add in/batch.toml",
    "resins-add-compression": "resins add-compression in/puck.csv --diameter 50 --height 30 --name pucks --ratio 15",
    "init": "init project",
    "status": "status project",
    "error-command": "sugest",
    "error-tissue": "suggest --tissue forefingr",
    "error-depth": "predict --young 25 --thickness 5 --depth 4",
    "error-trace": "fit in/broken.csv",
}
LONG = (
    "fit",
    "compare",
    "on-person",
    "suggest",
    "suggest-details",
    "suggest-crowned",
    "suggest-palm",
    "suggest-none",
    "whatif",
    "loop",
    "replay",
    "tissues-add-points",
)
"""Cases of seconds, and the one that changes a tissue: they come after all others."""


def answers(folder: Path, cases: Sequence[str] = tuple(CASES)) -> Iterator[tuple[str, str]]:
    """Name and whole answer of each case, in order: later ones read what earlier ones wrote."""
    from unittest import mock

    from dummydesign import cli
    from dummydesign.cli import entry

    if not (folder / "in").exists():
        make_inputs(folder / "in")
    for name in cases:
        words = CASES[name]
        out, err = io.StringIO(), io.StringIO()
        whole: list[str] = []

        def both(module: Any, options: Any, whole: list[str] = whole) -> Any:
            def screen(result: dict[str, Any]) -> str:
                if hasattr(module, "render_details") and not getattr(options, "details", False):
                    whole.append(module.render_details(result))
                return RENDER_OF(module, options)(result)

            return screen

        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            contextlib.chdir(folder),
            mock.patch.object(entry, "_render_of", both),
        ):
            try:
                status = cli.run([*words.split(), *([] if "help" in name else ["-q"])])
            except SystemExit as end:
                status = int(end.code or 0)
        text = f"$ dummydesign {words}\n{out.getvalue()}{err.getvalue()}status {status}\n"
        if whole and whole[0].strip() not in text:
            text += f"{DETAILS}{whole[0].rstrip()}\n"
        yield name, settled(text.replace(str(folder), "FOLDER").replace(os.environ["DUMMYDESIGN_HOME"], "HOME"))


def settled(text: str) -> str:
    """The text without what changes from day to day."""
    text = re.sub(r"\b\d{4}-\d{2}-\d{2}(?:[T ]\d{2}:\d{2}(?::\d{2})?)?\b", "DATE", text)
    text = re.sub(r"\b\d+ in \d+\.\d\d s;", "N in SECONDS s;", text)
    return re.sub(r"\bdesigns in \S+ s\b", "designs in SECONDS s", text)


def differs(before: str, after: str) -> str:
    """The first line that differs, both ways; empty when none does but by the last digits of numbers."""
    one, other = before.splitlines(), after.splitlines()
    for left, right in zip(one, other):
        numbers = [[float(x) for x in NUMBER.findall(line)] for line in (left, right)]
        close = len(numbers[0]) == len(numbers[1]) and all(
            abs(a - b) <= 1e-3 * max(abs(a), abs(b), 1e-9) for a, b in zip(*numbers)
        )
        if left != right and not (close and NUMBER.sub("#", left).split() == NUMBER.sub("#", right).split()):
            return f"- {left}\n+ {right}"
    return "" if len(one) == len(other) else f"{len(one)} lines, now {len(other)}"


def main() -> None:
    """Write all answers anew."""
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="snapshots-") as place:
        os.environ.update(DUMMYDESIGN_HOME=str(Path(place) / "home"), DUMMYDESIGN_CACHE="off")
        folder = (Path(place) / "work").resolve()
        folder.mkdir()
        for name, text in answers(folder):
            path = FOLDER / f"{name}.txt"
            old = path.read_text(encoding="utf-8") if path.exists() else ""
            if differs(old, text):
                path.write_text(text, encoding="utf-8")
                print(f"{name}: renewed", file=sys.stderr)
    for path in FOLDER.glob("*.txt"):
        if path.stem not in CASES:
            path.unlink()


if __name__ == "__main__":
    main()

"""A walk: command lines are typed one after the other in one folder with an empty home, the lab presses between them.

``python -W error -m tests.support.walk [PAGE...]`` walks README and all pages, or some, and prints lines and faults.
"""

from __future__ import annotations

import contextlib
import glob
import io
import json
import os
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from unittest import mock

from tests.support.typed_lines import (
    ROOT,
    TypedLine,
    complaints,
    filled,
    lines_of_answer,
    lines_of_page,
    lines_of_screen,
    names_made,
    parser_of,
)
from tests.support.walk_lab import supply

BAD_WORDS = re.compile(r"internal error|Traceback|did you mean|\bnan\b|\binf\b")
SERVES = ("studio", "completion", "doctor")
LONG = ("suggest", "loop", "replay", "mold")
"""Commands that wait or tell of the machine, and those that take a minute."""
OTHER_TEST = "from-machine-to-design.md"
"""Its commands and their answers: ``tests/cli/test_walkthrough.py``."""


@dataclass(frozen=True)
class Answer:
    """What a typed line printed, its exit status and JSON."""

    line: TypedLine
    status: int
    screen: str
    told: dict[str, Any]
    seconds: float
    faults: list[str] = field(default_factory=list)

    @property
    def following(self) -> list[TypedLine]:
        """Command lines that the answer names: on its screen, then as ``next`` in its JSON."""
        where = f"after '{self.line.text}'"
        lines = [*lines_of_screen(self.screen, where), *lines_of_answer(self.told.get("next"), where)]
        # what a project adds (its tissue) is not printed
        return [replace(line, whole=False) for line in lines] if self.line.words[0] == "status" else lines


class Walk:
    """One folder, its home, and what was typed there."""

    def __init__(self, folder: Path, log: bool = False) -> None:
        self.folder, self.log = folder, log
        self.answers: list[Answer] = []
        self.typed: set[str] = set()
        self.forms: set[str] = set()
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copytree(ROOT / "examples", folder / "examples")

    def go(self, line: TypedLine) -> Answer | None:
        """Type a line as it is printed; None if the same was typed before."""
        if asked(line) in self.typed:
            return None
        words = filled(line.words)[0]
        self._each_subject(words)
        supply(self.folder, words)
        self.typed.add(asked(line))
        self.forms.add(form(line))
        return self._run(line, words)

    def _each_subject(self, words: list[str]) -> None:
        """Fit the other subjects too: the page shows one."""
        shown = [one.line for one in self.answers if one.line.words[0] == "fit"]
        for word in words if words[:2] == ["tissues", "add"] else ():
            if shown and word.endswith(".toml") and not (self.folder / word).exists():
                name = Path(shown[-1].words[-1]).stem
                self.go(TypedLine(shown[-1].where, shown[-1].text.replace(name, Path(word).stem)))

    def _run(self, line: TypedLine, words: list[str]) -> Answer:
        from dummydesign import cli
        from dummydesign.cli import entry
        from dummydesign.core.serialise import json_text

        told: dict[str, Any] = {}
        render_of = entry._render_of

        def both(module: Any, options: Any) -> Any:
            def screen(result: dict[str, Any]) -> str:
                told.update(json.loads(json_text(words[0], result)))
                return str(render_of(module, options)(result))

            return screen

        out, err, begun = io.StringIO(), io.StringIO(), time.monotonic()
        streams = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
        # the page on projects goes into the folder that it has made
        made = (
            [one.line.words[1] for one in self.answers if one.line.words[0] == "init"] if words[0] == "status" else []
        )
        where = self.folder / (made[-1] if made else "")
        with streams[0], streams[1], contextlib.chdir(where), mock.patch.object(entry, "_render_of", both):
            whole = [path for word in words for path in (sorted(glob.glob(word)) or [word])]
            status = cli.run(whole)
        text = out.getvalue() + err.getvalue()
        answer = Answer(line, status, out.getvalue(), told, time.monotonic() - begun)
        answer.faults.extend(self._faults(answer, text))
        self.answers.append(answer)
        if self.log:
            print(f"{answer.status} {answer.seconds:6.1f} s  {line.where}: {line.text}", flush=True)
            print(*(f"            {fault}\n" for fault in answer.faults), end="", sep="", flush=True)
        return answer

    def _faults(self, answer: Answer, text: str) -> Iterator[str]:
        """Why the line is no good: status, words of a failure, files that are not there, commands that do not parse."""
        what = f"{answer.line.where}: {answer.line.text}"
        problem = next((line for line in text.splitlines() if line.startswith("error: ")), "")
        if answer.status not in (0, 1) or (answer.status == 1 and not answer.told):
            yield f"{what}: status {answer.status}: {problem}"
        if bad := BAD_WORDS.search(text):
            yield f"{what}: prints '{bad[0]}'"
        files = answer.told.get("files", {})
        for path in files.values() if isinstance(files, dict) else ():
            if isinstance(path, str) and not (self.folder / path).exists():
                yield f"{what}: file '{path}' is not there"
        made = names_made([one.line for one in self.answers] + [answer.line, *answer.following])
        for line in answer.following:
            yield from complaints(line, made)

    def read_me(self) -> None:
        """Type README's blocks in order, and what each answer names unless that kind was typed or README will."""
        lines = [
            line for line in lines_of_page((ROOT / "README.md").read_text(encoding="utf-8"), "README") if line.whole
        ]
        ahead = {form(line) for line in lines}
        for line in lines:
            if line.words[0] not in SERVES and (answer := self.go(line)):
                self._follow(answer, ahead)

    def _follow(self, answer: Answer, ahead: set[str]) -> None:
        for line in answer.following:
            if line.whole and form(line) not in self.forms | ahead:
                self.go(line)

    def page(self, path: Path) -> None:
        """Type those lines of a page that need no more than what lies here, and take seconds."""
        lines = lines_of_page(path.read_text(encoding="utf-8"), path.name) if path.name != OTHER_TEST else []
        for line in lines:
            if line.whole and quick(line, self.folder):
                self.go(line)

    @property
    def faults(self) -> list[str]:
        """All faults in order."""
        return [fault for answer in self.answers for fault in answer.faults]


def asked(line: TypedLine) -> str:
    """What a line asks, whatever the order of its options."""
    words = filled(line.words)[0]
    return repr(sorted(vars(parser_of(words[0]).parse_args(words[1:])).items(), key=str)) + words[0]


def form(line: TypedLine) -> str:
    """Command, action and options of a line, without their values; a mass is weighed where there is a balance."""
    words = line.words
    action = [word for word in words[1:2] if re.fullmatch(r"add\S*|new|check|from-files|record|list|show", word)]
    return " ".join([words[0], *action, *sorted(word for word in words if word.startswith("--") and word != "--mass")])


def quick(line: TypedLine, folder: Path) -> bool:
    """Whether a line takes seconds and needs nothing that neither the lab nor a line before it makes."""
    words = line.words
    folders = words[1:3] if words[0] == "compare-designs" else []
    folders += [one for flag, word in pairwise(words) if flag == "--from-mould" for one in word.split(",")]
    here = all((folder / word).exists() for word in folders)
    # names of the pads' files are the reader's, a template is no line to type
    theirs = words[:2] == ["campaign", "from-files"] or {"NAME", "..."} & set(words)
    return here and not theirs and words[0] not in (*SERVES, *LONG)


def main() -> None:
    """Walk README and the pages (or the pages that are named), and print what was typed."""
    with tempfile.TemporaryDirectory() as scratch:
        os.environ |= {"DUMMYDESIGN_HOME": f"{scratch}/home", "DUMMYDESIGN_CACHE": f"{scratch}/cache"}
        walk = Walk(Path(scratch) / "work", log=True)
        if not sys.argv[1:]:
            walk.read_me()
        for page in sorted((ROOT / "docs").glob("*.md")):
            if not sys.argv[1:] or page.stem in sys.argv[1:]:
                walk.page(page)


if __name__ == "__main__":
    sys.exit(main())

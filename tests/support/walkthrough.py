"""Run the commands of docs/from-machine-to-design.md; ``python -m tests.support.walkthrough`` renews its answers.

A block of the page is a command and its answer. A line ``...`` leaves out lines, an end `` ...`` the rest of a line.
Renewing keeps as many lines before and after ``...`` as the page has.
"""

from __future__ import annotations

import contextlib
import glob
import io
import os
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.support import walkthrough_files
from tests.support.snapshots import differs, settled

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "from-machine-to-design.md"
BLOCK = re.compile(
    r"^```(?:text|sh)\n(?:\$ )?dummydesign (?P<words>.+)\n(?P<answer>(?:(?!```).*\n)*)```$", re.MULTILINE
)
WIDTH = 150
"""Longer lines are cut on the page."""


@dataclass(frozen=True)
class Block:
    """A command of the page, its answer there, and where the answer lies in the text."""

    words: str
    answer: str
    begin: int
    end: int

    @property
    def shown(self) -> bool:
        """Whether the page shows an answer."""
        return bool(self.answer)


def blocks(text: str) -> list[Block]:
    """Commands of the page in order."""
    return [Block(m["words"], m["answer"], m.start("answer"), m.end("answer")) for m in BLOCK.finditer(text)]


def run_blocks(folder: Path, page: list[Block]) -> Iterator[tuple[Block, str]]:
    """Run every command in an empty folder; yield its block and the whole answer."""
    from dummydesign import cli

    walkthrough_files.write(folder)
    shutil.copytree(ROOT / "examples" / "campaign", folder / "examples" / "campaign")
    for block in page:
        stream = io.StringIO()
        with contextlib.redirect_stdout(stream), contextlib.redirect_stderr(stream), contextlib.chdir(folder):
            words = [path for word in shlex.split(block.words) for path in (sorted(glob.glob(word)) or [word])]
            try:
                cli.run([*words, "-q"])
            except SystemExit:
                pass
        home = os.environ["DUMMYDESIGN_HOME"]
        text = stream.getvalue().replace(home, "~/.local/share/dummydesign").replace(f"{folder}/", "")
        yield block, settled(text)


def shorten(block: Block, answer: str) -> str:
    """The answer with the lines left out that the page leaves out."""
    lines = [line if len(line) <= WIDTH else f"{line[: WIDTH - 4]} ..." for line in answer.rstrip().splitlines()]
    kept = block.answer.splitlines()
    if "..." in kept:
        head = kept.index("...")
        tail = len(kept) - head - 1
        lines = [*lines[:head], "...", *lines[len(lines) - tail :]] if head + tail < len(lines) else lines
    return "\n".join(lines) + "\n"


def fault(block: Block, answer: str) -> str:
    """The first line of the page that the program does not print; empty when all agree but in last digits."""
    return differs(block.answer, shorten(block, answer))


def main() -> None:
    """Renew the blocks of the page."""
    with tempfile.TemporaryDirectory() as scratch:
        os.environ |= {"DUMMYDESIGN_HOME": f"{scratch}/home", "COLUMNS": "100"}
        text = PAGE.read_text(encoding="utf-8")
        new = [(b, shorten(b, answer)) for b, answer in run_blocks(Path(scratch) / "walk", blocks(text)) if b.shown]
    for block, answer in reversed(new):
        text = text[: block.begin] + answer + text[block.end :]
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())

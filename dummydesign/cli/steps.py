"""Steps of a long command on the terminal: which, how many, how long it will still take."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO

from dummydesign.core.outputs.progress import tell


class Steps:
    """Shows one line on a terminal, which each step overwrites; nothing anywhere else.

    How many steps there will be is not known before the end: ``about`` is where the count starts from, and it grows
    when more come. The time left is that of the steps so far, carried on.

    Parameters
    ----------
    about : int
        Steps that a usual run takes.
    stream : file, optional
        Standard error by default.
    clock : callable, optional
        Seconds.
    """

    def __init__(
        self, about: int, stream: TextIO | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._about, self._stream, self._clock = about, stream or sys.stderr, clock
        self._done, self._start = 0, clock()

    def __call__(self, word: str) -> None:
        """Begin a step."""
        self._done += 1
        if self._done >= self._about:
            self._about = self._done + 2
        finished, left = self._done - 1, self._about - self._done + 1
        rest = ""
        if finished:
            seconds = (self._clock() - self._start) / finished * left
            rest = f", about {seconds:.0f} s left" if seconds < 90 else f", about {seconds / 60:.0f} min left"
        text = f"step {self._done} of about {self._about}: {word.replace('_', ' ')}{rest}"
        tell(text)
        if self._stream.isatty():
            print(f"\r\033[K{text}", end="", file=self._stream, flush=True)

    def clear(self) -> None:
        """Leave the terminal's line empty."""
        if self._stream.isatty():
            print("\r\033[K", end="", file=self._stream, flush=True)

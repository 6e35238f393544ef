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


class Count:
    """Shows on a terminal how many of a known number are done and how long the rest will take; nothing elsewhere.

    Parameters
    ----------
    of : str
        What is counted.
    stream : file, optional
        Standard error by default.
    clock : callable, optional
        Seconds.
    """

    def __init__(self, of: str, stream: TextIO | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self._of, self._stream, self._clock = of, stream or sys.stderr, clock
        self._start, self._first = clock(), -1

    def __call__(self, done: int, total: int) -> None:
        """Say that so many are done."""
        if self._first < 0:
            self._first, self._start = done, self._clock()
        if not self._stream.isatty():
            return
        rest = ""
        if done > self._first:
            # what an earlier run left does not make this one faster
            seconds = (self._clock() - self._start) / (done - self._first) * (total - done)
            rest = f", about {seconds:.0f} s left" if seconds < 90 else f", about {seconds / 60:.0f} min left"
        print(f"\r\033[K{done} of {total} {self._of}{rest}", end="", file=self._stream, flush=True)

    def clear(self) -> None:
        """Leave the terminal's line empty."""
        if self._stream.isatty():
            print("\r\033[K", end="", file=self._stream, flush=True)

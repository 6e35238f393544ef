"""Steps of a long command on the terminal: which, how many, how long it will still take."""

from __future__ import annotations

import os
import re
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TextIO

from dummydesign.core.progress import VARIABLE, write_progress

Clock = Callable[[], float]
loudness: ContextVar[str] = ContextVar("loudness", default="")
"""How much to print: ``verbose`` (a line for each step, on any stream), ``quiet`` (nothing), else a terminal's line."""


def say(text: str) -> None:
    """A line on standard error, in verbose mode."""
    if loudness.get() == "verbose":
        print(text, file=sys.stderr, flush=True)


@contextmanager
def timed() -> Iterator[None]:
    """Say at the end what the work took by the clock and of the processor, child processes included."""
    start, spent = time.monotonic(), _processor_s()
    try:
        yield
    finally:
        say(f"{time.monotonic() - start:7.1f} s  done, {_processor_s() - spent:.1f} s of the processor")


def _processor_s() -> float:
    """Processor time of this process and of its children that ended. [s]"""
    return sum(os.times()[:4])


class _Shown:
    """A line on a stream: overwritten on a terminal, one below the other in verbose mode.

    The loudness is that of the moment it is made.
    """

    def __init__(self, stream: TextIO | None = None, clock: Clock = time.monotonic) -> None:
        self._stream, self._clock, self._loudness = stream or sys.stderr, clock, loudness.get()
        self._start = clock()

    @property
    def active(self) -> bool:
        """Whether anything is shown."""
        return self._loudness == "verbose" or (self._loudness != "quiet" and self._stream.isatty())

    def line(self, text: str) -> None:
        """Show it."""
        if self._loudness == "verbose":
            print(f"{self._clock() - self._start:7.1f} s  {text}", file=self._stream, flush=True)
        elif self.active:
            print(f"\r\033[K{text}", end="", file=self._stream, flush=True)

    def clear(self) -> None:
        """Leave the terminal's line empty."""
        if self.active and self._loudness != "verbose":
            print("\r\033[K", end="", file=self._stream, flush=True)


def _left(seconds: float) -> str:
    return f", about {seconds:.0f} s left" if seconds < 90 else f", about {seconds / 60:.0f} min left"


class Watch(_Shown):
    """Shows while it is open what another process tells of its steps (``step 2 of 5: ...``), with the time left."""

    def __init__(self, stream: TextIO | None = None, clock: Clock = time.monotonic) -> None:
        super().__init__(stream, clock)
        self._ended, self._seen = threading.Event(), ""

    def __enter__(self) -> Watch:
        self._thread: threading.Thread | None = None
        # someone else watches: the line is for them
        if self.active and not os.environ.get(VARIABLE):
            from tempfile import TemporaryDirectory

            self._folder = TemporaryDirectory(prefix="dummydesign-")
            self._path = os.path.join(self._folder.name, "progress")
            os.environ[VARIABLE] = self._path
            self._thread = threading.Thread(target=self._watch, daemon=True)
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._thread is not None:
            del os.environ[VARIABLE]
            self._ended.set()
            self._thread.join()
            self._refresh()
            self._folder.cleanup()
            self.clear()

    def _watch(self) -> None:
        while not self._ended.wait(0.1):
            self._refresh()

    def _refresh(self) -> None:
        try:
            with open(self._path, encoding="utf-8") as stream:
                text = stream.read()
        except OSError:
            return
        if text and text != self._seen:
            self._seen = text
            step = re.match(r"step (\d+) of (\d+)", text)
            done = int(step[1]) - 1 if step else 0
            rest = _left((self._clock() - self._start) / done * (int(step[2]) - done)) if step and done else ""
            self.line(text + rest)


class Steps(_Shown):
    """Shows one line on a terminal, which each step overwrites; nothing anywhere else.

    How many steps there will be is not known before the end: ``about`` is where the count starts from, and it grows
    when more come. The time left is that of the steps so far, extrapolated.
    """

    def __init__(self, about: int, stream: TextIO | None = None, clock: Clock = time.monotonic) -> None:
        super().__init__(stream, clock)
        self._about, self._done = about, 0

    def __call__(self, word: str) -> None:
        """Begin a step."""
        self._done += 1
        if self._done >= self._about:
            self._about = self._done + 2
        finished, left = self._done - 1, self._about - self._done + 1
        rest = _left((self._clock() - self._start) / finished * left) if finished else ""
        text = f"step {self._done} of about {self._about}: {word.replace('_', ' ')}{rest}"
        write_progress(text)
        self.line(text)


@contextmanager
def steps_shown(about: int) -> Iterator[Steps]:
    """Steps of a command, whose line is cleared at its end, however it ends."""
    steps = Steps(about)
    try:
        yield steps
    finally:
        steps.clear()


class Count(_Shown):
    """Shows on a terminal how many of a known number are done and how long the rest will take; nothing elsewhere."""

    def __init__(self, of: str, stream: TextIO | None = None, clock: Clock = time.monotonic) -> None:
        super().__init__(stream, clock)
        self._of, self._first, self._first_s = of, -1, clock()

    def __call__(self, done: int, total: int) -> None:
        """Say that so many are done."""
        if self._first < 0:
            self._first, self._first_s = done, self._clock()
        # what an earlier run left does not make this one faster
        new, spent = done - self._first, self._clock() - self._first_s
        self.line(f"{done} of {total} {self._of}{_left(spent / new * (total - done)) if new > 0 else ''}")

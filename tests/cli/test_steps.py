"""Steps on the terminal: counted, with the time left, on a terminal only."""

from __future__ import annotations

import io

from dummydesign.cli.progress import Steps


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def shown(stream):
    return stream.getvalue().split("\r\033[K")[1:]


def test_steps_are_counted_with_the_time_that_is_left():
    now, stream = [0.0], Terminal()
    steps = Steps(4, stream, lambda: now[0])
    for word in ("base", "contact_offset", "remainder"):
        steps(word)
        now[0] += 10.0
    steps.clear()
    assert shown(stream) == [
        "step 1 of about 4: base",
        "step 2 of about 4: contact offset, about 30 s left",
        "step 3 of about 4: remainder, about 20 s left",
        "",
    ]


def test_more_steps_than_expected_raise_the_count_and_minutes_are_minutes():
    now, stream = [0.0], Terminal()
    steps = Steps(2, stream, lambda: now[0])
    for _ in range(3):
        steps("more")
        now[0] += 120.0
    assert shown(stream)[1] == "step 2 of about 4: more, about 6 min left"
    assert shown(stream)[2].startswith("step 3 of about 4")


def test_nothing_is_shown_where_there_is_no_terminal():
    stream = io.StringIO()
    steps = Steps(3, stream)
    steps("base")
    steps.clear()
    assert stream.getvalue() == ""

"""What holds of every command and every action: examples, helps, choices with their meaning, -v and -q."""

from __future__ import annotations

import argparse
import io
import json
import os
import re
import sys
import time

import pytest

from dummydesign import cli
from dummydesign.cli import entry
from dummydesign.cli.entry import meanings_of, parser_of, table_of
from dummydesign.cli.progress import Count, Steps, Watch, loudness
from dummydesign.core.progress import VARIABLE, write_progress


def below(parser, name):
    yield name, parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for word, one in action.choices.items():
                yield from below(one, f"{name} {word}")


ALL = [pair for command in cli.COMMANDS for pair in below(parser_of(command), command)]
NAMES = [name for name, _ in ALL]
EXAMPLES = table_of("help")["examples"]


@pytest.fixture(params=ALL, ids=NAMES)
def asked(request):
    return request.param


def test_the_help_ends_with_two_examples_that_the_command_understands(asked):
    name, parser = asked
    text = parser.format_help()
    assert len(EXAMPLES[name]) >= 2
    for _, words in EXAMPLES[name]:
        assert words.startswith(name) and f"dummydesign {words}" in text
        parser_of(words.split()[0]).parse_args(words.split()[1:])


def test_every_option_says_what_it_is(asked):
    _, parser = asked
    silent = [action.option_strings or action.dest for action in parser._actions if not action.help]
    assert silent == []


def test_every_word_that_can_be_chosen_is_explained(asked):
    """Options whose help lists words, one of them marked as the default."""
    name, parser = asked
    text = " ".join(parser.format_help().split())
    for action in parser._actions:
        listed = re.findall(r"(?<![\w:.-])([a-z][\w-]*(?::[\w.,]+)?)(?= \(default\))", action.help or "")
        if not listed or (name == "fit" and action.dest == "elements"):
            continue
        told = meanings_of(name, action)
        assert set(listed) <= set(told), (action.dest, listed)
        rest = action.help.partition(listed[0])[2].removeprefix(" (default)").partition(";")[0].partition(" (")[0]
        for word in re.split(r",\s+| or ", rest.strip(" ,:")):
            word = word.strip()
            if re.fullmatch(r"[a-z0-9][\w-]*(:\S+)?", word) and ":" not in rest[:1]:
                known = any(word == one or word.split(":")[0] == one.split(":")[0] for one in told)
                assert known, (name, action.dest, word)
        for word, meaning in told.items():
            assert f"{word} {meaning}" in text, (name, word)


def test_no_meaning_is_left_that_no_command_shows():
    used = {word for name, parser in ALL for action in parser._actions for word in meanings_of(name, action)}
    assert {word for words in table_of("help")["choices"].values() for word in words} <= used


def test_json_verbose_and_quiet_are_options_of_each_before_and_after_the_action(asked):
    name, parser = asked
    flags = {word for action in parser._actions for word in action.option_strings}
    assert {"--json", "-v", "--verbose", "-q", "--quiet"} <= flags
    words = EXAMPLES[name][0][1].split()
    for flag in ("-v", "-q", "--json"):
        options = vars(parser_of(words[0]).parse_args([*words[1:], flag]))
        assert options[{"-v": "verbose", "-q": "quiet", "--json": "json"}[flag]] is True


def test_a_flag_before_the_action_is_not_taken_back_by_the_action():
    assert parser_of("tissues").parse_args(["-v", "list"]).verbose is True


PREDICT = ["predict", "--young", "25", "--thickness", "5", "--depth", "1"]


def test_verbose_tells_what_it_took_on_standard_error_and_leaves_the_answer_alone(capsys):
    assert cli.run(PREDICT) == 0
    plain = capsys.readouterr()
    assert cli.run([*PREDICT, "-v"]) == 0
    told = capsys.readouterr()
    assert told.out == plain.out and plain.err == ""
    assert re.fullmatch(r" +\d+\.\d s  done, \d+\.\d s of the processor\n", told.err)
    assert cli.run(PREDICT) == 0 and capsys.readouterr().err == ""


def test_verbose_and_quiet_at_once_are_refused_in_one_line(capsys):
    assert cli.run([*PREDICT, "-v", "-q"]) == 2
    assert capsys.readouterr().err == "error: --verbose and --quiet: the one or the other\n"


@pytest.mark.slow
def test_an_option_typed_twice_is_told_and_its_last_value_counts(capsys):
    words = ["predict", "--young", "25", "--thickness", "5", "--depth", "1", "--json"]
    assert cli.run([*words, "--thickness=7", "--quiet", "--quiet"]) == 0
    answer = json.loads(capsys.readouterr().out)
    told = [one["message"] for one in answer["warnings"] if one["code"] == "option_repeated"]
    assert len(told) == 1 and told[0].startswith("--thickness ") and answer["inputs"]["thickness_mm"] == 7.0
    capsys.readouterr()
    twice = ["suggest", "--tissue", "palm", "--shape", "slab", "--no-cad", "--no-verify", "--thickness", "9:10"]
    cli.run([*twice, "--thickness", "14:15"])
    assert capsys.readouterr().err.count("warning: --thickness is given 2 times") == 1
    parser = parser_of("loop")
    assert entry._repeated(parser, ["c", "--effect", "a.py", "--effect", "b.py", "--json", "--json"]) == []
    assert len(entry._repeated(parser, ["c", "--out", "a", "--effect", "b.py", "--out=b"])) == 1


def test_verbose_says_what_the_project_added(tmp_path, monkeypatch, capsys):
    assert cli.run(["init", str(tmp_path / "thumb"), "--punch", "round:16"]) == 0
    monkeypatch.chdir(tmp_path / "thumb")
    capsys.readouterr()
    assert cli.run([*PREDICT, "-v"]) == 0
    assert "from project 'thumb': --punch round:16\n" in capsys.readouterr().err


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def loud(request):
    kept = loudness.set(request.param)
    yield request.param
    loudness.reset(kept)


@pytest.mark.parametrize("loud", ["quiet"], indirect=True)
def test_quiet_shows_no_progress_on_a_terminal(loud):
    stream = Terminal()
    steps, count = Steps(3, stream), Count("designs", stream)
    steps("base")
    count(1, 5)
    steps.clear()
    assert stream.getvalue() == ""


@pytest.mark.parametrize("loud", ["verbose"], indirect=True)
def test_verbose_writes_a_line_for_each_step_also_into_a_file(loud):
    now, stream = [0.0], io.StringIO()
    steps = Steps(3, stream, lambda: now[0])
    steps("base")
    now[0] = 12.0
    steps("remainder")
    steps.clear()
    first, second = stream.getvalue().splitlines()
    assert first == "    0.0 s  step 1 of about 3: base"
    assert second == "   12.0 s  step 2 of about 3: remainder, about 24 s left"


def test_steps_of_another_process_are_shown_with_the_time_left(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    now, stream = [0.0], Terminal()
    with Watch(stream, lambda: now[0]):
        for number, word in enumerate(("solids", "meshes")):
            now[0] = 10.0 * number
            write_progress(f"step {number + 1} of 5: {word}")
            deadline = time.monotonic() + 60
            while word not in stream.getvalue() and time.monotonic() < deadline:
                time.sleep(0.01)
    shown = stream.getvalue().split("\r\033[K")[1:]
    assert shown == ["step 1 of 5: solids", "step 2 of 5: meshes, about 40 s left", ""]
    assert VARIABLE not in os.environ


def test_whoever_watches_from_outside_keeps_the_line(monkeypatch, tmp_path):
    monkeypatch.setenv(VARIABLE, str(tmp_path / "progress"))
    stream = Terminal()
    with Watch(stream):
        write_progress("step 1 of 5: solids")
    assert stream.getvalue() == "" and (tmp_path / "progress").read_text() == "step 1 of 5: solids"
    assert sys.stderr is not stream

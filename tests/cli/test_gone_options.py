"""A command or option of an earlier version ends with one line that names what to do instead."""

from __future__ import annotations

import json
import re

import pytest

from dummydesign.cli.entry import COMMANDS, parser_of, run, table_of

COMMANDS_GONE = [name for name, instead in table_of("gone").items() if isinstance(instead, str)]
GONE = [
    (command, option)
    for command, options in table_of("gone").items()
    if command not in COMMANDS_GONE
    for option in options
]


@pytest.mark.parametrize("form", ["{} x", "{}=x"])
@pytest.mark.parametrize("command, option", GONE)
def test_a_gone_option_names_a_command_that_there_is(command, option, form, capsys):
    assert run([command, *form.format(f"--{option}").split(), "--json"]) == 2
    shown = capsys.readouterr()
    assert shown.err.count("\n") == 1
    error = json.loads(shown.out)["error"]
    assert error["code"] == "unknown_option" and error["value"] == f"--{option}"
    named = re.findall(r"'dummydesign ([a-z-]+) ([^']*)'", error["message"])
    assert named and all(name in COMMANDS for name, _ in named)
    for name, words in named:
        known = parser_of(name)._option_string_actions
        assert all(word in known for word in words.split() if word.startswith("--"))


@pytest.mark.parametrize("command", COMMANDS_GONE)
def test_a_gone_command_names_one_that_there_is(command, capsys):
    assert command not in COMMANDS and run([command, "a", "b", "--json"]) == 2
    shown = capsys.readouterr()
    error = json.loads(shown.out)["error"]
    assert shown.err.count("\n") == 1 and error["code"] == "unknown_name" and error["value"] == command
    named = re.findall(r"'dummydesign ([a-z-]+)", error["message"])
    assert named and all(name in COMMANDS for name in named)


@pytest.mark.parametrize("command, option", GONE)
def test_a_gone_option_is_no_option_any_more(command, option):
    assert f"--{option}" not in parser_of(command)._option_string_actions


def test_an_option_that_never_was_is_still_told_its_neighbour(capsys):
    assert run(["suggest", "--tisue", "palm"]) == 2
    assert "--tissue" in capsys.readouterr().err

"""Completion in real shells, and what it offers against what the commands really take."""

import os
import shutil
import subprocess
import sys

import pytest

from dummydesign.cli.completion import BETWEEN, WORDS, next_words
from dummydesign.cli.entry import COMMANDS, parser_of, run
from dummydesign.core.user_library import entries
from dummydesign.geometry.shape_registry import shape_names


def test_commands_options_and_actions_are_those_of_the_parsers():
    assert next_words([""]) == list(COMMANDS)
    assert next_words(["pre"]) == ["predict"]
    for command in ("suggest", "predict", "whatif"):
        assert set(next_words([command, "-"])) == set(parser_of(command)._option_string_actions)
    assert "add-points" in next_words(["tissues", "add"])
    assert "--diameter" in next_words(["resins", "add-compression", "a.csv", "--d"])
    assert next_words(["nonsense", ""]) == []


def test_values_are_those_the_command_takes():
    assert set(next_words(["suggest", "--tissue", ""])) == {one.name for one in entries("materials/tissues").values()}
    assert set(next_words(["predict", "--resin", ""])) == {one.name for one in entries("materials/resins").values()}
    assert set(shape_names()) <= set(next_words(["suggest", "--shape", ""]))
    assert {"bonded", "frictionless", "friction:"} <= set(next_words(["predict", "--condition", ""]))
    assert next_words(["fit", "a.csv", "--elements", ""]) == ["3", "5", "7", "auto"]
    assert next_words(["predict", "--depth", ""]) == []  # a number: nothing to offer


def test_names_of_ones_own_are_offered_and_alone_to_be_removed(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    built_in = next(iter(entries("materials/tissues").values()))
    (tmp_path / "materials" / "tissues").mkdir(parents=True)
    shutil.copy(built_in.path, tmp_path / "materials" / "tissues" / "shin.toml")
    assert {"shin", built_in.name} <= set(next_words(["tissues", "show", ""]))
    assert next_words(["tissues", "remove", ""]) == ["shin"]


def test_an_unknown_shell_is_bad_input(capsys):
    assert run(["completion", "csh"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_nothing_heavy_is_loaded():
    code = (
        "import sys; from dummydesign.cli.entry import run; run(['completion', 'bash']);"
        "print([m for m in ('numpy', 'scipy', 'skfem', 'cadquery', 'matplotlib', 'vtk') if m in sys.modules])"
    )
    asked = {**os.environ, WORDS: BETWEEN.join(["suggest", "--shape", ""])}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=asked)
    assert done.returncode == 0 and done.stdout.endswith("[]\n"), done.stderr
    assert "crowned" in done.stdout


@pytest.fixture
def path(tmp_path):
    """Search path with a ``dummydesign`` of this interpreter in front."""
    command = tmp_path / "dummydesign"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m dummydesign "$@"\n', encoding="utf-8")
    command.chmod(0o755)
    return {**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}


def shell(name, script, environment):
    if shutil.which(name) is None:
        pytest.skip(f"{name} is not installed")
    done = subprocess.run([name, *script], capture_output=True, text=True, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.mark.slow
def test_bash(path):
    for typed, offered in (
        ("sug", ["suggest"]),
        ("suggest --tissue fore", ["forefinger"]),
        ("predict --condition fric", ["frictionless", "friction:"]),
    ):
        words = f"COMP_WORDS=(dummydesign {typed}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _dummydesign"
        script = f'source <(dummydesign completion bash); {words}; printf "%s\\n" "${{COMPREPLY[@]}}"'
        assert shell("bash", ["-c", script], path) == offered
    words = "COMP_WORDS=(dummydesign suggest --tissue ''); COMP_CWORD=3; _dummydesign"
    script = f'source <(dummydesign completion bash); {words}; printf "%s\\n" "${{COMPREPLY[@]}}"'
    assert set(shell("bash", ["-c", script], path)) == set(next_words(["suggest", "--tissue", ""]))


def test_zsh(path):
    script = (
        "compdef() { }; compadd() { shift $(($# - 1)); print -l ${(P)1}; }; _files() { print files; };"
        'eval "$(dummydesign completion zsh)"; words=(dummydesign WORDS ""); CURRENT=$#words; _dummydesign'
    )
    assert "predict" in shell("zsh", ["-fc", script.replace(" WORDS", "")], path)
    assert "forefinger" in shell("zsh", ["-fc", script.replace("WORDS", "suggest --tissue")], path)
    assert shell("zsh", ["-fc", script.replace("WORDS", "predict --depth")], path) == ["files"]


def test_fish(path):
    script = "dummydesign completion fish | source; complete -C 'dummydesign {}'"
    assert shell("fish", ["-Nc", script.format("sug")], path)[0] == "suggest"
    assert shell("fish", ["-Nc", script.format("suggest --tissue fore")], path) == ["forefinger"]
    assert "crowned" in shell("fish", ["-Nc", script.format("suggest --shape ")], path)

"""The list of commands: every module of the folder is a command, every command has the four things it needs."""

import pkgutil

import pytest

from dummydesign.cli import commands
from dummydesign.cli.common_options import loaded
from dummydesign.cli.entry import COMMANDS, module_of


def test_every_module_of_the_folder_is_a_command():
    found = {module.name for module in pkgutil.iter_modules(commands.__path__)}
    named = {module_of(command).__name__ for command in COMMANDS} - {"dummydesign.cli.completion"}
    assert {f"{commands.__name__}.{name}" for name in found} == named


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_declares_arguments_runs_and_renders(command):
    module = module_of(command)
    assert module.HELP.endswith(".")
    # what is one call needs no code of its own to declare and to run it
    called = callable(loaded(module.CALL)) if hasattr(module, "CALL") else False
    assert callable(module.render) and (called or callable(module.add_arguments))
    assert callable(getattr(module, "run", None)) or (called and module.ABOUT_STEPS > 0)

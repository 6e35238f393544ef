"""The list of commands: every module of a room is a command, every command has the four things it needs."""

import pkgutil

import pytest

from dummydesign.cli import design, library, measurement, project
from dummydesign.cli.registry import COMMANDS, MODULES, module_of


def test_every_module_of_a_room_is_a_command():
    rooms = (design, measurement, library, project)
    found = []
    for room in rooms:
        name = room.__name__.removeprefix("dummydesign.cli.")
        found += [f"{name}.{module.name}" for module in pkgutil.iter_modules(room.__path__)]
    assert sorted(found) == sorted(MODULES.values())


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_declares_arguments_runs_and_renders(command):
    module = module_of(command)
    assert module.HELP.endswith(".")
    assert all(callable(getattr(module, name)) for name in ("add_arguments", "run", "render"))

"""The command line: one module a command: its arguments, the one function it calls, its print."""

from dummydesign.cli.entry import main, run
from dummydesign.cli.registry import COMMANDS

__all__ = ["COMMANDS", "main", "run"]

"""The command line: one module a command: its arguments, the one function it calls, its print."""

from dummydesign.cli.entry import COMMANDS, main, run

__all__ = ["COMMANDS", "main", "run"]

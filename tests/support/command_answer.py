"""A command's answer as its ``--json`` gives it."""

import json

from dummydesign.cli.entry import run


def answer(capsys, *arguments):
    """Exit status and answer of a command line."""
    status = run([*arguments, "--json"])
    return status, json.loads(capsys.readouterr().out)

"""The commands, each a module of its own in one of the rooms; the order is that of the overview."""

from __future__ import annotations

import importlib
from types import ModuleType

MODULES = {
    "suggest": "design.suggest",
    "compare-designs": "design.compare_designs",
    "predict": "design.predict",
    "whatif": "design.whatif",
    "import": "measurement.import_",
    "fit": "measurement.fit",
    "mold": "design.mold",
    "campaign": "measurement.campaign",
    "loop": "measurement.loop",
    "replay": "measurement.replay",
    "compare": "measurement.compare",
    "tissues": "library.tissues",
    "resins": "library.resins",
    "init": "project.init",
    "status": "project.status",
    "studio": "project.studio",
}
COMMANDS = tuple(MODULES)


def module_of(command: str) -> ModuleType:
    """The module of a command (``HELP``, ``add_arguments``, ``run``, ``render``); importing it loads nothing heavy."""
    return importlib.import_module(f"dummydesign.cli.{MODULES[command]}")

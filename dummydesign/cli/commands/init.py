"""``dummydesign init``: make a project folder."""

from __future__ import annotations

import argparse
from typing import Any

HELP = "Make a project folder: project.toml and a folder for each step; commands run inside it use it."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options; each is a default of the commands that are run inside the folder."""
    from dummydesign.geometry.shape_registry import shape_help

    add = parser.add_argument
    add("folder", metavar="DIR", help="made when needed; what lies in it stays")
    add("--name", help="of the project (default the folder's)")
    add("--tissue", metavar="NAME|FILE", help="see 'dummydesign tissues list'")
    add("--resin", metavar="NAME|FILE", help="see 'dummydesign resins list'")
    add("--punch", metavar="KIND:SIZE", help="square:14 (default), rectangle:AxB, round:D, ball:D, profile:FILE.csv")
    add("--aim", metavar="AIM", help="average (default), safe-side, subject:NAME or people:PERCENT")
    add("--shape", metavar="NAME[:P,..]", help="auto (default), " + shape_help("auto"))


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Check the names, make the folder."""
    from dummydesign.project.folder import FILE, FOLDERS, make_project
    from dummydesign.resin import load_resin
    from dummydesign.tissue import load_tissue

    given = {name: getattr(options, name) for name in ("tissue", "resin", "punch", "aim", "shape")}
    if options.tissue is not None and not options.tissue.endswith(".toml"):
        tissue = load_tissue(options.tissue)
        if options.aim is not None:
            tissue.target(options.aim)
    if options.resin is not None and not options.resin.endswith(".toml"):
        load_resin(options.resin)
    project = make_project(options.folder, options.name, **given)
    return {
        "inputs": {"folder": options.folder, "name": options.name, **given},
        "name": project.name,
        "folder": str(project.root),
        "folders": list(FOLDERS),
        "files": {"project": str(project.root / FILE)},
    }


def render(result: dict[str, Any]) -> str:
    """What was made, and what comes next."""
    import shlex

    return "\n".join(
        [
            f"project '{result['name']}' in {result['folder']}",
            f"  {', '.join(f'{name}/' for name in result['folders'])}",
            f"next: cd {shlex.quote(result['folder'])} && dummydesign status   (or: dummydesign studio)",
        ]
    )

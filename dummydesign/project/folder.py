"""The project folder: project.toml, one folder a step, and what it gives to commands inside it."""

from __future__ import annotations

import os
import shlex
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.files import csv_text, write_text, writing
from dummydesign.core.user_library import data_folder, read_toml, toml_text

FILE = "project.toml"
SCHEMA = 1
FOLDERS = ("measured", "tissue", "designs", "moulds", "campaigns", "calibrations")
"""One folder a step, in the order of the work."""
NAMES = ("tissue", "resin", "punch")
ASKED = ("aim", "shape", "thickness", "ratio", "calibration")
"""What may stand under ``[asked]``: options of ``suggest`` of the same name."""
_HELP = {
    "tissue": "a name of 'dummydesign tissues list', or a file such as \"tissue/mine.toml\"",
    "resin": "a name of 'dummydesign resins list', or a file",
    "punch": "square:14, round:D, ...: for predict, whatif and campaign new",
}


@dataclass(frozen=True)
class Project:
    """A project folder and what its ``project.toml`` says."""

    root: Path
    name: str
    tissue: str | None = None
    resin: str | None = None
    punch: str | None = None
    asked: tuple[tuple[str, str], ...] = ()

    def given(self) -> dict[str, str]:
        """All that ``project.toml`` says, by option."""
        own = {name: value for name in NAMES if (value := getattr(self, name)) is not None}
        return own | dict(self.asked)

    def toml(self) -> str:
        """Text of ``project.toml``; what is not given stands there as a comment."""
        lines = [f"schema = {SCHEMA}", f"name = {toml_text(self.name)}", ""]
        lines.append("# Defaults of the commands that are run in this folder; an option on the command line wins.")
        for name in NAMES:
            value = getattr(self, name)
            given = f"{name} = {toml_text(value)}" if value is not None else f"# {name} = "
            lines.append(f"{given:<40} # {_HELP[name]}")
        lines += ["", "# Options of 'dummydesign suggest'.", "[asked]"]
        known = dict(self.asked)
        lines += [f"{name} = {toml_text(known[name])}" if name in known else f"# {name} = " for name in ASKED]
        return "\n".join(lines) + "\n"


def find_project(start: str | Path = ".") -> Project | None:
    """The project that a folder lies in: the nearest ``project.toml`` upwards; None without one.

    A file of that name without ``schema`` belongs to something else and is passed over.
    """
    here = Path(start).resolve()
    for folder in (here, *here.parents):
        path = folder / FILE
        if path.is_file() and _ours(path):
            return read_project(folder)
    return None


def _ours(path: Path) -> bool:
    """Whether a ``project.toml`` is meant for us; a damaged one is, for silence would hide it."""
    try:
        return "schema" in read_toml(path)[0]
    except InputError:
        return True


def read_project(folder: str | Path) -> Project:
    """Read the ``project.toml`` of a folder."""
    root = Path(folder).resolve()
    path = root / FILE
    if not path.is_file():
        make = f"dummydesign init {shlex.quote(str(folder))}"
        message = f"'{folder}' is no project folder: it holds no {FILE} (make one: {make})"
        raise InputError(message, "file_not_found", "project", str(folder))
    try:
        data, _ = read_toml(path)
    except InputError as problem:
        # which of several projects is meant is seen by its folder
        raise InputError(f"{root}{os.sep}{problem}", "file_unreadable", "project", str(path)) from None
    if data.get("schema") != SCHEMA:
        message = f"{path}: schema = {data.get('schema')} is not {SCHEMA}, the one this version reads"
        raise InputError(message, "unsupported", "schema", data.get("schema"), SCHEMA)
    asked = data.get("asked", {})
    if not isinstance(asked, dict):
        raise InputError(f"{path}: asked must be a table, [asked]", "malformed", "asked")
    for table, entries, known in (("", data, ("schema", "name", "asked", *NAMES)), ("asked.", asked, ASKED)):
        for key, value in entries.items():
            if key not in known:
                message = f"{path}: {unknown_name('entry', key, known)}"
                raise InputError(message, "unknown_key", f"{table}{key}", key, known)
            if key not in ("schema", "asked") and not (isinstance(value, str) and value.strip()):
                message = f"{path}: {table}{key} = {value!r} must be text that is not empty"
                raise InputError(message, "malformed", f"{table}{key}", value)
    named = {name: data.get(name) for name in NAMES}
    return Project(root, data.get("name", root.name), **named, asked=tuple(sorted(asked.items())))


def project_of(root: Path) -> Project | None:
    """The project of a folder as it is now; None in a folder that is none yet."""
    return read_project(root) if (root / FILE).is_file() else None


def make_project(folder: str | Path, name: str | None = None, **given: str | None) -> Project:
    """Make a project folder, or complete the folders of one that has none of them."""
    root = Path(folder)
    if (root / FILE).exists():
        message = f"'{root / FILE}' exists: the folder is a project; edit the file to change what it says"
        raise InputError(message, "file_exists", "project", str(root))
    asked = tuple(sorted((key, value) for key in ASKED if (value := given.get(key)) is not None))
    title = name or root.resolve().name or "project"
    project = Project(root.resolve(), title, **{key: given.get(key) for key in NAMES}, asked=asked)
    with writing("project folder", root, "project"):
        for part in FOLDERS:
            (root / part).mkdir(parents=True, exist_ok=True)
    write_text(root / FILE, project.toml())
    return project


EXAMPLE_SEED, NOISE_N, RATE_HZ = 1, 0.02, 1000.0
LEAD_S, FAR_MM = 3.0, 10.0
"""How long and how far before contact a press of the example begins; a shorter one is doubted by `import`."""


def make_example(root: Path) -> None:
    """Make a project to try all steps with: presses of the forefinger's aim, simulated, and a pressed campaign."""
    import numpy as np

    from dummydesign.design.scoring.press_simulation import Sampling
    from dummydesign.design.scoring.targets import make_targets
    from dummydesign.tissue import load_tissue

    make_project(root, "Example", tissue="forefinger")
    sampling, draw = Sampling(400, 100, 400), np.random.default_rng(EXAMPLE_SEED)
    for press in make_targets(load_tissue("forefinger"), "average", sampling).conditions:
        moved = sampling.motion(press.velocity_mm_s, press.aim.depth_mm)
        time_s = np.arange(-LEAD_S, press.aim.time_s[-1], 1.0 / RATE_HZ)
        before_mm = np.maximum(time_s * press.velocity_mm_s, -FAR_MM)
        way_mm = np.where(time_s < 0, before_mm, np.interp(time_s, moved.time_s[0], moved.displacement_mm[0]))
        force_N = np.interp(time_s, press.aim.time_s, press.aim.curves_N[0], left=0.0)
        rows = np.column_stack([time_s + LEAD_S, way_mm, force_N + draw.normal(0.0, NOISE_N, len(time_s))])
        name = f"finger_v{press.velocity_mm_s:03.0f}_f{press.steady_force_N:02.0f}.csv"
        write_text(root / "measured" / name, csv_text(("time_s", "displacement_mm", "force_N"), np.round(rows, 4)))
    shutil.copytree(data_folder() / "examples" / "campaign", root / "campaigns" / "example")


def change_project(project: Project, **given: Any) -> Project:
    """Write new values into ``project.toml``; None takes one away. Comments of one's own are not kept."""
    own = {key: value for key, value in given.items() if key in ("name", *NAMES)}
    asked = dict(project.asked) | {key: value for key, value in given.items() if key in ASKED}
    kept = tuple(sorted((key, value) for key, value in asked.items() if value is not None))
    changed = replace(project, **own, asked=kept)
    write_text(project.root / FILE, changed.toml())
    return changed


GIVEN: dict[tuple[str, ...], tuple[str, ...]] = {
    ("suggest",): ("tissue", "resin", "aim", "shape", "thickness", "ratio", "calibration", "punch"),
    ("predict",): ("punch",),
    ("whatif",): ("tissue", "resin", "aim", "punch"),
    ("compare",): ("tissue", "punch"),
    ("on-person",): ("tissue", "punch"),
    ("mold",): ("resin",),
    ("campaign", "new"): ("punch",),
    ("campaign", "from-files"): ("punch",),
}
"""Options that each command takes from the project; ``resin`` and ``young`` of ``predict`` stay with the user."""
OUT = {
    **dict.fromkeys(("suggest", "whatif", "compare", "on-person"), "designs"),
    "import": "measured",
    "mold": "moulds",
    "loop": "calibrations",
}
"""Folder of the project into which each command writes when no ``--out`` is typed."""
WITH_TISSUE = ("aim",)
"""Defaults that hold for the project's own tissue alone, as the name of a subject does."""
WITH_RESIN = ("ratio", "calibration")
"""Defaults that hold for the project's own resin alone."""
PATHS = {"tissue": ".toml", "resin": ".toml", "calibration": ".json"}
"""Options that may be files: with this ending they are meant from the project folder on."""


def words_for(project: Project, arguments: Sequence[str], start: str | Path = ".") -> list[str]:
    """Options that a project adds to a command line."""
    typed = {word.partition("=")[0] for word in arguments}
    given, words = project.given(), []
    excluded = (WITH_TISSUE if "--tissue" in typed else ()) + (WITH_RESIN if "--resin" in typed else ())
    for name in GIVEN.get(command_of(arguments), ()):
        if name in given and f"--{name}" not in typed and name not in excluded:
            words += [f"--{name}", _from_here(project, name, given[name], start)]
    return words


def command_of(arguments: Sequence[str]) -> tuple[str, ...]:
    """The command, with its action where the table knows one, such as ``("campaign", "new")``."""
    two = tuple(arguments[:2])
    return two if two in GIVEN else two[:1]


def _from_here(project: Project, name: str, value: str, start: str | Path) -> str:
    ending = PATHS.get(name)
    if ending is None or not value.lower().endswith(ending) or os.path.isabs(value):
        return value
    return os.path.relpath(project.root / value, Path(start).resolve())


def output_path_for(project: Project, command: str, name: str, start: str | Path = ".") -> str:
    """Where a command writes in a project: ``designs/NAME``, seen from the folder it is run in."""
    return os.path.relpath(project.root / OUT[command] / name, Path(start).resolve())

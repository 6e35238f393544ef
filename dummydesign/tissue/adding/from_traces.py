"""``tissues add``, ``tissues add-curves``: a tissue of your own from traces or fits, or a table of curves."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import output_folder, write_text
from dummydesign.core.user_library import DEVICE, make_room, user_folder
from dummydesign.measurement.sensor import parse_lowpass
from dummydesign.measurement.trace import Trace, check_one_press, magnitude_fault, read_trace
from dummydesign.tissue.adding.observations import ObservedCurve, check_curves, force_unit_fault, read_curves
from dummydesign.tissue.adding.people import AUTO, NONE, people_tissue
from dummydesign.tissue.model.maxwell_law import fitted_law
from dummydesign.tissue.model.tissue import Subject
from dummydesign.tissue.model.tissue_file import KIND, load_tissue, tissue_toml

_NAME = re.compile(r"^[A-Za-z0-9][A-Za-z0-9_-]*$")


def add_tissue(
    name: str, files: list[str], law: str, elements: str, lowpass: str | None, replace_own: bool = False
) -> dict[str, Any]:
    """Make a tissue from several subjects and keep it in the user's folder."""
    path, hidden = reserve(name, replace_own, elements, law)
    sensor = parse_lowpass(lowpass)
    subjects, groups = _sort_files(files)
    read = {person: [read_trace(path) for path in paths] for person, paths in groups.items()}
    sources = {person: ", ".join(path.name for path in paths) for person, paths in groups.items()}
    tissue, parts = people_tissue(name, read, sources, law, elements, sensor, [subject for subject, _ in subjects])
    write_text(path, tissue_toml(tissue))
    inputs = {"action": "add", "name": name, "files": files, "law": law, "elements": elements, "lowpass": lowpass}
    parts["fits"] = [{"subject": subject.name, "from": source} for subject, source in subjects] + parts["fits"]
    parts["warnings"] += hidden
    return {"inputs": inputs, **tissue.to_dict(), **parts, "files": {"tissue": str(path)}}


def add_curves(name: str, table: str, law: str, elements: str, replace_own: bool = False) -> dict[str, Any]:
    """Make a tissue from a table of curves and keep it in the user's folder."""
    path = Path(table)
    target, hidden = reserve(name, replace_own, elements, law)
    curves = read_curves(path)
    for subject in dict.fromkeys(curve.subject for curve in curves):
        check_curves([curve for curve in curves if curve.subject == subject], path.name)
    read = _traces(curves)
    tissue, parts = people_tissue(name, read, dict.fromkeys(read, path.name), law, elements)
    write_text(target, tissue_toml(tissue))
    inputs = {"action": "add-curves", "name": name, "curves": table, "law": law, "elements": elements}
    parts["warnings"] += hidden
    return {"inputs": inputs, **tissue.to_dict(), **parts, "files": {"tissue": str(target)}}


def _traces(curves: list[ObservedCurve]) -> dict[str, list[Trace]]:
    """Curves as traces by person, each with its commanded speed, and with all that is checked of traces."""
    read: dict[str, list[Trace]] = {}
    for number, curve in enumerate(curves, start=1):
        arrays = (curve.time_s, curve.depth_mm, curve.force_N)
        # nine digits, which two tables of one press share
        time, x, force = (np.array([float(f"{value:.9g}") for value in array]) for array in arrays)
        trace = Trace(f"curve_{number}_line_{curve.line}.csv", time, x, force, curve.velocity_mm_s)
        if words := force_unit_fault(x, force):
            raise InputError(f"{trace.name}: {words}", "implausible_unit", "force_N", float(force.max()))
        if fault := magnitude_fault(time, x, force):
            raise InputError(f"{trace.name}: {fault.message}", fault.code, fault.column)
        check_one_press(trace)
        read.setdefault(curve.subject, []).append(trace)
    return read


def tissue_folder(name: str) -> Path:
    """Folder of the user's tissues, tried for writing; refuses names that make no file name."""
    if not _NAME.match(name) or DEVICE.fullmatch(name):
        raise InputError(f"tissue name '{name}' may hold letters, digits, '-' and '_' only", "bad_name", "tissue", name)
    return output_folder(user_folder() / KIND)


def reserve(name: str, replace_own: bool, elements: str = "5", law: str = AUTO) -> tuple[Path, list[dict[str, str]]]:
    """Return the file of a new tissue and a warning of what it hides; refuse what can be no tissue of the user."""
    if law not in (AUTO, NONE):
        fitted_law(law)
    path = tissue_folder(name) / f"{name}.toml"
    hidden = make_room(KIND, "tissue", name, replace_own)
    if elements not in ("3", "5", "7"):
        message = f"--elements {elements} is not one of 3, 5, 7: the subjects of a tissue share one number"
        raise InputError(message, "unknown_name", "elements", elements, ("3", "5", "7"))
    return path, hidden


def _sort_files(files: list[str]) -> tuple[list[tuple[Subject, str]], dict[str, list[Path]]]:
    """Subjects of TOML files with their source, and the traces of every other subject.

    A folder of traces is one subject, unless its files begin with several names (letters alone before the first "_");
    one without a trace holds a folder for each subject.
    """
    subjects: list[tuple[Subject, str]] = []
    groups: dict[str, list[Path]] = {}
    for text in files:
        path = Path(text)
        if path.is_dir():
            here = [path] if any(path.glob("*.csv")) else sorted(one for one in path.iterdir() if one.is_dir())
            inside = [one for folder in here for one in sorted(folder.glob("*.csv"))]
            if not inside:
                raise InputError(f"folder '{text}' holds no trace (*.csv)", "nothing_found", "trace", text)
            words = [one.stem.split("_")[0] for one in inside]
            several = here == [path] and len(set(words)) > 1 and all(map(str.isalpha, words))
            for one, word in zip(inside, words):
                groups.setdefault(word if several else one.resolve().parent.name, []).append(one)
        elif path.suffix.lower() == ".toml":
            tissue = load_tissue(str(path))
            alone = len(tissue.subjects) == 1
            subjects += [(replace(one, name=tissue.name) if alone else one, path.name) for one in tissue.subjects]
        elif path.is_file():
            groups.setdefault(path.stem.split("_")[0], []).append(path)
        else:
            raise InputError(
                f"'{text}' is neither a trace CSV, a folder of traces nor a tissue TOML",
                "file_not_found",
                "trace",
                text,
            )
    return subjects, groups

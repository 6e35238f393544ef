"""``tissues add``: a tissue of your own from several subjects' traces or fits."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import output_folder, write_text
from dummydesign.core.user_library import DEVICE, make_room, user_folder
from dummydesign.measurement.importing.press_checks import copies_among
from dummydesign.measurement.sensor import parse_lowpass
from dummydesign.measurement.trace import read_trace
from dummydesign.tissue.model.maxwell_law import fitted_law
from dummydesign.tissue.model.tissue import Subject, Tissue, same_shape
from dummydesign.tissue.model.tissue_file import KIND, load_tissue, tissue_toml

if TYPE_CHECKING:
    from dummydesign.measurement.sensor import Lowpass
    from dummydesign.measurement.trace import Trace
    from dummydesign.tissue.fitting.fit import TissueFit

AUTO, NONE = "auto", "none"
"""Laws of a tissue: the default one where it follows the people, and their curves."""
_NAME = re.compile(r"^[A-Za-z0-9][A-Za-z0-9_-]*$")


def add_tissue(
    name: str, files: list[str], law: str, elements: str, lowpass: str | None, replace_own: bool = False
) -> dict[str, Any]:
    """Make a tissue from several subjects and keep it in the user's folder."""
    from dummydesign.tissue.adding.from_curves import people_tissue

    path, hidden = reserve(name, replace_own, elements, law)
    sensor = parse_lowpass(lowpass)
    subjects, groups = _sort_files(files)
    read = {person: [read_trace(path) for path in paths] for person, paths in groups.items()}
    sources = {person: ", ".join(path.name for path in paths) for person, paths in groups.items()}
    others = [subject for subject, _ in subjects]
    tissue, parts = people_tissue(name, read, sources, law, elements, sensor, others)
    write_text(path, tissue_toml(tissue))
    inputs = {"action": "add", "name": name, "files": files, "law": law, "elements": elements, "lowpass": lowpass}
    parts["fits"] = [{"subject": subject.name, "from": source} for subject, source in subjects] + parts["fits"]
    parts["warnings"] += hidden
    return {"inputs": inputs, **tissue.to_dict(), **parts, "files": {"tissue": str(path)}}


def tissue_folder(name: str) -> Path:
    """Folder of the user's tissues, tried for writing; refuses names that make no file name."""
    if not _NAME.match(name) or DEVICE.fullmatch(name):
        message = f"tissue name '{name}' may hold letters, digits, '-' and '_' only"
        raise InputError(message, "bad_name", "tissue", name)
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
    """Subjects of TOML files with their source, and the traces of every other subject."""
    subjects: list[tuple[Subject, str]] = []
    groups: dict[str, list[Path]] = {}
    for text in files:
        path = Path(text)
        if path.is_dir():
            inside = sorted(path.glob("*.csv"))
            if not inside:
                raise InputError(f"folder '{text}' holds no trace (*.csv)", "nothing_found", "trace", text)
            groups.setdefault(path.resolve().name, []).extend(inside)
        elif path.suffix.lower() == ".toml":
            tissue = load_tissue(str(path))
            single = len(tissue.subjects) == 1
            named = [replace(one, name=tissue.name) if single else one for one in tissue.subjects]
            subjects += [(subject, path.name) for subject in named]
        elif path.is_file():
            groups.setdefault(path.stem.split("_")[0], []).append(path)
        else:
            message = f"'{text}' is neither a trace CSV, a folder of traces nor a tissue TOML"
            raise InputError(message, "file_not_found", "trace", text)
    return subjects, groups


def fit_people(
    read: dict[str, list[Trace]], law: str, elements: str, lowpass: Lowpass | None = None, intervals: bool = True
) -> dict[str, TissueFit]:
    """Fit the law to each person's traces, per speed."""
    from dummydesign.tissue.fitting.fit import fit_traces

    options = law, "per-speed", lowpass, intervals
    return {person: fit_traces(traces, int(elements), *options) for person, traces in read.items()}


def fit_row(person: str, source: str, fit: TissueFit) -> dict[str, Any]:
    """Return the row of an answer on a fit."""
    return {"subject": person, "from": source, **{key: fit.result[key] for key in ("rmse_N", "max_residual_N")}}


def fit_warnings(person: str, fit: TissueFit) -> list[dict[str, str]]:
    """Return the warnings of a fit with the person's name; copies are found by :func:`copies_of`."""
    own = [warning for warning in fit.result["warnings"] if warning["code"] != "same_press"]
    return [{"code": w["code"], "message": f"{person}: {w['message']}"} for w in own]


def copies_of(read: dict[str, list[Trace]]) -> list[dict[str, str]]:
    """Warn of presses that are listed twice, over all subjects: one under two names counts twice."""
    return copies_among([replace(trace, name=f"{who}: {trace.name}") for who, own in read.items() for trace in own])


def tissue_of_fits(name: str, fits: dict[str, TissueFit], others: Sequence[Subject] = ()) -> Tissue:
    """Make the tissue of fitted subjects and others, by rising gamma1."""
    from dummydesign.tissue.fitting.fit import subject_from_fit

    subjects = [*others, *(subject_from_fit(who, fit) for who, fit in fits.items())]
    names = [subject.name.lower() for subject in subjects]
    double = next((n for n in names if names.count(n) > 1), None)
    if double:
        raise InputError(f"subject '{double}' is listed twice; rename one file", "duplicate", "subject", double)
    same_shape(tuple(subjects))
    ordered = tuple(sorted(subjects, key=lambda s: s.parameters.gamma1_N_per_mm3))
    notes = ("Below the smallest steady force that was measured the band is the law extrapolated.",)
    title = f"{len(ordered)} subject{'s' if len(ordered) > 1 else ''}"
    return Tissue(name, title, ordered[0].parameters.law, ordered, (), notes, "user")

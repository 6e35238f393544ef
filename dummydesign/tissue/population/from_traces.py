"""``tissues add``: a tissue of your own from several subjects' traces or fits."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.datafiles import user_folder
from dummydesign.core.errors import InputError
from dummydesign.core.files import output_folder, write_text
from dummydesign.core.own_files import make_room
from dummydesign.measurement.sensor import parse_lowpass
from dummydesign.measurement.trace import read_trace
from dummydesign.measurement.trace_checks import copies_among
from dummydesign.tissue.model.tissue import Subject, Tissue, same_shape
from dummydesign.tissue.model.tissue_file import KIND, load_tissue, tissue_toml

if TYPE_CHECKING:
    from dummydesign.measurement.sensor import Lowpass
    from dummydesign.measurement.trace import Trace
    from dummydesign.tissue.fitting.fit import Fit

_NAME = re.compile(r"^[A-Za-z0-9][A-Za-z0-9_-]*$")


def add_tissue(
    name: str, files: list[str], law: str, elements: str, lowpass: str | None, replace_own: bool = False
) -> dict[str, Any]:
    """Make a tissue from several subjects and keep it in the user's folder.

    A TOML file (as ``fit --out`` writes) brings its subjects; a folder holds the traces of one subject
    and gives the subject its name; single traces belong to the subject named before their first
    underscore. Traces are fitted per speed.

    Parameters
    ----------
    name : str
        Name of the tissue: letters, digits, ``-`` and ``_``.
    files : list of str
        TOML files, folders, trace CSVs.
    law, elements : str
        Law and number of elements of the fits of traces.
    lowpass : str or None
        Filter of the recorded forces, ``HZ[:ORDER[:PASSES]]``.
    replace_own : bool
        Take the place of a tissue of the user with this name.

    Returns
    -------
    dict
        The tissue, its file, and which traces made which subject.

    Raises
    ------
    InputError
        For a bad or taken name, unreadable files, subjects of the same name, or laws that differ.
    """
    folder = tissue_folder(name)
    hidden = make_room(KIND, "tissue", name, replace_own)
    if elements not in ("3", "5", "7"):
        raise InputError(f"--elements {elements} is not one of 3, 5, 7: the subjects of a tissue share one number")
    sensor = parse_lowpass(lowpass)
    subjects, groups = _sort_files(files)
    rows: list[dict[str, Any]] = [{"subject": subject.name, "from": source} for subject, source in subjects]
    warnings: list[dict[str, str]] = []
    made = [subject for subject, _ in subjects]
    read = {person: [read_trace(path) for path in paths] for person, paths in groups.items()}
    # over all subjects, for one under two names counts twice
    named = [replace(trace, name=f"{who}: {trace.name}") for who, traces in read.items() for trace in traces]
    warnings += copies_among(named)
    for person, fit in fit_people(read, law, elements, sensor).items():
        made.append(subject_of_fit(person, fit))
        rows.append(fit_row(person, ", ".join(path.name for path in groups[person]), fit))
        warnings += fit_warnings(person, fit)
    tissue = tissue_of(name, made)
    warnings += hidden
    path = write_text(folder / f"{name}.toml", tissue_toml(tissue))
    inputs = {"action": "add", "name": name, "files": files, "law": law, "elements": elements, "lowpass": lowpass}
    return {
        "inputs": inputs, **tissue.to_dict(), "fits": rows, "warnings": warnings, "files": {"tissue": str(path)},
    }  # fmt: skip


def tissue_folder(name: str) -> Path:
    """Folder of the user's tissues, tried for writing; refuses names that make no file name."""
    if not _NAME.match(name):
        raise InputError(f"tissue name '{name}' may hold letters, digits, '-' and '_' only")
    return output_folder(user_folder() / KIND)


def _sort_files(files: list[str]) -> tuple[list[tuple[Subject, str]], dict[str, list[Path]]]:
    """Subjects of TOML files with their source, and the traces of every other subject."""
    subjects: list[tuple[Subject, str]] = []
    groups: dict[str, list[Path]] = {}
    for text in files:
        path = Path(text)
        if path.is_dir():
            inside = sorted(path.glob("*.csv"))
            if not inside:
                raise InputError(f"folder '{text}' holds no trace (*.csv)")
            groups.setdefault(path.resolve().name, []).extend(inside)
        elif path.suffix.lower() == ".toml":
            tissue = load_tissue(str(path))
            single = len(tissue.subjects) == 1
            for subject in tissue.subjects:
                named = Subject(tissue.name if single else subject.name, subject.parameters, subject.numbers)
                subjects.append((named, path.name))
        elif path.is_file():
            groups.setdefault(path.stem.split("_")[0], []).append(path)
        else:
            raise InputError(f"'{text}' is neither a trace CSV, a folder of traces nor a tissue TOML")
    return subjects, groups


def fit_people(
    read: dict[str, list[Trace]], law: str, elements: str, lowpass: Lowpass | None = None, intervals: bool = True
) -> dict[str, Fit]:
    """The law fitted to each person's traces, per speed.

    Parameters
    ----------
    read : dict
        Traces by person.
    law, elements : str
        Of the fits.
    lowpass : Lowpass, optional
        Filter of the recorded forces.
    intervals : bool
        Whether intervals are worked out, which takes most of the time.
    """
    from dummydesign.tissue.fitting.fit import fit_traces

    how = law, "per-speed", lowpass, intervals
    return {person: fit_traces(traces, int(elements), *how) for person, traces in read.items()}


def subject_of_fit(person: str, fit: Fit) -> Subject:
    """The person with the fitted parameters."""
    from dummydesign.tissue.fitting.subject import subject_from_fit

    return subject_from_fit(person, fit)


def fit_row(person: str, source: str, fit: Fit) -> dict[str, Any]:
    """What an answer says of a fit.

    Parameters
    ----------
    person, source : str
        Who, and the files.
    fit : Fit
    """
    left = {key: fit.result[key] for key in ("rmse_N", "max_residual_N")}
    return {"subject": person, "from": source, **left}


def fit_warnings(person: str, fit: Fit) -> list[dict[str, str]]:
    """Warnings of a fit with the person's name; presses that come twice are told of all persons together."""
    said = [warning for warning in fit.result["warnings"] if warning["code"] != "same_press"]
    return [{"code": w["code"], "message": f"{person}: {w['message']}"} for w in said]


def tissue_of(name: str, subjects: list[Subject]) -> Tissue:
    """The tissue of fitted subjects, by rising gamma1.

    Raises
    ------
    InputError
        For names that come twice, or subjects that differ in law or elements.
    """
    names = [subject.name.lower() for subject in subjects]
    double = next((n for n in names if names.count(n) > 1), None)
    if double:
        raise InputError(f"subject '{double}' comes twice; rename one file")
    same_shape(tuple(subjects))
    ordered = tuple(sorted(subjects, key=lambda s: s.parameters.gamma1_N_per_mm3))
    notes = ("Below the smallest steady force that was measured the band is the law extrapolated.",)
    title = f"{len(ordered)} subject{'s' if len(ordered) > 1 else ''}"
    return Tissue(name, title, ordered[0].parameters.law, ordered, (), notes, "user")

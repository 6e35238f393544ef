"""The call that reads what test machines write: :func:`import_traces`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Result
from dummydesign.api.questions import question

if TYPE_CHECKING:
    from dummydesign.measurement.importing.core.decisions import Settings


def import_traces(
    files: Iterable[str | PathLike[str]],
    *,
    profile: str | None = None,
    save_profile: str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    encoding: str | None = None,
    skip: int | None = None,
    flip: Iterable[str] | None = None,
    tare: str | None = None,
    contact: str | None = None,
    split: str | None = None,
    out: str | PathLike[str] | None = None,
    replace: bool = False,
) -> Result:
    """Read files as test machines wrote them, and write each press as a trace.

    What is None is taken from the profile, and where there is none from the file.

    Parameters
    ----------
    files : iterable of path
        Files, or folders that stand for the files in them.
    profile : str, optional
        Settings kept for a machine: a name, or the path of a TOML file.
    save_profile : str, optional
        Name to keep the settings under, with the columns and signs of text that were found.
    columns, units : mapping, optional
        From ``time``, ``displacement`` and ``force`` to a column's name or number, and to a unit.
    separator, decimal, encoding : str, optional
        Between columns (``tab``, ``semicolon``, ``comma``, ``bar``, ``spaces``), the decimal sign (``.`` or ``,``),
        and the encoding (``utf-8``, ``cp1252``, ...).
    skip : int, optional
        Lines to leave out at the start.
    flip : iterable of str, optional
        Which of ``displacement`` and ``force`` to negate; empty for none.
    tare, contact : str, optional
        ``auto``, ``none``, or the reading at no force and at contact, as the file counts it, in N and mm.
    split : str, optional
        ``auto`` or ``none``.
    out : path, optional
        Folder of the traces and of the preview, which are not written without it; the next free number when it
        holds another answer.
    replace : bool
        Take the place of another answer in ``out``, and with ``save_profile`` that of a profile of its name.

    Returns
    -------
    Result
        The same as ``dummydesign import --json`` prints; ``found`` is the list of
        :class:`~dummydesign.measurement.importing.read.Imported`, with the presses as arrays.

    Raises
    ------
    InputError
        For files that cannot be read, and for what they leave open: then with the option that settles it.
    """
    from dummydesign.measurement.importing.batch import describe, import_files, plan_traces, write_traces
    from dummydesign.measurement.importing.profiles import learned
    from dummydesign.measurement.importing.profiles import save_profile as keep

    given: dict[str, Any] = {"columns": columns, "units": units, "separator": separator, "decimal": decimal,
                             "encoding": encoding, "skip": skip, "tare": tare, "contact": contact, "split": split,
                             "flip": None if flip is None else frozenset(flip)}  # fmt: skip
    settings = _settings(profile, {key: value for key, value in given.items() if value is not None})
    names = [fspath(name) for name in files]
    imported, warnings = import_files(names, settings)
    inputs = {
        "files": names,
        "profile": profile,
        **settings.to_dict(),
        "save_profile": save_profile,
        "out": None if out is None else fspath(out),
    }
    planned = plan_traces(imported, None if out is None else Path(out))
    found = describe(imported, planned)
    result: dict[str, Any] = {
        "inputs": inputs,
        "files": found,
        "preview": None,
        "warnings": [*(warning for one in found for warning in one["warnings"]), *warnings],
    }

    def kept() -> dict[str, str]:
        if not save_profile:
            return {}
        return {"profile": str(keep(save_profile, learned(settings, imported), replace))}

    if out is None:
        return Result(imported, result | kept(), "import_traces")
    from dummydesign.core.outputs.write import new_folder
    from dummydesign.report.imported import write_preview

    asked = question("import", inputs, files=[one.source for one in imported])
    with new_folder(out, asked, replace=replace) as output:
        # first: a name that is taken must not leave traces behind
        profiles = kept()
        write_traces(planned, output.work)
        output.extra["summary"] = {"traces": sum(len(one["traces"]) for one in found)}
        result["preview"] = output.settled(write_preview(output.work, imported, found, warnings))
    result["inputs"] = {**inputs, "out": str(output.folder)}
    result["manifest"] = str(output.folder / output.place.manifest)
    result["warnings"] += output.place.warnings
    return Result(imported, result | profiles, "import_traces")


def _settings(profile: str | None, given: dict[str, Any]) -> Settings:
    """What the caller and the profile settle together; the caller wins."""
    from dataclasses import replace

    from dummydesign.measurement.importing.core.decisions import Settings
    from dummydesign.measurement.importing.profiles import load_profile

    base = load_profile(profile) if profile else Settings()
    for key in ("columns", "units"):
        if key in given:
            given[key] = {**getattr(base, key), **given[key]}
    return replace(base, **given)

"""The call that sets designs side by side: :func:`compare_designs`."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike, fspath

from dummydesign.api.answers import Result
from dummydesign.api.questions import question


def compare_designs(
    folders: Iterable[str | PathLike[str]], *, out: str | PathLike[str] | None = None, replace: bool = False
) -> Result:
    """Compare the designs of several folders of ``suggest``; see :mod:`dummydesign.design.comparison`.

    Parameters
    ----------
    folders : iterable of path
        Two or more folders that ``suggest`` wrote.
    out : path, optional
        Folder of the report, which is not written without it; the next free number when it holds another answer.
    replace : bool
        Take the place of the other answer instead.

    Returns
    -------
    Result
        The same as ``dummydesign compare-designs --json`` prints for the same question.

    Raises
    ------
    InputError
        For fewer than two folders, and for one that holds no design.
    """
    from dummydesign.design.comparison import ANSWER
    from dummydesign.design.comparison import compare_designs as compare

    names = [fspath(folder) for folder in folders]
    found = compare(names)
    inputs = {"folders": names, "out": None if out is None else fspath(out)}
    if out is None:
        return Result(found, {"inputs": inputs, **found.to_dict(), "files": {}}, "compare-designs")
    from dummydesign.core.outputs.write import new_folder
    from dummydesign.report.compare_designs import write_designs_report

    asked = question("compare-designs", inputs, files=[f"{name}/{ANSWER}" for name in names])
    with new_folder(out, asked, replace=replace) as output:
        head = {"inputs": {**inputs, "out": str(output.folder)}, **found.to_dict()}
        result = output.answer({**head, "files": write_designs_report(output.work, found)})
    return Result(found, result, "compare-designs")

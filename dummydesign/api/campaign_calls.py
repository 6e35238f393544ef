"""The calls of the loop: :func:`calibrate` by a measured campaign, :func:`replay` one with a calibration."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from os import PathLike, fspath

from dummydesign.api.answers import Result

Paths = Iterable["str | PathLike[str]"]


def calibrate(
    campaign: str | PathLike[str],
    *,
    effects: Paths = (),
    out: str | PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Find what the model lacks in a measured campaign, and correct it; see :func:`dummydesign.loop.run.close_loop`.

    Parameters
    ----------
    campaign : path
        Folder with campaign.toml and one CSV per trial.
    effects : iterable of path
        Files with effects of your own.
    out : path, optional
        Folder of calibration and report, which are not written without it.
    progress : callable, optional
        Called with a word at each step.

    Returns
    -------
    Result
        The same as ``dummydesign loop --json`` prints for the same question.

    Raises
    ------
    InputError
        For files that cannot be used.
    """
    from dummydesign.core.files import output_folder
    from dummydesign.loop.calibration import calibration_of
    from dummydesign.loop.calibration_file import write_calibration
    from dummydesign.loop.effects.own import own_effects
    from dummydesign.loop.result import result_dict
    from dummydesign.loop.run import close_loop
    from dummydesign.measurement.campaign_file import read_campaign
    from dummydesign.report.loop import write_loop_report

    read = read_campaign(fspath(campaign))
    folder = None if out is None else output_folder(out)
    with own_effects([fspath(path) for path in effects]):
        found = close_loop(read, progress or (lambda word: None))
    inputs = {
        "campaign": fspath(campaign), "out": None if folder is None else str(folder), "trials": len(read.trials)
    }  # fmt: skip
    if folder is None:
        return Result(found, {"inputs": inputs, **result_dict(found), "calibration_file": None, "files": {}})
    calibration = str(write_calibration(calibration_of(found), folder / "calibration.json"))
    files = {"calibration": calibration, **write_loop_report(folder, found)}
    return Result(found, {"inputs": inputs, **result_dict(found), "calibration_file": calibration, "files": files})


def replay(campaign: str | PathLike[str], calibration: str | PathLike[str], *, effects: Paths = ()) -> Result:
    """Predict a campaign with a calibration and compare with what was measured.

    Parameters
    ----------
    campaign : path
        Folder with campaign.toml and one CSV per trial.
    calibration : path
        ``calibration.json`` of :func:`calibrate`.
    effects : iterable of path
        Files with effects of your own that the calibration names.

    Returns
    -------
    Result
        The same as ``dummydesign replay --json`` prints for the same question.

    Raises
    ------
    InputError
        For files that cannot be used.
    """
    from dummydesign.loop.calibration_file import read_calibration
    from dummydesign.loop.effects.own import own_effects
    from dummydesign.loop.replay import replay as predict_again
    from dummydesign.measurement.campaign_file import read_campaign

    with own_effects([fspath(path) for path in effects]):
        known, read = read_calibration(fspath(calibration)), read_campaign(fspath(campaign))
        found = predict_again(read, known)
    caution = [{"code": "calibration", "message": known.caution}] if known.caution else []
    result = {
        "inputs": {"campaign": fspath(campaign), "calibration": fspath(calibration)},
        "warnings": [*read.warnings, *caution],
        "verdict": known.verdict,
        "effects": [one.effect.name for one in known.after.active],
        **found.to_dict(),
        "warning_band_N": known.remainder_N,
    }
    return Result(found, result)

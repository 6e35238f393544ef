"""The calls of the loop: :func:`calibrate` by a measured campaign, :func:`replay` one with a calibration."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import ExitStack
from os import PathLike, fspath
from pathlib import Path

from dummydesign.api.answers import Result
from dummydesign.api.questions import question

Paths = Iterable["str | PathLike[str]"]


def calibrate(
    campaign: str | PathLike[str],
    *,
    effects: Paths = (),
    prior: str | PathLike[str] | None = None,
    plan: str | PathLike[str] | None = None,
    out: str | PathLike[str] | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Find what the model lacks in a measured campaign, and correct it; see :func:`dummydesign.loop.run.close_loop`.

    Parameters
    ----------
    campaign : path
        Folder with campaign.toml and one CSV per trial.
    effects : iterable of path
        Files with effects of your own.
    prior : path, optional
        ``calibration.json`` of an earlier campaign of the same material; see :mod:`dummydesign.loop.prior`.
    plan : path, optional
        Folder for the next measurement, as a campaign to press; the next free number when it holds something else.
    out : path, optional
        Folder of calibration and report, which are not written without it; the next free number when it holds
        another answer.
    replace : bool
        Take the place of the other answer instead.
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
    from dummydesign.core.outputs.write import new_folder
    from dummydesign.loop.answer import answer_dict
    from dummydesign.loop.calibration import calibration_of
    from dummydesign.loop.calibration_file import read_calibration, write_calibration
    from dummydesign.loop.effects.own import own_effects
    from dummydesign.loop.planning.plan import plan_of, write_plan
    from dummydesign.loop.result import result_dict
    from dummydesign.loop.run import close_loop
    from dummydesign.measurement.campaign_file import FILE, read_campaign
    from dummydesign.report.loop import write_loop_report

    read, own = read_campaign(fspath(campaign)), [fspath(path) for path in effects]
    inputs = {"campaign": fspath(campaign), "out": None if out is None else fspath(out), "trials": len(read.trials)}
    inputs |= {name: fspath(path) for name, path in (("prior", prior), ("plan", plan)) if path is not None}
    files: list[str | Path] = [read.folder / FILE, *(read.folder / trial.file for trial in read.trials), *own]
    files += read.records
    files += [] if prior is None else [fspath(prior)]
    asked = question("loop", inputs, files=files)
    with own_effects(own), ExitStack() as places:
        known = None if prior is None else read_calibration(fspath(prior))
        planned = None if plan is None else places.enter_context(new_folder(plan, asked, replace=replace))
        output = None if out is None else places.enter_context(new_folder(out, asked, replace=replace))
        found = close_loop(read, progress or (lambda word: None), prior=known)
        result = {"inputs": inputs, **answer_dict(found), **result_dict(found), "calibration_file": None}
        written: dict[str, str] = {}
        if planned is not None:
            written |= planned.settled(write_plan(planned.work, read, plan_of(found)))
        if output is None:
            return Result(found, {**result, "files": written}, "close_loop")
        calibration = str(write_calibration(calibration_of(found, known), output.path("calibration.json")))
        written |= {"calibration": calibration, **write_loop_report(output.work, found)}
        result["inputs"] = {**inputs, "out": str(output.folder)}
        output.extra["summary"] = {
            "campaign": read.folder.resolve().name, "verdict": result["verdict"],
            "effects": [one["name"] for one in result["effects"]], "text": result["answer"][0],
        }  # fmt: skip
        result = output.answer({**result, "calibration_file": calibration, "files": written})
    return Result(found, result, "close_loop")


def replay(
    campaign: str | PathLike[str], calibration: str | PathLike[str], *, tissue: str | None = None, effects: Paths = (),
    progress: Callable[[str], None] | None = None,
) -> Result:  # fmt: skip
    """Predict a campaign with a calibration and compare with what was measured.

    Parameters
    ----------
    campaign : path
        Folder with campaign.toml and one CSV per trial.
    calibration : path
        ``calibration.json`` of :func:`calibrate`.
    tissue : str, optional
        Name or file: each pad of the campaign is then judged by its presses, as :func:`compare` does.
    effects : iterable of path
        Files with effects of your own that the calibration names.
    progress : callable, optional
        Called with a word at each step.

    Returns
    -------
    Result
        The same as ``dummydesign replay --json`` prints for the same question.

    Raises
    ------
    InputError
        For files that cannot be used.
    """
    from dummydesign.design.assessment.verdict_of_campaign import verdicts_of_campaign
    from dummydesign.loop.calibration_file import read_calibration
    from dummydesign.loop.effects.own import own_effects
    from dummydesign.loop.replay import replay as predict_again
    from dummydesign.measurement.campaign_file import read_campaign
    from dummydesign.tissue.model.tissue_file import load_tissue

    site = None if tissue is None else load_tissue(tissue)
    with own_effects([fspath(path) for path in effects]):
        known, read = read_calibration(fspath(calibration)), read_campaign(fspath(campaign))
        found = predict_again(read, known, progress)
    caution = [{"code": "calibration", "message": known.caution}] if known.caution else []
    beyond = [{"code": "beyond_table", "message": found.left_out}] if found.left_out else []
    pads = () if site is None else verdicts_of_campaign(read, site)
    judged = [pad.verdict for pad in pads if pad.verdict is not None]
    unjudged = [{"code": "pad_not_judged", "message": f"{pad.shape or 'slab'} of {pad.thickness_mm:g} mm: {pad.reason}"}
                for pad in pads if pad.reason]  # fmt: skip
    result = {
        "inputs": {"campaign": fspath(campaign), "calibration": fspath(calibration), "tissue": tissue},
        "warnings": [*beyond, *read.warnings, *caution, *unjudged],
        "verdict": judged[0].to_dict() if judged else None,
        "pads": [pad.to_dict() for pad in pads],
        "calibration_verdict": known.verdict,
        "effects": [one.effect.name for one in known.after.active],
        **found.to_dict(),
        "warning_band_N": known.remainder_N,
    }
    return Result(found, result, "replay")

"""The calls of campaigns: plan, check, make; calibrate and replay."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from os import fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Result, question
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.files import FilePath
from dummydesign.core.parsing import SYSTEMS, one_of
from dummydesign.core.progress import quiet, write_progress

if TYPE_CHECKING:
    from dummydesign.loop.planning import Expected
    from dummydesign.measurement.campaign import Campaign
    from dummydesign.measurement.campaign_file import SetUp
    from dummydesign.measurement.campaign_plan import Planned, PlanSettings


def plan_campaign(
    folder: FilePath,
    set_up: SetUp,
    design: PlanSettings,
    *,
    power: bool = True,
    replace: bool = False,
    units: str = "mm",
) -> Result:
    """Make a randomised, balanced plan of presses, with its campaign file and a sheet to press from.

    Parameters
    ----------
    folder : DIR
        Folder to make.

        The next free number when there is another answer.
    set_up : SetUp
        Pad, punch and sensor.
    design : PlanSettings
        Pads, speeds, targets, repeats, days, seed.
    power
        Do not work out which effects the plan cannot see or tell apart.

        In Python ``power=False``.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).
    units : NAME
        Of the sheet: ``mm`` (default; mm, N) or ``in`` (inches, pounds-force).

    Returns
    -------
    Result
        The same as ``dummydesign campaign new --json`` prints.

    Raises
    ------
    InputError
        For values that cannot be pressed.
    """
    from dummydesign.core.outputs import new_folder
    from dummydesign.measurement.campaign_file import FILE, campaign_toml, no_ratio
    from dummydesign.measurement.campaign_plan import make_plan
    from dummydesign.report.campaign_sheet import sheet_html

    one_of("units", units, SYSTEMS)
    plan = make_plan(design)
    tables = set_up.tables()
    inputs = {"set_up": {**set_up.__dict__, "lowpass": tables["sensor"].get("lowpass_hz")}, "design": design.__dict__}
    comments = (
        f"{len(plan)} presses, seed {design.seed}; fill in temperature_C as they are pressed.",
        "'dummydesign campaign check' says what is missing, 'dummydesign loop' reads it when all is there.",
    )
    by_shape = _by_shape(set_up, tables, design.pads_mm)
    for campaign, pads_mm in by_shape:
        _check_set_up(campaign, pads_mm)
    summary = {key: ", ".join(f"{k} = {v}" for k, v in tables[key].items()) for key in ("pad", "punch", "sensor")}
    if set_up.shapes:
        summary["shapes"] = "; ".join(f"{thickness:g} mm: {shape}" for thickness, shape in set_up.shapes)
    with new_folder(folder, question("campaign new", inputs), replace=replace) as output:
        asked = plan
        plan, expected, summary["expected"], notes, material = _expected(plan, by_shape)
        slower = [one["message"] for one in notes if one["code"] == "speed_not_reached"]
        # shaped pads last: the power of a plan with one is not computed
        seen, warnings = _power(plan, by_shape[-1][0], design.seed) if power else (None, [])
        trials = [_trial(row, set_up) for row in plan]
        output.path(FILE).write_text(campaign_toml(set_up, trials, (*comments, *slower)), encoding="utf-8")
        _copy_profile(set_up, output.work)
        page = sheet_html(set_up.name, plan, summary, design.seed, expected, units)
        output.path("sheet.html").write_text(page, encoding="utf-8")
        result = output.answer(
            {
                "inputs": {**inputs, "folder": str(output.folder)},
                "trials": [
                    row | {"asked_velocity_mm_s": before.velocity_mm_s} | (expected[i].to_dict() if expected else {})
                    for i, (row, before) in enumerate(zip(trials, asked))
                ],
                "expected": material,
                "power": seen,
                "files": {"campaign": str(output.path(FILE)), "sheet": str(output.path("sheet.html"))},
                "warnings": [*no_ratio(set_up.ratio), *notes, *warnings],
            }
        )
    return Result(plan, result, "plan_campaign")


def _expected(
    plan: tuple[Planned, ...], by_shape: Sequence[tuple[Campaign, tuple[float, ...]]]
) -> tuple[tuple[Planned, ...], tuple[Expected, ...], str, list[dict[str, str]], dict[str, Any] | None]:
    """The plan at speeds that are reached; depth or force of each press, what the sheet says of it, warnings, and the
    material: nothing without a law."""
    from dummydesign.loop.model.material import material_of
    from dummydesign.loop.planning import at_reached_speed, expected_presses
    from dummydesign.measurement.motion import DECELERATION_MM_S2

    what = "force" if plan[0].by_depth else "depth"
    try:
        material = material_of(by_shape[0][0])
        of_press: dict[int, Expected] = {}
        for campaign, pads_mm in by_shape:
            rows = tuple(row for row in plan if row.thickness_mm in pads_mm)
            of_press.update(
                zip((row.sequence for row in rows), expected_presses(rows, campaign, material, write_progress))
            )
        expected = tuple(of_press[row.sequence] for row in plan)
    except (InputError, NoAnswerError) as problem:
        message = f"no {what} beside the {'depth' if plan[0].by_depth else 'force'} of each press: {problem}"
        return plan, (), message, [{"code": "no_expected", "message": message}], None
    young = material.young_kPa
    known = young.high > young.low
    interval = f" (95 %: {young.low:.3g} to {young.high:.3g} kPa)" if known else " (interval not known)"
    arms = "with the resin's relaxation" if material.prony else "without relaxation"
    words = f"{what} for a modulus of {young.value:.3g} kPa{interval}, {arms}; in brackets the 95 % interval "
    words += "by modulus and force law" if known else "by the force law alone"
    deep = [row.file for row, one in zip(plan, expected) if one.beyond]
    may = [row.file for row, one in zip(plan, expected) if one.may_go_beyond and not one.beyond]
    notes = []
    for code, files, verb in (("beyond_depth_limit", deep, "goes"), ("may_go_beyond_depth_limit", may, "may go")):
        if files:
            listed = f"{len(files)} presses ({files[0]}{', ...' if len(files) > 1 else ''})"
            message = f"{listed}: the punch {verb} deeper than 0.6 of the pad's thickness, or than the model reaches; "
            notes.append({"code": code, "message": message + "take a smaller force or a thicker pad"})
    reached = tuple(map(at_reached_speed, plan, expected))
    if slower := [(row, one) for row, one in zip(plan, reached) if row != one]:
        row, one = min(slower, key=lambda pair: pair[1].velocity_mm_s)
        message = (
            f"{len(slower)} press{'es are' if len(slower) > 1 else ' is'} planned slower than asked "
            f"({row.file}: {one.velocity_mm_s:g} mm/s, not {row.velocity_mm_s:g}): "
            f"braking with {DECELERATION_MM_S2 / 1e3:g} m/s2 from contact on, a robot touches no faster"
        )
        notes.append({"code": "speed_not_reached", "message": message})
        words += f". {message}"
    return reached, expected, words, notes, material.to_dict()


def _check_set_up(campaign: Campaign, pads_mm: Iterable[float]) -> None:
    """Refuse what could not be read or solved once it is pressed."""
    from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, check_covers
    from dummydesign.loop.model.campaign_law import check_round
    from dummydesign.measurement.campaign import check_edge

    pad, punch, geometry = campaign.pad, campaign.punch, campaign.pad.geometry
    length_mm, width_mm = pad.length_mm or PAD_LENGTH_MM, pad.width_mm or PAD_WIDTH_MM
    check_edge(pad, punch, [geometry])
    widest = 0.0 if punch.shape == "plate" else punch.side_mm or 2.0 * punch.radius_mm
    check_covers(f"{length_mm:g}x{width_mm:g}", (length_mm, width_mm), widest, punch.text)
    if geometry.plain:
        return
    if punch.profile_mm is not None:
        message = f"shape {geometry} is pressed by a flat punch, not by a {punch.shape}"
        raise InputError(message, "conflict", "shape", str(geometry))
    check_round(geometry)
    for thickness in pads_mm:
        geometry.check(thickness, length_mm, width_mm)


def _copy_profile(set_up: SetUp, folder: Path) -> None:
    """Put the profile of the punch beside the campaign file."""
    import shutil

    from dummydesign.geometry.punch import read_profile

    if set_up.profile is not None:
        read_profile(set_up.profile)
        shutil.copyfile(set_up.profile, folder / set_up.profile.name)


def _by_shape(
    set_up: SetUp, tables: Mapping[str, Mapping[str, Any]], pads_mm: Iterable[float]
) -> list[tuple[Campaign, tuple[float, ...]]]:
    """A campaign without trials for each shape, with the thicknesses of its pads; slabs come first."""
    groups: dict[str, tuple[float, ...]] = {}
    for thickness in pads_mm:
        shape = set_up.shape_of(thickness)
        groups[shape] = (*groups.get(shape, ()), thickness)
    if len(groups) == 1:
        return [(_empty_campaign(set_up, tables), tuple(pads_mm))]
    made = [
        (_empty_campaign(set_up, {**tables, "pad": {**tables["pad"], "shape": shape}}), own)
        for shape, own in groups.items()
    ]
    return sorted(made, key=lambda one: not one[0].pad.geometry.plain)


def _trial(row: Planned, set_up: SetUp) -> dict[str, Any]:
    shape = {"shape": set_up.shape_of(row.thickness_mm)} if set_up.shapes else {}
    return {
        "file": row.file,
        "thickness_mm": row.thickness_mm,
        **shape,
        "velocity_mm_s": row.velocity_mm_s,
        "hold_s": row.hold_s,
        ("target_depth_mm" if row.by_depth else "target_force_N"): row.target,
        "repeat": row.repeat,
        "sequence": row.sequence,
        "rest_s": row.rest_s,
        "age_days": row.age_days,
        "unload": row.unload,
        "temperature_C": None,
    }


def _power(
    plan: tuple[Planned, ...], campaign: Campaign, seed: int
) -> tuple[dict[str, Any] | None, list[dict[str, str]]]:
    """The effects that the plan can detect; a warning for a set-up without a tabulated force."""
    from dummydesign.loop.model.material import material_of
    from dummydesign.loop.planning import plan_power

    try:
        power = plan_power(plan, campaign, 1e-3 * material_of(campaign).young_kPa.value, seed)
    except InputError as problem:
        message = f"which effects this plan can detect is not known for this pad and punch: {problem}"
        return None, [{"code": "no_power", "message": message}]
    return power.to_dict(), []


def _empty_campaign(set_up: SetUp, tables: Mapping[str, Mapping[str, Any]]) -> Campaign:
    from dummydesign.geometry.punch import ball_profile, read_profile
    from dummydesign.geometry.shape_registry import read_shape
    from dummydesign.geometry.shapes.slab import Slab
    from dummydesign.measurement.campaign import Campaign, PadSpec, PunchSpec

    pad, punch = tables["pad"], tables["punch"]
    profile = ball_profile(punch["diameter_mm"]) if punch["shape"] == "ball" else None
    profile = read_profile(set_up.profile) if set_up.profile is not None else profile
    return Campaign(
        set_up.name,
        Path(),
        PadSpec(
            pad.get("young_kPa_nominal"),
            pad.get("resin"),
            pad.get("ratio"),
            "cylinder" if pad.get("shape") == "cylinder" else "slab",
            pad.get("length_mm"),
            pad.get("width_mm"),
            pad.get("diameter_mm"),
            pad["base"],
            Slab() if pad.get("shape") in (None, "cylinder") else read_shape(pad["shape"]),
        ),
        PunchSpec(
            punch["shape"],
            punch.get("side_mm"),
            punch.get("diameter_mm"),
            punch["contact"],
            profile,
            punch.get("edge_radius_mm", 0.0),
        ),
        set_up.lowpass,
        set_up.force_resolution_N,
        (),
    )


def check_campaign(folder: FilePath) -> Result:
    """Say what of a campaign is not yet pressed, and what looks wrong.

    Parameters
    ----------
    folder : DIR
        Folder with campaign.toml.

    Returns
    -------
    Result
        The same as ``dummydesign campaign check --json`` prints.

    Raises
    ------
    InputError
        When there is no campaign.
    """
    from dummydesign.measurement.campaign_presses import check_campaign as status_of_campaign

    status = status_of_campaign(fspath(folder))
    result = {
        "inputs": {"folder": fspath(folder)},
        "name": status.name,
        "ready": status.ready,
        "pressed": list(status.pressed),
        "missing": list(status.missing),
        "wrong": list(status.wrong),
        "warnings": list(status.warnings),
    }
    return Result(status, result, "check_campaign")


def campaign_from_files(
    folder: FilePath,
    files: Iterable[FilePath],
    set_up: SetUp,
    *,
    table: FilePath | None = None,
    thickness_mm: float | None = None,
    replace: bool = False,
) -> Result:
    """Make a campaign of traces that one has; they are copied, never changed.

    Parameters
    ----------
    folder : DIR
        Folder to make; the traces are copied into it.

        The next free number when there is another answer.
    files : FILE ...
        Traces, named such as t05_v010_f03_1.csv.
    set_up : SetUp
        Pad, punch and sensor.
    table : trials.csv
        file,thickness_mm,velocity_mm_s,... of each press.
    thickness_mm : MM
        Of pads whose file name and row do not say. [mm]
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).

    Returns
    -------
    Result
        The same as ``dummydesign campaign from-files --json`` prints.

    Raises
    ------
    InputError
        For files that are no traces, and for what they leave open, with the option that settles it.
    """
    import shutil

    from dummydesign.core.outputs import new_folder
    from dummydesign.measurement.campaign_file import FILE, campaign_toml, read_campaign
    from dummydesign.measurement.campaign_presses import trials_of

    paths = [Path(file) for file in files]
    tables = set_up.tables()
    trials, decisions = trials_of(paths, None if table is None else fspath(table), thickness_mm)
    inputs = {
        "files": [str(path) for path in paths],
        "table": None if table is None else fspath(table),
        "thickness_mm": thickness_mm,
        "set_up": {**set_up.__dict__, "lowpass": tables["sensor"].get("lowpass_hz")},
    }
    asked = question("campaign from-files", inputs, files=[*paths, table])
    with new_folder(folder, asked, replace=replace) as output:
        for path in paths:
            shutil.copyfile(path, output.path(path.name))
        _copy_profile(set_up, output.work)
        output.path(FILE).write_text(campaign_toml(set_up, trials), encoding="utf-8")
        read = read_campaign(output.work)
        result = output.answer(
            {
                "inputs": {**inputs, "folder": str(output.folder)},
                "trials": trials,
                "decisions": decisions,
                "files": {"campaign": str(output.path(FILE))},
                "warnings": list(read.warnings),
            }
        )
    return Result(trials, result, "campaign_from_files")


Paths = Iterable[FilePath]


def calibrate(
    campaign: FilePath,
    *,
    effects: Paths = (),
    prior: FilePath | None = None,
    plan: FilePath | None = None,
    out: FilePath | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Find what the model lacks in a measured campaign, and correct it; see :func:`dummydesign.loop.run.close_loop`.

    Parameters
    ----------
    campaign : CAMPAIGN_DIR
        Folder with campaign.toml and one CSV per trial.
    prior : CALIBRATION
        calibration.json of an earlier campaign of the same material.

        See :mod:`dummydesign.loop.calibration`.
    plan : DIR
        Write the next measurement as a campaign to press.

        The next free number when the folder holds something else.
    out : DIR
        Where report and calibration go (default: loop-NAME).

        Without it nothing is written; the next free number when it holds another answer.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).
    effects : --effect FILE.py ...
        File with one effect class of your own; its code is run; may be repeated.
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
    from dummydesign.core.outputs import new_folder
    from dummydesign.design.calibrated import settles_modulus
    from dummydesign.loop.calibration import calibration_of
    from dummydesign.loop.calibration_file import read_calibration, write_calibration
    from dummydesign.loop.effects.registry import own_effects
    from dummydesign.loop.planning import plan_of, write_plan
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
        calibrated = close_loop(read, progress or quiet, prior=known)
        result = {"inputs": inputs, **result_dict(calibrated), "calibration_file": None}
        written: dict[str, str] = {}
        if planned is not None:
            written |= planned.settled(write_plan(planned.work, read, plan_of(calibrated)))
        if output is None:
            return Result(calibrated, {**result, "files": written}, "close_loop")
        learned = calibration_of(calibrated, known)
        calibration = str(write_calibration(learned, output.path("calibration.json")))
        written |= {"calibration": calibration, **write_loop_report(output.work, calibrated)}
        result["inputs"] = {**inputs, "out": str(output.folder)}
        output.extra["summary"] = {
            "campaign": read.folder.resolve().name,
            "verdict": result["verdict"],
            "effects": [one["name"] for one in result["effects"]],
            "text": result["answer"][0],
            "designable": settles_modulus(learned),
        }
        result = output.answer({**result, "calibration_file": calibration, "files": written})
    return Result(calibrated, result, "close_loop")


def replay(
    campaign: FilePath,
    calibration: FilePath,
    *,
    tissue: str | None = None,
    effects: Paths = (),
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Predict a campaign with a calibration and compare with what was measured.

    Parameters
    ----------
    campaign : CAMPAIGN_DIR
        Folder with campaign.toml and one CSV per trial.
    calibration : --calibration FILE
        calibration.json of 'dummydesign loop'.
    tissue : NAME|FILE
        Judge each pad of the campaign by its presses, as 'compare' does.
    effects : --effect FILE.py ...
        File with one effect class of your own; its code is run; may be repeated.
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
    from dummydesign.core.serialise import to_plain
    from dummydesign.design.measured_pad import verdicts_of_campaign
    from dummydesign.loop.calibration_file import read_calibration
    from dummydesign.loop.effects.registry import own_effects
    from dummydesign.loop.run import HOLDS_WITHIN
    from dummydesign.loop.run import replay as predict_again
    from dummydesign.measurement.campaign_file import read_campaign
    from dummydesign.tissue.model.tissue_file import load_tissue

    site = None if tissue is None else load_tissue(tissue)
    with own_effects([fspath(path) for path in effects]):
        known, read = read_calibration(fspath(calibration)), read_campaign(fspath(campaign))
        replayed = predict_again(read, known, progress or quiet)
    caution = [{"code": "calibration", "message": known.caution}] if known.caution else []
    beyond = [{"code": "beyond_table", "message": replayed.left_out}] if replayed.left_out else []
    pads = () if site is None else verdicts_of_campaign(read, site)
    judged = [pad.verdict for pad in pads if pad.verdict is not None]
    unjudged = [
        {"code": "pad_not_judged", "message": f"{pad.shape or 'slab'} of {pad.thickness_mm:g} mm: {pad.reason}"}
        for pad in pads
        if pad.reason
    ]
    result = {
        "inputs": {"campaign": fspath(campaign), "calibration": fspath(calibration), "tissue": tissue},
        "warnings": [*beyond, *read.warnings, *caution, *unjudged],
        "verdict": judged[0].to_dict() if judged else None,
        "budget": next((to_plain(pad.budget) for pad in pads if pad.verdict is not None), None),
        "pads": [pad.to_dict() for pad in pads],
        "calibration_verdict": known.verdict,
        "effects": [one.effect.name for one in known.after.active],
        **replayed.to_dict(),
        "holds": replayed.total_rmse_N <= HOLDS_WITHIN * known.noise_floor_N,
        "noise_floor_N": known.noise_floor_N,
        "warning_band_N": known.remainder_N,
    }
    return Result(replayed, result, "replay")

"""``dummydesign campaign``: plan the presses of a cast pad, check how far they are, make a campaign of files."""

from __future__ import annotations

import argparse
import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.cli.common_options import add_options, call
from dummydesign.cli.text import file_lines, files_block, labelled, screen, warning_block, warning_lines
from dummydesign.core.errors import InputError, NoAnswerError

if TYPE_CHECKING:
    from dummydesign.measurement.campaign_file import SetUp
    from dummydesign.measurement.campaign_plan import PlanSettings

PLAN, CHECK, FROM_FILES = "campaigns.plan_campaign", "campaigns.check_campaign", "campaigns.campaign_from_files"
HELP = "Plan presses (randomised, with a sheet to press from), check them, or make a campaign from files."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the actions."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="new|check|from-files", help="what to do")
    new = actions.add_parser("new", help="a plan, campaign.toml and a sheet to press from")
    files = actions.add_parser("from-files", help="campaign.toml from existing traces")
    calls: dict[Any, tuple[Any, ...]] = {new: (_design, PLAN), files: (FROM_FILES,)}
    for one, functions in calls.items():
        for function in (*functions, _set_up):
            add_options(one, function)
    add_options(actions.add_parser("check", help="what is not yet pressed, and problems"), CHECK)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Do the action and return plain values."""
    if options.action == "check":
        status = call(CHECK, options).to_dict()
        if status["wrong"]:
            count = len(status["wrong"])
            problems = f"{count} problem{'s' if count > 1 else ''} in {options.folder}"
            raise NoAnswerError("campaign_wrong", problems, status, "campaign")
        return status
    moulded = _moulded(options) if options.action == "new" and options.from_mould is not None else None
    set_up = call(_set_up, options, moulded=moulded)
    if options.action == "from-files":
        return call(FROM_FILES, options, set_up=set_up).to_dict()
    design = call(_design, options, moulded=moulded)
    plan = call(PLAN, options, set_up=set_up, design=design).to_dict()
    if moulded is not None:
        plan["inputs"]["from_mould"] = list(moulded.folders)
    elif options.pads is None:
        plan["warnings"] = [*plan["warnings"], *_unused_moulds()]
    return plan


def _moulded(options: argparse.Namespace) -> Any:
    """The pads of the moulds that are named; what they settle cannot be typed too."""
    from dummydesign.mold.moulded_pads import moulded_pads

    for name in ("pads", "pad", "shape"):
        if getattr(options, name):
            message = f"--from-mould with --{name}: the moulds settle it; leave one of the two out"
            raise InputError(message, "conflict", name)
    pads = moulded_pads([part for part in options.from_mould.split(",") if part])
    if options.young is None:
        # a batch of one's own, or another ratio in the same mould, is typed
        resin, ratio = pads.pour() if options.resin is None or options.ratio is None else (None, None)
        options.resin = resin if options.resin is None else options.resin
        options.ratio = ratio if options.ratio is None else options.ratio
    return pads


def _unused_moulds() -> list[dict[str, str]]:
    """A hint in a project that has moulds."""
    from dummydesign.mold.moulded_pads import SPEC
    from dummydesign.project.folder import find_project

    project = find_project()
    made = (
        []
        if project is None
        else [
            folder
            for room in ("moulds", "designs")
            for folder in sorted((project.root / room).glob("[!.]*"))
            if (folder / SPEC).is_file() or any(folder.glob(f"[!.]*/{SPEC}"))
        ]
    )
    if not made:
        return []
    listed = shlex.quote(",".join(os.path.relpath(folder) for folder in made))
    message = f"the pads are the default ones, not those of the project's moulds; --from-mould {listed} plans these"
    return [{"code": "moulds_not_used", "message": message}]


def _set_up(
    folder: str,
    *,
    name: str | None = None,
    young: str | None = None,
    resin: str | None = None,
    ratio: float | None = None,
    pad: str | None = None,
    shape: str | None = None,
    punch: str = "square:14",
    edge_radius: str | float = 0.0,
    base: str = "bonded",
    contact: str = "bonded",
    lowpass: str | None = None,
    moulded: Any = None,
) -> SetUp:
    """Pad, punch and sensor, of moulds where there are any.

    Parameters
    ----------
    name : NAME
        Of the campaign (default the folder's).
    young : KPA
        Nominal modulus of the pads.
    resin : NAME
        Or the resin they are cast of, with --ratio.
    ratio : R
        Mixing ratio; without it the campaign leads to no recipe.
    pad : LxW|cylinder:D
        Outline in mm (default 150x120).
    shape : NAME:P,..
        Of the pads on their base, with its lengths: crowned:radius=20,height=3,foot=11 (default slab).
    punch : SHAPE
        ``square:14`` (default), ``round:D``, ``ball:D``, ``profile:FILE.csv`` or ``plate``.
    edge_radius : MM
        Fillet of the punch's edge (default 0, sharp).
    base : BASE
        ``bonded`` (default), ``sliding`` or ``friction:MU``.
    contact : CONTACT
        Of the punch: ``bonded`` (default), ``frictionless`` or ``friction:MU``.
    lowpass : HZ[:ORDER[:PASSES]]
        Filter the force went through before it was saved.
    """
    from dummydesign.core.parsing import EDGE, YOUNG, YOUNG_KPA, read_allowed, read_number
    from dummydesign.measurement.campaign_file import SetUp
    from dummydesign.measurement.sensor import parse_lowpass

    if resin is not None:
        from dummydesign.resin import load_resin

        material = load_resin(resin)
        if ratio is not None:
            material.check_ratio(ratio)
    return SetUp(
        name or Path(folder).resolve().name,
        None if young is None else read_allowed(young, YOUNG, *YOUNG_KPA),
        resin,
        ratio,
        moulded.outline if moulded else pad or "150x120",
        punch,
        base,
        contact,
        parse_lowpass(lowpass),
        shape=moulded.shape if moulded else shape or "slab",
        edge_radius_mm=read_number(edge_radius, EDGE),
        shapes=moulded.shapes if moulded and moulded.mixed else (),
    )


def _design(
    *,
    pads: str | None = None,
    from_mould: str | None = None,
    velocity: str | None = None,
    force: str | None = None,
    depth: str | None = None,
    repeats: int | None = None,
    ages: str | None = None,
    rest: str | None = None,
    hold: str | None = None,
    seed: int = 1,
    moulded: Any = None,
) -> PlanSettings:
    """What is pressed, how often and when; the pads are those of ``from_mould`` where these are read.

    Parameters
    ----------
    pads : MM,...
        Thicknesses of the pads (default 5,15,20).
    from_mould : DIR,...
        Press the pads of these moulds: thickness, shape, outline, resin and ratio of folders of 'mold'.
    velocity : MM_S,...
        Default 10,250.
    force : N,...
        Steady forces to press to (default 5,10,15).
    depth : MM,...
        Depths to press to, instead of forces.
    repeats : N
        Of every condition, on different days (default 2).
    ages : DAYS,...
        Age of the pads on each day of pressing (default 9,14,29).
    rest : S
        Rest between presses of a pad (default 60).
    hold : S
        Default 10.
    seed : N
        Of the order (default 1).
    """
    from dummydesign.core import parsing
    from dummydesign.measurement.campaign_plan import PlanSettings

    if force is not None and depth is not None:
        raise InputError("--force and --depth: press to the one or to the other", "conflict", "depth")

    typed = (
        ("pads_mm", pads, parsing.THICKNESS),
        ("velocities_mm_s", velocity, parsing.VELOCITY),
        ("targets", depth, parsing.DEPTH),
        ("targets", force, parsing.FORCE),
    )
    given: dict[str, Any] = {
        name: parsing.read_numbers(text, purpose) for name, text, purpose in typed if text is not None
    }
    given |= {"pads_mm": moulded.pads_mm} if moulded else {}
    if ages is not None:
        try:
            given["ages_days"] = tuple(float(part) for part in ages.split(","))
        except ValueError:
            message = f"--ages {ages} must be numbers separated by commas"
            raise InputError(message, "not_a_number", "ages", ages) from None
    given |= {} if repeats is None else {"repeats": repeats}
    for name, text, purpose in (("rest_s", rest, parsing.REST), ("hold_s", hold, parsing.HOLD)):
        given |= {} if text is None else {name: parsing.read_number(text, purpose)}
    return PlanSettings(**given, by_depth=depth is not None, seed=seed)


def render(result: dict[str, Any]) -> str:
    """What was planned, what the plan can see, and what to do next."""
    if "ready" in result:
        return _status(result)
    if "decisions" in result:
        table = [f"  {one['what']:<28} {one['value']} ({one['why']})" for one in result["decisions"]]
        return screen([], table, warning_block(result), files_block(result, ("campaign",)))
    first, power = _plan(result)[0], result["power"]
    head = labelled("PLAN", first)
    for label, names in (
        ()
        if power is None
        else (
            ("DETECTS", list(power["seen"])),
            ("MISSES", list(power["hidden"])),
            ("ALIKE", [f"{' and '.join(pair['effects'])} look the same in this plan" for pair in power["alike"]]),
            ("NO TEST", list(power["untested"])),
        )
    ):
        head += labelled(label, ", ".join(names), 4)
    return screen(
        head,
        [],
        warning_block(result),
        labelled(
            "NEXT",
            "print the sheet, press in its order and save each trace under its name in the folder; then "
            f"dummydesign campaign check {shlex.quote(result['inputs']['folder'])}",
        ),
        files_block(result, ("sheet", "campaign")),
        labelled("MORE", "--details: sizes of the effects that this plan misses"),
    )


def render_details(result: dict[str, Any]) -> str:
    """Make the readable text."""
    if "ready" in result:
        return _status(result)
    made = [f"{one['what']:<28} {one['value']} (by {one['why']})" for one in result.get("decisions", [])]
    lines = made if "decisions" in result else _plan(result)
    return "\n".join(lines + file_lines(result) + warning_lines(result))


def _plan(result: dict[str, Any]) -> list[str]:
    trials = result["trials"]
    days = sorted({trial["age_days"] for trial in trials})
    per_day = ", ".join(f"{sum(t['age_days'] == day for t in trials)} at {day:g} days" for day in days)
    back = sum(trial["unload"] for trial in trials)
    lines = [f"{len(trials)} presses in random order: {per_day}; {back} also record the unloading"]
    power = result["power"]
    if power is None:
        return lines
    lines.append(f"this plan detects, at their usual size: {', '.join(power['seen']) or 'nothing'}")
    if power["hidden"]:
        hidden = ", ".join(f"{name} ({size:.1f} standard deviations)" for name, size in power["hidden"].items())
        lines.append(f"this plan cannot detect, at their usual size: {hidden}")
    for pair in power["alike"]:
        lines.append(f"look alike: {' and '.join(pair['effects'])} (cosine {pair['cosine']:.2f})")
    lines += [f"not testable: {name}: {reason}" for name, reason in power["untested"].items()]
    return lines


def _status(result: dict[str, Any]) -> str:
    done, left = len(result["pressed"]), len(result["missing"])
    lines = [f"{result['name']}: {done} of {done + left} presses are there"]
    lines += [f"to press: {name}" for name in result["missing"][:5]]
    if left > 5:
        lines.append(f"  ... and {left - 5} more")
    lines += [f"wrong: {one['file']}{': ' if one['file'] else ''}{one['message']}" for one in result["wrong"]]
    if result["ready"]:
        lines.append(f"ready: dummydesign loop {shlex.quote(result['inputs']['folder'])}")
    return "\n".join(lines + warning_lines(result))

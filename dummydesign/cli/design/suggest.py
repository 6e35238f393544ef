"""``dummydesign suggest``: recipe, pad and mould for a tissue."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.shared_options import add_effect_option, add_replace_option
from dummydesign.cli.steps import Steps, steps_shown

ABOUT_STEPS = 8
HELP = "Recommend resin ratio, pad thickness, weights to pour and a mould for a tissue."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what can be asked."""
    from dummydesign.geometry.shape_names import shape_help

    add = parser.add_argument
    add("--tissue", required=True, metavar="NAME|FILE", help="see 'dummydesign tissues list'")
    add("--aim", default="average", metavar="AIM", help="average (default), safe-side or subject:NAME")
    add("--resin", default="polyurethane-nagoya", metavar="NAME|FILE", help="see 'dummydesign resins list'")
    add("--thickness", metavar="MIN:MAX", help="limits in mm, inside 3 to 30")
    add("--ratio", metavar="MIN:MAX", help="limits of the mixing ratio, inside the resin's range")
    add("--calibration", metavar="FILE", help="file written by 'dummydesign loop'; none leaves a project's out")
    add_effect_option(parser)
    shapes = shape_help("auto", default="auto") + "; lengths that are not given are searched"
    add("--shape", default="auto", metavar="NAME[:P,..]", help=shapes)
    add("--cad", action="store_true", help="make the mould also of a pad that is not acceptable")
    add("--no-cad", action="store_true", help="skip the mould; write recipe and report only")
    add("--no-verify", action="store_true", help="do not check the design by finite elements")
    _add_test(parser)
    add("--balance", default=0.1, metavar="G", help="error of weighing, plus and minus (default 0.1 g)")
    tolerance = "error of the cast thickness, plus and minus (default 0.2 mm)"
    add("--thickness-tolerance", default=0.2, metavar="MM", help=tolerance)
    drawn = "castings that are drawn for every share and factor (default 1200, which is the least)"
    add("--castings", default=1200, metavar="N", help=drawn)
    add("--robot-mass", metavar="KG", help="safety view: mass of the free body that hits tissue and pad")
    add("--robot-velocity", metavar="MM_S", help="its speed, with --robot-mass (default 250 mm/s)")
    add("--limits", metavar="FILE", help="safety view: your limits of force and pressure, with their source (TOML)")
    add("--out", metavar="DIR", help="folder of the files (default suggest-TISSUE)")
    add_replace_option(parser)


def _add_test(parser: argparse.ArgumentParser) -> None:
    """One's own test: how people and pad are pressed, and what the mould must fit."""
    test = parser.add_argument_group("your own test", "numbers may carry their unit: 0.25m/s, 10mm/s")
    add = test.add_argument
    punches = "square:14 (default), rectangle:AxB, round:D, ball:D, profile:FILE.csv"
    add("--punch", default="square:14", metavar="KIND:SIZE", help=punches)
    add("--edge-radius", default=0.0, metavar="MM", help="fillet of the punch's edge (default 0, sharp)")
    faces = "bonded (default; under a ball or a profile frictionless), frictionless, friction:MU"
    add("--condition", metavar="NAME", help=faces)
    add("--force", default="5,10,15", metavar="F1,F2,...", help="steady forces (default 5,10,15 N)")
    add("--velocity", default="10,250", metavar="V1,V2,...", help="speeds (default 10,250 mm/s)")
    add("--hold", default=10.0, metavar="S", help="hold after the stop (default 10 s)")
    add("--deceleration", default=30000.0, metavar="MM_S2", help="braking (default 30000 mm/s2)")
    add("--pad", default="150x120", metavar="LxW", help="length and width of the pad (default 150x120 mm)")
    add("--base", default="bonded", metavar="NAME", help="bonded (default), sliding or friction:MU")
    sites = "crowns along and across one pad, such as 4x3, far enough apart to be independent (solved)"
    add("--sites", metavar="NxM", help=sites)
    presets = "mould preset: open (default), lidded, printed or a TOML file"
    add("--preset", default="open", metavar="NAME|FILE", help=presets)
    add("--machine", metavar="NAME|FILE", help="printer, vacuum chamber and oven the mould must fit")
    add("--silicone", metavar="NAME|FILE", help="silicone of the mould")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Find the design, make its mould, write the report and return the answer."""
    from dummydesign.core.errors import NoAnswerError

    with steps_shown(ABOUT_STEPS) as steps:
        answer = _asked(options, steps)
    result = answer.to_dict()
    if not answer.found.verdict.acceptable:
        text = f"no acceptable pad: the best one found is {result['verdict']['level'].replace('_', ' ')}"
        text += "" if options.cad or options.no_cad else "; no mould was made of it (--cad makes it all the same)"
        raise NoAnswerError("no_acceptable_pad", text, result)
    return result


def _asked(options: argparse.Namespace, steps: Steps) -> Any:
    from dummydesign.api import suggest

    return suggest(
        options.tissue,
        aim=options.aim,
        resin=options.resin,
        thickness_mm=options.thickness,
        ratio=options.ratio,
        shape=options.shape,
        calibration=None if options.calibration == "none" else options.calibration,
        effects=options.effect,
        verify=not options.no_verify,
        cad=False if options.no_cad else (True if options.cad else None),
        punch=options.punch,
        force_N=options.force,
        velocity_mm_s=options.velocity,
        hold_s=options.hold,
        deceleration_mm_s2=options.deceleration,
        pad=options.pad,
        base=options.base,
        edge_radius_mm=options.edge_radius,
        condition=options.condition,
        preset=options.preset,
        machine=options.machine,
        silicone=options.silicone,
        sites=options.sites,
        castings=options.castings,
        balance_g=options.balance,
        thickness_tolerance_mm=options.thickness_tolerance,
        robot_mass_kg=options.robot_mass,
        robot_velocity_mm_s=options.robot_velocity,
        limits=options.limits,
        out=default_out(options) if options.out is None else options.out,
        replace=options.replace,
        progress=steps,
    )


def render(result: dict[str, Any]) -> str:
    """The answer on one screen."""
    from dummydesign.cli.texts.suggested import render

    return render(result)


def render_details(result: dict[str, Any]) -> str:
    """All of the answer."""
    from dummydesign.cli.texts.suggested_details import details

    return details(result)


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    from pathlib import Path

    return f"suggest-{Path(options.tissue).stem}"

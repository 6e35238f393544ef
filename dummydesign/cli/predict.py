"""``dummydesign predict``: the force of one pad."""

from __future__ import annotations

import argparse
from typing import Any

HELP = "Force of one pad at static depths, under a measured motion, or in a ramp and hold."
SHOWN = 25


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the pad, the material and what is done to it."""
    add = parser.add_argument
    add("--young", type=float, metavar="KPA", help="long-term Young's modulus in kPa")
    add("--resin", metavar="NAME|FILE", help="resin, with --ratio")
    add("--ratio", type=float, metavar="R", help="mixing ratio of the resin")
    add("--thickness", type=float, required=True, metavar="MM")
    add("--depth", metavar="D1,D2,...", help="static depths in mm")
    add("--motion", metavar="FILE.csv", help="measured motion: columns time_s, displacement_mm")
    add("--force", type=float, metavar="N", help="force at the end of a ramp and hold, with --velocity")
    add("--velocity", type=float, metavar="MM_S", help="speed of the ramp")
    add("--hold", type=float, default=10.0, metavar="S", help="hold after the stop (default 10 s)")
    add("--deceleration", type=float, default=30000.0, metavar="MM_S2", help="braking (default 30000 mm/s2)")
    punches = "square:14 (default), round:D, rectangle:AxB, profile:FILE.csv, plate"
    add("--punch", default="square:14", metavar="KIND:SIZE", help=punches)
    add("--condition", default="bonded", metavar="NAME", help="bonded (default), frictionless, friction:MU")
    add("--base", default="bonded", metavar="NAME", help="bonded (default), sliding or friction:MU")
    add("--pad", default="slab:150x120", metavar="slab:LxW", help="slab (default 150x120 mm) or cylinder:DIAMETER")
    shapes = "slab (default), crowned:RADIUS,HEIGHT[,FOOT], bumped, layered, boned"
    add("--shape", default="slab", metavar="NAME[:P,..]", help=shapes)
    add("--poisson", type=float, default=0.5, metavar="NU", help="Poisson's ratio (default 0.5)")
    laws = "neo-hookean (default), yeoh:C2_OVER_MU or ogden:MU,ALPHA;MU,ALPHA (scaled to the modulus)"
    add("--law", default="neo-hookean", metavar="NAME", help=laws)
    add("--prony", metavar="TAU:BETA,...", help="relaxation, beta relative to the long-term modulus")
    add("--fidelity", default="table", metavar="NAME", help="table (default), axisymmetric, 3d or viscoelastic")
    add("--out", metavar="FILE.csv", help="write the curve as CSV")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Predict, write the curve if asked, and return it."""
    from dummydesign.core.errors import InputError
    from dummydesign.measurement.motion import ramp_and_hold
    from dummydesign.measurement.motion_file import read_motion
    from dummydesign.pad.predict import depth_for_steady_force, predict_motion, predict_static

    asked = [name for name in ("depth", "motion", "force") if getattr(options, name) is not None]
    if len(asked) != 1:
        raise InputError(f"give exactly one of --depth, --motion and --force, not {len(asked)}")
    pad, young, sources, warnings = _pad(options)
    common = {"inputs": _inputs(options), "sources": sources, "warnings": warnings, "young_kPa": young}
    common["prony"] = [term.to_dict() for term in pad.prony]
    progress = _progress(options)
    if asked == ["depth"]:
        found = predict_static(pad, _numbers("depth", options.depth), options.fidelity, progress)
        columns = ("depth_mm", "force_N", "force_low_N", "force_high_N", "local_exponent")
    else:
        if asked == ["motion"]:
            motion = read_motion(options.motion)
        else:
            if options.velocity is None:
                raise InputError("--force needs --velocity, the speed of the ramp in mm/s")

            def motion_to(depth: float) -> Any:
                return ramp_and_hold(options.velocity, depth, options.hold, options.deceleration)

            depth = depth_for_steady_force(pad, options.force, options.hold, motion_to, options.fidelity)
            motion = motion_to(depth)
            common["depth_mm"] = depth
        found = predict_motion(pad, motion, options.fidelity, progress)
        columns = ("time_s", "displacement_mm", "force_N", "force_low_N", "force_high_N")
    result = {**common, **found.to_dict()}
    result["warnings"] = warnings + [{"code": "stopped_early", "message": note} for note in result.pop("notes")]
    if options.out:
        result["files"] = {"curve": str(_write(options.out, columns, result))}
    return result


def _pad(options: argparse.Namespace) -> tuple[Any, dict[str, float], list[str], list[dict[str, str]]]:
    """Make the pad from the options; also its modulus with interval, sources and warnings."""
    from math import pi, sqrt

    from dummydesign.core.errors import InputError
    from dummydesign.geometry.shapes import read_shape
    from dummydesign.pad.material.hyperelastic import read_law
    from dummydesign.pad.pad import Pad
    from dummydesign.pad.tables.punch import equal_area_radius_mm

    prony = _prony(options.prony)
    sources: list[str] = []
    if (options.young is None) == (options.resin is None):
        raise InputError("give either --young KPA or --resin NAME with --ratio R")
    if options.young is not None:
        young = {"value": options.young, "low": options.young, "high": options.young}
    else:
        from dummydesign.resin import load_resin

        if options.ratio is None:
            raise InputError("--resin needs --ratio, the mixing ratio")
        resin = load_resin(options.resin)
        modulus = resin.modulus_kPa(options.ratio)
        young = {"value": modulus.value, "low": modulus.low, "high": modulus.high}
        sources += [modulus.source, *resin.references]
        prony = prony if options.prony is not None else resin.prony(options.ratio)
    kind, _, size = options.pad.partition(":")
    sides = _numbers("pad", size.replace("x", ","))
    if {"slab": 2, "cylinder": 1}.get(kind) != len(sides) or not min(sides) > 0:
        raise InputError(f"pad '{options.pad}' is not of the form slab:LENGTHxWIDTH or cylinder:DIAMETER in mm")
    cylinder, plate = kind == "cylinder", options.punch == "plate"
    if cylinder != plate:
        raise InputError(f"pad '{options.pad}' and punch '{options.punch}': plates press cylinders only")
    profile = _profile(options.punch[len("profile:") :]) if options.punch.startswith("profile:") else None
    if cylinder:
        radius = 0.5 * sides[0]
    else:
        radius = profile[0][-1] if profile else equal_area_radius_mm(options.punch)
    pad = Pad(
        thickness_mm=options.thickness,
        young_MPa=young["value"] * 1e-3,
        radius_mm=radius,
        prony=prony,
        base=options.base,
        condition=options.condition,
        poisson=options.poisson,
        law=read_law(options.law),
        extent_mm=sqrt(sides[0] * sides[-1] / pi),
        sides_mm=None if profile or cylinder else _punch_sides(options.punch),
        slab_mm=(sides[0], sides[-1]),
        profile_mm=profile,
        cylinder=cylinder,
        geometry=read_shape(options.shape),
    )
    return pad, young, sources, _shape_warnings(pad, options.fidelity)


def _profile(path: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Read a punch profile: columns r_mm and z_mm, the height over its lowest point."""
    import csv
    from pathlib import Path

    from dummydesign.core.errors import InputError

    name = Path(path).name
    try:
        rows = list(csv.DictReader(Path(path).read_text(encoding="utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError) as problem:
        reason = getattr(problem, "strerror", "not UTF-8")
        raise InputError(f"punch profile '{path}' cannot be read: {reason}") from None
    values = []
    for line, row in enumerate(rows, start=2):
        try:
            values.append((float(row["r_mm"]), float(row["z_mm"])))
        except (KeyError, TypeError, ValueError):
            raise InputError(f"{name}:{line}: needs numbers in the columns r_mm and z_mm") from None
    if len(values) < 3:
        raise InputError(f"{name}: {len(values)} rows; a punch profile needs at least 3 of r_mm, z_mm")
    r, z = zip(*values)
    return r, z


def _punch_sides(punch: str) -> tuple[float, float] | None:
    """Sides of a square or rectangular punch, None for a round one; the text was checked before."""
    kind, _, size = punch.partition(":")
    if kind == "round":
        return None
    sides = [float(part) for part in size.split("x")]
    return sides[0], sides[-1]


def _shape_warnings(pad: Any, fidelity: str) -> list[dict[str, str]]:
    """Warn where a square or rectangle is taken as the circle of equal area."""
    from dummydesign.pad.elastic import has_square_factor

    if pad.sides_mm is None or fidelity == "3d" or has_square_factor(pad):
        return []
    message = (
        "the punch is taken as the circle of equal area; a square is 0 to 3 % stiffer (5 to 20 mm pads), "
        "a rectangle more; --fidelity 3d solves it"
    )
    return [{"code": "equal_area_punch", "message": message}]


def _numbers(name: str, text: str) -> list[float]:
    from dummydesign.core.errors import InputError

    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--{name} '{text}' is not a list of numbers separated by commas") from None


def _prony(text: str | None) -> tuple[Any, ...]:
    from dummydesign.core.errors import InputError
    from dummydesign.pad.material.relaxation import PronyTerm

    if not text:
        return ()
    terms = []
    for part in text.split(","):
        pair = part.split(":")
        if len(pair) != 2:
            raise InputError(f"--prony '{part}' is not TAU:BETA, such as 0.1:0.3,1.5:0.3")
        terms.append(PronyTerm(*(_numbers("prony", number)[0] for number in pair)))
    return tuple(terms)


def _inputs(options: argparse.Namespace) -> dict[str, Any]:
    """All values used, under names that carry their unit."""
    units = {"young": "young_kPa", "thickness": "thickness_mm", "force": "force_N", "velocity": "velocity_mm_s"}
    units |= {"hold": "hold_s", "deceleration": "deceleration_mm_s2", "depth": "depth_mm"}
    return {units.get(name, name): value for name, value in vars(options).items() if name != "json"}


def _progress(options: argparse.Namespace) -> Any:
    import sys

    if options.fidelity == "table" or not sys.stderr.isatty():
        return None
    return lambda depth: print(f"\rsolved d/h = {depth:.3f} ", end="", file=sys.stderr, flush=True)


def _write(path: str, columns: tuple[str, ...], result: dict[str, Any]) -> Any:
    from dummydesign.core.files import write_text

    rows = zip(*(result[name] for name in columns))
    lines = [",".join(columns), *(",".join(f"{value:.8g}" for value in row) for row in rows)]
    return write_text(path, "\n".join(lines) + "\n")


def render(result: dict[str, Any]) -> str:
    """Write the answer as a short table."""
    young = result["young_kPa"]
    lines = [
        f"pad {result['inputs']['thickness_mm']:g} mm, E = {young['value']:.4g} kPa "
        f"({young['low']:.4g} to {young['high']:.4g}), punch {result['inputs']['punch']}, fidelity {result['fidelity']}"
    ]
    if "peak_force_N" in result:
        lines += [
            f"peak force    {result['peak_force_N']:.3f} N at {result['peak_time_s']:.4f} s",
            f"force at end  {result['steady_force_N']:.3f} N",
        ]
        names, formats = ("time_s", "displacement_mm", "force_N"), ("{:>10.4f}", "{:>16.3f}", "{:>10.3f}")
    else:
        names = ("depth_mm", "force_N", "force_low_N", "force_high_N", "local_exponent")
        formats = ("{:>9.3f}", "{:>9.3f}", "{:>12.3f}", "{:>13.3f}", "{:>15.3f}")
    lines.append(" ".join(f"{name:>{len(form.format(0))}}" for name, form in zip(names, formats)))
    rows = list(zip(*(result[name] for name in names)))
    step = max(1, len(rows) // SHOWN)
    lines += [" ".join(form.format(value) for form, value in zip(formats, row)) for row in rows[::step]]
    solver = result["solver"]
    if solver["unknowns"]:
        lines.append(
            f"solved {solver['unknowns']} unknowns, {solver['load_steps']} load steps, "
            f"{solver['newton_iterations']} Newton iterations, {solver['seconds']:.1f} s"
        )
    lines += [f"warning: {warning['message']}" for warning in result["warnings"]]
    return "\n".join(lines)

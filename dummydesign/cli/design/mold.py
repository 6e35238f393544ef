"""``dummydesign mold``: mould, master, frame and pour sheet of a pad."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from dummydesign.cli.shared_options import add_replace_option
from dummydesign.cli.steps import Watch

HELP = "Make the silicone mould of a pad: STEP files, printable master and frame, pour sheet, all checked."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of contracts: thickness, size, shape, preset, resin, ratio, output folder; and ``record``."""
    from dummydesign.cli import mold_record
    from dummydesign.geometry.shape_names import shape_help

    actions = parser.add_subparsers(dest="action", metavar="[record]", help="without it a mould is made")
    record = actions.add_parser("record", help=mold_record.HELP, allow_abbrev=False)
    mold_record.add_arguments(record)
    parser.add_argument(
        "--thickness", metavar="MM[,MM..]", help="thickness of the pad, 3 to 30 mm; required; several make one job"
    )
    parser.add_argument("--count", type=int, default=1, metavar="N", help="cavities in one mould (default 1)")
    parser.add_argument("--castings", type=int, default=1, metavar="N", help="castings of each mould (default 1)")
    parser.add_argument("--length", default=150.0, metavar="MM", help="length of the pad (default 150)")
    parser.add_argument("--width", default=120.0, metavar="MM", help="width of the pad (default 120)")
    parser.add_argument(
        "--shape",
        default="slab",
        metavar="NAME[:P,..]",
        help=shape_help("puck"),
    )
    parser.add_argument(
        "--preset", default="open", metavar="NAME|FILE",
        help="mould preset: open (default), lidded, printed or a TOML file",
    )
    parser.add_argument("--resin", metavar="NAME|FILE", help="resin to weigh (default the paper's polyurethane)")
    parser.add_argument("--ratio", type=float, default=15.0, metavar="R", help="mixing ratio of the resin (default 15)")
    parser.add_argument(
        "--base-ratio", type=float, metavar="R", help="ratio of a layered pad's base (default: from its modulus ratio)"
    )
    parser.add_argument(
        "--face-sheet", type=float, metavar="MM", help="thickness of a sheet of glass let in as the tested face"
    )
    add = parser.add_argument
    add("--bone", metavar="FILE", help="STL or STEP (mm) of a bone in the gel; the model takes the nearest dome")
    add("--bone-height", type=float, metavar="MM", help="how far it reaches into the gel from the free face")
    add("--bone-scale", type=float, default=1.0, metavar="S", help="size over that in the file (default 1)")
    add("--bone-turn", default="0,0,0", metavar="X,Y,Z", help="degrees about x, y, z; then its lowest point is the tip")
    add("--bone-at", default="0,0", metavar="X,Y", help="where the tip lies from the pad's middle, mm (default 0,0)")
    parser.add_argument("--out", metavar="DIR", help="folder for the files (default mould_tMM)")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Build the mould, or keep the record of a pad, and return the answer."""
    from dummydesign.api import make_mould
    from dummydesign.core.errors import InputError

    if options.action == "record":
        from dummydesign.cli import mold_record

        return mold_record.run(options)
    if options.thickness is None:
        raise InputError("--thickness is missing: the thickness of the pad in mm, 3 to 30")

    with Watch():
        return make_mould(
            options.thickness,
            length_mm=options.length,
            width_mm=options.width,
            shape=options.shape,
            preset=options.preset,
            resin=options.resin,
            ratio=options.ratio,
            count=options.count,
            castings=options.castings,
            face_sheet_mm=options.face_sheet,
            bone=options.bone,
            bone_height_mm=options.bone_height,
            bone_scale=options.bone_scale,
            bone_turn_deg=_numbers("--bone-turn", options.bone_turn, 3),
            bone_at_mm=_numbers("--bone-at", options.bone_at, 2),
            base_ratio=options.base_ratio,
            out=options.out,
            replace=options.replace,
        ).to_dict()


def _numbers(option: str, text: str, count: int) -> Any:
    from dummydesign.core.errors import InputError

    try:
        found = tuple(float(part) for part in text.split(","))
    except ValueError:
        found = ()
    if len(found) != count:
        raise InputError(f"{option} {text} must be {count} numbers parted by commas")
    return found


def default_out(options: argparse.Namespace) -> str | None:
    """Name of the folder in a project when none is typed; elsewhere the call names it. A record has its folder."""
    if options.action == "record" or options.thickness is None:
        return None
    from dummydesign.mold.several.job import folder_name, read_thicknesses

    shape = "boned" if options.bone else options.shape.partition(":")[0].lower()
    kind = "" if shape == "slab" else shape
    return folder_name(read_thicknesses(options.thickness), options.castings, kind, options.count)


def render(result: dict[str, Any]) -> str:
    """Write the answer as short tables."""
    if "specification" in result:
        from dummydesign.cli import mold_record

        return mold_record.render(result)
    if "moulds" in result:
        return _job(result)
    inputs, pour = result["inputs"], result["pour"]
    size = f"{inputs['length_mm']:g} x {inputs['width_mm']:g} x {inputs['thickness_mm']:g} mm"
    several = f"{inputs['count']} pads" if inputs.get("count", 1) > 1 else "a"
    pads = f"{several} {inputs['shape']} pad" if several == "a" else f"{several} ({inputs['shape']}), each"
    lines = [
        f"Mould ({inputs['preset']}) for {pads} of {size}, specification {result['spec_hash']}",
        "",
    ]
    batch = result["batch"]
    first = "upper layer, poured first: " if "base" in batch else ""
    lines.append(f"Mix ({first}{inputs['resin']}, ratio {inputs['ratio']:g} {inputs['ratio_meaning']})")
    lines += _weights(batch, inputs.get("count", 1))
    if "base" in batch:
        lines.append(f"Mix (base layer, poured second: {inputs['resin']}, ratio {inputs['base_ratio']:.4g})")
        lines += _weights(batch["base"], inputs.get("count", 1))
    if pour["silicone_mass_g"]:
        lines.append(f"  {'silicone':<14}{pour['silicone_mass_g']:10.0f} g   for the mould itself")
    volumes = result.get("volumes_mm3", {})
    if volumes:
        lines += ["", "Volumes"]
        lines += [f"  {name:<16}{volume / 1000:10.2f} cm3" for name, volume in volumes.items()]
    checks = result.get("checks", [])
    if checks:
        counts = {status: sum(c["status"] == status for c in checks) for status in ("pass", "fail", "skipped")}
        lines += ["", f"Checks: {counts['pass']} passed, {counts['fail']} failed, {counts['skipped']} skipped"]
        for item in checks:
            if item["status"] != "pass":
                lines.append(f"  {item['status']:<8}{item['id']}: {item.get('note', '')}")
    if result["files"]:
        folder = Path(next(iter(result["files"].values()))).parent
        lines += ["", f"Files in {folder}"]
        lines += [f"  {role:<24}{Path(path).name}" for role, path in result["files"].items()]
    if result["warnings"]:
        lines += ["", "Cautions"]
        lines += [f"  - {item['message']}" for item in result["warnings"]]
    return "\n".join(lines)


def _job(result: dict[str, Any]) -> str:
    """One line a mould, then what all need."""
    lines = []
    for one in result["moulds"]:
        counts = {status: sum(c["status"] == status for c in one["checks"]) for status in ("pass", "fail", "skipped")}
        said = f"{counts['pass']} checks passed, {counts['fail']} failed, {counts['skipped']} skipped"
        lines.append(f"{one['thickness_mm']:>6g} mm  {one['spec_hash']}  {said}  {one['folder']}")
    if "bill_of_materials" not in result:
        # One of them failed, and what was made is not kept.
        failed = [item for item in result.get("checks", []) if item["status"] == "fail"]
        return "\n".join([*lines, *(f"  fail    {item['id']}: {item.get('note', '')}" for item in failed)])
    lines += ["", f"Needed for all, {result['inputs']['castings']} castings of each"]
    lines += [f"  {what:<46}{much:<16}{purpose}" for what, much, purpose in result["bill_of_materials"][1:]]
    lines += ["", *(f"{role}: {result['files'][role]}" for role in ("job", "job_pdf", "manifest"))]
    return "\n".join(lines + [f"warning: {item['message']}" for item in result["warnings"]])


def _weights(batch: dict[str, Any], count: int) -> list[str]:
    lines = [f"  {part['name']:<14}{part['mass_g']:10.1f} g" for part in batch["components"]]
    where = "into the mould" if count == 1 else f"into the {count} cavities"
    lines.append(f"  {'total':<14}{batch['total_g']:10.1f} g   pour {batch['pour_g']:.1f} g of it {where}")
    witness = batch["witness"]
    if witness["total_g"] > batch["total_g"]:
        masses = " + ".join(f"{part['name']} {part['mass_g']:.1f} g" for part in witness["components"])
        lines.append(f"  with a witness puck: {masses} = {witness['total_g']:.1f} g")
    return lines

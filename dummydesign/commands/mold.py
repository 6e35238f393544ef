"""``dummydesign mold``: mould, master, frame and pour sheet of a pad."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from dummydesign.errors import InputError, NoAnswerError

HELP = "Make the silicone mould of a pad: STEP files, printable master and frame, pour sheet, all checked."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of contracts: thickness, size, shape, preset, resin, ratio, output folder."""
    parser.add_argument("--thickness", type=float, required=True, metavar="MM", help="thickness of the pad, 3 to 30 mm")
    parser.add_argument("--length", type=float, default=150.0, metavar="MM", help="length of the pad (default 150)")
    parser.add_argument("--width", type=float, default=120.0, metavar="MM", help="width of the pad (default 120)")
    parser.add_argument("--shape", default="slab", metavar="NAME[:P,..]", help="shape of the pad (default slab)")
    parser.add_argument(
        "--preset", default="open", metavar="NAME|FILE", help="mould preset: open, lidded or a TOML file"
    )
    parser.add_argument("--resin", metavar="NAME|FILE", help="resin to weigh (default the paper's polyurethane)")
    parser.add_argument("--ratio", type=float, default=15.0, metavar="R", help="mixing ratio of the resin (default 15)")
    parser.add_argument("--out", metavar="DIR", help="folder for the files (default mould_tMM)")


def parse_shape(text: str) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Split ``NAME:KEY=VALUE,...`` or ``NAME:VALUE,...`` into a name and its parameters.

    Raises
    ------
    InputError
        When a parameter is not a number.
    """
    name, _, rest = text.partition(":")
    parameters = []
    for index, item in enumerate(filter(None, rest.split(","))):
        key, equals, value = item.rpartition("=")
        try:
            parameters.append((key if equals else str(index), float(value)))
        except ValueError:
            raise InputError(f"shape parameter '{item}' is not a number; write NAME:VALUE or NAME:KEY=VALUE") from None
    return name, tuple(parameters)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Build the mould and return the answer."""
    from dummydesign.mold.preset import mould_spec
    from dummydesign.mold.runner import make_mold

    kind, parameters = parse_shape(options.shape)
    spec = mould_spec(
        options.thickness, options.length, options.width, options.preset, options.resin, options.ratio, kind, parameters
    )
    folder = Path(options.out) if options.out else Path(f"mould_{spec.tag}")
    inputs = {
        "thickness_mm": spec.pad.thickness_mm, "length_mm": spec.pad.length_mm, "width_mm": spec.pad.width_mm,
        "shape": options.shape, "preset": spec.preset, "resin": spec.pour.resin, "ratio": spec.pour.ratio,
        "ratio_meaning": spec.pour.ratio_meaning, "out": str(folder),
    }  # fmt: skip
    head = {"inputs": inputs, "sources": list(spec.sources)}
    try:
        result = make_mold(spec, folder)
    except NoAnswerError as reason:
        raise NoAnswerError(reason.code, str(reason), {**head, **reason.result}) from None
    answer = {**head, **result.to_dict(), "spec": spec.to_dict()}
    # Memory differs from run to run; the same question shall get the same answer but for seconds.
    del answer["memory_MB"]
    return answer


def render(result: dict[str, Any]) -> str:
    """Write the answer as short tables."""
    inputs, pour = result["inputs"], result["pour"]
    size = f"{inputs['length_mm']:g} x {inputs['width_mm']:g} x {inputs['thickness_mm']:g} mm"
    lines = [
        f"Mould ({inputs['preset']}) for a {inputs['shape']} pad of {size}, specification {result['spec_hash']}",
        "",
    ]
    lines.append(f"Weigh ({inputs['resin']}, ratio {inputs['ratio']:g} {inputs['ratio_meaning']})")
    lines += [f"  {part['name']:<14}{part['mass_g']:10.1f} g" for part in pour["components"]]
    lines.append(f"  {'total':<14}{pour['batch_mass_g']:10.1f} g   of which {pour['pad_mass_g']:.1f} g stay in the pad")
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
        lines += [f"  {role:<20}{Path(path).name}" for role, path in result["files"].items()]
    if result["warnings"]:
        lines += ["", "Mind"]
        lines += [f"  - {item['message']}" for item in result["warnings"]]
    return "\n".join(lines)

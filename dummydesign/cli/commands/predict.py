"""``dummydesign predict``: the force of one pad."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import call
from dummydesign.cli.text import labelled, screen, tissue_lines, verdict_lines, warning_block, warning_lines
from dummydesign.core.tables import Table

CALL = "predictions.predict"
HELP = "Force of one pad: static, under a motion, in a ramp and hold, or as it stops a free mass."
SHOWN = 25
NO_RELAXATION = "no_relaxation"
BY_TABLE = "; shares are by the table: suggest solves its pad (--fidelity axisymmetric), a few percent differ"


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Predict, write the curve if asked, and return it."""
    return call(CALL, options, progress=_progress(options)).to_dict()


def _progress(options: argparse.Namespace) -> Any:
    import sys

    if options.fidelity == "table" or not sys.stderr.isatty():
        return None
    return lambda depth: print(f"\rsolved d/h = {depth:.3f} ", end="", file=sys.stderr, flush=True)


def render(result: dict[str, Any]) -> str:
    """The pad, then its presses or its curve, thinned to a dozen rows."""
    first = [item["message"] for item in result["warnings"] if item["code"] == NO_RELAXATION]
    head = [
        *verdict_lines(result.get("verdict")),
        *tissue_lines(result),
        *(line for text in first for line in labelled("WARNING", text, 2)),
        *labelled("PAD", _pad_text(result)),
    ]
    if "force_N" not in result:
        return "\n".join(head)
    if "peak_force_N" in result:
        head += labelled("PRESS", _press_text(result))
        head += labelled("ERROR", _error_text(result))
    elif "presses" not in result and "conditions" not in result:
        head += labelled("FORCE", "static, fully relaxed at each depth; low and high: the model's own uncertainty")
    tail = [line for text in _contact_texts(result) for line in labelled("CONTACT", text)]
    rows = (
        _tissue_presses(result)
        if "conditions" in result
        else (_press_lines(result["presses"]) if "presses" in result else _curve_lines(result, 12)[-13:])
    )
    written = _files_written(result)
    curve = "" if any(role.startswith("curve") for role in result.get("files", {})) else "; --out FILE writes the curve"
    by_table = "conditions" in result and result["inputs"]["fidelity"] == "table"
    more = labelled("MORE", f"--details: all points and the solver's work{curve}{BY_TABLE * by_table}")
    warnings = warning_block(result, (NO_RELAXATION,))
    if len(written) > 3:
        written = [*written[:2], f"and {len(written) - 2} more"]
    files = labelled("FILES", "\n".join(written)) if written else []
    return screen([*head, ""], rows, [""], tail[:4], warnings, files, more)


def _pad_text(result: dict[str, Any]) -> str:
    """Shape, thickness, modulus, punch and fidelity."""
    young, given = result["young_kPa"], result["inputs"]
    span = f" (95 %: {young['low']:.3g} to {young['high']:.3g})" if young["low"] < young["high"] else ""
    solved = "" if given["fidelity"] == "table" else f", {given['fidelity']}"
    shape = "" if given["shape"] == "slab" else f"{given['shape']}, "
    return f"{shape}{given['thickness_mm']:g} mm, E = {young['value']:.4g} kPa{span}, punch {given['punch']}{solved}"


def _press_text(result: dict[str, Any]) -> str:
    """Peak and end of a press; of a free mass also where it stops, and its energy."""
    peak = f"peak {result['peak_force_N']:.3f} N at {result['peak_time_s']:.4f} s"
    if "energy_mJ" not in result:
        return f"{peak}, {result['steady_force_N']:.3f} N at the end"
    given = result["inputs"]
    return (
        f"{given['drive']} hits at {given['velocity_mm_s']:g} mm/s: {peak} and {result['depth_at_peak_mm']:.3f} mm; "
        f"stopped at {result['depth_mm']:.3f} mm after {result['stop_s']:.4f} s, {result['energy_mJ']:.4g} mJ absorbed"
    )


def _contact_texts(result: dict[str, Any]) -> list[str]:
    """Contact pressure at each depth."""
    texts = []
    for one in result.get("contact_pressure", []):
        edge = f", at the edge up to {one['edge_kPa']:.3g} kPa" if one["edge_kPa"] > one["peak_kPa"] else ""
        texts.append(
            f"at {one['depth_mm']:.3g} mm: mean {one['mean_kPa']:.3g} kPa, peak {one['peak_kPa']:.3g} kPa "
            f"at radius {one['peak_radius_mm']:.2g} mm{edge}"
        )
    return texts


def _error_text(result: dict[str, Any]) -> str:
    """Error against the force of the motion's file; empty where it has none."""
    if "measured" not in result:
        return ""
    one = result["measured"]
    return (
        f"{one['rmse_N']:.3g} N rms against the file's force; largest force {one['peak_error_N']:+.3g} N, "
        f"measured {one['peak_force_N']:.4g} N"
    )


def _files_written(result: dict[str, Any]) -> list[str]:
    """Paths of curves, fields and picture."""
    return [one for path in result.get("files", {}).values() for one in (path if isinstance(path, list) else [path])]


def _tissue_presses(result: dict[str, Any]) -> list[str]:
    """Each press beside the subjects' range; one out of reach ends after its test."""
    from dummydesign.report.suggest_facts import press_texts

    rows = [
        [
            row["steady_force_N"],
            row["velocity_mm_s"],
            *(
                [row["out_of_reach"]]
                if row["depth_mm"] is None
                else [row["depth_mm"], row["peak_force_N"], *press_texts(row)]
            ),
        ]
        for row in result["conditions"]
    ]
    head = ["steady N", "mm/s", "depth mm", "pad peak N", "subjects N", ""]
    return Table(head, rows).lines("<9g <6g <9.2f <11.1f <13 <1".split())


def render_details(result: dict[str, Any]) -> str:
    """Write the answer as a short table."""
    if "force_N" not in result:
        return render(result)
    first = [item["message"] for item in result["warnings"] if item["code"] == NO_RELAXATION]
    lines = [
        *([f"warning: {text}" for text in first] + [""] if first else []),
        *verdict_lines(result.get("verdict")),
        *tissue_lines(result),
        f"pad {_pad_text(result)}",
    ]
    lines += [f"error of the prediction: {text}"] if (text := _error_text(result)) else []
    lines += _tissue_presses(result) if "conditions" in result else []
    lines += _press_lines(result["presses"]) if "presses" in result else _curve_lines(result)
    lines += [f"contact pressure {text}" for text in _contact_texts(result)]
    solver = result["solver"]
    if solver["unknowns"]:
        lines.append(
            f"solved {solver['unknowns']} unknowns, {solver['load_steps']} load steps, "
            f"{solver['newton_iterations']} Newton iterations, {solver['seconds']:.1f} s"
        )
    others = [item for item in result["warnings"] if item["code"] != NO_RELAXATION]
    lines += warning_lines({"warnings": others})
    lines += [f"written: {path}" for path in _files_written(result)]
    return "\n".join(lines)


def _press_lines(presses: list[dict[str, Any]]) -> list[str]:
    """A table of several presses; one out of reach ends after its test."""
    rows = [
        [
            row["steady_force_N"],
            row["velocity_mm_s"],
            *(
                [f"  out of reach: {row['out_of_reach'].partition(': ')[2].partition(';')[0]}"]
                if row["depth_mm"] is None
                else [row["depth_mm"], row["peak_force_N"], row["peak_force_N"] / row["steady_force_N"]]
            ),
        ]
        for row in presses
    ]
    head = ["steady N", "mm/s", "depth mm", "peak N", "peak over steady"]
    return Table(head, rows).lines(">10.4g >7.4g >10.3f >9.3f >18.2f".split(), indent="")


MOVED = {"time_s": ">10.4f", "displacement_mm": ">16.3f", "force_N": ">10.3f"}
STATIC = {
    "depth_mm": ">9.3f",
    "force_N": ">9.3f",
    "force_low_N": ">12.3f",
    "force_high_N": ">13.3f",
    "local_exponent": ">15.3f",
}


def _curve_lines(result: dict[str, Any], shown: int = SHOWN) -> list[str]:
    """A curve over depth or over time, thinned."""
    moved = "peak_force_N" in result
    forms, lines = (MOVED, [_press_text(result)]) if moved else (STATIC, [])
    rows = list(zip(*(result[name] for name in forms)))
    if moved and shown < SHOWN:
        rows = _spread_in_time(rows, result["peak_time_s"], shown)
    else:
        rows = rows[:: max(1, -(-len(rows) // shown))]
    return lines + Table([*forms], rows, [*forms.values()]).lines(indent="")


def _spread_in_time(rows: list[tuple[float, ...]], peak_s: float, shown: int) -> list[tuple[float, ...]]:
    """The rows nearest to even times up to the peak force, and to even steps of log time after it."""
    last, rise = rows[-1][0], shown // 3
    wanted = [peak_s * step / rise for step in range(rise + 1)]
    if last > peak_s > 0.0:
        wanted += [peak_s * (last / peak_s) ** (step / (shown - rise - 1)) for step in range(1, shown - rise)]
    chosen = {min(range(len(rows)), key=lambda at: abs(rows[at][0] - time)) for time in wanted}
    return [rows[at] for at in sorted(chosen)]

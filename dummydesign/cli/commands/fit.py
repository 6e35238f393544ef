"""``dummydesign fit``: fit the tissue law to traces."""

from __future__ import annotations

from typing import Any

from dummydesign.cli.text import file_lines, files_block, labelled, screen, warning_block, warning_lines
from dummydesign.core.tables import Table

HELP = "Fit the nonlinear 3, 5 or 7 element law to traces of one tissue or dummy."
CALL = "traces.fit"


ABOUT_STEPS = 12
"""Steps of a usual fit: three numbers of elements, presses left out, seven intervals, the contact."""


def render(result: dict[str, Any]) -> str:
    """How well the law fits, its parameters, and the presses with the largest residuals."""
    rows = sorted(result["by_trace"], key=lambda row: -row["rmse_N"])
    worst = rows[0]
    presses = f"{len(rows)} press{'es' * (len(rows) != 1)}"
    head = labelled(
        "FIT",
        f"{result['elements']} elements (law {result['law']}, mode {result['mode']}): residual "
        f"{result['rmse_N']:.3g} N rms, noise alone {result['noise_floor_N']:.3g} N. {presses}; "
        f"the worst is {worst['file']} with {worst['rmse_N']:.3g} N rms.",
    )
    left = {count: row["heldout_rmse_N"] for count, row in result["comparison"].items()}
    rivals = "; ".join(f"{count} elements {error:.3g} N" for count, error in left.items() if error is not None)
    return screen(
        [*head, ""],
        _parameters(result, 28, ">10.4g", "at its bound", "  "),
        [""],
        labelled("RIVALS", f"error on presses left out: {rivals}" if rivals else ""),
        warning_block(result),
        files_block(result, ("tissue", "report")),
        labelled("MORE", "--details: residual of every press, other numbers of elements"),
    )


def _parameters(result: dict[str, Any], wide: int, form: str, at_bound: str, indent: str = "") -> list[str]:
    """Each parameter with its interval, and whether it lies at its bound."""
    from dummydesign.core.serialise import parameter_rows

    rows = [
        {"label": label, **one, "state": f" {at_bound}" if one["at_bound"] else ""}
        for label, one in parameter_rows(result["parameters"])
    ]
    columns = {
        "parameter": f"label:<{wide}",
        "value": f"value:{form}",
        "95 % low": f"low:{form}",
        "95 % high": f"high:{form}",
        "": "state:<1",
    }
    return Table.of(rows, columns).lines(indent=indent)


TRACES = {
    "trace": "file:<28.28",
    "mm/s": "velocity_mm_s:>7.4g",
    "mm": "depth_mm:>7.3f",
    "steady N": "steady_force_N:>9.3f",
    "peak N": "peak_force_N:>8.3f",
    "rms N": "rmse_N:>8.4f",
    "worst N": "max_residual_N:>8.4f",
}


def render_details(result: dict[str, Any]) -> str:
    """Make the readable tables."""
    lines = [
        f"{result['elements']} elements, law {result['law']}, {result['mode']}: rms residual "
        f"{result['rmse_N']:.4g} N (noise floor {result['noise_floor_N']:.3g} N), largest "
        f"{result['max_residual_N']:.3g} N",
        *_parameters(result, 30, ">11.5g", "at bound"),
    ]
    lowest = min(row["aicc"] for row in result["comparison"].values())
    rivals = [
        [
            count,
            row["rmse_N"],
            f"{row['aicc'] - lowest:.1f}" if row["aicc"] - lowest < 1000 else "> 1000",
            row["heldout_rmse_N"],
        ]
        for count, row in result["comparison"].items()
    ]
    heads = ["elements", "rms N", "AICc above", "held-out rms N"]
    lines += Table(heads, rivals).lines("<9 >9.4g >11 >15.4g".split(), indent="")
    tried = result["starts"]
    lines.append(f"{tried['same_optimum']} of {tried['tried']} starts ended in the same optimum")
    lines += Table.of(result["by_trace"], TRACES).lines(indent="")
    lines += [
        f"{row['file'][:28]:<28} touched {row['value_mm']:+.3f} mm before its zero "
        f"({row['low_mm']:+.3f} to {row['high_mm']:+.3f})"
        for row in result.get("contact_offsets") or []
    ]
    return "\n".join(lines + warning_lines(result) + file_lines(result))

"""A resin as plain values and as the text of a resin file, so that what was updated can be kept."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.files import write_text
from dummydesign.core.quantity import Quantity

if TYPE_CHECKING:
    from dummydesign.resin.model.resin import Resin


def resin_dict(resin: Resin) -> dict[str, Any]:
    """Return the content of the resin's file; quantities become {value, low, high, kind, source}."""
    modulus: dict[str, Any] = {"law": resin.law.name, **_plain(resin.numbers)}
    if resin.posterior is not None and resin.prior_numbers is not None:
        modulus["prior"] = _plain(resin.prior_numbers)
        modulus["posterior"] = {key: [float(v) for v in column] for key, column in resin.posterior.items()}
    content: dict[str, Any] = {
        "schema": 1,
        "name": resin.name,
        "title": resin.title,
        "ratio_meaning": resin.ratio_meaning,
        "ratio_min": resin.ratio_min,
        "ratio_max": resin.ratio_max,
        "ratio_step": resin.ratio_step,
        "references": list(resin.references),
        "notes": list(resin.notes),
        "contradictions": list(resin.contradictions),
        "component": [
            {
                "name": liquid.name,
                "parts": "ratio" if liquid.parts is None else liquid.parts,
                "density_g_per_cm3": liquid.density_g_per_cm3.to_dict(),
                "viscosity_Pa_s": liquid.viscosity_Pa_s.to_dict(),
            }
            for liquid in resin.liquids
        ],
        "modulus": modulus,
        "relaxation": {
            "ratio_ref": resin.relaxation_ratio_ref,
            "softness_exponent": resin.softness_exponent.to_dict(),
            "term": [{"tau_s": arm.tau_s.to_dict(), "beta": arm.beta.to_dict()} for arm in resin.arms],
        },
        "property": _plain(resin.properties),
    }
    if resin.points:
        content["point"] = [
            {"ratio": item["ratio"], "young_kPa": item["young_kPa"].to_dict()}
            | ({"puck": item["puck"].to_dict()} if "puck" in item else {})
            for item in resin.points
        ]
    if resin.prior_relaxation is not None:
        arms, ratio_ref = resin.prior_relaxation
        terms = [{"tau_s": arm.tau_s.to_dict(), "beta": arm.beta.to_dict()} for arm in arms]
        content["relaxation"]["prior"] = {"ratio_ref": ratio_ref, "term": terms}
    return content


def save_resin(resin: Resin, path: Path) -> Path:
    """Write a resin file under its final name only when complete.

    Raises
    ------
    InputError
        When the place cannot be written.
    """
    return write_text(path, "\n".join(_lines(resin_dict(resin), "")) + "\n")


def _plain(quantities: Mapping[str, Quantity]) -> dict[str, Any]:
    return {key: quantity.to_dict() for key, quantity in quantities.items()}


def _value(value: Any) -> str:
    """Write a plain value, a list of plain values or a quantity on one line of TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(float(value)) if isinstance(value, float) else str(value)


def _is_inline(value: Any) -> bool:
    """Quantities and plain values stay on one line; other tables get a heading of their own."""
    if isinstance(value, dict):
        return "kind" in value and "source" in value
    return not (isinstance(value, list) and value and isinstance(value[0], dict))


def _lines(table: Mapping[str, Any], prefix: str) -> list[str]:
    """Write a table: its own values first, then the tables inside it."""
    lines = [f"{key} = {_value(value)}" for key, value in table.items() if _is_inline(value)]
    for key, value in table.items():
        if _is_inline(value):
            continue
        name = f"{prefix}{key}"
        for item in value if isinstance(value, list) else [value]:
            heading = f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
            lines += ["", heading, *_lines(item, f"{name}.")]
    return lines

"""Designs side by side: what ``suggest`` left in several folders, and in what the questions differ."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import fspath
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import FilePath, read_json
from dummydesign.core.serialise import Serialised
from dummydesign.design.request import ANSWER

SCHEMA = "dummydesign.suggest/2"
MANIFEST = "manifest.json"
# Inputs that change what a verdict or a score means; limits of the search are left out.
QUESTIONS = {
    "tissue": "tissue",
    "aim": "aim",
    "resin": "resin",
    "calibration": "calibration",
    "punch": "punch",
    "edge_radius_mm": "edge radius in mm",
    "condition": "contact of the punch",
    "base": "base",
    "force_N": "steady forces in N",
    "velocity_mm_s": "speeds in mm/s",
    "hold_s": "hold in s",
    "deceleration_mm_s2": "braking in mm/s2",
    "pad_mm": "pad size in mm",
    "weighing_g": "weighing error in g",
    "thickness_tolerance_mm": "thickness tolerance in mm",
    "castings": "number of castings",
    "verify": "check by finite elements",
    "weights": "weights of the score",
}
LARGEST_FILE = 64_000_000


@dataclass(frozen=True)
class DesignComparison(Serialised):
    """Designs in the order given, and in what their questions differ."""

    designs: tuple[dict[str, Any], ...]
    differences: tuple[dict[str, Any], ...]
    warnings: tuple[dict[str, str], ...]
    sources: tuple[str, ...]


def compare_designs(folders: Iterable[FilePath]) -> DesignComparison:
    """Read the designs of two or more folders of ``suggest``."""
    paths = [Path(fspath(folder)) for folder in folders]
    if len(paths) < 2:
        message = f"folders = {len(paths)}: give two or more folders of 'dummydesign suggest'"
        raise InputError(message, "not_enough_data", "folders", len(paths))
    seen: dict[Path, Path] = {}
    for path in paths:
        if (first := seen.setdefault(path.resolve(), path)) is not path:
            raise InputError(f"folder '{path}' is listed twice (as '{first}')", "duplicate", "folders", str(path))
    answers = [read_design(path) for path in paths]
    designs = tuple(_design(path, name, answer) for path, name, answer in zip(paths, _names(paths), answers))
    sources = dict.fromkeys(text for answer in answers for text in answer["sources"])
    differences = _differences(answers)
    return DesignComparison(designs, differences, _warnings(designs, differences, answers), tuple(sources))


def read_design(folder: Path) -> dict[str, Any]:
    """Read the answer that ``suggest`` left in a folder."""
    if not folder.is_dir():
        raise InputError(f"folder '{folder}' does not exist", "file_not_found", "folder", str(folder))
    manifest = _json(folder / MANIFEST) or {}
    if not (folder / ANSWER).is_file():
        message = f"folder '{folder}' holds no design: give folders of 'dummydesign suggest'"
        raise InputError(message, "nothing_found", "folder", str(folder))
    answer = _json(folder / ANSWER)
    if answer is None or answer.get("schema") != SCHEMA:
        message = f"file '{folder / ANSWER}' is not an answer of this version of 'dummydesign suggest'; run it again"
        raise InputError(message, "file_unreadable", "design_file")
    try:
        _design(folder, "", answer)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as problem:
        message = f"file '{folder / ANSWER}' is damaged: {problem}; run 'dummydesign suggest' again"
        raise InputError(message, "malformed", "design_file") from None
    read = manifest.get("files_read")
    answer["files_read"] = [one for one in read if isinstance(one, dict)] if isinstance(read, list) else []
    return answer


def _json(path: Path) -> dict[str, Any] | None:
    """A JSON object that is not too large; None where there is none that can be read."""
    whole = path.is_file() and path.stat().st_size <= LARGEST_FILE
    return read_json(path) or None if whole else None


def _names(paths: Sequence[Path]) -> list[str]:
    """Folder names, or whole paths where two folders have the same name."""
    short = [path.resolve().name for path in paths]
    return [str(path) if short.count(name) > 1 else name for path, name in zip(paths, short)]


def _design(path: Path, name: str, answer: Mapping[str, Any]) -> dict[str, Any]:
    """What is compared of one answer."""
    best, verdict, inputs, castings = (answer[key] for key in ("recommendation", "verdict", "inputs", "castings"))
    length, width = inputs["pad_mm"]
    steps = (
        "steady_force_N",
        "velocity_mm_s",
        "depth_mm",
        "peak_force_N",
        "target_peak_low_N",
        "target_peak_high_N",
        "reads",
        "percent_outside",
        "gel_compression",
    )
    return {
        "name": name,
        "folder": str(path),
        "tissue": inputs["tissue"],
        "aim": inputs["aim"],
        "verdict": {key: verdict[key] for key in ("level", "light", "reads", "text")},
        "pad": {
            "shape": best["shape"],
            "thickness_mm": float(best["thickness_mm"]),
            "length_mm": float(length),
            "width_mm": float(width),
            "base": inputs["base"],
        },
        "resin": best["resin"],
        "ratio": float(best["ratio"]),
        "ratio_meaning": best["ratio_meaning"],
        "young_kPa": {key: float(best["young_kPa"][key]) for key in ("value", "low", "high")},
        "scores": {"total": best["scores"]["total"], **best["scores"]},
        **{side: {key: verdict[side][key] for key in ("central", "q95", "press")} for side in ("shortfall", "over")},
        "correction": {key: verdict["correction"][key] for key in ("factor_central", "factor")},
        "castings": {
            **castings,
            "usable_fraction": castings["usable"],
            "needed_fraction": (verdict.get("limits") or {}).get("share"),
        },
        "batch": _batch(best["batch"]),
        "conditions": [{key: row[key] for key in steps} for row in best["conditions"]],
        "steady_curve": answer["steady_curve"],
    }


def _batch(batch: Mapping[str, Any]) -> dict[str, Any]:
    """What to weigh, of a layered pad also of its base."""
    kept: dict[str, Any] = {
        "components": [{"name": one["name"], "mass_g": float(one["mass_g"])} for one in batch["components"]],
        "total_g": float(batch["total_g"]),
        "pour_g": float(batch["pour_g"]),
    }
    return {**kept, "base": _batch(batch["base"])} if "base" in batch else kept


def _differences(answers: Sequence[Mapping[str, Any]]) -> tuple[dict[str, Any], ...]:
    """Inputs in which the questions differ; a file of one name and another content is one of them."""
    columns = {key: [answer["inputs"].get(key) for answer in answers] for key in QUESTIONS}
    columns["limits"] = [answer["verdict"].get("limits") for answer in answers]
    names = {**QUESTIONS, "limits": "limits of the verdict"}
    rows = [
        {"input": key, "name": names[key], "values": values}
        for key, values in columns.items()
        if any(value != values[0] for value in values)
    ]
    files = [{one.get("name"): one.get("sha256") for one in answer["files_read"]} for answer in answers]
    for name in dict.fromkeys(name for one in files for name in one):
        sums = [one.get(name) for one in files]
        if all(sums) and len(set(sums)) > 1:
            rows.append({"input": "file", "name": f"content of {name}", "values": sums})
    return tuple(rows)


def _warnings(
    designs: Sequence[Mapping[str, Any]], differences: Sequence[Mapping[str, Any]], answers: Sequence[Mapping[str, Any]]
) -> tuple[dict[str, str], ...]:
    warnings = []
    if differences:
        names = ", ".join(one["name"] for one in differences)
        message = f"The designs answer different questions ({names}): compare their verdicts and scores with care."
        warnings.append({"code": "different_questions", "message": message})
    versions = dict.fromkeys(str(answer.get("version")) for answer in answers)
    if len(versions) > 1:
        message = f"The designs were made by different versions ({', '.join(versions)}): run 'suggest' again."
        warnings.append({"code": "different_versions", "message": message})
    return tuple(warnings)

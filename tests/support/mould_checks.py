"""What a good mould's list of checks may hold."""

from typing import Any

from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec, read_kind

MAY_SKIP = {"label_reads_right", "label_not_mirrored", "fits_oven", "fits_vacuum_chamber", "step_second_reader"}
"""Without room for a label, oven, vacuum, FreeCAD or gmsh there is nothing to check; all others are worked out."""


def no_check_fails(checks: list[dict[str, Any]]) -> bool:
    """Whether every check passes but those that may be left out."""
    return bool(checks) and all(
        item["status"] == "pass" or (item["status"] == "skipped" and item["id"] in MAY_SKIP) for item in checks
    )


def shape_spec(text: str, thickness_mm: float, **given: Any) -> MouldSpec:
    """Specification of a 60 x 50 mm pad of a shape such as ``crowned:3,8,9``."""
    kind, parameters = read_kind(text)
    return mould_spec(thickness_mm, 60.0, 50.0, kind=kind, parameters=parameters, **given)


def failed(checks: list[Any]) -> list[str]:
    """What failed, with its value and note."""
    return [f"{item.id} = {item.value} ({item.note})" for item in checks if item.status == "fail"]


def named(checks: list[Any]) -> dict[str, Any]:
    """Checks by their name."""
    return {item.id: item for item in checks}

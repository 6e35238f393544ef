"""Presses of a campaign that come in, folders from elsewhere, and the start of a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.measurement.campaign_from_files import read_trials
from dummydesign.studio.file_transfer import check_press, holds, inside, plain_name
from dummydesign.studio.project_index import Mould, moulds, shape_key
from dummydesign.studio.state import State
from dummydesign.studio.trash import Taken, keep_file


def take(root: Path, campaign: str, name: str, content: bytes, planned: str = "") -> Taken:
    """Take a press under its planned name: that which is chosen, else that of the file."""
    plain_name(name)
    folder, plan = inside(root, campaign), {trial["file"]: trial for trial in read_trials(root / campaign)}
    target = planned or name
    if target not in plan:
        raise InputError(
            f"{name} is not a planned name: choose the press that it is, then drop it again",
            "unknown_name",
            "campaign.trials",
            name,
            tuple(plan),
        )
    plain_name(target)  # a plan can name another file of its folder as a press, such as itself
    check_press(name, content, plan[target].get("velocity_mm_s"))
    for other in plan:
        if other != target and holds(folder / other, content):
            message = f"{name} is the same as {other}, which is there: press it again"
            raise InputError(message, "duplicate", "trace", name)
    taken = keep_file(root, folder, target, content)
    return taken if target == name else replace(taken, text=f"{name} is now {target}. {taken.text}")


FIELDS: dict[str, Any] = {
    "pads": "5,15,20",
    "speeds": "10,250",
    "forces": "5,10,15",
    "ages": "9,14,29",
    "repeats": 2,
    "hold": 10.0,
    "shape": "slab",
    "pad": "150x120",
}


def usual_moulds(root: Path, state: State) -> list[str]:
    """Moulds whose pads one campaign can press: of one outline, resin and ratio, each of its own thickness.

    Those of the pad that is chosen, else those of the newest mould.
    """
    # The chosen pad's stand last: of each thickness the last one counts.
    own = sorted(moulds(root), key=lambda one: one.is_of(state))
    kept = {one.pad["thickness_mm"]: one.folder for one in own if _kind(one) == _kind(own[-1])}
    return [kept[thickness] for thickness in sorted(kept)]


def _kind(mould: Mould) -> tuple[Any, ...]:
    pad = mould.pad
    return mould.length_mm, mould.width_mm, pad["resin"], pad["ratio"], shape_key(pad["shape"])


def plan_of(root: Path, campaign: str) -> dict[str, Any]:
    """The fields of a plan that ``campaign new`` wrote, by its manifest; empty where it cannot be read."""
    try:
        manifest = read_json(root / campaign / MANIFEST)
        pads, set_up = manifest["inputs"]["design"], manifest["inputs"]["set_up"]
        if manifest["command"] != "campaign new" or pads["by_depth"]:
            return {}
        plan: dict[str, Any] = {
            "pads": _list(pads["pads_mm"]),
            "speeds": _list(pads["velocities_mm_s"]),
            "forces": _list(pads["targets"]),
            "ages": _list(pads["ages_days"]),
            "repeats": int(pads["repeats"]),
            "hold": float(pads["hold_s"]),
            "shape": str(set_up.get("shape", "slab")),
            "pad": str(set_up["pad"]),
            "resin": set_up.get("resin"),
            "ratio": set_up.get("ratio"),
            "punch": str(set_up["punch"]),
        }
    except (AttributeError, ValueError, KeyError, TypeError, OverflowError):
        return {}
    return plan if plan["resin"] and plan["ratio"] else {}


def _list(values: Sequence[float]) -> str:
    return ",".join(f"{value:g}" for value in values)


def plan_options(given: Mapping[str, Any]) -> dict[str, object]:
    """Options of ``campaign new`` for the fields of a plan; pads come from moulds where some are named."""
    presses = {
        "velocity": given["speeds"],
        "force": given["forces"],
        "repeats": given["repeats"],
        "ages": given["ages"],
        "hold": given["hold"],
    }
    if given.get("moulds"):
        return {"from-mould": ",".join(given["moulds"]), **presses, "punch": given["punch"]}
    pads = {
        key: "" if key in ("shape", "pad") and given[key] == FIELDS[key] else given[key]
        for key in ("pads", "shape", "pad")
    }
    return {**pads, **presses, **{key: given[key] for key in ("resin", "ratio", "punch")}}

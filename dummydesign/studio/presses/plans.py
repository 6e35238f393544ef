"""What a new plan begins with: the pads that were moulded, or the plan that is changed."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dummydesign.core.outputs.manifest import NAME as MANIFEST
from dummydesign.studio.made import Mould, moulds, shape_key
from dummydesign.studio.state import State

FIELDS = {
    "pads": "5,15,20", "speeds": "10,250", "forces": "3,7,12", "ages": "9,14,29", "repeats": 2, "hold": 10.0,
    "shape": "slab", "pad": "150x120", "moulds": (),
}  # fmt: skip


def usual_moulds(root: Path, state: State) -> list[str]:
    """Moulds whose pads one campaign can press: of one outline, resin and ratio, each of its own thickness.

    Those of the pad that is chosen come first, else those of the newest mould.

    Parameters
    ----------
    root : Path
        The project folder.
    state : State
    """
    found = list(reversed(moulds(root)))
    first = next((one for one in found if one.is_of(state)), found[0] if found else None)
    if first is None:
        return []
    kept: dict[float, Mould] = {}
    for one in [first, *found]:
        if _kind(one) == _kind(first):
            kept.setdefault(one.pad["thickness_mm"], one)
    return [kept[thickness].folder for thickness in sorted(kept)]


def _kind(mould: Mould) -> tuple[Any, ...]:
    pad = mould.pad
    return mould.length_mm, mould.width_mm, pad["resin"], pad["ratio"], shape_key(pad["shape"])


def plan_of(root: Path, campaign: str) -> dict[str, Any]:
    """The fields of a plan that ``campaign new`` wrote, by its manifest; empty where it cannot be read.

    Parameters
    ----------
    root : Path
        The project folder.
    campaign : str
        Its folder.
    """
    try:
        told = json.loads((root / campaign / MANIFEST).read_text(encoding="utf-8"))
        pads, set_up = told["inputs"]["design"], told["inputs"]["set_up"]
        if told["command"] != "campaign new" or pads["by_depth"]:
            return {}
        found: dict[str, Any] = {
            "pads": _list(pads["pads_mm"]), "speeds": _list(pads["velocities_mm_s"]),
            "forces": _list(pads["targets"]), "ages": _list(pads["ages_days"]), "repeats": int(pads["repeats"]),
            "hold": float(pads["hold_s"]), "shape": str(set_up.get("shape", "slab")), "pad": str(set_up["pad"]),
            "resin": set_up.get("resin"), "ratio": set_up.get("ratio"), "punch": str(set_up["punch"]),
        }  # fmt: skip
    except (OSError, ValueError, KeyError, TypeError):
        return {}
    return found if found["resin"] and found["ratio"] else {}


def _list(values: Sequence[float]) -> str:
    return ",".join(f"{value:g}" for value in values)


def plan_options(given: Mapping[str, Any]) -> dict[str, object]:
    """Options of ``campaign new`` for the fields of a plan; pads come from moulds where some are named."""
    common = {
        "velocity": given["speeds"], "force": given["forces"], "repeats": given["repeats"], "ages": given["ages"],
        "hold": given["hold"],
    }  # fmt: skip
    punch = {"punch": given["punch"]}
    if given["moulds"]:
        return {"from-mould": ",".join(given["moulds"]), **common, **punch}
    shape = "" if given["shape"] == "slab" else given["shape"]
    pad = "" if given["pad"] == FIELDS["pad"] else given["pad"]
    return {"pads": given["pads"], "shape": shape, "pad": pad, **common, "resin": given["resin"],
            "ratio": given["ratio"], **punch}  # fmt: skip

"""Presses of a campaign that come in, folders from elsewhere, and the start of a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import csv_text, read_json, write_bytes, write_text, writing
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.measurement.campaign_file import FILE, read_campaign_toml, trial_tables
from dummydesign.measurement.campaign_from_files import COLUMNS, named_values, read_table, read_trials
from dummydesign.measurement.campaign_status import differences_from_plan
from dummydesign.measurement.trace import read_trace
from dummydesign.studio.file_transfer import check_press, holds, inside, plain_name, read_sent, save_upload
from dummydesign.studio.project_index import Mould, moulds, shape_key
from dummydesign.studio.state import State
from dummydesign.studio.trash import Deleted, check_idle, delete, replace_file

HELD = "unassigned"
"""Folder in that of a campaign, for files that have no planned name."""


@dataclass(frozen=True)
class Taken:
    """What became of a file: a sentence, and the file whose place it took."""

    text: str
    gone: Deleted | None = None


def take(root: Path, campaign: str, name: str, content: bytes) -> Taken:
    """Take a press: under its planned name at once, under another name for later."""
    plain_name(name)
    planned = {trial["file"]: trial for trial in read_trials(root / campaign)}
    check_press(name, content, planned.get(name, {}).get("velocity_mm_s"))
    if name not in planned:
        kept = save_upload(inside(root, f"{campaign}/{HELD}"), name, content).name
        return Taken(f"{kept} is not a planned name. Assign it to a press below.")
    return _put(root, campaign, name, content)


def held(root: Path, campaign: str) -> list[str]:
    """Files of a campaign that wait for their press."""
    return _names(root / campaign / HELD)


def presses_for(root: Path, campaign: str, name: str) -> dict[str, str]:
    """Planned presses that a held file may be, with words: those that fit and are missing first."""
    folder, trace = root / campaign, None
    with suppress(InputError):
        trace = read_trace(folder / HELD / name)
    rows = []
    for number, trial in enumerate(table.data for table in trial_tables(read_campaign_toml(folder))):
        fits = trace is not None and not list(differences_from_plan(trace, trial))
        there = (folder / str(trial.get("file"))).is_file()
        words = f"{trial.get('file')}{' (as planned)' if fits else ''}{', replaces the one there' if there else ''}"
        rows.append((not fits, there, number, str(trial.get("file")), words))
    return {file: words for *_, file, words in sorted(rows)}


def assign(root: Path, campaign: str, name: str, planned: str) -> Taken:
    """Give a held file the name of a planned press; an earlier file of that press goes to the bin."""
    folder = root / campaign
    if planned not in {trial["file"] for trial in read_trials(folder)}:
        raise InputError(f"'{planned}' is not in the plan", "unknown_name", "campaign.trials", planned)
    held_file = folder / HELD / plain_name(name)
    try:
        content = held_file.read_bytes()
    except OSError:
        raise InputError(f"'{name}' is not there (any more)", "file_not_found", "trace", name) from None
    taken = _put(root, campaign, planned, content)
    with writing(f"{planned} was added;", name, "trace"):
        held_file.unlink()
    return Taken(f"{name} is now {planned}. {taken.text}", taken.gone)


def discard(root: Path, campaign: str, name: str) -> Deleted:
    """Move a held file to the bin."""
    return delete(root, f"{campaign}/{HELD}/{plain_name(name)}")


def _put(root: Path, campaign: str, name: str, content: bytes) -> Taken:
    plain_name(name)  # a plan can name another file of its folder as a press, such as itself
    folder = inside(root, campaign)
    for other in (trial["file"] for trial in read_trials(folder)):
        if other != name and holds(folder / other, content):
            message = f"{name} is the same as {other}, which is there: press it again"
            raise InputError(message, "duplicate", "trace", name)
    if not (folder / name).is_file():
        save_upload(folder, name, content)
        return Taken(f"{name} was added.")
    if holds(folder / name, content):
        return Taken(f"{name} is there already.")
    return Taken(f"{name} was added. The earlier one is in the bin.", replace_file(root, folder, name, content))


FOLDER = "measured/to-bring-in"
TABLE, AS_SENT = "trials.csv", ".trials.csv"
"""The table that the page writes, of the presses that came so far; and the one that was dropped, for those to come."""
KEYS = ("sequence", "thickness_mm", "velocity_mm_s", "target_force_N", "repeat", "age_days", "temperature_C", "rest_s")
"""Columns of the table that are filled in on the page."""
ENDINGS = (".csv", ".toml", ".txt", ".md", ".json", ".html")


def save_waiting_file(root: Path, name: str, content: bytes) -> str:
    """Keep a file that was dropped, in the place of an earlier one of its name; return its name."""
    if name != FILE:  # the one file of a meaning of its own that belongs here
        plain_name(name)
    if not name.lower().endswith(ENDINGS):
        message = f"a campaign has files of the kinds {', '.join(ENDINGS)}"
        raise InputError(message, "unknown_name", "file_ending", name, ENDINGS)
    with writing("folder", FOLDER, "folder"):
        inside(root, FOLDER).mkdir(parents=True, exist_ok=True)
    if name == TABLE:
        read_sent(name, content, read_table)
        write_bytes(root / FOLDER / AS_SENT, content)
    return write_bytes(root / FOLDER / name, content).name


def waiting(root: Path) -> list[str]:
    """Files that wait to be brought in."""
    return _names(root / FOLDER)


def _names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("[!.]*") if path.is_file())


def traces(root: Path) -> list[str]:
    """Presses among them."""
    return [name for name in waiting(root) if name.lower().endswith(".csv") and name != TABLE]


def new_campaign_folder(root: Path, name: str) -> str:
    """Folder of a new campaign."""
    folder = f"campaigns/{plain_name(name.strip())}"
    if (root / folder).exists():
        raise InputError(f"'{folder}' is there already: choose another name", "file_exists", "campaign", folder)
    return folder


def bring_in(root: Path, name: str) -> str:
    """Make a campaign of the files as they are; return its folder from the project folder on."""
    folder = new_campaign_folder(root, name)
    read_campaign_toml(root / FOLDER)
    check_idle(root, FOLDER)
    with writing("campaign", folder, "campaign"):
        (root / folder).parent.mkdir(exist_ok=True)
        (root / FOLDER).rename(root / folder)
    return folder


def table(root: Path) -> list[dict[str, Any]]:
    """A row for each press: what its name says, and what a table of trials among the files says."""
    given: dict[str, dict[str, Any]] = {}
    for one in (AS_SENT, TABLE):
        with suppress(InputError):
            given |= read_table(root / FOLDER / one)
    return [
        {"file": name, **dict.fromkeys(COLUMNS[1:]), **named_values(Path(name)), **given.get(name, {})}
        for name in traces(root)
    ]


def write_table(root: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write the table that ``campaign from-files`` reads."""
    used = [key for key in COLUMNS if any(row.get(key) is not None for row in rows)]

    def cell(value: object) -> object:
        return f"{value:g}" if isinstance(value, float) else value

    write_text(root / FOLDER / TABLE, csv_text(used, ([cell(row.get(key)) for key in used] for row in rows)))


def words(root: Path, name: str, more: Sequence[str]) -> list[str]:
    """The command that makes a campaign of presses without ``campaign.toml``."""
    presses = traces(root)
    if not presses:
        raise InputError("drop the files of the presses first", "missing", "trace")
    folder = new_campaign_folder(root, name)
    return [
        "campaign",
        "from-files",
        folder,
        *(f"{FOLDER}/{one}" for one in presses),
        "--table",
        f"{FOLDER}/{TABLE}",
        *more,
    ]


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

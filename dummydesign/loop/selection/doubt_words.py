"""Doubts about labels in words: what each kind says, and the lines of ``campaign.toml`` that read it otherwise."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.serialise import Serialised
from dummydesign.core.user_library import toml_value
from dummydesign.loop.data.trials import Presses
from dummydesign.measurement.campaign import Trial


@dataclass(frozen=True)
class Doubt(Serialised):
    """A label that looks wrong: its kind, the presses, how odd they are (standard deviations of what right ones
    scatter), in words, and the lines of ``campaign.toml`` that read it otherwise."""

    kind: str
    files: tuple[str, ...]
    z: float
    text: str
    read_as: str
    rows: tuple[int, ...] = field(default=(), repr=False)


@dataclass(frozen=True)
class PadReading:
    """Presses as presses of one of the pads: ln of the force and standard deviations by which they differ from what is
    expected of it, all (T,), the chi-square that is left, and whether the force law reaches so deep."""

    pad: Trial
    difference: NDArray
    z: NDArray
    left: NDArray
    reached: NDArray


@dataclass(frozen=True)
class OddGroup:
    """Presses (T,) that differ from the rest, by how much, how clearly, and whether they are those of a day."""

    rows: NDArray
    apart: float
    z: float
    of_day: bool


def _lines(files: list[str], **keys: object) -> str:
    """Lines of ``campaign.toml`` that read some presses in another way."""
    return "\n".join(
        ["[[read_as]]", f"files = {toml_value(files)}", *(f"{k} = {toml_value(v)}" for k, v in keys.items())]
    )


def exchanged(presses: Presses, one: int, two: int, z: float) -> Doubt:
    """Two presses that look exchanged."""
    files = [presses.trials[row].file for row in (one, two)]
    text = f"{files[0]} and {files[1]} look exchanged: each is what is expected of the other's row"
    return Doubt("exchanged", tuple(files), z, text, _lines(files, exchanged=True), (one, two))


def pads_exchanged(presses: Presses, rows: NDArray, one: Trial, two: Trial, z: float) -> Doubt:
    """Two pads that look exchanged for a day."""
    trials = [trial for trial, own in zip(presses.trials, rows) if own]
    text = f"{_named(one)} and {_named(two)} look exchanged at the age of {trials[0].age_days:g} days"
    files = [[trial.file for trial in trials if trial.pad == pad.pad] for pad in (one, two)]
    lines = [_lines(own, pad_of=of.file) for own, of in zip(files, (two, one)) if own]
    return Doubt("exchanged", (*files[0], *files[1]), z, text, "\n\n".join(lines), tuple(np.flatnonzero(rows).tolist()))


def _named(trial: Trial) -> str:
    shape = "" if trial.geometry.plain else f"{trial.geometry} "
    return f"the {shape}{trial.thickness_mm:g} mm pad"


def _of_press(kind: str, presses: Presses, row: int, z: float, looks: str, **keys: object) -> Doubt:
    """A press that looks otherwise than its row says."""
    file = presses.trials[row].file
    return Doubt(kind, (file,), z, f"{file} {looks}", _lines([file], **keys), (row,))


def other_pad(presses: Presses, row: int, best: PadReading, z: float) -> Doubt:
    """A press that looks like one of another pad."""
    looks = f"looks like {_named(best.pad)}, not {presses.thickness_mm[row]:g} mm"
    return _of_press("pad", presses, row, z, looks, pad_of=best.pad.file)


def mistyped(presses: Presses, row: int, mm: float, z: float) -> Doubt:
    """A press whose thickness looks mistyped."""
    looks = f"looks like a pad of about {mm:.2g} mm, not {presses.thickness_mm[row]:g} mm"
    return _of_press("thickness", presses, row, z, looks, thickness_mm=float(f"{mm:.3g}"))


def whole_pad(presses: Presses, rows: NDArray, mm: float | None, z: float) -> Doubt:
    """All presses of a pad, whose thickness looks wrong; ``mm`` is None where it is not known."""
    files, declared = [presses.trials[row].file for row in rows], presses.trials[rows[0]].thickness_mm
    like = "look like one of another thickness" if mm is None else f"look like one of about {mm:.2g} mm"
    text = f"all {len(files)} presses of the {declared:g} mm pad {like}: gauge it"
    lines = _lines(files, thickness_mm=declared if mm is None else float(f"{mm:.3g}"))
    return Doubt("thickness", tuple(files), z, text, lines, tuple(rows.tolist()))


def other_speed(presses: Presses, row: int, ln_speed: float, z: float) -> Doubt:
    """A press of another speed than its row says."""
    declared = presses.trials[row].velocity_mm_s
    speed = float(f"{declared * np.exp(ln_speed):.3g}")
    looks = f"was pressed at {speed:g} mm/s, not {declared:g} mm/s"
    return _of_press("speed", presses, row, z, looks, velocity_mm_s=speed)


def _of_group(kind: str, presses: Presses, group: OddGroup, looks: str, **keys: object) -> Doubt:
    """Some presses, or those of a day, that look in some way."""
    trials = [trial for trial, own in zip(presses.trials, group.rows) if own]
    files = [trial.file for trial in trials]
    words = files[0] if len(files) == 1 else f"{len(files)} presses ({', '.join(files)})"
    if group.of_day:
        words = f"the {len(files)} presses at the age of {trials[0].age_days:g} days"
    rows = tuple(np.flatnonzero(group.rows).tolist())
    return Doubt(kind, tuple(files), group.z, f"{words} {looks}", _lines(files, **keys), rows)


def other_sensor(presses: Presses, group: OddGroup, hz: float, usual: float) -> Doubt:
    """Presses that look filtered otherwise than the rest."""
    looks = f"look filtered at about {hz:.2g} Hz, not {usual:g} Hz as the others"
    return _of_group("sensor", presses, group, looks, lowpass_hz=float(f"{hz:.2g}"))


def other_zero(presses: Presses, group: OddGroup) -> Doubt:
    """Presses whose zero is another than that of the rest."""
    looks = f"read {group.apart:+.2g} N before contact, beside the others: their zero is another"
    return _of_group("zero", presses, group, looks, zero_N=float(f"{group.apart:.2g}"))

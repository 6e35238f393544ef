"""What ``dummydesign import`` makes of presses drawn with all that robots and sensors do, in drawn files.

``python -m benchmarks.accuracy.import_drawn [--draws N] [--seed S] [--plain] [--out FILE]`` draws presses of tissue and
pads with overshoot (0 to 10 %), ringing, drift (to 0.1 N/s), slope with travel (to 0.01 N/mm, as of a dragged cable),
digits of the force, noise that wanders, dropped rows and, in three of ten, a zero of the position far from contact.
Each is written in a drawn layout (languages, units, two time bases, wrong units of the header:
:mod:`benchmarks.accuracy.import_layouts`; ``--plain``: as a canonical CSV) and imported, with ``--spoil KIND`` as a
slower position, a late force or packets of rows record it. The table gives the rates of
wrong answers without a warning of them, of questions of files that say all, and of intervals (95 %) of contact and
steady force with the truth. A contact or steady force that is off by more than 1 % and lies within its stated interval
counts as ``stated``.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy.import_layouts import write_file
from benchmarks.accuracy.overshoot import law_force, path
from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.decisions import Settings
from dummydesign.measurement.importing.read import Imported, import_files
from dummydesign.measurement.sensor import Lowpass

DEPTH, STEADY, HOLD = 0.01, 0.01, (0.3, 0.03)
"""What depth and steady force may be off (shares), and the hold (the larger of s and share)."""
SPOILS = {
    "steps": "coarse_position",
    "held": "coarse_position",
    "late": "force_delayed",
    "packets": "",
    "tail": "force_not_back",
    "short": "",
    "long": "",
    "slow": "",
    "jitter": "",
    "lost": "",
    "lowpass": "",
    "thermal": "",
    "stopping": "",
    "stages": "several_holds",
    "touch": "no_free_travel",
}
"""What another rig, robot or protocol does to a recording, and the warning that names it."""
ZERO = {"contact_uncertain", "contact_may_be_late", "contact_not_checked", "contact_of_slower_presses"}
NO_WORD = {
    "contact": {"force_drifts", "steady_uncertain", "force_not_back", "coarse_digits", *ZERO},
    "steady force": ZERO,
}
"""Warnings that are no word of a fault: of another quantity, or of an interval, which counts by itself."""


@dataclass(frozen=True)
class Drawn:
    """A press as it stands in the file, its zero of the position included, and its truth."""

    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    depth_mm: float
    hold_s: float
    steady_N: float
    zero_mm: float
    kinds: dict[str, float]


def warped(time: NDArray, kinds: dict[str, float], kind: str) -> NDArray:
    """Time along the usual path: it eases to the stop (``stopping``) or rests on the way (``stages``). [s]"""
    stop = kinds["depth_mm"] / kinds["speed_mm_s"]
    if kind == "stages":
        return np.where(time < kinds["rests_s"], time, np.maximum(time - kinds["paused_s"], kinds["rests_s"]))
    if kind != "stopping":
        return time
    share, end = kinds["eased"] * stop, stop + kinds["hold_s"]
    eased = stop - share * np.exp(-np.maximum(time - stop + share, 0.0) / share)
    return np.where(time > end, time, np.where(time > stop - share, eased, time))


def draw(rng: np.random.Generator, kind: str = "") -> Drawn:
    """Draw one press, evenly sampled but for its dropped rows, of a kind of robot or protocol."""
    released = kind == "tail"

    def spread(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    kinds = {
        "overshoot": float(rng.uniform(0.0, 0.1)),
        "ringing_Hz": spread(3.0, 50.0),
        "damping": spread(0.02, 1.0),
        "depth_mm": spread(1.0, 8.0),
        "speed_mm_s": spread(1.0, 100.0),
        "hold_s": float(rng.uniform(3.0, 10.0)),
        "peak_N": spread(3.0, 30.0),
        "noise_N": spread(0.002, 0.03),
        "digit_N": float(rng.choice([1e-4, 0.001, 0.01, 0.1])),
        "drift_N_s": float(rng.choice([0, 1]) * rng.uniform(-0.1, 0.1)),
        "slope_N_mm": float(rng.choice([0, 1]) * rng.uniform(-0.01, 0.01)),
        "wander": float(rng.choice([0.0, 0.5])),
        "dropped": float(rng.choice([0.0, 0.0, 0.01])),
        "dwell_s": float(rng.uniform(0.5, 4.0)),
        "gap_mm": float(rng.uniform(1.0, 1.9 if released else 5.0)),  # it comes back by 1 mm: half of that at least
        "released": max(float(rng.integers(2)), float(released)),
        "zero_mm": float(rng.choice([0, 0, 0, 0, 0, 0, 0, 1, 1, 1]) * rng.uniform(5, 400)),
    }
    kinds["release_mm_s"] = kinds["speed_mm_s"]
    rate = float(rng.choice([200.0, 500.0, 1000.0]))
    stop = kinds["depth_mm"] / kinds["speed_mm_s"]
    longer = 0.0
    if kind in ("short", "long"):
        kinds["hold_s"] = float(rng.uniform(0.5, 2.0) if kind == "short" else rng.uniform(20.0, 40.0))
    elif kind == "slow":
        kinds["speed_mm_s"] = kinds["release_mm_s"] = spread(1.0, 10.0)
        stop, rate = kinds["depth_mm"] / kinds["speed_mm_s"], spread(20.0, 50.0)
    elif kind == "stopping":
        kinds |= {"overshoot": 0.0, "eased": float(rng.uniform(0.05, 0.3))}
    elif kind == "stages":
        longer = float(rng.uniform(0.3, 2.0))
        kinds |= {"rests_s": float(rng.uniform(0.2, 0.7)) * stop, "paused_s": longer}
    end = stop + kinds["hold_s"] + longer
    last = end + (kinds["released"] * ((kinds["depth_mm"] + 1.0) / kinds["release_mm_s"] + rng.uniform(0.5, 2.0)))
    time = np.arange(-kinds["gap_mm"] / kinds["speed_mm_s"] - kinds["dwell_s"], last, 1.0 / rate)
    fine = np.arange(0.0, last + 2e-4, max(min(2e-3 * stop, 0.02 / kinds["ringing_Hz"]), 1e-4))
    law = str(rng.choice(["tissue", "ball", "flat"]))
    way = warped(fine, kinds, kind)
    force, plain = (forces(law, fine, path(way, kinds, ringing)) for ringing in (True, False))
    scale = kinds["peak_N"] / force.max()
    late = (fine > end - 0.05 * kinds["hold_s"]) & (fine <= end)
    moved = path(warped(time, kinds, kind), kinds)
    x = np.where(time < 0.0, np.maximum(kinds["speed_mm_s"] * time, -kinds["gap_mm"]), moved)
    keep = np.exp(-1.0 / rate / 0.5)
    wander, level = np.zeros(len(time)), rng.normal()
    for at, kick in enumerate(rng.normal(0.0, np.sqrt(1.0 - keep**2), len(time))):
        level = keep * level + kick
        wander[at] = level
    measured = scale * np.interp(time, fine, force, left=0.0) + kinds["drift_N_s"] * (time - time[0])
    noise = rng.standard_normal(len(time)) + kinds["wander"] * wander
    measured += kinds["slope_N_mm"] * (x - x[0]) + kinds["noise_N"] * noise
    measured = np.round(before_digits(time - time[0], measured, kind, rng) / kinds["digit_N"]) * kinds["digit_N"]
    x = np.round(x + rng.normal(0.0, 0.001, len(x)), 4)
    if kind == "stopping":  # it has stopped where a tenth of its speed is left
        stop += kinds["eased"] * stop * (np.log(10.0) - 1.0)
    held = (end if kinds["released"] else float(time[-1])) - stop - longer
    return Drawn(
        time - time[0],
        x + kinds["zero_mm"],
        measured,
        kinds["depth_mm"],
        held,
        scale * float(plain[late].mean()),
        kinds["zero_mm"],
        kinds,
    )


def before_digits(time: NDArray, force: NDArray, kind: str, rng: np.random.Generator) -> NDArray:
    """A force as the amplifier's low-pass and a sensor that warms up show it to the converter."""
    if kind == "lowpass":
        return Lowpass(float(np.exp(rng.uniform(np.log(20.0), np.log(100.0)))), 2, 1).apply(time, force)
    if kind == "thermal":
        size, lasts = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.3)), float(rng.uniform(5.0, 60.0))
        return force + size * (1.0 - np.exp(-time / lasts))
    return force


def forces(law: str, time: NDArray, x: NDArray) -> NDArray:
    """Force of tissue, or of a pad under a ball or a flat punch that relaxes by 30 % in 1.5 s and 20 % in 0.05 s."""
    if law == "tissue":
        return law_force(time, x)
    from scipy.signal import lfilter

    elastic = np.maximum(x, 0.0) ** (1.5 if law == "ball" else 1.0) * (1.0 + 0.05 * np.maximum(x, 0.0))
    force, step = 0.5 * elastic, float(time[1] - time[0])
    for share, lasts in ((0.3, 1.5), (0.2, 0.05)):
        keep = np.exp(-step / lasts)
        force = force + share * lfilter([np.sqrt(keep)], [1.0, -keep], np.r_[0.0, np.diff(elastic)])
    return np.where(x > 0.0, np.maximum(force, 0.0), 0.0)


def spoiled(press: Drawn, kind: str, rng: np.random.Generator) -> Drawn:
    """The same press as another rig records it.

    A position in steps or held, a force that is late (half of them begin on the way in, with fewer samples of the
    hold), packets of rows, a force that comes back slowly: by the creep of the load cell, or as an average is shown;
    stamps that jitter, rows lost in bursts, a zero set at a touch.
    """
    time, x, force = press.time_s, press.displacement_mm, press.force_N
    if kind == "steps":
        step = float(rng.choice([0.02, 0.05, 0.1, 0.2]))
        return replace(press, displacement_mm=np.round(x / step) * step)
    if kind == "held":
        rate = float(rng.choice([5.0, 10.0, 20.0, 30.0]))
        return replace(press, displacement_mm=np.interp(np.floor(time * rate) / rate, time, x))
    if kind == "late":
        late = float(rng.choice([-1.0, 1.0]) * np.exp(rng.uniform(np.log(0.005), np.log(0.05))))
        force = np.round(np.interp(time - late, time, force) / press.kinds["digit_N"]) * press.kinds["digit_N"]
        if rng.random() < 0.5:
            return replace(press, force_N=force)
        drawn = press.kinds
        touch = drawn["dwell_s"] + drawn["gap_mm"] / drawn["speed_mm_s"]
        begin = touch - rng.uniform(0.2, 0.9) * drawn["gap_mm"] / drawn["speed_mm_s"]
        rises = time < touch + drawn["depth_mm"] / drawn["speed_mm_s"] + 0.3
        kept = (time >= begin) & (rises | (np.arange(len(time)) % 20 == 0))
        return replace(press, time_s=time[kept] - begin, displacement_mm=x[kept], force_N=force[kept])
    if kind == "tail":
        from scipy.signal import lfilter

        step, digit, rest = float(time[1] - time[0]), press.kinds["digit_N"], float(force[0])
        if rng.random() < 0.5:
            rows = int(rng.uniform(0.3, 3.0) / step)
            force = rest + lfilter(np.full(rows, 1.0 / rows), [1.0], force - rest)
        else:
            share, lasts = np.exp(rng.uniform(np.log([0.005, 2.0]), np.log([0.05, 20.0])))
            kept = np.exp(-step / lasts)
            force = force + share * lfilter([1.0 - kept], [1.0, -kept], force - rest)
        return replace(press, force_N=np.round(force / digit) * digit)
    if kind == "jitter":
        step = float(time[1] - time[0])
        return replace(press, time_s=np.round(time + rng.uniform(-0.35, 0.35, len(time)) * step, 6))
    if kind == "lost":
        kept = np.ones(len(time), bool)
        for first in rng.integers(0, len(time), int(rng.integers(2, 8))):
            kept[first : first + int(rng.integers(2, 12))] = False
        return replace(press, time_s=time[kept], displacement_mm=x[kept], force_N=force[kept])
    if kind == "touch":
        drawn = press.kinds
        touch = drawn["dwell_s"] + drawn["gap_mm"] / drawn["speed_mm_s"]
        kept = time > touch + rng.uniform(0.01, 0.1) * drawn["depth_mm"] / drawn["speed_mm_s"]
        begin = float(x[kept][0])
        columns = {"time_s": time[kept] - time[kept][0], "displacement_mm": x[kept] - begin, "force_N": force[kept]}
        return replace(press, zero_mm=press.zero_mm - begin, **columns)
    if kind != "packets":
        return press
    rows = int(rng.integers(5, 60))
    last = np.minimum((np.arange(len(time)) // rows + 1) * rows - 1, len(time) - 1)
    return replace(press, time_s=time[last] + 1e-5 * (np.arange(len(time)) % rows))


def write_plain(file: Path, press: Drawn, rng: np.random.Generator) -> dict[str, Any]:
    """Write a canonical CSV with rows dropped at random."""
    kept = rng.random(len(press.time_s)) >= press.kinds["dropped"]
    rows = np.stack([press.time_s, press.displacement_mm, press.force_N], axis=1)[kept]
    np.savetxt(file, rows, fmt="%.6f", delimiter=",", header="time_s,displacement_mm,force_N", comments="")
    return {"slip": "", "needs": {}, "layout": {"form": "plain"}}


def judge(press: Drawn, found: Imported) -> tuple[list[str], bool | None, bool | None]:
    """What is wrong with one imported press, and whether the intervals of contact and steady force hold the truth."""
    if len(found.presses) != 1:
        return ["presses"], None, None
    one = found.presses[0]
    summary, faults = one.summary, []
    moved = float(np.max(one.displacement_mm)) - (np.max(press.displacement_mm) - press.zero_mm)
    if abs(summary.depth_mm / press.depth_mm - 1.0) > DEPTH:
        faults.append("depth" if abs(moved) < 0.5 * DEPTH * press.depth_mm else "contact")
    if abs(summary.hold_s - press.hold_s) > max(HOLD[0], HOLD[1] * press.hold_s):
        faults.append("hold")
    if summary.steady_force_N is None or abs(summary.steady_force_N / press.steady_N - 1.0) > STEADY:
        faults.append("steady force")
    if (
        not 0.5 < float(np.ptp(one.time_s)) / float(np.ptp(press.time_s)) < 2.0
        or not 0.5 < (float(np.ptp(one.displacement_mm)) / float(np.ptp(press.displacement_mm))) < 2.0
    ):
        faults = ["unit"]
    within = None
    if summary.steady_force_N is not None and one.steady_error_N is not None:
        within = bool(abs(summary.steady_force_N - press.steady_N) <= one.steady_error_N)
    return faults, bool(one.contact_low_mm <= moved <= one.contact_high_mm), within


def main() -> None:
    """Print the table and write its numbers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=20261126)
    parser.add_argument("--plain", action="store_true")
    parser.add_argument("--spoil", choices=tuple(SPOILS))
    parser.add_argument("--out", type=Path)
    parser.add_argument("--show", type=int, default=0)
    options = parser.parse_args()
    counts: Counter[str] = Counter()
    inside: list[bool] = []
    steady: list[bool] = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(options.draws):
            rng = np.random.default_rng([options.seed, number])
            press, file = draw(rng, options.spoil or ""), Path(folder, f"press_{number}.csv")
            press = spoiled(press, options.spoil, rng) if options.spoil else press
            columns = (press.time_s, press.displacement_mm, press.force_N)
            truth = write_plain(file, press, rng) if options.plain else write_file(file, rng, *columns)
            try:
                read = import_files([file], Settings(**truth["needs"]))[0]
            except InputError as refusal:
                needed = press.zero_mm and refusal.quantity == "contact"
                asked = f"{'needed' if needed else 'asked'}: {refusal.quantity}"
                name = "slip caught" if truth["slip"] else asked
                counts[name] += 1
                if number < options.show:
                    print(number, name, str(refusal)[:250])
                continue
            finally:
                for made in Path(folder).glob("*"):
                    made.unlink()
            if len(read) != 1:
                counts["several tests"] += 1
                continue
            codes = {warning["code"] for warning in read[0].warnings}
            faults, held, within = judge(press, read[0])
            inside += [] if held is None else [held]
            steady += [] if within is None else [within]
            told = codes - {"hold_too_short", "no_hold"}
            if truth["slip"]:
                counts["slip caught" if told else "quiet: unit"] += 1
                continue
            counts["the kind is named"] += SPOILS.get(options.spoil, "") in codes
            for fault in faults:
                stated = {"contact": held, "steady force": within}.get(fault)
                quiet = "stated" if stated else "quiet"
                counts[f"{'warned' if told - NO_WORD.get(fault, set()) else quiet}: {fault}"] += 1
            counts["right" if not faults else "wrong"] += 1
            if faults and number < options.show:
                drawn = {key: round(value, 4) for key, value in press.kinds.items()}
                print(number, faults, sorted(codes), read[0].presses[0].summary, drawn, round(press.steady_N, 4))
    result = {
        "draws": options.draws,
        "seed": options.seed,
        "plain": options.plain,
        "contact_intervals": len(inside),
        "contact_coverage": round(float(np.mean(inside)), 4),
        "steady_intervals": len(steady),
        "steady_coverage": round(float(np.mean(steady)), 4),
        "counts": dict(sorted(counts.items())),
    }
    print(f"contact intervals that hold the truth: {result['contact_coverage']:.3f} of {len(inside)}")
    print(f"intervals of the steady force that do: {result['steady_coverage']:.3f} of {len(steady)}")
    for name, count in sorted(counts.items()):
        print(f"{name:28s} {count:5d}  {100.0 * count / options.draws:.1f} %")
    if options.out:
        options.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

"""A laboratory for a walk through the commands: it presses people, pucks and pads by formulas of its own.

Shared with the package: the columns of a trace and the names in ``campaign.toml``, which it reads as an operator does.
The people's law is that of ``answer_inputs``. A pad is a bed of springs, each a neo-Hookean column of its own height,
stiffened by what the rest holds back (``HELD``); it relaxes by three arms. Moduli are those that screens print.
"""

from __future__ import annotations

import glob
import re
import shutil
import tomllib
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tests.support.answer_inputs import STEP_S, five_elements, motion

ARMS = ((0.02, 0.5), (0.25, 0.35), (2.5, 0.25))
"""Time [s] and share of the elastic force of each arm of the batch."""
HELD = 1.7
"""A column is stiffer by HELD (a / h)^2 for a contact of radius a on a pad of height h."""
NOISE_N, LIFT_MM_S = 0.02, 10.0
PEOPLE = {"anna": 0.9, "ben": 1.15}
PLAN = "campaign.toml"
BATCH = """name = "{}"
base = "polyurethane-nagoya"
[[point]]
ratio = 15.0
young_kPa = {{ value = 31.0, low = 29.0, high = 33.0, kind = "measured", source = "puck" }}
"""
HEAD = "time_s,displacement_mm,force_N"


def supply(folder: Path, words: Sequence[str]) -> None:
    """Measure what a command line reads and nobody has measured yet."""
    plans = {path for word in words for path in (folder / word / PLAN, (folder / word).parent / PLAN)}
    for plan in sorted(path for path in plans if path.is_file()):
        press_campaign(plan)
    for word in words[1:2] if words[0] == "import" else ():
        # a machine that a page describes writes its own file, and its folder of them
        if word.endswith(".txt"):
            press_machine(folder / word, *words_of_machine(words))
        elif "--profile" in words:
            shutil.rmtree(folder / word, ignore_errors=True)
    missing = [word for word in words[1:] if not glob.glob(str(folder / word))]
    for word in words if words[:2] == ["resins", "add-compression"] else ():
        # a puck of another ratio is pressed anew under the same names
        if word.endswith(".csv"):
            speed = re.search(r"v(\d+)\.csv", word, re.IGNORECASE)
            size = (float(value(words, name, "30")) for name in ("--diameter", "--height"))
            press_puck(folder / word, *size, float(speed[1]) if speed else 10.0, float(value(words, "--ratio", "15.5")))
    for word in missing:
        path = folder / word
        if words[0] == "import" and "." not in word and not word.startswith("-") and word == words[1]:
            press_people(path, sorted(folder.glob("*.txt")) if "--profile" in words else [])
        elif word.endswith(".toml") and words[:2] == ["resins", "add"]:
            path.write_text(BATCH.format(path.stem), encoding="utf-8")
        elif word == value(words, "--limits", ""):
            shutil.copy(folder / "examples" / "limits.toml", path)
        elif word.endswith(".csv") and words[0] in ("import", "predict", "compare", "on-person", "fit"):
            # a pad of 5 mm is not pressed as deep as a person
            default = "1.5" if words[0] == "predict" else "10"
            for k, force in enumerate(value(words, "--force", default).split(",")):
                press_person(folder / word.replace("*", f"{k + 1}"), "anna", 100.0, float(force))


def value(words: Sequence[str], option: str, default: str) -> str:
    """Value of an option in a command line."""
    return words[words.index(option) + 1] if option in words else default


def young_MPa(ratio: float) -> float:
    """Long-term modulus of the batch at a ratio."""
    return 0.042 * float(np.exp(0.95 * (ratio - 15.5)))


def relaxed(elastic: np.ndarray) -> np.ndarray:
    """Force of the elastic spring and its arms, exact for an elastic force that is straight between samples."""
    force = elastic.copy()
    for tau, beta in ARMS:
        keep, arm = np.exp(-STEP_S / tau), 0.0
        for k, rise in enumerate(np.diff(elastic)):
            arm = keep * arm + beta * rise / STEP_S * tau * (1.0 - keep)
            force[k + 1] += arm
    return np.maximum(force, 0.0)


def column(squeeze: np.ndarray) -> np.ndarray:
    """Nominal stress over modulus of a neo-Hookean column that is squeezed by a share of its height."""
    stretch = 1.0 - squeeze
    return (stretch**-2 - stretch) / 3.0


def press_puck(path: Path, diameter_mm: float, height_mm: float, speed_mm_s: float, ratio: float) -> None:
    """A puck between oiled plates, to 30 % of its height, held for 10 s."""
    t, x = motion(speed_mm_s, 0.3 * height_mm, 10.0)
    area = np.pi * diameter_mm**2 / 4.0
    save(path, t, x, relaxed(young_MPa(ratio) * area * column(np.clip(x, 0.0, None) / height_mm)))


def pad_curve(pad: dict, thickness_mm: float, side_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths and long-term forces over modulus of a slab or a crown under a square punch. [mm, mm2]"""
    sizes = {key: float(value) for key, value in re.findall(r"(radius|height)=([\d.]+)", pad.get("shape", "slab"))}
    half = np.linspace(-0.5, 0.5, 57)[:-1] + 0.5 / 56
    r2 = side_mm**2 * np.add.outer(half**2, half**2)
    drop = np.zeros_like(r2)
    if sizes:
        sphere = sizes["radius"] - np.sqrt(np.clip(sizes["radius"] ** 2 - r2, 0.0, None))
        drop = np.minimum(sphere, sizes["height"])
    height, depth, cell = thickness_mm - drop, np.linspace(0.0, 0.7 * thickness_mm, 200), side_mm**2 / r2.size
    force = []
    for d in depth:
        squeeze = np.clip(d - drop, 0.0, None) / height
        contact = cell * np.count_nonzero(squeeze)
        held = 1.0 + HELD * contact / np.pi / thickness_mm**2
        force.append(held * cell * column(np.minimum(squeeze, 0.9)).sum())
    return depth, np.array(force)


def press_campaign(plan: Path) -> None:
    """Press every trial that has no trace yet, and write down the temperature."""
    text = plan.read_text(encoding="utf-8")
    data = tomllib.loads(text)
    pad, side = data["pad"], data["punch"].get("side_mm", 12.4)
    for trial in data["trial"]:
        path = plan.parent / trial["file"]
        if path.exists():
            continue
        depth, share = pad_curve(pad, trial["thickness_mm"], side)
        force = young_MPa(pad.get("ratio", 15.5)) * share
        deep = trial.get("target_depth_mm") or float(np.interp(trial["target_force_N"], force, depth))
        t, x = motion(trial["velocity_mm_s"], deep, trial["hold_s"])
        if trial["unload"]:
            back = np.arange(1, round((deep + 1.0) / LIFT_MM_S / STEP_S)) * STEP_S
            t, x = np.r_[t, t[-1] + back], np.r_[x, deep - LIFT_MM_S * back]
        save(path, t, x, relaxed(np.interp(x, depth, force)))
    plan.write_text(text.replace("# temperature_C =", "temperature_C = 23.0"), encoding="utf-8")


def press_person(path: Path, who: str, speed_mm_s: float, force_N: float) -> None:
    """One press of a person, as a trace."""
    t, x = motion(speed_mm_s, float(np.cbrt(force_N / (0.09 * PEOPLE[who]))), 10.0)
    save(path, t, x, PEOPLE[who] * five_elements(t, x))


def press_people(folder: Path, known: Sequence[Path]) -> None:
    """Six presses of each person in the files of a German machine; of one whose file is known, that file for each."""
    folder.mkdir(parents=True)
    for who in PEOPLE:
        for speed in (10.0, 250.0):
            for force in (5.0, 10.0, 15.0):
                path = folder / f"{who}_v{speed:03.0f}_f{force:02.0f}.txt"
                if known:
                    shutil.copy(known[-1], path)
                    continue
                press_machine(path, "Zeit [s];Traversenweg [mm];Kraft [N]", (1.0, 1.0, 1.0), who, speed, force)


def press_machine(
    path: Path,
    head: str,
    units: tuple[float, float, float],
    who: str = "anna",
    speed_mm_s: float = 10.0,
    force_N: float = 10.0,
) -> None:
    """One press of a person in a file with semicolons and decimal commas."""
    press_person(path, who, speed_mm_s, force_N)
    rows = np.loadtxt(path, delimiter=",", skiprows=1) * units
    text = [";".join(f"{cell:.4f}" for cell in row).replace(".", ",") for row in rows]
    path.write_text("\n".join([f"Prüfprotokoll;{who}", head, *text]) + "\n", encoding="cp1252")


def words_of_machine(words: Sequence[str]) -> tuple[str, tuple[float, float, float]]:
    """Head and units of the file that an import's options describe."""
    roles = ("time", "displacement", "force")
    names = dict(
        pair.split("=") for pair in value(words, "--columns", "time=Zeit,displacement=Weg,force=Kraft").split(",")
    )
    units = dict(pair.split("=") for pair in value(words, "--units", "time=s,displacement=mm,force=N").split(","))
    sizes = {"s": 1.0, "ms": 1e3, "mm": 1.0, "um": 1e3, "N": 1.0}
    return ";".join(names[role] for role in roles), tuple(sizes[units[role]] for role in roles)  # type: ignore[return-value]


def save(path: Path, t: np.ndarray, x: np.ndarray, force: np.ndarray) -> None:
    """Every second sample, with noise that the file's name draws; time begins where the recording does."""
    noise = np.random.default_rng(zlib.crc32(path.name.encode())).normal(0.0, NOISE_N, len(t))
    rows = np.column_stack([t - t[0], x, force + noise])[::2]
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, rows, "%.4f", ",", header=HEAD, comments="")

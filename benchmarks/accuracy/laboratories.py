"""Does the whole way hold? ``python -m benchmarks.accuracy.laboratories --seed S --count 40 --rows FILE``

Each laboratory draws people, a batch of resin and one undeclared effect of rig, sensor or material (none in a third),
and types README's routes two and three: import, fit, tissues add, suggest, mold, puck, suggest, campaign, compare,
on-person, loop, suggest --calibration, replay of the next pad. Each command is a process of its own in an empty folder
with an empty home and reads what the one before wrote; what ``next`` names is typed where it names it.

Nothing here imports the package. People, pucks and pads are pressed by :mod:`benchmarks.accuracy.laboratory_press`,
forces of pads are by finite elements of :mod:`benchmarks.accuracy.laboratory_pad`, relaxation by steps of a generalised
Maxwell model with one to four arms of its own times, pucks by the slab method of rubbing plates. Still shared:
quasi-linear superposition, the cubic five-element law for half of the people, the form of the modulus over the ratio
and its intervals (those of the resin's file), the outline of a crown, the limits of the verdict (docs/design.md). The
punch is round: square ones on crowns are not tried.
"""

from __future__ import annotations

import argparse
import glob
import json
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy.laboratory_draws import OF_MATERIAL, draw
from benchmarks.accuracy.laboratory_figures import summary
from benchmarks.accuracy.laboratory_pad import Curve, press
from benchmarks.accuracy.laboratory_press import (
    DEEPEST,
    FORCES_N,
    SPEEDS_MM_S,
    ZERO_MM,
    Pad,
    depth_for,
    motion,
    readings,
    record,
    usable_truth,
)
from benchmarks.rows import keep_row, read_rows, scratch

ROOT = Path(__file__).resolve().parents[2]
PUNCH_MM, CONTACT_MM, POURS = 16.0, 0.004, 0.02
"""Standard deviations of a press's contact, and of the modulus between pours of one batch."""
NEAR_FOOT_MM = np.array([-0.1, -0.05, 0.0, 0.05, 0.1, 0.2])
"""Depths beyond the height of a crown at which its force is solved too."""
RED = ("no_acceptable_pad", "not_representative")
"""Codes of answers that are a verdict, not a fault."""


class Stop(Exception):
    """The way ends here; its text is the row's ``stopped``."""


class Lab:
    """One laboratory: what it drew, its folder, and the row that it fills."""

    def __init__(self, seed: int, number: int, folder: Path) -> None:
        self.rng = rng = np.random.default_rng([seed, number, 59])
        self.folder = folder
        self.row: dict[str, Any] = {"seed": seed, "number": number}
        drawn = draw(seed, number, rng)
        self.people, self.batch, self.put = drawn.people, drawn.batch, drawn.put
        self.row |= {"site": drawn.site, "people": len(self.people), "own_law": self.people[0].power is not None}
        self.row |= {"young_ref_kPa": self.batch.young_ref, "arms": self.batch.arms, "yeoh": self.batch.yeoh}
        self.row |= {"put": self.put, "commands": [], "broken": []}
        self.curves: dict[tuple, Curve] = {}
        self.pour = 1.0, 1.0

    def type(self, line: str, may_fail: bool = False) -> dict[str, Any]:
        """Run a command as it is typed; its JSON. What ends in an error or a traceback is kept in the row."""
        words = [
            path for word in shlex.split(line) for path in (sorted(glob.glob(word, root_dir=self.folder)) or [word])
        ]
        words = words[words[0] == "dummydesign" :]
        environment = {**os.environ, "HOME": f"{self.folder}/home", "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
        environment |= {"DUMMYDESIGN_HOME": str(self.folder / "own"), "OPENBLAS_NUM_THREADS": "1"}
        (self.folder / "home").mkdir(exist_ok=True)
        begun = time.monotonic()
        whole = [sys.executable, "-m", "dummydesign", *words, "--json"]
        done = subprocess.run(whole, cwd=self.folder, env=environment, capture_output=True, text=True)
        self.row["commands"].append([line, done.returncode, round(time.monotonic() - begun, 1)])
        try:
            told = json.loads(done.stdout)
        except ValueError:
            told = {"error": (done.stderr.strip() or done.stdout.strip()).splitlines()[-1:] or "no answer"}
        red = isinstance(told.get("error"), dict) and told["error"].get("code") in RED and "verdict" in told
        if "Traceback" in done.stderr or ("error" in told and not red):
            self.row["broken"].append([line, str(told.get("error"))[:600], done.stderr[-600:]])
            if not may_fail:
                raise Stop(f"error of {words[0]} {words[1] if len(words) > 1 else ''}")
        return told  # type: ignore[no-any-return]

    def named(self, told: dict[str, Any], begin: str, otherwise: str) -> str:
        """The command that an answer's ``next`` names, or README's; whether it did goes to the row."""
        every = [one.get("command") if isinstance(one, dict) else one for one in told.get("next") or []]
        found = [str(one) for one in every if one and str(one).startswith(f"dummydesign {begin}")]
        self.row.setdefault("not_named", [])
        if not found:
            self.row["not_named"].append(begin)
        return found[0] if found else otherwise

    def press_people(self) -> None:
        """Every subject at every force and speed, in files of a machine."""
        for who, person in enumerate(self.people):
            for speed in SPEEDS_MM_S:
                for force in FORCES_N:
                    t, x = motion(speed, depth_for(person, force, speed, 40.0))
                    name = f"exports/p{who + 1}_v{speed:03.0f}_f{force:02.0f}.csv"
                    record(self.folder / name, t, x, person.force(t, x), self.rng, machine=True)

    def press_puck(self, line: str) -> float:
        """The presses that a line of add-compression reads; the true modulus of the puck. [kPa]"""
        rng, words = self.rng, shlex.split(line)
        ratio, size, height = (float(words[words.index(f"--{name}") + 1]) for name in ("ratio", "diameter", "height"))
        poured = self.batch.poured(ratio, rng)
        young = self.batch.young_MPa(poured) * np.exp(rng.normal(0.0, POURS))
        friction = float(np.exp(rng.normal(np.log(0.05), 0.5)))
        for path in (word for word in words if word.endswith(".csv")):
            speed = float(re.findall(r"v(\d+)", path)[0])
            squeeze = np.linspace(0.0, 0.4, 400)
            stretch = 1.0 - squeeze
            first = stretch**2 + 2.0 / stretch - 3.0
            stress = (stretch**-2 - stretch) / 3.0 * (1.0 + 2.0 * self.batch.yeoh * first)
            # the slab method: full slip, pressure grows towards the middle
            rub = friction * size / np.sqrt(stretch) / (height * stretch)
            area = np.pi * size**2 / 4.0 * stress * 2.0 * (np.expm1(rub) - rub) / rub**2
            puck = Pad(Curve(height * squeeze, area), height, young, self.batch.arms_at(poured), self.of_material())
            t, x = motion(speed, 0.3 * height)
            record(self.folder / path, t, x, puck.force(t, x), rng)
        return 1e3 * float(young)

    def cast(self, told: dict[str, Any], wrong_mm: float, same: bool = False) -> Pad:
        """The pad of an answer as it comes out of its mould; poured and cured as the one before if it is the same."""
        chosen = told["recommendation"]
        sizes = re.findall(r"=([\d.]+)", chosen["shape"])
        if not chosen["shape"].startswith(("slab", "crowned")):
            raise Stop(f"shape {chosen['shape']}")
        crown = (float(sizes[0]), float(sizes[1]), float(sizes[2])) if sizes else None
        thickness = chosen["thickness_mm"] + wrong_mm
        key = thickness, crown
        if key not in self.curves:
            depth = thickness * DEEPEST * np.linspace(0.0, 1.0, 46)[1:] ** 1.15
            if crown:
                # where the foot is met the force bends sharply
                depth = np.unique(np.concatenate([depth, crown[1] + NEAR_FOOT_MM]))
            self.curves[key] = press(thickness, PUNCH_MM / 2.0, crown, depth, self.batch.yeoh)
        if not same:
            weighed = self.batch.poured(chosen["ratio"], self.rng) / chosen["ratio"]
            self.pour = weighed, float(np.exp(self.rng.normal(0.0, POURS)))
        poured = self.pour[0] * chosen["ratio"]
        young = self.batch.young_MPa(poured) * self.pour[1]
        return Pad(
            self.curves[key], thickness, young, self.batch.arms_at(poured), self.of_material("strain_stiffening")
        )

    def of_material(self, *more: str) -> dict[str, float]:
        """What is undeclared of the resin: every puck and pad of it has this; of a pad ``more``."""
        return {name: one for name, one in self.put.items() if name in OF_MATERIAL or name in more}

    def press_campaign(self, name: str, pad: Pad, gauged_mm: float) -> float:
        """Press the plan of a campaign; what the effect changes in the presses, rms. [N]"""
        plan, rng, changed = self.folder / name / "campaign.toml", self.rng, []
        text = re.sub(r"(?m)^thickness_mm = .*", f"thickness_mm = {gauged_mm:.2f}", plan.read_text(encoding="utf-8"))
        head, *trials = text.split("[[trial]]")
        kept, known = [], Pad(pad.curve, pad.thickness_mm, pad.young_MPa, pad.arms)
        depths: dict[tuple, float] = {}
        rig = Pad(pad.curve, pad.thickness_mm, pad.young_MPa, pad.arms, {**self.put})
        days: dict[float, float] = {}
        for before, trial in enumerate(trials):
            ask = dict(re.findall(r"(?m)^(\w+) = \"?([^\"\n]+)", trial))
            force, speed, age = (float(ask[key]) for key in ("target_force_N", "velocity_mm_s", "age_days"))
            key = force, speed
            if key not in depths:
                depths[key] = depth_for(known, force, speed, min(DEEPEST * pad.thickness_mm, pad.curve.depth_mm[-1]))
            if not np.isfinite(depths[key]):
                continue
            warm = days.setdefault(age, 23.0 + (rng.uniform(-4.0, 4.0) if "temperature" in self.put else 0.0))
            t, x = motion(speed, depths[key], float(ask["hold_s"]), ask.get("unload", "") == "true")
            state = {"warm_C": warm, "age_days": age if "ageing" in self.put else 7.0, "before": float(before)}
            seen = x + rng.normal(0.0, CONTACT_MM)
            read, plain = rig.force(t, seen, state), known.force(t, seen)
            changed.append(np.mean((read - plain)[:660] ** 2))
            record(plan.parent / ask["file"], t, x, read, rng)
            kept.append(re.sub(r"# temperature_C =.*", f"temperature_C = {warm:.1f}", trial))
        self.row.setdefault("lost_presses", []).append(len(trials) - len(kept))
        plan.write_text("[[trial]]".join([head, *kept]), encoding="utf-8")
        return float(np.sqrt(np.mean(changed))) if changed else 0.0

    def walk(self) -> None:
        """The whole way; the row grows with every answer."""
        row, rng, own = self.row, self.rng, f"--tissue my-site --punch round:{PUNCH_MM:g}"
        mould = " --no-cad"
        self.press_people()
        told = self.type("import exports --out traces", may_fail=True)
        if (told.get("error") or {}).get("quantity") == "contact":
            # fast presses do not show it; the operator knows where the slow ones touched
            row["asked"] = row["broken"].pop()[1][:200]
            told = self.type(f"import exports --out traces --contact {ZERO_MM:g}")
        elif "error" in told:
            raise Stop("error of import")
        for who in range(len(self.people)):
            fitted = self.type(f"fit traces/p{who + 1}_*.csv --elements 5 --out p{who + 1}.toml")
            row.setdefault("fit_warnings", []).append([one["code"] for one in fitted.get("warnings", [])])
        self.type("tissues add my-site " + " ".join(f"p{who + 1}.toml" for who in range(len(self.people))))
        told = self.type(f"suggest {own}{mould}")
        row["light_as_poured"] = told["verdict"]["level"]
        ratio = told["recommendation"]["ratio"]
        if told["verdict"]["level"] == "not_representative":
            raise Stop("red before the puck")
        line = self.named(told, "mold --puck", f"mold --puck 50x30 --ratio {ratio}")
        if row["number"] % 4 == 0:
            self.type(line)
        line = "resins add-compression puck50x30-v10.csv puck50x30-v50.csv --diameter 50 --height 30 --friction "
        line += f"lubricated --ratio {ratio} --name my-batch --resin polyurethane-nagoya"
        line = self.named(told, "resins add-compression", line)
        true = self.press_puck(line)
        puck = self.type(line)
        row["puck"] = {"true_kPa": true, **_first_interval(puck), "warnings": [w["code"] for w in puck["warnings"]]}
        told = self.type(self.named(told, "suggest", f"suggest {own} --resin my-batch") + mould)
        chosen, level = told["recommendation"], told["verdict"]["level"]
        row["light_after_puck"], row["shape"] = level, f"{chosen['thickness_mm']} mm {chosen['shape']}"
        row["after_puck_said"] = told["verdict"]["castings"]
        row["next_after_puck"] = [one.get("command") for one in told.get("next") or []]
        wrong = float(rng.uniform(-0.1, 0.1))
        pad = self.cast(told, wrong)
        row["truth"] = usable_truth(pad, self.people)
        row["design_error"] = _errors(chosen["conditions"], readings(pad, DEEPEST * pad.thickness_mm))
        row["pad_kPa"] = 1e3 * pad.young_MPa
        row["curve_reached"] = float(pad.curve.depth_mm[-1] / pad.thickness_mm)
        if level == "not_representative":
            raise Stop("red after the puck")
        plan = f"campaign new my-dummy --resin my-batch --ratio {chosen['ratio']} --pads {chosen['thickness_mm']} "
        plan += f"--shape {chosen['shape']} --punch round:{PUNCH_MM:g}"
        self.type(self.named(told, "campaign new", plan))
        name = (sorted(self.folder.glob("*/campaign.toml"), key=lambda path: path.stat().st_mtime)[-1]).parent.name
        gauge = pad.thickness_mm - self.put.get("thickness_error", 0.0)
        row["change_N"] = self.press_campaign(name, pad, gauge)
        checked = self.type(f"campaign check {name}", may_fail=True)
        row["check"] = [str(one)[:120] for one in checked.get("problems", checked.get("findings", []))][:4]
        compared = self.type(f"compare {name}/*.csv {own}", may_fail=True)
        row["compare"] = compared.get("verdict", {}).get("level")
        one = sorted(path.name for path in (self.folder / name).glob("*v010_f10_1.csv"))
        if one:
            self.type(f"on-person {name}/{one[0]} {own} --drive steady", may_fail=True)
        loop = self.type(f"loop {name}")
        row["loop"] = self.of_loop(loop, pad)
        # the mould that was made is kept
        line = f"suggest {own} --resin my-batch --calibration loop-{name}/calibration.json --shape {chosen['shape']} "
        line += f"--thickness {chosen['thickness_mm']}:{chosen['thickness_mm']}"
        told = self.type(line + mould)
        row["light_calibrated"], chosen = told["verdict"]["level"], told["recommendation"]
        row["calibration_warnings"] = [one["code"] for one in told["warnings"]]
        self.next_pad(told, chosen, name, wrong)

    def next_pad(self, told: dict[str, Any], chosen: dict[str, Any], name: str, wrong: float) -> None:
        """Cast and press the pad of the calibrated answer: both predictions of it, and ``replay``.

        ``alike`` is the pad weighed and cured as the first one: two pours of one batch differ by more than the loop
        corrects.
        """
        row = self.row
        alike = self.cast(told, wrong, same=True)
        alike_reads = readings(alike, DEEPEST * alike.thickness_mm)
        pad = self.cast(told, wrong)
        row["next_pad_kPa"], row["next_truth"] = 1e3 * pad.young_MPa, usable_truth(pad, self.people)
        true = readings(pad, DEEPEST * pad.thickness_mm)
        row["next_error"] = _errors(chosen["conditions"], true)
        row["alike_error"] = _errors(chosen["conditions"], alike_reads)
        line = f"predict --resin my-batch --ratio {chosen['ratio']} --thickness {chosen['thickness_mm']} --punch "
        line += f"round:{PUNCH_MM:g} --force 5,10,15 --velocity 10,250 --shape {chosen['shape']}"
        before = self.type(line, may_fail=True)
        if before.get("presses"):
            row["next_error_before"] = _errors(before["presses"], true)
            row["alike_error_before"] = _errors(before["presses"], alike_reads)
        plan = f"campaign new my-next --resin my-batch --ratio {chosen['ratio']} --pads {chosen['thickness_mm']} "
        self.type(plan + f"--shape {chosen['shape']} --punch round:{PUNCH_MM:g} --seed 2 --repeats 1 --no-power")
        self.press_campaign("my-next", pad, pad.thickness_mm - self.put.get("thickness_error", 0.0))
        line = f"replay my-next --calibration loop-{name}/calibration.json --tissue my-site"
        replay = self.type(line, may_fail=True)
        names = ("rmse_N", "base_rmse_N", "noise_floor_N", "holds")
        row["replay"] = {key: replay.get(key) for key in names}

    def of_loop(self, loop: dict[str, Any], pad: Pad) -> dict[str, Any]:
        """Verdict, names, errors and whether the truths lie in their intervals."""
        young, true = loop["after"]["parameters"]["young_kPa"], 1e3 * pad.young_MPa
        out = {
            "verdict": loop["verdict"],
            "names": [one["name"] for one in loop["effects"]],
        }
        out["learned"] = loop["learned"] is not None
        out["because"] = loop["residual"]["unexplained_because"]
        out["young"] = [young["value"], young["low"], young["high"], true]
        out["inside"] = bool(young["low"] <= true <= young["high"])
        out["ranking"] = [one.get("name") or one.get("names") for one in loop["ranking"][:3]]
        out["confounded"] = [one.get("confounded_with") for one in loop["effects"]]
        out["base_N"], out["after_N"] = (loop[key]["error"]["heldout_rmse_N"] for key in ("base", "after"))
        out["floor_N"] = loop["after"]["error"]["noise_floor_N"]
        out["held"] = (loop["as_designed"] or {}).get("held")
        out["designed_N"] = (loop["as_designed"] or {}).get("rmse_N")
        out["warnings"] = [one["code"] for one in loop["warnings"]]
        out["doubts"] = [one.get("kind") for one in loop["doubts"]]
        for one in loop["effects"]:
            if one["name"] in self.put:
                out["size"] = next(iter(one["parameters"].values()))
        return out


def _errors(said: list[dict[str, Any]], true: dict[str, NDArray]) -> float | None:
    """Largest relative error of the peaks of the six presses."""
    found = []
    for one in said:
        if one.get("peak_force_N") is None:
            continue
        at = SPEEDS_MM_S.index(one["velocity_mm_s"]) * 3 + FORCES_N.index(one["steady_force_N"])
        found.append(abs(one["peak_force_N"] / true["peak"][at] - 1.0))
        found.append(abs((one["depth_mm"] / true["depth"][at]) - 1.0))
    return float(np.nanmax(found)) if found and np.isfinite(found).any() else None


def _first_interval(puck: dict[str, Any]) -> dict[str, Any]:
    """Modulus of a puck with its interval, wherever the answer has it."""
    for place in (puck, *(one for one in puck.values() if isinstance(one, dict))):
        if isinstance(place.get("young_kPa"), dict):
            return {key: place["young_kPa"].get(key) for key in ("value", "low", "high")}
    return {}


def run(seed: int, number: int, folder: Path) -> dict[str, Any]:
    """One laboratory; its row says where it stopped, if it did."""
    lab = Lab(seed, number, folder)
    begun = time.monotonic()
    try:
        lab.walk()
    except Stop as stop:
        lab.row["stopped"] = str(stop)
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, StopIteration) as fault:
        # a fault of this study: the others go on
        lab.row["stopped"] = f"study: {fault!r}"
    lab.row["minutes"] = round((time.monotonic() - begun) / 60.0, 2)
    return lab.row


def main() -> None:
    """Run what is missing and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=590)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--rows", type=Path, required=True)
    parser.add_argument("--keep", type=Path, help="keep the laboratories' folders here")
    options = parser.parse_args()
    known = {(row["seed"], row["number"]) for row in read_rows(options.rows)}
    for number in range(options.count):
        if (options.seed, number) in known:
            continue
        if options.keep:
            (folder := options.keep / f"lab{number}").mkdir(parents=True)
            keep_row(options.rows, run(options.seed, number, folder))
            continue
        with scratch("lab-") as folder:
            keep_row(options.rows, run(options.seed, number, folder))
    print(summary([row for row in read_rows(options.rows) if row["seed"] == options.seed]))


if __name__ == "__main__":
    main()

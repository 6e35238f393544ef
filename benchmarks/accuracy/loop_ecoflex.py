"""The loop on real compression curves: ``python -m benchmarks.accuracy.loop_ecoflex DATA_DIR``.

DATA_DIR is the set "Hyperelastic Characterisation of Silicone Tissue Phantoms" (Dawood et al. 2026, CC BY 4.0), with
raw/NAME_A1.csv and NAME_B1.csv of 19 mixtures: pucks of 50 x 30 mm between plates whose friction is not stated. Each
mixture becomes a campaign of two specimens with the frictionless puck as base model. Specimens are left out in turn;
depths are left out by calibrating to 12 and to 9 mm and predicting to 15 mm.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np

from benchmarks.rows import scratch
from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.result import result_dict
from dummydesign.loop.run import close_loop, replay
from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.campaign_file import read_campaign
from studies.marked_page import wrapped

ROOT = Path(__file__).resolve().parents[2]

HEAD = """schema = 1
name = "{name}"
[pad]
young_kPa_nominal = 40.0
shape = "cylinder"
diameter_mm = 50.0
[punch]
shape = "plate"
contact = "frictionless"
"""
TRIAL = """[[trial]]
file = "{file}"
thickness_mm = 30.0
velocity_mm_s = 0.1667
repeat = {repeat}
"""
DEEP_MM, SHALLOW_MM = 15.0, (12.0, 9.0)
PAGE, TABLE = ROOT / "docs" / "loop-ecoflex.md", ROOT / "docs" / "data" / "loop-ecoflex.csv"


def heads(depth_mm: float) -> tuple[str, str, str]:
    """Columns of the calibration to a depth: what it found, error to 15 mm of its base and with what it found."""
    base, after = (f"to_{DEEP_MM:g}mm{model}_from_{depth_mm:g}mm_N" for model in ("_base", ""))
    return f"found_to_{depth_mm:g}mm", base, after


HEADS = [
    "mixture",
    "largest_N",
    "young_base_kPa",
    "young_after_kPa",
    "verdict",
    "found",
    "rivals",
    "evidence_alone",
    "left_out_base_N",
    "left_out_after_N",
    *(name for depth in SHALLOW_MM for name in heads(depth)),
]


def read_raw(path: Path) -> np.ndarray:
    """Time [s], compression [mm], load [N] of a raw file, whatever stands above the numbers."""
    rows = []
    for line in path.read_text(errors="replace").splitlines():
        cells = [cell for cell in line.replace(";", ",").replace("\t", ",").split(",") if cell.strip()]
        try:
            numbers = [float(cell) for cell in cells[:3]]
        except ValueError:
            continue
        if len(numbers) == 3:
            rows.append(numbers)
    return np.array(rows)


def campaign_to(folder: Path, name: str, curves: dict[str, np.ndarray], depth_mm: float) -> Campaign:
    """Write the campaign of one mixture, curves cut at a depth, and read it."""
    folder.mkdir(parents=True, exist_ok=True)
    text = HEAD.format(name=name)
    for repeat, (file, rows) in enumerate(curves.items(), 1):
        rows = rows[rows[:, 1] <= depth_mm]
        rows = rows[np.r_[True, np.diff(rows[:, 0]) > 0]]
        lines = "\n".join(f"{t:.3f},{x:.5f},{f:.5f}" for t, x, f in rows)
        (folder / file).write_text("time_s,displacement_mm,force_N\n" + lines + "\n")
        text += TRIAL.format(file=file, repeat=repeat)
    (folder / "campaign.toml").write_text(text)
    return read_campaign(folder)


def run_mixture(name: str, curves: dict[str, np.ndarray], folder: Path) -> list[str]:
    """One row of the table."""
    deep = campaign_to(folder / "deep", name, curves, DEEP_MM)
    result = close_loop(deep)
    data = result_dict(result)
    shallow = []
    for depth in SHALLOW_MM:
        calibration = calibration_of(close_loop(campaign_to(folder / f"to-{depth:g}", name, curves, depth)))
        predicted = replay(deep, calibration)
        effects = ", ".join(one.effect.name for one in calibration.after.active)
        shallow += [effects, f"{predicted.total_base_rmse_N:.2f}", f"{predicted.total_rmse_N:.2f}"]
    parts = []
    for effect in data["effects"]:
        p = next(iter(effect["parameters"].values()))
        parts.append(f"{effect['name']} {p['value']:.3g} ({p['low']:.3g} to {p['high']:.3g})")
    if result.learnt is not None:
        parts.append(result.learnt.effect.name)
    rivals = ", ".join(name for effect in data["effects"] for name in effect["confounded_with"])
    modulus = [1e3 * model.fit.base.young_MPa for model in (result.base, result.after)]
    held = [model.errors.heldout_N or float("nan") for model in (result.base, result.after)]
    top = max(trial.trace.force_N.max() for trial in deep.trials)
    alone = ", ".join(f"{row['name']} {row['evidence']:.0f}" for row in data["ranking"][:3])
    return [
        name,
        f"{top:.0f}",
        *(f"{one:.1f}" for one in modulus),
        result.verdict,
        "; ".join(parts),
        rivals,
        alone,
        *(f"{one:.2f}" for one in held),
        *shallow,
    ]


def page(table: list[dict[str, str]]) -> str:
    """Summary of the table, as the page of the documentation."""
    rubbing = [row for row in table if "plate_friction" in row["found"]]
    sizes = [float(row["found"].split()[1]) for row in rubbing]
    share = [float(row["left_out_after_N"]) / float(row["left_out_base_N"]) for row in rubbing]
    rest = [row for row in table if row not in rubbing and "strain_stiffening" not in row["found"]]
    learned, other = ([row["mixture"] for row in rest if bool(row["found"]) is some] for some in (True, False))
    stiffer = [row for row in table if row not in rubbing and "strain_stiffening" in row["found"]]
    unexplained = sum(row["verdict"] == "unexplained" for row in table)
    evidence = [dict(one.rsplit(" ", 1) for one in row["evidence_alone"].split(", ")) for row in rubbing]
    alike = sum(
        any(
            float(value) > 0.9 * float(one.get("plate_friction", "0"))
            for name, value in one.items()
            if name != "plate_friction"
        )
        for one in evidence
    )
    lines = [
        "# The loop on real curves: silicone pucks between plates",
        "",
        "Data: Dawood, Zhang, Osman, Suulker, Abdulali, Angelmahr, Althoefer (2026), Hyperelastic Characterisation",
        "of Silicone Tissue Phantoms, CC BY 4.0. Two specimens of each mixture, 50 x 30 mm, 10 mm/min, no hold,",
        f"friction of the plates not stated. Base: frictionless neo-Hookean puck. Errors are N rms to {DEEP_MM:g} mm.",
        "Other public measurements: [real presses](real-data.md).",
        "",
        f"- The loop finds plate friction in {len(rubbing)} of {len(table)} mixtures, {min(sizes):.2f} to "
        f"{max(sizes):.2f}.",
        f"- With it the error on the left-out specimen is {min(share):.2f} to {max(share):.2f} of the base's "
        f"(median {float(np.median(share)):.2f}).",
        f"- In {len(stiffer)} others it finds `strain_stiffening` instead.",
        f"- In {len(learned)} it learns a function only; in {len(other)} it finds nothing.",
        f"- `unexplained`: {unexplained} of {len(table)}.",
        "- Stiffening, a curve of the load cell or a thickness error have over 0.9 of the friction's evidence in",
        f"  {alike} of them.",
        "",
        "**Press to half the height.** Curves cut at less depth do not separate friction from modulus:",
        "",
        "| calibrated to | friction found | another effect found | error to 15 mm larger with it |",
        "|---|---|---|---|",
    ]
    for depth in SHALLOW_MM:
        name, base, after = heads(depth)
        own = [row for row in table if row[name]]
        friction = sum("plate_friction" in row[name] for row in own)
        worse = sum(float(row[after]) > float(row[base]) for row in own)
        lines.append(f"| {depth:g} mm | {friction} | {len(own) - friction} | {worse} |")
    lines += ["", "| mixture | largest N | E base, after kPa | found (95 %) | left out: base, after |"]
    lines.append("|---|---|---|---|---|")
    for row in table:
        if row["mixture"].endswith("_0T"):
            modulus, left = (
                f"{row[f'{name}_base_{unit}']}, {row[f'{name}_after_{unit}']}"
                for name, unit in (("young", "kPa"), ("left_out", "N"))
            )
            lines.append(f"| {row['mixture']} | {row['largest_N']} | {modulus} | {row['found'] or '-'} | {left} |")
    made = "`python -m benchmarks.accuracy.loop_ecoflex DATA_DIR`"
    lines += ["", f"`docs/data/{TABLE.name}` has all mixtures. Made by {made}."]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run all mixtures, and write the table and the page."""
    parser = argparse.ArgumentParser(description="The loop on real compression curves of silicone pucks.")
    parser.add_argument("data", type=Path, nargs="?", help="without it: write the page from the table")
    options = parser.parse_args()
    if options.data is not None:
        names = sorted({path.name[:-7] for path in (options.data / "raw").glob("*_A1.csv")})
        rows = []
        with scratch("ecoflex-") as folder:
            for name in names:
                curves = {f"{name}_{s}.csv": read_raw(options.data / "raw" / f"{name}_{s}.csv") for s in ("A1", "B1")}
                rows.append(run_mixture(name, curves, folder / name))
                print(", ".join(rows[-1]), flush=True)
        with TABLE.open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream, lineterminator="\n").writerows([HEADS, *rows])
    with TABLE.open(encoding="utf-8", newline="") as stream:
        PAGE.write_text(wrapped(page(list(csv.DictReader(stream)))), encoding="utf-8")


if __name__ == "__main__":
    main()

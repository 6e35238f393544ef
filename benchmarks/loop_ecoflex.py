"""The loop on real compression curves: ``python benchmarks/loop_ecoflex.py DATA_DIR``.

DATA_DIR is the set "Hyperelastic Characterisation of Silicone Tissue Phantoms" (Dawood et al. 2026, CC BY 4.0), with
raw/NAME_A1.csv and NAME_B1.csv of 19 mixtures: pucks of 50 x 30 mm between plates whose friction is not stated. Each
mixture becomes a campaign of two specimens with the frictionless puck as base model. Specimens are left out in turn;
depths are left out by calibrating to 12 and to 9 mm and predicting to 15 mm.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path

import numpy as np

from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.result import result_dict
from dummydesign.loop.run import close_loop, replay
from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.campaign_file import read_campaign

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


def run_mixture(name: str, curves: dict[str, np.ndarray], folder: Path) -> str:
    """One row of the table."""
    deep = campaign_to(folder / "deep", name, curves, DEEP_MM)
    result = close_loop(deep)
    data = result_dict(result)
    shallow = []
    for depth in SHALLOW_MM:
        calibration = calibration_of(close_loop(campaign_to(folder / f"to-{depth:g}", name, curves, depth)))
        predicted = replay(deep, calibration)
        found = ", ".join(one.effect.name for one in calibration.after.active) or "-"
        shallow.append(f"{found} | {predicted.total_base_rmse_N:.2f} | {predicted.total_rmse_N:.2f}")
    parts = []
    for effect in data["effects"]:
        p = next(iter(effect["parameters"].values()))
        parts.append(f"{effect['name']} {p['value']:.3g} ({p['low']:.3g} to {p['high']:.3g})")
    rivals = ", ".join(name for effect in data["effects"] for name in effect["confounded_with"])
    modulus = [1e3 * stage.fit.base.young_MPa for stage in (result.base, result.after)]
    held = [stage.errors.heldout_N or float("nan") for stage in (result.base, result.after)]
    top = max(trial.trace.force_N.max() for trial in deep.trials)
    alone = ", ".join(f"{row['name']} {row['evidence']:.0f}" for row in data["ranking"][:3])
    return (
        f"| {name} | {top:.0f} | {modulus[0]:.1f} | {modulus[1]:.1f} | {result.verdict} | {'; '.join(parts) or '-'} | "
        f"{rivals or '-'} | {alone} | {held[0]:.2f} | {held[1]:.2f} | "
        f"{' | '.join(shallow)} |"
    )


def main() -> None:
    """Run all mixtures and write the table."""
    parser = argparse.ArgumentParser(description="The loop on real compression curves of silicone pucks.")
    parser.add_argument("data", type=Path)
    parser.add_argument("--out", type=Path, default=Path(__file__).resolve().parent.parent / "docs" / "loop-ecoflex.md")
    options = parser.parse_args()
    names = sorted({path.name[:-7] for path in (options.data / "raw").glob("*_A1.csv")})
    lines = [
        "# The loop on real curves: silicone pucks between plates", "",
        "Data: Dawood, Zhang, Osman, Suulker, Abdulali, Angelmahr, Althoefer (2026), Hyperelastic Characterisation",
        "of Silicone Tissue Phantoms, CC BY 4.0; two specimens of each mixture, 50 x 30 mm, 10 mm/min, no hold,",
        "friction of the plates not stated. Base: frictionless neo-Hookean puck. Errors are N rms: each specimen",
        f"predicted from the other (to {DEEP_MM:g} mm), and to {DEEP_MM:g} mm with a calibration to 12 and to 9 mm.",
        "Made by `python benchmarks/loop_ecoflex.py DATA_DIR`.", "",
        "| mixture | largest N | E base kPa | E after kPa | verdict | found (95 %) | rivals | evidence of each alone | "
        "specimen left out: base | after | found to 12 mm | to 15 mm: base | after | found to 9 mm | to 15 mm: base | "
        "after |",
        "|" + "---|" * 16,
    ]  # fmt: skip
    folder = Path(tempfile.mkdtemp(prefix="ecoflex-"))
    try:
        for name in names:
            curves = {f"{name}_{s}.csv": read_raw(options.data / "raw" / f"{name}_{s}.csv") for s in ("A1", "B1")}
            lines.append(run_mixture(name, curves, folder / name))
            print(lines[-1], flush=True)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    options.out.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()

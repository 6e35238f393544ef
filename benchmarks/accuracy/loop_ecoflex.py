"""The loop on real compression curves: ``python -m benchmarks.accuracy.loop_ecoflex DATA_DIR``.

DATA_DIR is the set "Hyperelastic Characterisation of Silicone Tissue Phantoms" (Dawood et al. 2026, CC BY 4.0), with
raw/NAME_A1.csv and NAME_B1.csv of 19 mixtures: pucks of 50 x 30 mm between plates whose friction is not stated. Each
mixture becomes a campaign of two specimens with the frictionless puck as base model. Specimens are left out in turn.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np

from benchmarks.accuracy.loop_puck_heights import SEED, rows_file
from benchmarks.rows import read_rows, scratch, write_evidence
from dummydesign.loop.result import result_dict
from dummydesign.loop.run import close_loop
from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.campaign_file import read_campaign

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
VERDICTS = ("ambiguous", "none", "effect", "unexplained")
DEEP_MM = 15.0
TABLE = ROOT / "docs" / "data" / "loop-ecoflex.csv"


HEADS = [
    "mixture",
    "largest_N",
    "young_base_kPa",
    "young_after_kPa",
    "verdict",
    "found",
    "explanations",
    "specimens_differ_N",
    "residual_base_N",
    "residual_after_N",
    "left_out_base_N",
    "left_out_after_N",
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
    parts = []
    for effect in data["effects"]:
        p = next(iter(effect["parameters"].values()))
        parts.append(f"{effect['name']} {p['value']:.3g} ({p['low']:.3g} to {p['high']:.3g})")
    if result.learnt is not None:
        parts.append(result.learnt.effect.name)
    among = data["ambiguity"] or {"explanations": [], "repeats_differ_N": float("nan"), "base_residual_N": float("nan")}
    rivals = "; ".join(
        f"{' + '.join(effect['name'] for effect in one['effects'])} ({one['young_kPa']:.1f} kPa, "
        f"{one['residual_N']:.2f} N)"
        for one in among["explanations"]
    )
    fitted = [data[model]["error"]["train_rmse_N"] for model in ("base", "after")]
    modulus = [1e3 * model.fit.base.young_MPa for model in (result.base, result.after)]
    held = [model.errors.heldout_N or float("nan") for model in (result.base, result.after)]
    top = max(trial.trace.force_N.max() for trial in deep.trials)
    return [
        name,
        f"{top:.0f}",
        *(f"{one:.1f}" for one in modulus),
        result.verdict,
        "; ".join(parts),
        rivals,
        f"{among['repeats_differ_N']:.2f}",
        *(f"{one:.2f}" for one in fitted),
        *(f"{one:.2f}" for one in held),
    ]


def possible(row: dict[str, str], name: str) -> bool:
    """Whether an effect is among the explanations of a mixture."""
    return any(one.startswith(f"{name} ") for one in row["explanations"].split("; "))


def mixtures(table: list[dict[str, str]]) -> str:
    """Summary of the table."""
    of = {
        name: [row for row in table if row["verdict"] == name]
        for name in ("ambiguous", "none", "unexplained", "effect")
    }
    counts = ", ".join(f"`{name}` {len(rows)}" for name, rows in of.items() if rows)

    doubted = of["ambiguous"]
    friction = sum(possible(row, "plate_friction") for row in doubted)
    best = sum(row["explanations"].startswith("plate_friction ") for row in doubted)
    lines = [
        f"- Verdicts of {len(table)} mixtures: {counts}.",
        f"- Plate friction is among the explanations in {friction} of {len(doubted)} `ambiguous` ones and the best in "
        f"{best}, strain stiffening in {sum(possible(row, 'strain_stiffening') for row in doubted)}.",
    ]
    return "\n".join(lines) + "\n"


def heights(rows: list[dict]) -> str:
    """What drawn pucks of one height and of two give, by kind."""
    lines = ["| drawn | cause named or listed: one, two heights | friction decided | modulus in its interval |"]
    lines.append("|---|---|---|---|")
    causes = {"friction": {"plate_friction"}, "stiffening": {"strain_stiffening"}}
    causes |= {"both": causes["friction"] | causes["stiffening"], "none": set()}
    for kind, cause in causes.items():
        own = [row for row in rows if row["kind"] == kind]
        counts = []
        for count in ("one", "two"):
            said = [set(row["possible"][count] or row["named"][count]) for row in own]
            decided = sum(_decides(row["sets"][count], "plate_friction" in cause) for row in own)
            held = [row["young_kPa"][count] for row in own]
            inside = sum(low <= 1e3 * row["rubber"]["young_MPa"] <= high for row, (_, low, high) in zip(own, held))
            counts.append((sum(cause <= one if cause else not one for one in said), decided, inside))
        cells = (f"{one}, {two} of {len(own)}" for one, two in zip(*counts, strict=True))
        lines.append(f"| {kind} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _decides(sets: list[list[str]], rubs: bool) -> bool:
    """Whether all explanations have friction if the plates rub, and none if they do not."""
    return all(("plate_friction" in one) is rubs for one in sets) and (bool(sets) or not rubs)


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
        write_evidence("mixtures", mixtures(list(csv.DictReader(stream))))
    write_evidence("heights", heights(read_rows(rows_file(SEED))))


if __name__ == "__main__":
    main()

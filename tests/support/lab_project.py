"""A project folder as a laboratory has it half-way: a red design, moulds, pressed campaigns, calibrations."""

from __future__ import annotations

import json
from pathlib import Path

from dummydesign.api.campaigns import plan_campaign
from dummydesign.core.files import csv_text
from dummydesign.core.manifest import sha256_of
from dummydesign.measurement.campaign_file import SetUp
from dummydesign.measurement.campaign_plan import PlanSettings
from dummydesign.mold.files.solid_view import Shown, box, view_page
from dummydesign.project.folder import make_project
from dummydesign.report.plot import COLUMNS
from tests.support.pressed_plan import press_campaign

RESIN = "polyurethane-nagoya"
CROWNED = "crowned:radius=20,height=2,foot=9"


def manifest(root: Path, folder: str, command: str, inputs: dict, **more: object) -> Path:
    """Write the manifest of a folder as a command does."""
    path = root / folder
    path.mkdir(parents=True, exist_ok=True)
    told = {"command": command, "date": "2026-01-01T00:00:00+00:00", "finished": True, "inputs": inputs, **more}
    (path / "manifest.json").write_text(json.dumps(told), encoding="utf-8")
    return path


def design(root: Path, name: str, shape: str, thickness: float, verdict: str, date: str) -> None:
    """A design with its verdict."""
    inputs = {"tissue": "forefinger", "aim": "average", "punch": "square:14", "calibration": None}
    summary = {
        "shape": shape,
        "thickness_mm": thickness,
        "ratio": 15.0,
        "resin": RESIN,
        "verdict": verdict,
        "text": f"The verdict of {name}.",
    }
    manifest(root, f"designs/{name}", "suggest", inputs, summary=summary, date=date)


def mould(root: Path, name: str, thickness: float, shape: str = "slab") -> None:
    """A mould with a few of its files."""
    inputs = {
        "shape": shape,
        "thickness_mm": thickness,
        "length_mm": 150.0,
        "width_mm": 120.0,
        "preset": "open",
        "resin": RESIN,
        "ratio": 15.0,
    }
    folder = manifest(
        root,
        f"moulds/{name}",
        "mold",
        inputs,
        summary={key: inputs[key] for key in ("shape", "thickness_mm", "ratio", "resin", "preset")},
    )
    for file in (f"pour_t{thickness:g}.pdf", f"master_t{thickness:g}.step", f"drawings_t{thickness:g}.dxf"):
        (folder / file).write_text("x", encoding="utf-8")
    solid = Shown("pad", box(150.0, 120.0, thickness), (0.9, 0.7, 0.6))
    (folder / f"assembly_t{thickness:g}.html").write_text(view_page([solid], name, ""), encoding="utf-8")
    checks = [{"id": "solids_valid", "status": "pass"}, {"id": "fits", "status": "skipped", "note": "no oven"}]
    (folder / "checks.json").write_text(json.dumps(checks), encoding="utf-8")


def gauged(folder: Path, thickness: float) -> None:
    """Gauge points in the specification of a mould."""
    places = {"middle": (0.0, 0.0), "corner1": (70.0, 55.0)}
    points = [
        {
            "name": name,
            "x_mm": x,
            "y_mm": y,
            "nominal_mm": thickness,
            "low_mm": 0.97 * thickness,
            "high_mm": 1.03 * thickness,
            "gel_mm": thickness,
            "pressed": True,
        }
        for name, (x, y) in places.items()
    ]
    (folder / "spec.json").write_text(json.dumps({"gauge_points": points}), encoding="utf-8")


def plan(root: Path, name: str, pads: tuple[float, ...] = (6.0, 15.0), pressed: bool = True) -> Path:
    """A campaign of 8 presses, planned as ``campaign new`` plans it."""
    folder = root / "campaigns" / name
    presses = PlanSettings(pads, (10.0,), (3.0, 6.0), repeats=2, ages_days=(9.0, 14.0))
    plan_campaign(folder, SetUp(name, resin=RESIN, ratio=15.0), presses, power=False)
    if pressed:
        press_campaign(folder, 3, 25.0, coarse=True)
    return folder


def calibration(root: Path, name: str, campaign: str) -> None:
    """A calibration as one made on the terminal."""
    toml = root / "campaigns" / campaign / "campaign.toml"
    read = [{"name": f"campaigns/{campaign}/campaign.toml", "file": "campaign.toml", "sha256": sha256_of(toml)}]
    summary = {"campaign": campaign, "verdict": "none", "effects": [], "text": f"Learned of {campaign}."}
    folder = manifest(
        root,
        f"calibrations/{name}",
        "loop",
        {"campaign": f"campaigns/{campaign}", "trials": 8},
        summary=summary,
        files_read=read,
    )
    (folder / "calibration.json").write_text("{}", encoding="utf-8")
    (folder / "report.html").write_text("<h1>report</h1>", encoding="utf-8")
    rows = [
        ("press-6mm-10mm-s-3N", f"{kind}, a.csv", "time_s", "force_N", 0.01 * (k + 1), 0.1 * k, "", "")
        for kind in ("measured", "base", "corrected")
        for k in range(9)
    ]
    (folder / "report.csv").write_text(csv_text(COLUMNS, rows), encoding="utf-8")


def weighed(part: dict) -> dict:
    """What an answer of ``mold`` says of the weights, with one component."""
    batch = {"components": [part], "total_g": 75.0, "pour_g": 70.0, "witness": {"mass_g": 5.0, "components": [part]}}
    return {"pour": {"silicone_mass_g": None}, "batch": batch}


def job(root: Path, number: int, name: str, words: list[str], answer: dict, status: int, error: str = "") -> None:
    """A command that ended, as the studio keeps it."""
    folder = root / ".studio" / "jobs" / f"{number:04d}-{name}"
    folder.mkdir(parents=True)
    kept = {"name": name, "words": words, "cwd": str(root), "start": 1e9 + number}
    (folder / "command.json").write_text(json.dumps(kept), encoding="utf-8")
    (folder / "answer.json").write_text(json.dumps(answer) if answer else "", encoding="utf-8")
    (folder / "errors.txt").write_text(f"error: {error}\n" if error else "", encoding="utf-8")
    ended = {"status": status, "stopped": False, "start": 1e9 + number, "end": 1e9 + number + 3}
    (folder / "status.json").write_text(json.dumps(ended), encoding="utf-8")


def learned(file: str, sentence: str) -> dict:
    """An answer of ``loop``, short."""
    return {
        "answer": [sentence],
        "effects": [],
        "warnings": [],
        "calibration_file": file,
        "next_measurement": None,
        "after": {"error": {"heldout_rmse_N": 0.02, "noise_floor_N": 0.02}},
    }


def lab_project(folder: Path) -> Path:
    """Make it; return its folder."""
    root = make_project(folder, tissue="forefinger").root
    design(root, "good", CROWNED, 4.5, "usable_with_correction", "2026-01-01")
    design(root, "red", "slab", 6.0, "not_representative", "2026-02-01")
    mould(root, "mould_t6", 6.0)
    mould(root, "mould_t15", 15.0)
    plan(root, "first")
    plan(root, "second", pressed=False)
    calibration(root, "terminal-first", "first")
    return root

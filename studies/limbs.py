"""Thickness law of arms and legs over bone: ``python -m studies.limbs MULTIS_DIR``.

MULTIS_DIR has ``limb_indentation.csv``: 95 people, eight sites, a hand-held ultrasound probe (sbdoherty/UltrasoundML,
MIT; base data Erdemir and Neumann, SimTK 2018, doi 10.18735/S5R97F). The measurements are not part of this repository.
Writes ``docs/data/limbs.csv`` and the tables of ``docs/real-data.md``.

The pad model takes a limb for a glued layer on rigid bone under a flat round punch of the probe's area. Each law turns
force, depth and thickness of a press into a modulus; the right law gives the same one at every thickness.
"""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.pad.tables.slab import load_table
from studies.marked_page import MarkedPage

REPOSITORY = Path(__file__).resolve().parents[1]
ROWS = Path("docs", "data", "limbs.csv")
PAGE = MarkedPage(Path("docs", "real-data.md"), "<!-- limbs begin -->", "<!-- limbs end -->")
LIMBS = {"UA": "upper arm", "LA": "forearm", "UL": "thigh", "LL": "calf"}
FACES = {"A": "front", "P": "back"}
SITES = {f"{limb}_{face}": f"{text}, {side}" for limb, text in LIMBS.items() for face, side in FACES.items()}
LAWS = {
    "none": "no law: stiffness alone",
    "bar": "bar: E A / h",
    "half_space": "half-space: no bone",
    "sliding": "layer that slides on bone",
    "bonded": "layer glued to bone (pad model)",
}


@dataclass(frozen=True)
class Press:
    """One press of a person at a site."""

    person: str
    site: str
    thickness_mm: float
    depth_mm: float
    force_N: float
    area_mm2: float

    @property
    def ratio(self) -> float:
        """Radius of the circle of the probe's area over the thickness."""
        return math.sqrt(self.area_mm2 / math.pi) / self.thickness_mm


def read_presses(folder: Path) -> list[Press]:
    """Presses whose thickness is known."""
    with (folder / "limb_indentation.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["Thickness"] and row["TotalStrain"]]
    presses = []
    for row in rows:
        force, thickness, strain, stress = (
            float(row[name]) for name in ("MaxForce", "Thickness", "TotalStrain", "maxForce_normArea")
        )
        presses.append(Press(row["person"], row["Location"], thickness, strain * thickness, force, force / stress))
    return presses


def force_over_modulus(press: Press, law: str) -> float:
    """F / E of a press by a law [mm2]; F / d of the stiffness alone has the unit N/mm."""
    area, depth, thickness = press.area_mm2, press.depth_mm, press.thickness_mm
    radius = math.sqrt(area / math.pi)
    if law == "none":
        return depth
    if law == "bar":
        return area * depth / thickness
    if law == "half_space":  # incompressible: 2 a E d / (1 - 1/4)
        return 8.0 / 3.0 * radius * depth
    secant = load_table(law).log(depth / thickness, press.ratio)
    return radius * depth * float(np.exp(secant))


def in_table(press: Press) -> bool:
    """Whether the tables of both bases hold a press."""
    tables = load_table("bonded"), load_table("sliding")
    low, high = tables[0].ratio_range
    return low <= press.ratio <= high and all(
        press.depth_mm <= table.depth_limit(press.ratio) * press.thickness_mm for table in tables
    )


def within(values: NDArray, groups: Sequence[str]) -> NDArray:
    """Values less the mean of their group."""
    names = np.array(groups)
    return values - np.array([values[names == name].mean() for name in names])


@dataclass(frozen=True)
class LawResult:
    """What a law leaves: slopes of ln modulus over ln thickness with 95 % intervals, and spreads."""

    law: str
    presses: int
    people_slope: float
    people_low: float
    people_high: float
    sites_slope: float
    sites_low: float
    sites_high: float
    within_person: float
    within_site: float
    left_out: float
    left_out_factor: float


def judge(presses: Sequence[Press], law: str, draws: int = 1000) -> LawResult:
    """Judge a law by the moduli that it gives; intervals by drawing people anew.

    ``left_out``: rms of ln force at a site predicted from the person's other sites and the usual ratio of that site to
    the others, the person left out of that ratio; ``left_out_factor`` is exp of it.
    """
    people, sites = [one.person for one in presses], [one.site for one in presses]
    log_modulus = np.log([one.force_N / force_over_modulus(one, law) for one in presses])
    log_thickness = np.log([one.thickness_mm for one in presses])
    slopes = [slope(log_thickness, log_modulus, people, groups, draws) for groups in (people, sites)]
    error = left_out_errors(log_modulus, people, sites)
    rms = float(np.sqrt(np.mean(error**2)))
    return LawResult(
        law,
        len(presses),
        *slopes[0],
        *slopes[1],
        float(np.sqrt(np.mean(within(log_modulus, people) ** 2))),
        float(np.sqrt(np.mean(within(log_modulus, sites) ** 2))),
        rms,
        float(np.exp(rms)),
    )


def slope(
    x: NDArray, y: NDArray, people: Sequence[str], groups: Sequence[str], draws: int
) -> tuple[float, float, float]:
    """Slope of y over x within groups, and its 95 % interval."""
    x, y = within(x, groups), within(y, groups)
    rows = [np.nonzero(np.array(people) == name)[0] for name in dict.fromkeys(people)]
    sums = np.array([[x[at] @ y[at], x[at] @ x[at]] for at in rows])
    drawn = sums[np.random.default_rng(1).integers(len(sums), size=(draws, len(sums)))].sum(axis=1)
    low, high = np.quantile(drawn[:, 0] / drawn[:, 1], [0.025, 0.975]).tolist()
    return float(sums[:, 0].sum() / sums[:, 1].sum()), low, high


def left_out_errors(values: NDArray, people: Sequence[str], sites: Sequence[str]) -> NDArray:
    """Each value less its prediction: the person's mean over other sites, and the site's offset of other people."""
    names, places = np.array(people), np.array(sites)
    out = []
    for at in range(len(values)):
        others = names != names[at]
        offset = {site: values[others & (places == site)].mean() for site in set(places[others].tolist())}
        own = np.nonzero((names == names[at]) & (places != places[at]))[0]
        if len(own):
            mean = np.mean([values[one] - offset[places[one]] for one in own])
            out.append(values[at] - mean - offset[places[at]])
    return np.array(out)


def tables(presses: Sequence[Press], used: Sequence[Press], results: Sequence[LawResult]) -> str:
    """Both tables of the page."""
    lines = [f"{len(used)} of {len(presses)} presses lie in the tables (a/h from 0.25; thicker limbs do not).", ""]
    lines += [
        "| law | slope within people, over sites (95 %) | slope within sites, over people (95 %) | left-out site, "
        "factor (rms) |",
        "|---|---|---|---|",
    ]
    for one in results:
        over_sites = f"{one.people_slope:+.2f} ({one.people_low:+.2f} to {one.people_high:+.2f})"
        over_people = f"{one.sites_slope:+.2f} ({one.sites_low:+.2f} to {one.sites_high:+.2f})"
        lines.append(f"| {LAWS[one.law]} | {over_sites} | {over_people} | {one.left_out_factor:.2f} |")
    lines += ["", "| site | presses | thickness mm | modulus kPa (2.5 to 97.5 % of people) | between people |"]
    lines.append("|---|---|---|---|---|")
    for site, text in SITES.items():
        own = [one for one in used if one.site == site]
        if len(own) < 10:
            lines.append(f"| {text} | {len(own)} | - | - | - |")
            continue
        young = 1e3 * np.array([one.force_N / force_over_modulus(one, "bonded") for one in own])
        low, middle, high = np.quantile(young, [0.025, 0.5, 0.975])
        thick = np.median([one.thickness_mm for one in own])
        spread = 100 * float(np.std(np.log(young)))
        lines.append(f"| {text} | {len(own)} | {thick:.0f} | {middle:.0f} ({low:.0f} to {high:.0f}) | {spread:.0f} % |")
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> None:
    """Read, judge, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("multis", type=Path, metavar="MULTIS_DIR")
    options = parser.parse_args(arguments)
    PAGE.read(REPOSITORY)
    presses = read_presses(options.multis)
    used = [one for one in presses if in_table(one)]
    results = [judge(used, law) for law in LAWS]
    with (REPOSITORY / ROWS).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(LawResult.__dataclass_fields__)
        writer.writerows([f"{v:.4g}" if isinstance(v, float) else v for v in vars(one).values()] for one in results)
    PAGE.write(REPOSITORY, tables(presses, used, results))


if __name__ == "__main__":
    main()

"""Share of people below a reading, on 95 real people: ``python -m benchmarks.accuracy.people_share FILE.csv``.

FILE.csv has one row per person and site (columns ``person``, ``Location``, ``Total_Stiff`` in MPa/mm, ``Total_EMod`` in
MPa): limbs of 95 people indented in vivo with an ultrasound probe, Erdemir and Neumann 2018, doi 10.18735/S5R97F
(Neumann et al. 2018, Scientific Data 5:180193). The secant stiffness stands for the force at a displacement, the
modulus for the force at a strain. The people of a site are taken as the population: 5 or 15 subjects are drawn
from it independently, as often as asked, and what :mod:`dummydesign.tissue.model.people_share` states of people by
these subjects is held against all people of the site. The true share below a reading is interpolated between the
people in ln reading. A log-normal population is drawn beside them: there the statements must hold by construction.

Statements, each of which should hold in 95 % of the draws: the lower end of the 90 % interval of the share is at most
the true share, the upper end at least it (at the reading below which 50, 80 and 95 % of people are, and at the mean of
the draw plus 1.5 of its standard deviations, where a pad above all subjects is); the bound that is stated to be above
95 % of people with 95 % confidence is.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.files import csv_text, write_text
from dummydesign.tissue.model.people_share import CONFIDENCE, Population

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "docs" / "data" / "people-share.csv"
READINGS = {"Total_Stiff": "stiffness", "Total_EMod": "modulus"}
SUBJECTS, SHARE = (5, 15), 0.95
AT = (0.5, 0.8, 0.95)
ABOVE_ALL = 1.5
LOG_NORMAL, LOG_SPREAD = 20_000, 0.3
HEAD = (
    "site",
    "reading",
    "people",
    "skewness",
    "normal_p",
    "subjects",
    "draws",
    "lower_holds_percent",
    "upper_holds_percent",
    "bound_holds_percent",
    "share_below_bound_5th",
    "mean_stated_share",
    "mean_true_share",
)


@dataclass(frozen=True)
class Site:
    """The sorted readings of all people at one site; ``name`` is ``log-normal`` for the population that is one."""

    name: str
    reading: str
    values: NDArray

    @property
    def logs(self) -> NDArray:
        """Natural logarithms of the readings."""
        return np.log(self.values)

    def share_below(self, log_reading: NDArray) -> NDArray:
        """True share of people below readings: half a person at the outermost, even between neighbours."""
        places = (np.arange(len(self.values)) + 0.5) / len(self.values)
        return np.interp(log_reading, self.logs, places, left=0.0, right=1.0)

    def reading_at(self, share: float) -> float:
        """Logarithm of the reading below which a share of people is."""
        return float(np.quantile(self.logs, share, method="hazen"))


def read_sites(path: Path) -> list[Site]:
    """Read all sites, both readings; people without a reading are left out."""
    with open(path, encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    sites = []
    for name in sorted({row["Location"] for row in rows}):
        for column, reading in READINGS.items():
            values = [float(row[column]) for row in rows if row["Location"] == name and row[column]]
            sites.append(Site(name, reading, np.sort([one for one in values if np.isfinite(one) and one > 0.0])))
    return sites


def log_normal() -> Site:
    """A population that is log-normal, by its even quantiles."""
    from scipy.special import ndtri

    even = (np.arange(LOG_NORMAL) + 0.5) / LOG_NORMAL
    return Site("log-normal", "drawn", np.exp(LOG_SPREAD * ndtri(even)))


def hold(site: Site, subjects: int, draws: int, rng: np.random.Generator) -> list[float]:
    """Percentages of draws in which each statement holds, the true share below the bound that 95 % of the bounds reach,
    and mean stated and true share of a pad above all subjects."""
    fixed = np.array([site.reading_at(share) for share in AT])
    low, high, bound, stated, true = [], [], [], [], []
    for _ in range(draws):
        drawn = rng.choice(site.logs, subjects)
        if not np.ptp(drawn):
            continue
        people = Population.of(np.repeat(np.exp(drawn)[:, None], len(AT) + 1, axis=1))
        away = np.r_[fixed, drawn.mean() + ABOVE_ALL * drawn.std(ddof=1)]
        share = site.share_below(away)
        least, most = people.interval_below(np.exp(away))
        low.append(least <= share + 1e-12)
        high.append(most >= share - 1e-12)
        bound.append(site.share_below(np.log(people.bound(SHARE)[:1]))[0])
        stated.append(people.expected_below(np.exp(away))[-1])
        true.append(share[-1])
    held = [100 * float(np.mean(one)) for one in (low, high, np.array(bound) >= SHARE)]
    return [*held, float(np.quantile(bound, 1.0 - CONFIDENCE)), float(np.mean(stated)), float(np.mean(true))]


def main() -> None:
    """Run, print and write the table."""
    from scipy.stats import shapiro, skew

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--draws", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--table", type=Path, default=TABLE)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    rows = []
    for site in [log_normal(), *read_sites(options.file)]:
        normal = 1.0 if site.reading == "drawn" else float(shapiro(site.logs).pvalue)
        for subjects in SUBJECTS:
            found = hold(site, subjects, options.draws, rng)
            rows.append(
                (
                    site.name,
                    site.reading,
                    len(site.values),
                    f"{skew(site.logs):.2f}",
                    f"{normal:.3f}",
                    subjects,
                    options.draws,
                    *(f"{one:.1f}" for one in found[:3]),
                    *(f"{one:.3f}" for one in found[3:]),
                )
            )
            print(*rows[-1], flush=True)
    write_text(options.table, csv_text(HEAD, rows))


if __name__ == "__main__":
    main()

"""Rate-dependent viscosity of an acrylic: ``python -m studies.acrylic VHB_DIR PREDICTION_DIR``.

VHB_DIR has eleven curves of loading and unloading of VHB 4910 (Hossain, Vu and Steinmann 2012, digitised by the authors
of ConstitutiveANN/vCANN, MIT); PREDICTION_DIR is their folder ``Code/Results_VHB4910/*/prediction``. Neither is part of
this repository. Writes ``docs/data/acrylic.csv`` and the table of ``docs/real-data.md``.

As in their network, the curves to a stretch of 3.0 are fitted (0.01 and 0.05 1/s) and the nine others are predicted.
The model is the loop's: elastic stress, two linear arms, and times that go with a power of the rate.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.model.effect import Arm
from dummydesign.loop.model.forward_model import relax
from studies.marked_page import MarkedPage

REPOSITORY = Path(__file__).resolve().parents[1]
ROWS = Path("docs", "data", "acrylic.csv")
PAGE = MarkedPage(Path("docs", "real-data.md"), "<!-- acrylic begin -->", "<!-- acrylic end -->")
FITTED, REFERENCE = 3.0, 0.03
SAMPLES = 600  # of each curve, as in the network's data
NETWORK = "network of the authors (vCANN)"
MODELS = {
    "neo-Hookean, two arms": (False, False),
    "neo-Hookean, two arms, viscosity by rate": (False, True),
    "Ogden, two arms": (True, False),
    "Ogden, two arms, viscosity by rate": (True, True),
}
"""Whether the exponent of the elastic law and that of the rate are fitted."""
START = (30.0, 1.5, 0.5, 30.0, 0.5, 2.0, 0.0)  # modulus kPa, time s and strength of two arms, exponents
FIELDS = ("model", "stretch", "rate_per_s", "fitted", "rms_kPa", "peak_kPa", "rms_over_peak")


@dataclass(frozen=True)
class Curve:
    """A curve of loading and unloading at one rate, evenly spaced in time."""

    largest: float
    rate: float
    time_s: NDArray
    stretch: NDArray
    stress_kPa: NDArray


def curve_of(largest: float, rate: float, stretch: NDArray, stress_kPa: NDArray) -> Curve:
    """A curve whose times follow from its rate."""
    time = np.r_[0.0, np.cumsum(np.abs(np.diff(stretch)) / rate)]
    even = np.linspace(0.0, time[-1], SAMPLES)
    return Curve(largest, rate, even, np.interp(even, time, stretch), np.interp(even, time, stress_kPa))


def read_curves(folder: Path) -> list[Curve]:
    """All curves of the folder."""
    curves = []
    for path in sorted(folder.glob("stretch_*_*.txt")):
        largest, rate = (float(word) for word in path.stem.split("_")[1:])
        curves.append(curve_of(largest, rate, *np.loadtxt(path, delimiter=",").T))
    return curves


def stress_kPa(curve: Curve, values: Sequence[float]) -> NDArray:
    """Nominal stress of a bar: P = E 2 / (3 a) (l^(a - 1) - l^(-a / 2 - 1)), relaxed by two arms whose times go with
    (rate / 0.03 1/s)^-n. [kPa]"""
    young, tau_1, beta_1, tau_2, beta_2, alpha, power = values
    stretch = curve.stretch
    elastic = young * 2.0 / (3.0 * alpha) * (stretch ** (alpha - 1.0) - stretch ** (-0.5 * alpha - 1.0))
    slower = (curve.rate / REFERENCE) ** -power
    arms = [Arm(tau_1 * slower, beta_1), Arm(tau_2 * slower, beta_2)]
    return relax(curve.time_s[None], elastic[None], arms)[0]


def fitted(curves: Sequence[Curve], stiffens: bool, by_rate: bool) -> list[float]:
    """Values of the least squares, each curve relative to its largest stress."""
    from scipy.optimize import least_squares

    free = [True] * 5 + [stiffens, by_rate]
    # the modulus, times, strengths and the law's exponent are positive
    start = np.r_[np.log(START[:6]), START[6]]

    def values(some: NDArray) -> list[float]:
        every = start.copy()
        every[free] = some
        return [*np.exp(every[:6]).tolist(), float(every[6])]

    def residual(some: NDArray) -> NDArray:
        now = values(some)
        return np.concatenate([(stress_kPa(one, now) - one.stress_kPa) / one.stress_kPa.max() for one in curves])

    low, high = np.r_[np.log([1.0, 0.02, 1e-3, 1.0, 1e-3, 0.2]), -1.0], np.r_[np.log([300, 20, 50, 1e3, 50, 8.0]), 2.0]
    best = least_squares(residual, start[free], bounds=(low[free], high[free]))
    return values(best.x)


def rows_of(model: str, curves: Sequence[Curve], predicted: Sequence[NDArray]) -> list[dict[str, object]]:
    """Errors of a model, a row a curve."""
    rows: list[dict[str, object]] = []
    for one, stress in zip(curves, predicted):
        error, peak = rms(stress - one.stress_kPa), float(one.stress_kPa.max())
        cells = model, one.largest, one.rate, one.largest == FITTED, error, peak, error / peak
        rows.append(dict(zip(FIELDS, cells)))
    return rows


def network_of(folder: Path, curves: Sequence[Curve]) -> list[NDArray]:
    """The authors' predictions at the times of the curves: rows stretch, time and stress. [kPa]"""
    out = []
    for one in curves:
        _, time, stress = np.load(folder / f"lam_{one.largest}_lam_dot_{one.rate}.npy")
        out.append(np.interp(one.time_s, time, stress))
    return out


def rms(values: Sequence[float] | NDArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def scatter(curves: Sequence[Curve], stretch: float = 1.4) -> float:
    """By how much curves of one rate differ while they rise through a stretch, rms of ln stress about their mean."""
    logs: dict[float, list[float]] = {}
    for one in curves:
        top = int(np.argmax(one.stretch)) + 1
        logs.setdefault(one.rate, []).append(float(np.log(np.interp(stretch, one.stretch[:top], one.stress_kPa[:top]))))
    squares = sum(len(own) * float(np.var(own)) for own in logs.values())
    return float(np.sqrt(squares / (len(curves) - len(logs))))


def table(rows: Sequence[dict[str, object]], exponents: dict[str, tuple[float, float]], curves: Sequence[Curve]) -> str:
    """A line a model: errors of the two fitted curves and of the nine others."""
    lines = [
        "| model | law's exponent | rate's exponent | fitted | predicted |",
        "|---|---|---|---|---|",
    ]
    for model in dict.fromkeys(str(row["model"]) for row in rows):
        own = [row for row in rows if row["model"] == model]
        new = [row for row in own if not row["fitted"]]
        groups = [[row for row in own if row["fitted"]], new]
        errors = [f"{100 * rms([float(str(row['rms_over_peak'])) for row in group]):.1f} %" for group in groups]
        law, power = (f"{one:.2f}" for one in exponents[model]) if model in exponents else ("-", "-")
        lines.append(f"| {model} | {law} | {power} | {' | '.join(errors)} |")
    differ = f"Curves of one rate differ by {100 * scatter(curves):.0f} % where they rise through a stretch of 1.4."
    return "\n".join([*lines, "", differ]) + "\n"


def main(arguments: Sequence[str] | None = None) -> None:
    """Read, fit, predict, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("acrylic", type=Path, metavar="VHB_DIR")
    parser.add_argument("network", type=Path, metavar="PREDICTION_DIR")
    options = parser.parse_args(arguments)
    PAGE.read(REPOSITORY)
    curves = read_curves(options.acrylic)
    known = [one for one in curves if one.largest == FITTED]
    rows, exponents = [], {}
    for model, free in MODELS.items():
        values = fitted(known, *free)
        print(model, ", ".join(f"{value:.3g}" for value in values))
        exponents[model] = values[5], values[6]
        rows += rows_of(model, curves, [stress_kPa(one, values) for one in curves])
    rows += rows_of(NETWORK, curves, network_of(options.network, curves))
    with (REPOSITORY / ROWS).open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows({k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    PAGE.write(REPOSITORY, table(rows, exponents, curves))


if __name__ == "__main__":
    main()

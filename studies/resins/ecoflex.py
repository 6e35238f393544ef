"""Moduli and resin files of Ecoflex 00-10, 00-30 and 00-50 with thinner, from public compression curves.

``python -m studies.resins.ecoflex`` fits the 19 mixtures of ``materials/measured/ecoflex-compression.csv``
(see its attribution file) with the pad model's puck, then each family's modulus against thinner, and writes
``materials/measured/ecoflex-moduli.csv``, the three resin files and the table in ``docs/real-data.md``.
``--reduce FILE`` first makes the reduced curves from the data set's curves on a 0.25 mm grid.

Law of a family: E = E_0 (100 / (100 + r))^n, r parts of thinner per 100 A+B, fitted to ln E by least squares
with the mixtures' own intervals as weights and a scatter of the law in the weights until the misfit agrees.
What plate friction leaves open is common to all mixtures of a family: it is not averaged away but widens E_0.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.core.user_library import data_folder
from dummydesign.inference.least_squares import CHI_SQUARE_95
from dummydesign.pad.tables.puck import DIAMETER_MM, HEIGHT_MM, friction_of, load_puck_table
from dummydesign.resin.puck_test.loading_fit import LoadingCurve, LoadingFit, fit_pucks
from studies.marked_page import MarkedPage

Array = np.ndarray

WINDOW_MM = (1.0, 15.0)
REDUCED_STEP_MM = 0.5
REDUCED_END_MM = 18.0
FAMILIES = {"EF10": "ecoflex-00-10", "EF30": "ecoflex-00-30", "EF50": "ecoflex-00-50"}
COMMAND = "python -m studies.resins.ecoflex"
PAGE = MarkedPage(Path("docs", "real-data.md"), "<!-- ecoflex begin -->", "<!-- ecoflex end -->")
DATA_SET = (
    "A. B. Dawood, Z. Zhang, D. Osman, S. Suulker, A. Abdulali, M. Angelmahr, K. Althoefer, Hyperelastic "
    "Characterisation of Silicone Tissue Phantoms (data set, 2026), "
    "https://github.com/abubakardawood/tissue-phantom-material-database, CC BY 4.0"
)


@dataclass(frozen=True)
class BatchFit:
    """What the curves of one batch say; intervals are 95 %.

    Whatever friction keeps the mean square misfit below its minimum + 3.84 s^2 / pucks belongs to the interval.
    ``friction`` is infinite for plates that hold the faces (bonded), ``profile`` what each friction would make of the
    batch: (friction, young_kPa, chi square above the best).
    """

    young_kPa: float
    young_low_kPa: float
    young_high_kPa: float
    alpha: float
    friction: float
    friction_low: float
    friction_high: float
    offsets_mm: Array
    young_frictionless_kPa: float
    young_bonded_kPa: float
    rmse: float
    rmse_frictionless: float
    scatter: float
    profile: tuple[tuple[float, float, float], ...]

    @classmethod
    def of(cls, fit: LoadingFit, pucks: int) -> BatchFit:
        """Read the profile of a fit of some pucks."""
        best = min(fit.profile, key=lambda one: one.misfit)
        kept = [one for one, excess in zip(fit.profile, fit.excess) if excess <= CHI_SQUARE_95]
        logs = [one.parameters[0] for one in kept]
        # one puck's modulus differs from another's: the mean of all is known to this
        around = float(np.sqrt(CHI_SQUARE_95 * fit.variance))
        profile = tuple(
            (friction_of(one.grip), float(np.exp(one.parameters[0])), float(excess))
            for one, excess in zip(fit.profile, fit.excess)
        )
        return cls(
            young_kPa=float(np.exp(best.parameters[0])),
            young_low_kPa=float(np.exp(min(logs) - around)),
            young_high_kPa=float(np.exp(max(logs) + around)),
            alpha=best.parameters[1],
            friction=friction_of(best.grip),
            friction_low=friction_of(kept[0].grip),
            friction_high=friction_of(kept[-1].grip),
            offsets_mm=best.parameters[2:] * HEIGHT_MM,
            young_frictionless_kPa=profile[0][1],
            young_bonded_kPa=profile[-1][1],
            rmse=fit.misfit,
            rmse_frictionless=fit.profile[0].misfit,
            scatter=float(np.sqrt(fit.variance * pucks - best.misfit**2)),
            profile=profile,
        )


@dataclass(frozen=True)
class Mixture:
    """One mixture: family code, parts of thinner per 100 A+B, and what its curves say."""

    family: str
    thinner: float
    fit: BatchFit

    @property
    def log_spread(self) -> float:
        """Standard deviation of ln E, from the 95 % interval."""
        return float(np.log(self.fit.young_high_kPa / self.fit.young_low_kPa) / (2.0 * 1.96))


@dataclass(frozen=True)
class FamilyLaw:
    """E_0 and exponent with 95 % intervals, scatter about the law, leave-one-out errors, interval of friction."""

    young_neat_kPa: tuple[float, float, float]
    exponent: tuple[float, float, float]
    scatter: float
    left_out: dict[float, float]
    friction: tuple[float, float]

    @property
    def cross_validated_error(self) -> float:
        """Root mean square of the relative error of the modulus of a mixture that was left out."""
        return float(np.sqrt(np.mean(np.square(list(self.left_out.values())))))


def measured_folder() -> Path:
    """Folder of the reduced measurements."""
    return data_folder() / "materials" / "measured"


def reduce_curves(source: Path, target: Path) -> None:
    """Thin the data set's resampled curves to every 0.5 mm up to 18 mm; numbers stay as they are."""
    with open(source, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    header, body = rows[0], rows[1:]
    if header[:1] != ["compression_mm"]:
        message = f"{source.name}: its first column is not compression_mm"
        raise InputError(message, "missing", "compression_mm")
    kept = []
    for row in body:
        steps = float(row[0]) / REDUCED_STEP_MM
        if abs(steps - round(steps)) < 1e-9 and float(row[0]) <= REDUCED_END_MM:
            kept.append(",".join(row))
    write_text(target, "\n".join([",".join(header), *kept]) + "\n")


def read_curves(path: Path) -> dict[tuple[str, float], list[LoadingCurve]]:
    """Read reduced curves by family code and parts of thinner."""
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    values = np.array(rows[1:], dtype=float)
    curves: dict[tuple[str, float], list[LoadingCurve]] = {}
    for name, load in zip(rows[0][1:], values.T[1:]):
        family, rest = name.split("_", 1)
        thinner, test = rest.split("T_")
        key = family, float(thinner.replace("_", "."))
        curves.setdefault(key, []).append(LoadingCurve(name.removesuffix("_N"), test[0], values[:, 0], load))
    return dict(sorted(curves.items()))


def fit_mixtures(curves: dict[tuple[str, float], list[LoadingCurve]]) -> list[Mixture]:
    """Fit every mixture."""
    table = load_puck_table()
    mixtures = []
    for (family, thinner), batch in curves.items():
        fit = fit_pucks(batch, DIAMETER_MM, HEIGHT_MM, table, WINDOW_MM)
        mixtures.append(Mixture(family, thinner, BatchFit.of(fit, len({curve.puck for curve in batch}))))
    return mixtures


def _line(mixtures: list[Mixture]) -> tuple[Array, Array, float]:
    """ln E_0 and n, their covariance, and the scatter that makes the misfit agree with the weights."""
    x = np.log([100.0 / (100.0 + m.thinner) for m in mixtures])
    y = np.log([m.fit.young_kPa for m in mixtures])
    own = np.array([m.log_spread for m in mixtures])
    design = np.stack([np.ones_like(x), x], axis=1)
    scatter = 0.0
    for _ in range(60):
        weight = 1.0 / np.sqrt(own**2 + scatter**2)
        solution, *_ = np.linalg.lstsq(design * weight[:, None], y * weight, rcond=None)
        misfit = float(np.sum(((y - design @ solution) * weight) ** 2))
        if misfit <= len(x) - 2:
            break
        scatter = max(1.15 * scatter, 0.005)
    covariance = np.linalg.inv((design * weight[:, None]).T @ (design * weight[:, None]))
    return solution, covariance, scatter


def fit_family(mixtures: list[Mixture]) -> FamilyLaw:
    """Fit the modulus of one family against thinner, with the error at each mixture when it is left out.

    Student's t with mixtures - 2 degrees of freedom makes the 95 % intervals; E_0 is then widened by what
    the moduli do between the ends of the friction that the family as a whole allows (the misfit of the law
    being common to its mixtures, they count as one for this).
    """
    from scipy.stats import t

    solution, covariance, scatter = _line(mixtures)
    width = t.ppf(0.975, len(mixtures) - 2) * np.sqrt(np.diag(covariance))
    left_out = {}
    for mixture in mixtures:
        rest, _, _ = _line([other for other in mixtures if other is not mixture])
        expected = rest[0] + rest[1] * np.log(100.0 / (100.0 + mixture.thinner))
        left_out[mixture.thinner] = float(np.exp(expected) / mixture.fit.young_kPa - 1.0)
    neat = tuple(float(np.exp(solution[0] + s * width[0])) for s in (0.0, -1.0, 1.0))
    exponent = tuple(float(solution[1] + s * width[1]) for s in (0.0, -1.0, 1.0))
    profiles = np.array([mixture.fit.profile for mixture in mixtures])
    excess = profiles[:, :, 2].mean(axis=0)
    kept = excess <= excess.min() + CHI_SQUARE_95
    change = np.log(profiles[:, kept, 1] / np.array([[m.fit.young_kPa] for m in mixtures])).mean(axis=0)
    neat = neat[0], neat[1] * float(np.exp(min(change.min(), 0.0))), neat[2] * float(np.exp(max(change.max(), 0.0)))
    friction = profiles[0, kept, 0]
    return FamilyLaw(neat, exponent, scatter, left_out, (float(friction[0]), float(friction[-1])))


def _number(quantity: dict[str, Any]) -> str:
    return (
        f"{{ value = {quantity['value']:.4g}, low = {quantity['low']:.4g}, high = {quantity['high']:.4g}, "
        f'kind = "{quantity["kind"]}", source = "{quantity["source"]}" }}'
    )


def _resin_text(family: str, law: FamilyLaw, largest: float) -> str:
    """Text of the resin file of one family; what is not measured comes from ``ecoflex-liquid.toml``."""
    from dummydesign.core.user_library import read_toml

    liquid, _ = read_toml(measured_folder() / "ecoflex-liquid.toml")
    own, common = liquid[family], liquid["common"]
    name = FAMILIES[family]
    source = (
        f"least squares over {len(law.left_out)} mixtures of the compression data of Dawood et al. (2026), CC BY 4.0, "
        f"by {COMMAND}; leave-one-mixture-out error {100 * law.cross_validated_error:.1f} % rms"
    )

    def fitted(triple: tuple[float, float, float]) -> str:
        return _number(dict(zip(("value", "low", "high"), triple)) | {"kind": "fitted", "source": source})

    title = f"Ecoflex {name.removeprefix('ecoflex-')} silicone thinned with Silicone Thinner"
    lines = [
        f"# Made by {COMMAND}; edit ecoflex-liquid.toml or the measurements, not this file.",
        "schema = 1",
        f'name = "{name}"',
        f'title = "{title}"',
        'ratio_meaning = "thinner per 100 A+B by weight"',
        "ratio_min = 0.0",
        f"ratio_max = {largest:.1f}",
        "ratio_step = 1.0",
        f'references = ["{DATA_SET}"]',
        "notes = [",
        *[f'  "{note}",' for note in common["notes"]],
        "]",
    ]
    for part, weight in (("part A", "50.0"), ("part B", "50.0"), ("thinner", '"ratio"')):
        values = common["thinner"] if part == "thinner" else own["part"]
        lines += ["", "[[component]]", f'name = "{part}"', f"parts = {weight}"]
        lines += [f"{key} = {_number(value)}" for key, value in values.items()]
    lines += ["", "[modulus]", 'law = "polymer_fraction"']
    lines += [f"young_neat_kPa = {fitted(law.young_neat_kPa)}", f"exponent = {fitted(law.exponent)}"]
    lines += ["", "[relaxation]", "ratio_ref = 0.0", f"softness_exponent = {_number(common['softness_exponent'])}"]
    for term in common["term"]:
        lines += ["", "[[relaxation.term]]", *[f"{key} = {_number(value)}" for key, value in term.items()]]
    for key, value in (own["property"] | common["property"]).items():
        lines += ["", f"[property.{key}]"]
        lines += [f"{end} = {value[end]:.4g}" for end in ("value", "low", "high")]
        lines += [f'kind = "{value["kind"]}"', f'source = "{value["source"]}"']
    return "\n".join(lines) + "\n"


def moduli_text(mixtures: list[Mixture]) -> str:
    """The fitted mixtures as CSV."""
    columns = (
        "young_kPa",
        "young_low_kPa",
        "young_high_kPa",
        "alpha",
        "friction",
        "friction_low",
        "friction_high",
        "young_frictionless_kPa",
        "young_bonded_kPa",
        "rmse",
        "rmse_frictionless",
        "scatter",
    )
    lines = [",".join(("family", "thinner_per_100", *columns, "offset_low_mm", "offset_high_mm"))]
    for m in mixtures:
        offsets = m.fit.offsets_mm
        values = [f"{getattr(m.fit, column):.4g}" for column in columns]
        lines.append(
            ",".join([FAMILIES[m.family], f"{m.thinner:g}", *values, f"{min(offsets):.3f}", f"{max(offsets):.3f}"])
        )
    return "\n".join(lines) + "\n"


def report(laws: dict[str, FamilyLaw]) -> str:
    """Table of the families for ``docs/real-data.md``; ``ecoflex-moduli.csv`` has every mixture."""
    lines = ["| family | E_0 kPa (95 %) | exponent n (95 %) | friction (95 %) | one left out, rms | largest |"]
    lines += ["|---|---|---|---|---|---|"]
    for family, law in laws.items():
        largest = max(law.left_out.values(), key=abs)
        neat, n = law.young_neat_kPa, law.exponent
        lines.append(
            f"| {FAMILIES[family]} | {neat[0]:.1f} ({neat[1]:.1f} to {neat[2]:.1f}) | {n[0]:.2f} ({n[1]:.2f} to "
            f"{n[2]:.2f}) | {_friction(law.friction[0])} to {_friction(law.friction[1])} | "
            f"{100 * law.cross_validated_error:.1f} % | {100 * largest:+.0f} % |"
        )
    return "\n".join(lines) + "\n"


def _friction(value: float) -> str:
    return "bonded" if np.isinf(value) else f"{value:.2f}"


def main() -> None:
    """Fit and write everything."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--reduce", metavar="FILE", help="curves_resampled.csv of the data set")
    options = parser.parse_args()
    path = measured_folder() / "ecoflex-compression.csv"
    if options.reduce:
        reduce_curves(Path(options.reduce), path)
    mixtures = fit_mixtures(read_curves(path))
    laws = {family: fit_family([m for m in mixtures if m.family == family]) for family in FAMILIES}
    write_text(measured_folder() / "ecoflex-moduli.csv", moduli_text(mixtures))
    for family, law in laws.items():
        text = _resin_text(family, law, max(law.left_out))
        write_text(data_folder() / "materials" / "resins" / f"{FAMILIES[family]}.toml", text)
    tables = report(laws)
    print(tables)
    PAGE.write(data_folder(), tables)


if __name__ == "__main__":
    main()

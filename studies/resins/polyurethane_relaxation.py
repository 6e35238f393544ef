"""Infer how strongly the paper's polyurethane relaxes from what the paper says of its dummies' peaks.

The paper gives no relaxation of its resin, but says (section IV-C, at 10 N steady, 10 and 250 mm/s): the
peaks of dummies I and III are small and lie in the force variation range of palm and forefinger, the peak
of dummy II almost reaches the upper edge of the thenar's. The tissues' peaks come from in vivo ratios, not
from the dummies, so the argument is no circle. What is not known is drawn (amplitude, exponent of the
power law over the three terms, modulus) and weighed by how well each statement is met.

Run ``python -m studies.resins.polyurethane_relaxation`` to repeat it and to see which statements clash.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, make_curves, press_to_depth, steady_depth
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS, PUNCH_RADIUS_MM
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.tables.square import square_law

DUMMIES = (("I", "palm", 15.0), ("II", "thenar", 20.0), ("III", "forefinger", 5.0))
"""Name, tissue and thickness in mm of the paper's dummies."""
VELOCITIES_MM_S = (10.0, 250.0)
STEADY_N, RADIUS_MM = 10.0, PUNCH_RADIUS_MM
TAU_S = (0.03, 0.3, 3.0)
AMPLITUDE, EXPONENT = (0.02, 2.0), (0.4, 0.8)
"""Strength at 0.3 s, even in the logarithm; beta falls as tau^-n with n from critical gels (0.5 to 0.7)."""
YOUNG_KPA = (15.0, 50.0)
TOLERANCE = 0.1
"""Edges of the inferred ranges are soft: one standard deviation of 10 % in force."""
DRAWS, SEED = 20_000, 5


@dataclass(frozen=True)
class Inference:
    """Weighted draws in short.

    ``beta`` holds (2.5 %, 50 %, 97.5 %) of each term, ``acceptance`` the mean weight, ``statements`` the
    mean weight of each statement over the posterior (1 is wholly met), ``peaks`` the posterior mean of
    peak over steady of each press.
    """

    tau_s: tuple[float, ...]
    beta: tuple[tuple[float, float, float], ...]
    acceptance: float
    effective_draws: float
    statements: dict[str, float]
    peaks: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """Return all fields."""
        return asdict(self)


def infer(law: ForceLaw | None = None, draws: int = DRAWS, seed: int = SEED) -> Inference:
    """Draw what is not known, press the three dummies, and weigh the draws by the paper's statements.

    Parameters
    ----------
    law : ForceLaw, optional
        Elastic force of slabs; that of the glued square punch by default.
    draws : int
        How many combinations of strength, exponent and modulus are tried.
    seed : int
        Of the generator of random numbers.
    """
    if law is None:
        from dummydesign.pad.tables.slab import load_table

        law = square_law(load_table(base="bonded"), "bonded")
    rng = np.random.default_rng(seed)
    amplitude = np.exp(rng.uniform(*np.log(AMPLITUDE), draws))
    exponent = rng.uniform(*EXPONENT, draws)
    young = np.exp(rng.uniform(*np.log(YOUNG_KPA), draws)) * 1e-3
    beta = amplitude[:, None] * (np.array(TAU_S) / 0.3) ** -exponent[:, None]
    parts, peaks = {}, {}
    for name, tissue, thickness in DUMMIES:
        curves = make_curves(law, [thickness], RADIUS_MM, MAX_DEPTH_OVER_THICKNESS)
        slabs = PadBatch(curves, np.zeros(draws, int), young, TAU_S, beta)
        for velocity in VELOCITIES_MM_S:
            peak = _peaks(slabs, velocity)
            key = f"dummy {name} at {velocity:g} mm/s"
            parts[key] = _weight(peak, *_wanted(tissue, velocity, upper=name == "II"))
            peaks[key] = peak / STEADY_N
    weight = np.prod(list(parts.values()), axis=0)
    total = weight / weight.sum()
    order = np.argsort(beta, axis=0)
    quantiles = []
    for column in range(len(TAU_S)):
        ranked = beta[order[:, column], column]
        share = np.cumsum(total[order[:, column]])
        quantiles.append(tuple(float(np.interp(q, share, ranked)) for q in (0.025, 0.5, 0.975)))
    return Inference(
        TAU_S,
        tuple(quantiles),
        float(weight.mean()),
        float(1.0 / np.sum(total**2)),
        {key: float(np.sum(total * part)) for key, part in parts.items()},
        {key: float(np.sum(total * np.nan_to_num(peak))) for key, peak in peaks.items()},
    )


def _peaks(slabs: PadBatch, velocity_mm_s: float) -> NDArray:
    """Peak of each draw at 10 N steady; NaN where the depth limit is met first."""
    sampling = Sampling(24, 12, 12)
    depth = steady_depth(slabs, STEADY_N, velocity_mm_s, sampling)
    return press_to_depth(slabs, depth, velocity_mm_s, sampling).peak_N


def _wanted(tissue: str, velocity_mm_s: float, upper: bool) -> tuple[float, float]:
    """Range of peaks a statement allows; 'almost the upper edge' is the upper quarter."""
    from dummydesign.tissue.model.ranges import force_range
    from dummydesign.tissue.model.tissue_file import load_tissue

    band = force_range(load_tissue(tissue).parameter_sets, STEADY_N, velocity_mm_s)
    low, high = band.peak_low_N, band.peak_high_N
    return (high - 0.25 * (high - low) if upper else low), high


def _weight(peak: NDArray, low: float, high: float) -> NDArray:
    """1 inside, falling as a normal curve of 10 % outside; 0 where the press cannot be made."""
    with np.errstate(invalid="ignore"):
        outside = np.maximum(np.log(low / peak), 0.0) + np.maximum(np.log(peak / high), 0.0)
    return np.where(np.isfinite(peak), np.exp(-0.5 * (np.nan_to_num(outside) / TOLERANCE) ** 2), 0.0)


def report(inference: Inference) -> str:
    """Lay the inference out as text."""
    lines = [f"mean weight {inference.acceptance:.3f}, effective draws {inference.effective_draws:.0f}"]
    for tau, (low, middle, high) in zip(inference.tau_s, inference.beta):
        lines.append(f"tau {tau:g} s: beta {middle:.3f} (95 %: {low:.3f} to {high:.3f})")
    for key, met in inference.statements.items():
        note = "" if met > 0.6 else "  <- in conflict with the others"
        lines.append(f"{key}: peak over steady {inference.peaks[key]:.2f}, statement met {met:.2f}{note}")
    return "\n".join(lines)


if __name__ == "__main__":
    print(report(infer()))

"""Drawn curves and how the package objective_rating_metrics (MIT) rates them: ``python -m tests.support.rated_curves``.

The package is an implementation of ISO/TS 18571 by others. It is needed to write ``rated_curves.json``, not to read it.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

FILE = Path(__file__).with_name("rated_curves.json")
COUNT = 24


def drawn_curve(rng: np.random.Generator, n: int) -> NDArray:
    """A press with noise, a random walk or a wave."""
    x, kind, top = np.linspace(0.0, 1.0, n), rng.integers(4), rng.uniform(0.2, 0.8)
    if kind == 0:
        return np.cumsum(rng.standard_normal(n))
    if kind == 1:
        return np.sin(2.0 * np.pi * rng.uniform(0.5, 5.0) * x + rng.uniform(0.0, 6.0))
    rise = (x / top).clip(0.0, 1.0) ** rng.uniform(1.0, 3.5)
    fall = rng.uniform(0.0, 0.6) * -np.expm1(-(x - top).clip(0.0) / rng.uniform(0.02, 0.5))
    return rng.uniform(0.6, 1.5) * (rise - fall) + rng.choice([0.0, 0.02]) * rng.standard_normal(n)


def drawn_pair(seed: int) -> tuple[NDArray, NDArray]:
    """Two curves of one length; in every third pair the second is the first, shifted and scaled."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(40, 260))
    first, second = drawn_curve(rng, n), drawn_curve(rng, n)
    if seed % 3 == 0:
        second = rng.uniform(0.8, 1.2) * np.roll(first, int(rng.integers(-n // 4, n // 4)))
    return first, second


def rated_by_package(reference: NDArray, compared: NDArray) -> list[float]:
    """R, Z, EP, EM and ES by the package."""
    from objective_rating_metrics.rating import ISO18571

    time = 1e-4 * np.arange(len(reference))
    iso = ISO18571(np.c_[time, reference], np.c_[time, compared])
    ratings = (iso.overall_rating, iso.corridor_rating, iso.phase_rating, iso.magnitude_rating, iso.slope_rating)
    return [float(rating(-1)) for rating in ratings]


def main() -> None:
    """Rate all pairs and write the file."""
    rows = [rated_by_package(*drawn_pair(seed)) for seed in range(COUNT)]
    FILE.write_text(json.dumps({"made_by": "objective_rating_metrics 1.3", "ratings": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

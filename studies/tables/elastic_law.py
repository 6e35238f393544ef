"""Build the table of pads of another elastic law than neo-Hookean: ``python -m studies.tables.elastic_law``.

One-term Ogden pads of one modulus under a round punch, glued to punch and base, are solved at three exponents, and
slabs of one proportion at a fourth as a check. Slabs are tabulated over a / h and d / h; crowned pads that designs
have taken are solved to see how far they are from the slab. ``--check SEED`` solves drawn crowns instead and prints how
far the table is off.
"""

from __future__ import annotations

import argparse

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.interpolation import between
from dummydesign.core.user_library import data_folder
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import make_shape
from dummydesign.pad.force_source import solve_points
from dummydesign.pad.pad_under_punch import SLAB, Pad
from dummydesign.pad.tables.elastic_law import NAME, load_elastic_table, mean_drop_mm, ogden_law
from studies.tables.common import Build, write_table

Array = np.ndarray
ALPHAS, CHECKED = (2.0, 3.5, 6.0), 1.5
RATIOS = (0.4, 0.65, 1.0, 1.6)
DEPTHS = (0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
RADIUS_MM = 7.9
CROWNS = (
    (4.5, (21.2, 2.0, 9.4)),
    (5.0, (23.2, 2.2, 11.3)),
    (6.5, (11.6, 2.1, 11.3)),
    (7.5, (7.9, 1.5, 7.9)),
    (10.0, (2.6, 3.2, 7.8)),
    (10.0, (6.0, 2.6, 7.9)),
    (10.5, (3.6, 4.6, 9.4)),
    (12.5, (2.3, 4.0, 9.5)),
    (13.5, (2.3, 2.7, 7.9)),
    (14.0, (2.1, 6.2, 11.3)),
    (16.5, (1.3, 3.3, 6.6)),
    (19.0, (1.1, 3.8, 5.5)),
)
"""Thickness, and apex radius, height and foot radius of crowns that designs have taken. [mm]"""


def log_forces(thickness_mm: float, shape: PadShape, alpha: float) -> Array:
    """Ln of the force of unit modulus at the depths, NaN where the solve ended before."""
    depth = thickness_mm * np.array(DEPTHS)
    try:
        force = solve_points(Pad(thickness_mm, 1.0, RADIUS_MM, law=ogden_law(alpha), geometry=shape), depth).force_N
    except NoAnswerError:
        force = np.array([])
    print(f"{shape} {thickness_mm:g} mm, alpha {alpha:g}: {len(force)} depths", flush=True)
    return np.log(np.pad(force, (0, len(depth) - len(force)), constant_values=np.nan))


def slope_and_bend(thickness_mm: float, shape: PadShape) -> Array:
    """s and q of a pad at the depths, the last known held beyond; shape (2, depths)."""
    middle, *others = (log_forces(thickness_mm, shape, alpha) for alpha in ALPHAS)
    first, second = ((one - middle) / (alpha - 2.0) for one, alpha in zip(others, ALPHAS[1:]))
    bend = (second - first) / (ALPHAS[2] - ALPHAS[1])
    rows = np.stack([first - (ALPHAS[1] - 2.0) * bend, bend])
    last = np.maximum.accumulate(np.where(np.isfinite(rows), np.arange(len(DEPTHS)), 0), axis=1)
    return np.take_along_axis(rows, last, axis=1)


def build() -> dict[str, object]:
    """Solve slabs and crowns; errors are those of s at an exponent that was not used, and of crowns by the slabs' s."""
    slope, bend = np.swapaxes([slope_and_bend(RADIUS_MM / ratio, SLAB) for ratio in RATIOS], 0, 1)
    at, away = RADIUS_MM / RATIOS[1], CHECKED - 2.0
    checked = (log_forces(at, SLAB, CHECKED) - log_forces(at, SLAB, 2.0)) / away
    depth, more = np.array(DEPTHS), []
    for thickness, (tip, height, foot) in CROWNS:
        shape = make_shape("crowned", [("radius", tip), ("height", height), ("foot", foot)])
        own = slope_and_bend(thickness, shape)
        drop = mean_drop_mm(shape, RADIUS_MM)
        rows = np.full(len(depth), np.log(RADIUS_MM / (thickness - drop)))
        pressed = np.maximum(depth * thickness - drop, 0.0) / (thickness - drop)
        slab = [between(pressed, rows, depth, np.log(RATIOS), one) for one in (slope, bend)]
        more.append(own - np.stack(slab))
    # what most crowns have in common is added, how far each is from that is the error
    middle = np.median(more, axis=0)
    misses = [np.abs(s + (alpha - 2.0) * q) for s, q in more - middle for alpha in (CHECKED, *ALPHAS[1:])]
    error = np.nan_to_num(np.abs(checked - slope[1] - away * bend[1]))
    return {
        "meaning": "ln F(alpha) / F(2) = (alpha - 2) slope + (alpha - 2)^2 bend [a/h][d/h] of one-term Ogden pads of "
        "one modulus; error and crown_error [d/h] are of it over alpha - 2",
        "ratio": list(RATIOS),
        "depth": list(DEPTHS),
        "slope": np.round(slope, 5).tolist(),
        "bend": np.round(bend, 5).tolist(),
        "error": np.round(np.maximum.accumulate(error), 5).tolist(),
        "crown_slope": np.round(middle[0], 5).tolist(),
        "crown_bend": np.round(middle[1], 5).tolist(),
        "crown_error": np.round(np.max(misses, axis=0), 5).tolist(),
        "alpha_range": [CHECKED, ALPHAS[-1]],
    }


def check(seed: int, count: int = 14) -> None:
    """Print the largest error of ln F of drawn crowns at each exponent and depth, and how often it is stated."""
    rng, table, off, stated = np.random.default_rng(seed), load_elastic_table(), [], []
    while len(off) < count:
        thickness, tip = rng.uniform(4.5, 18.0), np.exp(rng.uniform(np.log(1.2), np.log(25.0)))
        size = [("radius", tip), ("height", rng.uniform(1.5, min(6.0, 0.55 * thickness))), ("foot", rng.uniform(6, 13))]
        try:
            shape = make_shape("crowned", size)
            slope, bend = slope_and_bend(thickness, shape)
        except InputError:  # no crown has these
            continue
        at = np.array(DEPTHS), RADIUS_MM / thickness, "crowned", mean_drop_mm(shape, RADIUS_MM) / thickness
        known = [(alpha - 2.0, *table.factor(alpha, *at)) for alpha in (CHECKED, *ALPHAS[1:])]
        off.append([np.abs(away * slope + away**2 * bend - np.log(factor)) for away, factor, _ in known])
        stated.append([error for _, _, error in known])
    print("exponents", (CHECKED, *ALPHAS[1:]), "depths over thickness", DEPTHS)
    print(
        "largest error", np.max(off, axis=0).round(3).tolist(), "stated", np.mean(np.less_equal(off, stated)).round(3)
    )


def main(arguments: list[str] | None = None) -> None:
    """Solve and write the table, or check it."""
    parser = argparse.ArgumentParser(prog="python -m studies.tables.elastic_law", description=__doc__)
    parser.add_argument("--check", type=int, metavar="SEED")
    options = parser.parse_args(arguments)
    if options.check is not None:
        check(options.check)
        return
    run = Build.begin("studies.tables.elastic_law", arguments)
    write_table(data_folder() / "materials" / "tables" / NAME, build(), run)


if __name__ == "__main__":
    main()

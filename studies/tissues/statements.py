"""The paper's statements about dummies and tissues, and in vivo anchors, each as a test of samples.

A statement is true or false for a sample; how far its words reach (how near is "near the edge"?) is
itself drawn for every sample. In the posterior a broken statement costs a factor instead of the life of
the sample, because words may be misread and figures may deceive: see :data:`BROKEN`.

References
----------
"The paper" is :data:`dummydesign.core.quantity.NAGOYA_CITATION`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.quantity import HAND_STIFFNESS
from studies.tissues.dummy_curves import SITES, THICKNESS_MM, Unknowns, depth_at, force_at, steady_curves

BROKEN = 0.1
"""Weight of a sample for each statement it breaks: one statement in ten may be wrong or misread."""

SOFT_LAYER_MM = {"palm": (10.0, 20.0), "thenar": (15.0, 25.0), "forefinger": (5.0, 7.0)}
"""Assumed thickness of soft tissue over the bone, lowest and highest."""


@dataclass(frozen=True)
class Statement:
    """A named statement: text, where it stands, and for which samples (n,) it is true."""

    name: str
    text: str
    source: str
    holds: NDArray


@dataclass(frozen=True)
class SteadySamples:
    """Samples of the unknowns and what follows for the steady coefficients of each site.

    ``stiffest`` and ``spread`` map a site to gamma1 of the stiffest subject [N/mm3] and the ratio of
    the depths of the softest and the stiffest subject at equal force, each of shape (n,).
    """

    unknowns: Unknowns
    stiffest: dict[str, NDArray]
    spread: dict[str, NDArray]
    statements: tuple[Statement, ...]


def sample_steady(count: int, rng: np.random.Generator) -> SteadySamples:
    """Draw the unknowns of the dummies and judge every statement about the steady state.

    Parameters
    ----------
    count : int
        Number of samples n.
    rng : numpy Generator
    """
    unknowns = Unknowns(
        young_kPa=np.exp(rng.triangular(np.log(15.0), np.log(25.0), np.log(50.0), count)),
        slip=rng.uniform(0.0, 1.0, count),
        grip=rng.uniform(0.0, 1.0, count),
        stiffening=np.where(rng.random(count) < 0.5, 0.0, rng.uniform(0.0, 0.5, count)),
    )
    stiffest, spread, statements = {}, {}, []
    for site in SITES:
        spread[site] = np.exp(rng.uniform(np.log(1.15), np.log(2.2), count))
        crossing = rng.uniform(4.0, 6.0, count)
        depth, curves = steady_curves(site, unknowns)
        press = np.column_stack([crossing, *(np.full(count, f) for f in (5.0, 10.0, 15.0))])
        x = depth_at(press, depth, curves)
        stiffest[site] = crossing / x[:, 0] ** 3
        statements += _of_site(site, x[:, 1:], depth, curves, stiffest[site], spread[site], rng)
    return SteadySamples(unknowns, stiffest, spread, tuple(statements))


def _of_site(
    site: str,
    x: NDArray,
    depth: NDArray,
    curves: NDArray,
    stiffest: NDArray,
    spread: NDArray,
    rng: np.random.Generator,
) -> list[Statement]:
    """Statements of one site; ``x`` are the dummy's depths at 5, 10 and 15 N, shape (n, 3)."""
    count, dummy = len(stiffest), {"palm": "I", "thenar": "II", "forefinger": "III"}[site]
    softest = stiffest / spread**3
    position = _position_in_range(x, depth, curves, stiffest, softest, rng.integers(0, 3, count))
    inside = lambda at: (position[:, at] >= 0) & (position[:, at] <= 1)  # noqa: E731
    each = np.array([5.0, 10.0, 15.0]) / x**3
    # which part of a dummy's curve its gamma1 stands for is not said: all conditions, or the low forces
    fitted = np.where(rng.random(count) < 0.5, each.mean(axis=1), each[:, 0])
    layer = np.exp(rng.uniform(*np.log(SOFT_LAYER_MM[site]), count))
    middle = np.sqrt(stiffest * softest)
    tangent = 3.0 * np.cbrt(middle) * 140.0 ** (2 / 3)
    deepest = THICKNESS_MM[site] * rng.uniform(0.65, 0.8, count)
    reach = np.nan_to_num(x, nan=np.inf)
    here = [
        ("inside the range at 10 N", "the curve entered the range", "section IV-B", inside(1)),
        ("inside the range at 15 N", "high biofidelity above about 5 N", "section V-B", inside(2)),
        (
            "15 N was measured",
            "steady-state forces 5, 10 and 15 N",
            "sections II-B, IV-B",
            reach[:, 2] <= deepest,
        ),
    ]
    if site == "palm":
        width = rng.uniform(0.15, 0.3, count)
        near = np.abs(position[:, 1] - 0.5) <= width
        here.append(("at the centre of the range at 10 N", "at the center of the range", "section V-B", near))
    if site == "thenar":
        near = position[:, 1] <= rng.uniform(0.2, 0.4, count)
        here.append(("near the lower edge at 10 N", "close to the lower edge", "section V-B", near))
    if site == "forefinger":
        near = position[:, 1] >= 1 - rng.uniform(0.2, 0.4, count)
        here.append(("near the stiffest edge at 10 N", "near the left edge", "section IV-B", near))
        here.append(("gamma1 above the band", "larger than that of the pads", "section IV-A", fitted > stiffest))
    else:
        within = (fitted >= softest) & (fitted <= stiffest)
        here.append(("gamma1 inside the band", "between the largest and smallest", "section IV-A", within))
    factor = np.exp(rng.uniform(np.log(2.5), np.log(4.0), count))
    named = [Statement(f"dummy {dummy}: {name}", text, f"paper, {where}", ok) for name, text, where, ok in here]
    named.append(
        Statement(
            f"{site}: tangent at 140 N within a factor of 75 N/mm",
            "spring constant of hands and fingers 75 N/mm, held to a factor of 2.5 to 4",
            HAND_STIFFNESS,
            (tangent > 75 / factor) & (tangent < 75 * factor),
        )
    )
    softest_depth = np.cbrt(15.0 / softest)
    named.append(
        Statement(
            f"{site}: softest subject keeps 30 % of its tissue at 15 N",
            f"soft layer of {SOFT_LAYER_MM[site][0]:g} to {SOFT_LAYER_MM[site][1]:g} mm over the bone",
            "assumed",
            softest_depth <= 0.7 * layer,
        )
    )
    return named


def _position_in_range(
    x: NDArray, depth: NDArray, curves: NDArray, stiffest: NDArray, softest: NDArray, meaning: NDArray
) -> NDArray:
    """Place of the dummy in the range at 5, 10, 15 N: 0 at the softest edge, 1 at the stiffest, shape (n, 3).

    ``meaning`` says per sample in what the distance is measured: 0 in depth at equal force, 1 in force
    at the depth in the middle of the range, 2 in ln gamma.
    """
    forces = np.array([5.0, 10.0, 15.0])
    soft_x, stiff_x = np.cbrt(forces / softest[:, None]), np.cbrt(forces / stiffest[:, None])
    in_depth = (soft_x - x) / (soft_x - stiff_x)
    middle = 0.5 * (soft_x + stiff_x)
    low, high = softest[:, None] * middle**3, stiffest[:, None] * middle**3
    in_force = (force_at(middle, depth, curves) - low) / (high - low)
    in_gamma = np.log(forces / x**3 / softest[:, None]) / np.log(stiffest / softest)[:, None]
    return np.nan_to_num(np.choose(meaning[:, None], [in_depth, in_force, in_gamma]), nan=-9.0)


def weights(statements: tuple[Statement, ...]) -> NDArray:
    """Weight of each sample: :data:`BROKEN` to the power of the number of statements it breaks."""
    broken = sum((~statement.holds).astype(int) for statement in statements)
    return BROKEN**broken


def report(statements: tuple[Statement, ...], weight: NDArray) -> list[str]:
    """Say for each statement how many samples agree, before and after, and which statements clash."""
    share = weight / weight.sum()
    held = np.array([statement.holds for statement in statements])
    lines = [f"{'accepted':>9} {'posterior':>9}  statement"]
    lines += [f"{s.holds.mean():9.3f} {share @ s.holds:9.3f}  {s.name} [{s.source}]" for s in statements]
    together = held.all(axis=0).mean()
    lines.append(f"all {len(statements)} statements at once: {together:.2g} of the samples")
    lines.append("without one of them the share grows to (the hardest to reconcile first):")
    others = [(np.delete(held, i, axis=0).all(axis=0).mean(), s.name) for i, s in enumerate(statements)]
    lines += [f"{alone:9.2g}  without '{name}'" for alone, name in sorted(others, reverse=True)[:4]]
    lines.append("statements in conflict (hold together less than half as often as by chance):")
    lines += [f"{ratio:9.2f}  {one} | {two}" for ratio, one, two in conflicts(statements)] or ["     none"]
    return lines


def conflicts(statements: tuple[Statement, ...], below: float = 0.5) -> list[tuple[float, str, str]]:
    """Pairs of statements that hold together less than ``below`` times as often as independent ones would."""
    held, pairs = np.array([statement.holds for statement in statements]), []
    for i in range(len(statements)):
        for j in range(i):
            both, expected = np.mean(held[i] & held[j]), held[i].mean() * held[j].mean()
            if expected > 0 and both < below * expected:
                pairs.append((both / expected, statements[j].name, statements[i].name))
    return sorted(pairs)

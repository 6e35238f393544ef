"""Infer the built-in tissues from the paper's words and in vivo anchors.

``python -m studies.tissues.infer [--seed 1] [--samples 200000] [--out FOLDER]`` draws everything that is
not known, keeps what agrees (a broken statement costs a factor of ten), prints how often each statement
holds and which ones clash, and writes one tissue file and its posterior draws per site.

The five subjects of a file are order statistics: subject k has the posterior median of the k-th smallest
gamma1 of five. gamma2 / gamma1, gamma3 / gamma1 and the arms' times are posterior medians of their own k-th
smallest of five, dealt to the subjects in a fixed shuffled order (``posterior.DEALT``), since only the order of
the gammas is known (the same for all three, kept). So the subjects differ as five persons of the
posterior do; how well each is known is in its 95 % interval.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.files import output_folder, write_text
from dummydesign.core.quantity import HAND_STIFFNESS, NAGOYA_CITATION
from dummydesign.core.user_library import data_folder
from dummydesign.tissue.model.posterior import LAW, draws_csv, subject_of, typical_subjects
from dummydesign.tissue.model.tissue import Tissue
from dummydesign.tissue.model.tissue_file import tissue_toml
from studies.tissues.anchors import judge, propose
from studies.tissues.dummy_curves import SITES
from studies.tissues.statements import Statement, report, sample_steady, weights

SUBJECTS = 5
KEPT = 400
STEADY = 1000
PROPOSALS = 250
BLOCK = 40
SCATTER = (0.1, 0.4)
"""Assumed standard deviation of ln gamma_i / gamma1 and ln time between persons, lowest and highest."""

TITLES = {"palm": "centre of the palm", "thenar": "thenar eminence", "forefinger": "forefinger pad"}
SOURCES = (
    f"{NAGOYA_CITATION}; statements in words only, its numbers stand in figures",
    "Spartacus et al. 2021, PLOS ONE 16:e0261008 (peak ratio of the palm)",
    "Pawluk and Howe 1999, J Biomech Eng 121:178, doi 10.1115/1.2835100 (relaxation times of the fingerpad)",
    "Sensors 2017, 17:1190 (force rises with speed)",
    HAND_STIFFNESS,
)
NOTES = (
    "Not measured: inferred from the paper's description and in vivo data; wide intervals. Your own traces "
    "(tissues add) or points read off the paper's figures (tissues add-points) replace it.",
    "The subjects are posterior medians of the k-th smallest of five, not persons.",
    "Below a steady force of 5 N nothing was measured; the band there is the cube law extrapolated.",
)


def subjects_of(gamma1: NDArray, spread: NDArray, arms: dict[str, NDArray], rng: np.random.Generator) -> NDArray:
    """Make five subjects for every sample from the stiffest one, the spread and the arms.

    Parameters
    ----------
    gamma1, spread : ndarray, shape (n,)
        Stiffest subject [N/mm3]; ratio of depths of the softest and the stiffest at equal force.
    arms : dict of ndarray, shapes (n, ...)
        As :func:`anchors.propose` gives them.
    rng : numpy.random.Generator
        For the places between softest and stiffest and the scatter of the arms.

    Returns
    -------
    ndarray, shape (n, 5, 7)
        Columns as :data:`posterior.COLUMNS`, subjects by rising gamma1.
    """
    count = len(gamma1)
    normal = np.sort(rng.normal(size=(count, SUBJECTS)), axis=1)
    rank = (normal - normal[:, :1]) / (normal[:, -1:] - normal[:, :1])
    own = gamma1[:, None] * spread[:, None] ** (-3.0 * (1.0 - rank))
    # people differ in relaxation too; the scatter is a guess, the order of the gammas is the paper's
    scatter = rng.uniform(*SCATTER, (count, 1, 1))
    strength = arms["strength"][:, None, :] * np.exp(scatter * rng.normal(size=(count, SUBJECTS, 2)))
    gamma = np.sort(strength * own[..., None], axis=1)
    time = arms["time_s"][:, None] * np.exp(scatter[..., None] * rng.normal(size=(count, SUBJECTS, 1, 2)))
    depth = np.cbrt(10.0 / own)
    dampers = time * (gamma * depth[..., None] ** 2)[:, :, None, :]
    by_arm = np.moveaxis(dampers, -1, -2).reshape(count, SUBJECTS, 4)
    return np.concatenate([own[..., None], gamma, by_arm], axis=-1)


def infer_site(
    site: str, stiffest: NDArray, spread: NDArray, rng: np.random.Generator, proposals: int = PROPOSALS
) -> tuple[NDArray, list[str]]:
    """Draw the arms for posterior samples of the steady part; return draws (m, 5, 7) and report lines.

    One of ``proposals`` is taken per sample by its weight, so that the arms do not sway the steady part.

    Parameters
    ----------
    site : str
        ``palm``, ``thenar`` or ``forefinger``.
    stiffest, spread : ndarray, shape (n,)
        Posterior samples of the steady part: gamma1 of the stiffest subject [N/mm3] and the ratio of depths.
    rng : numpy.random.Generator
        Source of the proposals.
    proposals : int
        Combinations of arms tried for each sample.

    Returns
    -------
    draws : ndarray, shape (m, 5, 7)
        As :func:`subjects_of` gives them.
    lines : list of str
        What each statement excluded.
    """
    draws, judged, shares = [], [], []
    for block in np.array_split(np.arange(len(stiffest)), max(len(stiffest) // BLOCK, 1)):
        typical = np.repeat(stiffest[block] * spread[block] ** -1.5, proposals)
        arms = propose(typical, rng)
        statements = judge(site, typical, arms, rng)
        weight = weights(tuple(statements)).reshape(len(block), proposals)
        share = weight / weight.sum(axis=1, keepdims=True)
        chosen = (np.cumsum(share, axis=1) < rng.random((len(block), 1))).sum(axis=1)
        chosen = np.minimum(chosen, proposals - 1) + np.arange(len(block)) * proposals
        picked = {name: value[chosen] for name, value in arms.items()}
        draws.append(subjects_of(stiffest[block], spread[block], picked, rng))
        judged.append(statements)
        shares.append(share.ravel())
    return np.concatenate(draws), report(_merged(judged), np.concatenate(shares))


def _merged(parts: list) -> tuple[Statement, ...]:
    """Join the statements of several batches of samples."""
    return tuple(
        replace(same[0], holds=np.concatenate([statement.holds for statement in same])) for same in zip(*parts)
    )


def _tissue_from_draws(site: str, draws: NDArray, seed: int, samples: int) -> Tissue:
    """Make the tissue of a site from posterior draws (m, 5, 7), subjects by rising gamma1."""
    value = typical_subjects(draws)
    low, high = np.quantile(draws, [0.025, 0.975], axis=0)
    kinds = [("inferred", f"studies.tissues.infer --seed {seed} --samples {samples}")] * draws.shape[-1]
    subjects = tuple(
        subject_of(f"rank-{rank + 1}-of-{SUBJECTS}", value[rank], low[rank], high[rank], kinds)
        for rank in range(SUBJECTS)
    )
    return Tissue(site, TITLES[site], LAW, subjects, SOURCES, NOTES, "built-in")


def run(seed: int, samples: int, folder: Path, proposals: int = PROPOSALS) -> list[str]:
    """Infer all sites, write their files into ``folder`` and return the report's lines.

    Parameters
    ----------
    seed : int
        Of the generator of random numbers.
    samples : int
        Draws of the steady part.
    folder : Path
        Where the tissue files are written.
    proposals : int
        Combinations of arms tried for each sample of the steady part.
    """
    rng = np.random.default_rng(seed)
    parts = [sample_steady(min(samples - start, 20_000), rng) for start in range(0, samples, 20_000)]
    weight = np.concatenate([weights(part.statements) for part in parts])
    merged = _merged([part.statements for part in parts])
    effective = weight.sum() ** 2 / (weight**2).sum()
    lines = [f"steady state: {samples} samples, seed {seed}, effective number after weighting {effective:.0f}"]
    lines += report(merged, weight)
    lines += _stiffening_lines(merged, np.concatenate([part.unknowns.stiffening for part in parts]), weight)
    chosen = rng.choice(samples, size=STEADY, p=weight / weight.sum())
    for site in SITES:
        stiffest = np.concatenate([part.stiffest[site] for part in parts])[chosen]
        spread = np.concatenate([part.spread[site] for part in parts])[chosen]
        draws, notes = infer_site(site, stiffest, spread, rng, proposals)
        lines += ["", f"arms of the {site}: {STEADY * proposals} proposals", *notes]
        tissue = _tissue_from_draws(site, draws, seed, samples)
        summary = "\n".join(f'  "{line}",' for line in _summary(effective, merged, samples, seed))
        command = f"python -m studies.tissues.infer --seed {seed} --samples {samples}"
        extra = f'[inference]\ncommand = "{command}"\n'
        write_text(folder / f"{site}.toml", tissue_toml(tissue, f"{extra}summary = [\n{summary}\n]"))
        write_text(folder / f"{site}_draws.csv", draws_csv(draws[:: len(draws) // KEPT][:KEPT]))
    return lines


def _stiffening_lines(statements: tuple[Statement, ...], stiffening: NDArray, weight: NDArray) -> list[str]:
    """How often everything holds with and without strain stiffening of the resin, and what the posterior says."""
    together = np.all([statement.holds for statement in statements], axis=0)
    soft = stiffening == 0
    return [
        "a resin without strain stiffening (neo-Hookean), half of the samples: all statements at once "
        f"{together[soft].mean():.2g}, posterior share {weight[soft].sum() / weight.sum():.2g}",
        f"a stiffening resin: all statements at once {together[~soft].mean():.2g}",
    ]


def _summary(effective: float, statements: tuple, samples: int, seed: int) -> list[str]:
    held = np.array([statement.holds for statement in statements])
    return [
        f"{samples} samples, seed {seed}; effective number after weighting {effective:.0f}",
        f"all {len(statements)} statements on the steady state hold in {held.all(axis=0).mean():.2g} of them",
    ]


def main(arguments: list[str] | None = None) -> None:
    """Command line of the inference."""
    parser = argparse.ArgumentParser(prog="python -m studies.tissues.infer")
    parser.description = __doc__.split("\n")[0]
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--samples", type=int, default=200_000)
    parser.add_argument("--proposals", type=int, default=PROPOSALS, help="arms tried for each steady sample")
    parser.add_argument("--out", default=str(data_folder() / "materials" / "tissues"), help="folder of the files")
    options = parser.parse_args(arguments)
    folder = output_folder(options.out)
    print("\n".join(run(options.seed, options.samples, folder, options.proposals)))
    print(f"\nwritten to {folder}", file=sys.stderr)


if __name__ == "__main__":
    main()

"""The verdict on a pad that is only predicted: its curve and relaxation against a tissue, without a search."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dummydesign.design.assessment.castings import COUNT
from dummydesign.design.assessment.readings import reading_of
from dummydesign.design.request import PAPER, Protocol
from dummydesign.design.scoring.acceptability import ranges_of, readings_of, strict_aim
from dummydesign.design.scoring.presses import SAMPLES, Curves, Sampling, Slabs
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.targets import Targets, make_targets
from dummydesign.design.scoring.verdict import Verdict, verdict
from dummydesign.design.scoring.verdict_limits import verdict_limits
from dummydesign.design.search.slabs import Candidate
from dummydesign.resin.model.distribution import HALF_WIDTH

if TYPE_CHECKING:
    from dummydesign.pad.force_law import ForceCurve
    from dummydesign.pad.pad import Pad
    from dummydesign.tissue.model.tissue import Tissue

DRAWS, SEED = COUNT, 41


def verdict_of_pad(
    pad: Pad,
    curve: ForceCurve,
    young: dict[str, float],
    tissue: Tissue,
    aim: str = "average",
    sampling: Sampling | None = None,
    protocol: Protocol = PAPER,
) -> tuple[Verdict, Candidate, Targets]:
    """Press a pad by a test and judge it, with what is not known of its modulus and of the force.

    Parameters
    ----------
    pad : Pad
        Thickness, modulus and relaxation.
    curve : ForceCurve
        Its long-term elastic force over depth.
    young : dict
        ``value``, ``low`` and ``high`` of its modulus, 95 %. [kPa]
    tissue : Tissue
    aim : str
        ``average``, ``safe-side`` or ``subject:NAME``.
    sampling : Sampling, optional
        Hold and braking.
    protocol : Protocol
        Steady forces and speeds.

    Returns
    -------
    Verdict
    Candidate
        The pad as it was pressed.
    Targets
        What it was held against.
    """
    sampling = sampling or Sampling()
    thickness, limit = pad.thickness_mm, min(gel_limit_mm(pad), float(curve.limit_mm))
    depth = np.linspace(0.0, limit, SAMPLES)
    area = np.asarray(curve.force(depth), float) / pad.young_MPa
    area[0] = 0.0
    curves = Curves(np.array([thickness]), np.array([limit]), area[None])
    tau, beta = tuple(term.tau_s for term in pad.prony), np.array([[term.beta for term in pad.prony]])
    targets = make_targets(tissue, aim, sampling, protocol)
    slabs = Slabs(curves, np.array([0]), np.array([pad.young_MPa]), tau, beta.reshape(1, len(tau)))
    found = evaluate(slabs, targets, sampling, exact=True)
    candidate = Candidate(thickness, 0.0, 0, found, None, 0.0, 0.0)
    reached = found.depth_mm[0][np.isfinite(found.depth_mm[0])]
    error = float(np.nan_to_num(np.max(curve.relative_error(reached), initial=0.0))) if len(reached) else 0.0
    width = float(np.hypot(0.5 * np.log(young["high"] / young["low"]), error)) / HALF_WIDTH
    drawn = pad.young_MPa * np.exp(width * np.random.default_rng(SEED).standard_normal(DRAWS))
    every = Slabs(curves, np.zeros(DRAWS, int), drawn, tau, np.repeat(slabs.beta, DRAWS, axis=0))
    spread = readings_of(evaluate(every, targets, sampling.coarse))
    missing = len(reached) < found.depth_mm.shape[1]
    bound = [f"depth over thickness (at most {limit / thickness:.2f})"] if missing else []
    known = Slabs(curves, np.zeros(1, int), np.array([pad.young_MPa]), tau, slabs.beta)
    measured = readings_of(evaluate(known, targets, sampling.coarse))
    judged = verdict(
        ranges_of(targets), reading_of(candidate), spread, bound, of="pads with a modulus in its interval",
        strict=strict_aim(targets), measured=measured, limits=targets.limits,
    )  # fmt: skip
    return judged, candidate, targets


def gel_limit_mm(pad: Pad) -> float:
    """Depth at which the gel under the middle of the punch is compressed as far as the verdict allows. [mm]"""
    return float(verdict_limits().gel_compression * (pad.thickness_mm - pad.geometry.bone_height_mm))

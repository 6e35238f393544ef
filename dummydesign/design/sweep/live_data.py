"""What the live what-if page computes from: response tables, the resin on a grid of ratios, the subjects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

if TYPE_CHECKING:
    from dummydesign.design.scoring.presses import Sampling
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue

RATIOS = 401


def live_data(resin: Resin, tissue: Tissue | None, sampling: Sampling | None = None) -> dict[str, Any]:
    """What the page computes from: both response tables, the resin on a fine grid of ratios, the subjects.

    ln E and the strengths of the arms are linear between 401 ratios, which is within 0.01 % of the law.
    """
    from dummydesign.design.scoring.presses import Sampling
    from dummydesign.geometry.interface import BASES
    from dummydesign.pad.tables.slab import load_table
    from dummydesign.pad.tables.square import load_square

    sampling = sampling or Sampling()
    ratio = np.linspace(resin.ratio_min, resin.ratio_max, RATIOS)
    names = ("coefficients", "ratio_range", "depth_range")
    return {
        "tables": {base: _listed(load_table(base), *names, "limit_ratio", "limit_depth") for base in BASES},
        "squares": {base: _listed(load_square(base), *names, "reach_ratio", "reach_depth") for base in BASES},
        "resin": {
            "name": resin.name, "ratio": ratio.tolist(), "ln_young_MPa": np.log(resin.young_MPa(ratio)).tolist(),
            "tau_s": list(resin.tau_s), "beta": resin.strengths(ratio).T.tolist(),
        },
        "tissue": None if tissue is None else _tissue(tissue, sampling.hold_s),
        "protocol": {
            "hold_s": sampling.hold_s, "deceleration_mm_s2": sampling.deceleration_mm_s2,
            "fine": [sampling.ramp_points, sampling.brake_points, sampling.hold_points],
        },
    }  # fmt: skip


def _listed(table: object, *names: str) -> dict[str, Any]:
    """Arrays of a table as lists."""
    return {name: np.asarray(getattr(table, name)).tolist() for name in names}


def _tissue(tissue: Tissue, hold_s: float) -> dict[str, Any] | None:
    """The subjects and what the page computes their law by; None for a law that a page cannot compute."""
    from dummydesign.tissue.model.laws import law_named

    if tissue.measured:
        return _curves(tissue, hold_s)
    law = law_named(tissue.law).live
    if law is None:
        return None
    subjects = [
        {"gamma1": subject.gamma1_N_per_mm3, "gamma": list(subject.gamma_N_per_mm3),
         "speeds": list(subject.velocities_mm_s), "c": [list(dampers) for _, dampers in subject.c_N_s_per_mm]}
        for subject in tissue.parameter_sets
    ]  # fmt: skip
    return {"name": tissue.name, "law": law, "subjects": subjects}


def _curves(tissue: Tissue, hold_s: float) -> dict[str, Any]:
    """People as measured curves: steady curve at the end of the hold, and every press over its steady force."""
    from dummydesign.tissue.model.laws.curves import known_words
    from dummydesign.tissue.model.measured_curves import FORCE_FACTOR, SHARES, SPEED_FACTOR, MeasuredPerson, hold_times

    people = [cast(MeasuredPerson, one) for one in tissue.parameter_sets]
    law = {
        "measured": True, "ideal_ramp": False, "shares": SHARES.tolist(), "hold_times_s": hold_times(hold_s).tolist(),
        "force_apart": FORCE_FACTOR, "speed_apart": SPEED_FACTOR, "known": known_words(people, hold_s),
    }  # fmt: skip
    subjects = []
    for person in people:
        log_depth, log_force = person.steady_curve(hold_s)
        speeds = [
            {"v": speed, "force_N": known, "ln_depth": depths.tolist(), "over_steady": rows.tolist()}
            for speed in person.velocities_mm_s
            if (known := person.known_N(speed, min(hold_s, person.hold_known_s())))
            for depths, rows in [person.over_steady_at(speed, hold_s)]
        ]
        subjects.append({"ln_depth": log_depth.tolist(), "ln_force": log_force.tolist(), "speeds": speeds})
    return {"name": tissue.name, "law": law, "subjects": subjects}

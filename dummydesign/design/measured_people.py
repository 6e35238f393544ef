"""What the subjects of a tissue say of people below the peaks of a pad that was pressed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.measured_pad import peak_of
from dummydesign.design.scoring.people import (
    PeopleShares,
    ShareBelow,
    is_inferred,
    moved_tissues,
    reason_of,
    with_errors,
)
from dummydesign.design.scoring.targets import DRAWN
from dummydesign.tissue.model.people_share import Population
from dummydesign.tissue.model.ranges import force_ranges

if TYPE_CHECKING:
    from dummydesign.measurement.sensor import Lowpass
    from dummydesign.tissue.comparison import Comparison
    from dummydesign.tissue.model.tissue import Tissue


def shares_of_traces(comparison: Comparison, tissue: Tissue, lowpass: Lowpass | None = None) -> PeopleShares:
    """Return the share of people below the peaks of a pad, each press at its own force, speed, hold and braking.

    Repeats of a press are averaged.

    Parameters
    ----------
    comparison : Comparison
        Of the pad's traces with the tissue.
    tissue : Tissue
        The one of the comparison.
    lowpass : Lowpass, optional
        Filter that the traces went through.
    """
    count, inferred, reason = len(tissue.subjects), is_inferred(tissue), reason_of(tissue)
    if reason is not None:
        return PeopleShares(count, (), inferred, reason)
    noise = comparison.noise_N
    posterior = tissue.posterior(DRAWN)
    moved = [] if posterior else moved_tissues(tissue)
    kinds = [kind for kind, _ in moved]
    groups = [one.parameter_sets for one in (tissue, *posterior, *(one for _, one in moved))]
    rows = []
    for speed, pressed in comparison.conditions:
        forces, pads, subjects = list[float](), list[float](), list[NDArray]()
        for trace, _, braking in pressed:
            bands = force_ranges(groups, trace.steady_force_N, speed, trace.hold_s, braking, lowpass)
            forces.append(trace.steady_force_N)
            pads.append(peak_of(trace, noise))
            subjects.append(np.log([band.curves_N.max(axis=-1) for band in bands]))
        peak, peaks = float(np.mean(pads)), np.exp(np.mean(subjects, axis=0))
        people = Population.of_groups(peaks[1:]) if posterior else with_errors(peaks[0], list(peaks[1:]), kinds)
        low, high = (float(end) for end in people.interval_below(peak))
        exact = float(Population.of(peaks[0]).expected_below(peak))
        rows.append(ShareBelow(float(np.mean(forces)), speed, float(people.expected_below(peak)), (low, high), exact))
    return PeopleShares(count, tuple(rows), inferred)

"""A free mass on people who are measured curves: the depth at which their force has taken the mass's energy.

The curves are those of presses at the mass's own speed. A mass slows down, and what relaxes is then softer than at a
constant speed, so depths are at least what this gives; at most they are those on the steady curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.design.assessment.safety import Contact
from dummydesign.tissue.model.measured_curves import MeasuredPerson

if TYPE_CHECKING:
    from dummydesign.tissue.model.parameters import Parameters

FINE = 600
WORDS = (
    "Tissue: each subject stops it where the force measured at this speed, over depth, has taken its energy. A mass "
    "slows down, so subjects are deeper than that, and at most as deep as their steady curve makes them"
)


@dataclass(frozen=True)
class CurvesImpact:
    """Contact of every person, and in words how deep it may be, or why it is not known."""

    contact: Contact
    notes: tuple[str, ...]


def curves_impact(subjects: Sequence[Parameters], mass_kg: float, velocity_mm_s: float) -> CurvesImpact:
    """Stop a free mass on every person by the energy under the force-depth curve measured at its speed.

    Parameters
    ----------
    subjects : sequence of MeasuredPerson
        At least one.
    mass_kg, velocity_mm_s : float
        Of the mass at touch, above 0. [kg, mm/s]

    Returns
    -------
    CurvesImpact
        NaN for who takes less energy down to the deepest press at this speed.

    Raises
    ------
    InputError
        For a speed at which somebody was not pressed, with those at which all were.
    """
    for name, value in (("mass_kg", mass_kg), ("velocity_mm_s", velocity_mm_s)):
        if not (np.isfinite(value) and value > 0):
            raise out_of_range(name, value, "above 0", "any finite value")
    people = [cast(MeasuredPerson, one) for one in subjects]
    wanted = 0.5e-3 * mass_kg * velocity_mm_s**2
    rows, notes = [], []
    for person in people:
        curve = person.rise_at(velocity_mm_s)
        if curve is None:
            speeds = sorted(set.intersection(*(set(one.velocities_mm_s) for one in people)))
            raise InputError(
                f"robot_velocity_mm_s = {velocity_mm_s:g} is outside the speeds that were pressed, and measured curves "
                f"say nothing of others: all were pressed at {', '.join(f'{v:g}' for v in speeds)} mm/s"
            )
        depth, peak, taken = _stopped(*curve, wanted)
        rows.append((depth, wanted if np.isfinite(depth) else np.nan, peak))
        if not np.isfinite(depth):
            end = f"{taken:.3g} mJ to {curve[0][-1]:.2f} mm"
            notes.append(f"not stopped: it brings {wanted:.3g} mJ, the deepest press took {end}")
            continue
        at = np.linspace(0.0, curve[0][-1], FINE)
        rest = np.r_[0.0, person.steady_N(at[1:], np.inf)]
        most = _stopped(at, rest, wanted)[0]
        notes.append(f"at most {most:.2f} mm" if np.isfinite(most) else f"at rest deeper than {at[-1]:.2f} mm")
    depth, energy, peak = np.array(rows).T
    none = np.full(len(people), np.nan)
    return CurvesImpact(Contact(depth, energy, peak, none, none), tuple(notes))


def _stopped(depth_mm: NDArray, force_N: NDArray, energy_mJ: float) -> tuple[float, float, float]:
    """Depth at which a curve has taken an energy, the largest force up to there, and all that it takes; NaN beyond."""
    x = np.linspace(0.0, depth_mm[-1], FINE)
    force = np.interp(x, depth_mm, force_N)
    taken = np.r_[0.0, np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(x))]
    if taken[-1] < energy_mJ:
        return np.nan, np.nan, float(taken[-1])
    stop = float(np.interp(energy_mJ, taken, x))
    return stop, float(max(np.interp(stop, x, force), force[x <= stop].max())), float(taken[-1])

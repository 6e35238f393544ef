"""What a design is compared with: the tissue's ranges at each condition and the aim inside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.presses import Sampling

if TYPE_CHECKING:
    from dummydesign.tissue.model.parameters import Parameters
    from dummydesign.tissue.model.ranges import ForceRange
    from dummydesign.tissue.model.tissue import Tissue

FORCES_N = (5.0, 10.0, 15.0)
VELOCITIES_MM_S = (10.0, 250.0)
STEADY_GRID_N = np.linspace(5.0, 15.0, 41)
"""Steady forces at which the measured part of the range is scored. [N]"""
LOW_GRID_N = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0])
"""Steady forces of the part that was never measured; reported, not scored. [N]"""
NARROWEST = 0.15
"""Half-widths of bands are never taken below 15 %: a single subject has no band, but distances from it need
a scale on which a slab's unavoidable misfit still distinguishes better from worse."""


@dataclass(frozen=True)
class Condition:
    """One press of the protocol: the range of the subjects, and the aim's own curve on the same times."""

    steady_force_N: float
    velocity_mm_s: float
    range: ForceRange
    aim: ForceRange
    energy_mJ: tuple[float, float] = (np.nan, np.nan)
    """Energy of the rise, lowest and highest subject; NaN where a subject still moves when the range ends."""

    @property
    def aim_peak_N(self) -> float:
        """Peak of the aim. [N]"""
        return self.aim.peak_high_N

    @property
    def peak_half_width(self) -> float:
        """Half-width of the subjects' peaks in ln F."""
        return max(0.5 * float(np.log(self.range.peak_high_N / self.range.peak_low_N)), NARROWEST)


@dataclass(frozen=True)
class Targets:
    """A tissue, an aim, and the conditions of the protocol.

    Attributes
    ----------
    tissue : Tissue
    aim : str
        ``average``, ``safe-side`` or ``subject:NAME``.
    parameters : Parameters
        Of the aim.
    conditions : tuple of Condition
        Forces times speeds.
    """

    tissue: Tissue
    aim: str
    parameters: Parameters
    conditions: tuple[Condition, ...]

    def depth_range_mm(self, force_N: NDArray) -> tuple[NDArray, NDArray]:
        """Depth of the stiffest and the softest subject at steady forces. [mm]"""
        return self.tissue.steady_depth_range(force_N)

    def aim_depth_mm(self, force_N: NDArray) -> NDArray:
        """Depth of the aim at steady forces. [mm]"""
        return np.cbrt(np.asarray(force_N, float) / self.parameters.gamma1_N_per_mm3)

    @property
    def depth_half_width(self) -> float:
        """Half-width of the steady-state range in ln depth (the same at every force: all are cubic)."""
        stiff, soft = self.depth_range_mm(np.array([10.0]))
        return max(0.5 * float(np.log(soft[0] / stiff[0])), NARROWEST)


def make_targets(tissue: Tissue, aim: str, sampling: Sampling) -> Targets:
    """Compute the ranges of a tissue at every condition of the protocol.

    Parameters
    ----------
    tissue : Tissue
        Loaded tissue.
    aim : str
        ``average``, ``safe-side`` or ``subject:NAME``.
    sampling : Sampling
        Hold and braking of the robot.

    Raises
    ------
    InputError
        For an unknown aim or subject.
    """
    from dummydesign.tissue.model.ranges import force_range

    parameters = tissue.target(aim)
    conditions = []
    for velocity in VELOCITIES_MM_S:
        for force in FORCES_N:
            motion = (sampling.hold_s, sampling.deceleration_mm_s2)
            band = force_range((*tissue.parameter_sets, parameters), force, velocity, *motion)
            subjects = _part(band, slice(-1))
            energy = _energies(subjects, tissue.law, sampling)
            ends = float(energy.min()), float(energy.max())
            conditions.append(Condition(force, velocity, subjects, _part(band, slice(-1, None)), ends))
    return Targets(tissue, aim, parameters, tuple(conditions))


def subjects_press(band: ForceRange, law: str, sampling: Sampling) -> tuple[NDArray, NDArray, NDArray]:
    """Times, displacements and forces (subjects, n) of the subjects of a force range in their ramp and hold.

    Parameters
    ----------
    band : ForceRange
        Made with the hold and braking of ``sampling``.
    law : str
        Of the subjects; for one that knows ideal ramps only the displacement is that of the ideal ramp.
    sampling : Sampling
    """
    from dummydesign.tissue.model.laws import law_named
    from dummydesign.tissue.model.laws.ideal_ramp import ramps_of
    from dummydesign.tissue.model.ranges import interpolate_rows

    motion = sampling.motion(band.velocity_mm_s, band.depth_mm)
    grid = np.broadcast_to(band.time_s, band.curves_N.shape)
    forces = interpolate_rows(motion.time_s, grid, band.curves_N)
    displacement = motion.displacement_mm
    if law_named(law).ideal_ramp:
        contact, stop, depth = (values[:, None] for values in ramps_of(motion))
        displacement = depth * np.clip((motion.time_s - contact) / (stop - contact), 0.0, 1.0)
    return motion.time_s, displacement, forces


def _energies(band: ForceRange, law: str, sampling: Sampling) -> NDArray:
    """Energy of the rise of each subject. [mJ]"""
    _, displacement, force = subjects_press(band, law, sampling)
    energy = (0.5 * (force[:, 1:] + force[:, :-1]) * np.diff(displacement, axis=-1)).sum(axis=-1)
    return np.where(band.stop_s <= band.time_s[-1], energy, np.nan)


def _part(band: ForceRange, chosen: slice) -> ForceRange:
    """Some curves of a range with their own envelope: the aim's is no part of the subjects'."""
    from dataclasses import replace

    curves = band.curves_N[chosen]
    return replace(
        band,
        low_N=curves.min(axis=0),
        high_N=curves.max(axis=0),
        curves_N=curves,
        depth_mm=band.depth_mm[chosen],
        stop_s=band.stop_s[chosen],
    )

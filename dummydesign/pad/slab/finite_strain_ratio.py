"""How far a finite-strain viscoelastic pad departs from the quick (separable) prediction, on one and the same mesh.

The ratio of both forces is smooth, while each force needs the sharp-edge limit. So the ratio is computed with a
punch whose edge is a fillet of 0.025 of the smaller of punch radius and thickness (where that fails, twice as
large), and multiplies the prediction that rests on the sharp-edge limit. The departure itself depends on the
fillet: at 0.025 it is 2 to 14 % smaller than at 0.0125, at 0.05 another 4 to 20 %; see ``ratio_error``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.material.viscoelastic import Viscoelastic
from dummydesign.pad.slab.sharp_edge import Slab, rimmed_problem
from dummydesign.pad.solve.equilibrium import Problem
from dummydesign.pad.solve.motion_path import follow_motion

Array = np.ndarray

# Fillets that are tried in turn; a small one folds the corner too early on a pad that is thick and pressed deep.
RIMS = (0.025, 0.05, 0.1, 0.2)
LARGEST_STEP = 0.02
TOLERANCE = 5e-4
HOLD_GROWTH = 0.3


def ratio_error(rim: float) -> float:
    """Share of the viscous part of the force by which the ratio may be off with a fillet of this size.

    Half the fillet of 0.05 moves it by 0.01 to 0.02, half that of 0.025 by less than 0.01 (four presses of 5 to
    15 mm pads to d/h 0.2 to 0.4); half the time steps by 0.005.
    """
    return 0.02 * rim / RIMS[0]


class Watch(Protocol):
    """What looks at the states of a path: whether it may go on, and what is said of its end."""

    def look(self, depth: float, u: Array) -> str | None:
        """Why the path ends before the state at a depth, with displacements ``u``; None to go on."""

    def said(self, stop: str | None) -> str | None:
        """Why the path ended, from what it says of it itself."""


@dataclass(frozen=True)
class RatioPath:
    """Forces with one mesh at the times of a motion that were solved; unit mu h^2.

    ``elastic`` is that of the relaxed material, ``separable`` its convolution, ``force`` the finite-strain
    one; ``ratio`` is force over separable.
    """

    time_s: Array
    depth: Array
    elastic: Array
    separable: Array
    force: Array
    solver: dict[str, Any]

    @property
    def ratio(self) -> Array:
        """Force over separable force; 1 where there is next to no force."""
        tiny = np.abs(self.separable) <= 1e-6 * np.abs(self.separable).max()
        return np.where(tiny, 1.0, self.force / np.where(tiny, 1.0, self.separable))


def solve_ratio(
    slab: Slab,
    law: Law,
    prony: Sequence[PronyTerm],
    time_s: Array,
    depth: Array,
    *,
    poisson: float = 0.5,
    rims: Sequence[float] = RIMS,
    resolution: Resolution | None = None,
    progress: Callable[[float], None] | None = None,
) -> RatioPath:
    """Solve one motion twice on one mesh, with and without relaxation.

    Parameters
    ----------
    slab : Slab
        Slab and punch in thicknesses.
    law : Law
        Long-term law; only its shape counts.
    prony : sequence of PronyTerm
        Relative to the long-term modulus.
    time_s, depth : ndarray, shape (n,)
        Motion from the undeformed state (depth 0), depth in thicknesses. [s, -]
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    rims : sequence of float
        Fillet radii of the punch's edge over the smaller of punch radius and thickness; the first with which both
        solves get to the end is used.
    resolution : Resolution, optional
        Cells around the edge.
    progress : callable, optional
        Called with each solved depth.

    Raises
    ------
    NoAnswerError
        When a solve stops before the end with every fillet, with the last reason.
    """
    shape, arms, cells = law.scaled(1.0 / law.shear_MPa), tuple(prony), resolution or Resolution()
    inputs = {"slab": slab, "law": shape, "prony": arms, "time": time_s, "depth": depth, "poisson": poisson}
    inputs |= {"rims": rims, "resolution": cells}
    solve = partial(_solve_ratio, slab, shape, arms, time_s, depth, poisson, rims, cells, progress)
    return RatioPath(**cached("viscoelastic-ratio", inputs, solve))


def _solve_ratio(
    slab: Slab,
    shape: Law,
    prony: tuple[PronyTerm, ...],
    time_s: Array,
    depth: Array,
    poisson: float,
    rims: Sequence[float],
    cells: Resolution,
    progress: Callable[[float], None] | None,
) -> dict[str, Any]:
    """The fields of a RatioPath of a slab."""

    def problem(material: Law, rim: float) -> Problem:
        return rimmed_problem(slab, material, poisson, rim * slab.scale, cells)

    return vars(ratio_path(problem, shape, prony, time_s, depth, rims, 0.05 * slab.scale, progress))


def ratio_path(
    problem: Callable[[Any, float], Problem],
    shape: Law,
    prony: tuple[PronyTerm, ...],
    time_s: Array,
    depth: Array,
    rims: Sequence[float],
    largest_step: float,
    progress: Callable[[float], None] | None = None,
    watch: Callable[[Problem], Watch] | None = None,
) -> RatioPath:
    """Follow one motion with and without relaxation on the mesh of any pad.

    Parameters
    ----------
    problem : callable
        Makes the mesh, contact and supports from a law and a fillet radius, over the smaller of radius and thickness.
    shape : Law
        Long-term law of unit shear modulus.
    prony, time_s, depth, rims, progress
        As for :func:`solve_ratio`.
    largest_step : float
        Steps that go deeper than this are divided, in thicknesses.
    watch : callable, optional
        Makes what looks at the states of a problem; a pad that it refuses is not tried with another fillet.

    Raises
    ------
    NoAnswerError
        When a solve stops before the end with every fillet, with the last reason.
    """
    for rim in rims:
        paths, why = [], None
        for arms in ((), prony):
            made = problem(Viscoelastic(shape, arms), rim)
            seen = watch(made) if watch else None
            look = seen.look if seen else None
            paths.append(follow_motion(made, time_s, depth, largest_step, progress, look))
            why = seen.said(paths[-1].stop) if seen else paths[-1].stop
            if why:
                break
        if why is None or paths[-1].refused:
            break
    if why:
        raise NoAnswerError("no_convergence", f"the viscoelastic pad could not be followed: {why}")
    elastic, relaxing = paths
    solver = {
        "rim_over_scale": rim,
        "unknowns": elastic.unknowns,
        "load_steps": sum(path.load_steps for path in paths),
        "newton_iterations": sum(path.newton_iterations for path in paths),
        "seconds": sum(path.seconds for path in paths),
    }
    return RatioPath(
        time_s, depth, elastic.force, relaxed_force(time_s, elastic.force, prony), relaxing.force, solver
    )  # fmt: skip


def nodes_of_motion(
    time_s: Array, depth: Array, prony: Sequence[PronyTerm], fineness: int = 1
) -> tuple[Array, Array]:
    """Choose times of a motion to solve at: fine where it moves, growing in a hold.

    A step spans at most 0.02 thicknesses or a 16th of the largest depth, follows the motion within 5e-4
    thicknesses, and in a hold grows to 0.3 of the time since the motion ended; ``fineness`` divides all of
    these. The undeformed state stands where the punch is still less than 5e-4 thicknesses deep.

    Parameters
    ----------
    time_s, depth : ndarray, shape (n,)
        The motion, depth in thicknesses. [s, -]
    prony : sequence of PronyTerm
        The fastest one sets the first step where the motion begins below the surface.
    fineness : int
        By how much all steps are finer.

    Returns
    -------
    time_s, depth : ndarray
        The first depth is 0; negative depths are taken as 0.
    """
    depth = np.maximum(depth, 0.0)
    tolerance, largest = TOLERANCE / fineness, min(LARGEST_STEP, depth.max() / 16.0) / fineness
    first = int(np.argmax(depth > TOLERANCE))
    fastest = min((term.tau_s for term in prony), default=1.0)
    if first == 0:
        time_s, depth = np.r_[time_s[0] - 1e-6 * fastest, time_s], np.r_[0.0, depth]
        first = 1
    start = first - 1
    depth = np.where(np.arange(len(depth)) == start, 0.0, depth)
    keep, moved_at = [start], time_s[start]
    while keep[-1] < len(time_s) - 1:
        at, end = keep[-1], keep[-1] + 1
        longest = max(0.25 / fineness * fastest, HOLD_GROWTH / fineness * (time_s[at] - moved_at))
        while end < len(time_s) - 1:
            trial = end + 1
            between = slice(at + 1, trial)
            chord = np.interp(time_s[between], time_s[[at, trial]], depth[[at, trial]])
            moving = abs(depth[trial] - depth[at]) > tolerance
            if np.abs(depth[between] - chord).max() > tolerance or abs(depth[trial] - depth[at]) > largest:
                break
            if not moving and time_s[trial] - time_s[at] > longest:
                break
            end = trial
        if abs(depth[end] - depth[at]) > tolerance:
            moved_at = time_s[end]
        keep.append(end)
    return time_s[keep], depth[keep]

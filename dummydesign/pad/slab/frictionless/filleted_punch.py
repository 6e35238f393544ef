"""Force of a slab under a round flat punch with a filleted edge along which its face slides without friction.

The face slides round the fillet and up the punch's side, so the mesh's columns follow the fillet (``moving_mesh``).
Where it goes round the fillet it is stretched, the more the deeper, and on finer cells without a bound that was found:
fine cells end before coarse ones, whose forces differ little and which go on.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.threads import one_blas_thread
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.filleted import check_fillet
from dummydesign.pad.slab.frictionless.moving_mesh import SlidingMesh
from dummydesign.pad.slab.problem import PadCurve, Slab, normalise
from dummydesign.pad.slab.solved_depths import LATTICE, curve_through, lattice_depths, of_two_meshes
from dummydesign.pad.solve.continuation import EASY, Path
from dummydesign.pad.solve.equilibrium import Failure, Solution, find_equilibrium

Array = np.ndarray

# Cells over the fillet of the two meshes.
COARSE, FINE = 2, 3
SMALLEST_STEP = LATTICE / 128.0
# Error of contact, steps and the energy term; beside the step between the meshes, doubled where the fine one has ended.
LEAST_ERROR = 3e-3


def solve_sliding(
    thickness_mm: float,
    radius_mm: float,
    fillet_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    *,
    base: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float = PAD_EXTENT_MM,
    law: Law | None = None,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a slab under a round punch with a filleted edge whose face, fillet and side are frictionless.

    Parameters
    ----------
    thickness_mm, radius_mm, fillet_mm, young_MPa, depth_mm, base, poisson, extent_mm, law, progress
        As for :func:`dummydesign.pad.slab.filleted.solve_filleted`.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` says why if some are missing. The stated error is what cells
        of 1.5 times the size change, twice the largest of it where only those got to, and 0.3 %.

    Raises
    ------
    InputError
        For a value outside its range.
    NoAnswerError
        When no depth could be solved.
    """
    shape, depths, ratio, unit = normalise(thickness_mm, radius_mm, young_MPa, depth_mm, poisson, law)
    check_fillet(fillet_mm, radius_mm)
    slab, fillet = Slab(ratio, extent_mm / thickness_mm, base), fillet_mm / thickness_mm
    nodes = lattice_depths(float(depths[-1]))
    inputs = {"slab": slab, "fillet": fillet, "law": shape, "poisson": poisson, "depths": nodes}
    found = cached("sliding", inputs, lambda: _solve(slab, shape, poisson, fillet, nodes, progress))
    return curve_through(nodes, found, depths, thickness_mm, unit)


def _solve(
    slab: Slab, law: Law, poisson: float, fillet: float, nodes: Array,
    progress: Callable[[float], None] | None,
) -> dict[str, Any]:  # fmt: skip
    """F / d over mu h at the first of the nodes, those that were reached, and its relative error."""
    coarse, fine = (
        follow_sliding(SlidingMesh(slab, law, poisson, fillet, cells), nodes, progress) for cells in (COARSE, FINE)
    )
    return of_two_meshes(coarse, fine, nodes, LEAST_ERROR)


@one_blas_thread()
def follow_sliding(
    mesh: SlidingMesh, depths: Array, progress: Callable[[float], None] | None = None,
    visit: Callable[[float, Solution], None] | None = None,
) -> Path:  # fmt: skip
    """Follow the slab through depths while the mesh's columns follow the fillet.

    The next state is carried on from the last two in the frame of the punch, in which it hardly changes.

    Parameters
    ----------
    mesh : SlidingMesh
    depths : ndarray, shape (n,)
        Increasing, in thicknesses; every one is met.
    progress : callable, optional
        Called with each solved depth.
    visit : callable, optional
        Called with each of the depths and its solution, while the mesh's columns stand as in that state.

    Returns
    -------
    Path
        ``stop`` says how far the face is stretched over the fillet where it ended.
    """
    began = time.perf_counter()
    problem = mesh.problem
    u, p = problem.start()
    rate = problem.direction()
    places = problem.solid.mesh.nodes.T + u.reshape(-1, 2)
    earlier: tuple[float, float, Array, Array] | None = None
    depth, here, step, stop, stretch = 0.0, mesh.edge, float(depths[0]), None, 1.0
    found: list[tuple[float, float, float]] = []
    steps = iterations = 0
    while len(found) < len(depths) and stop is None:
        remaining = depths[len(found)] - depth
        goal = float(depths[len(found)] if remaining <= 1.25 * step else depth + min(step, 0.5 * remaining))
        if earlier is None:
            ahead = goal - depth
            edge, guess, pressure = here, places + ahead * rate[0].reshape(-1, 2), p + ahead * rate[1]
        else:
            ahead = min((goal - depth) / (depth - earlier[0]), 5.0)
            edge = here + ahead * (here - earlier[1])
            guess, pressure = places + ahead * (places - earlier[2]), p + ahead * (p - earlier[3])
            edge, guess = mesh.better(edge, guess, goal)
        mesh.move(edge)
        nodes = problem.solid.mesh.nodes.T
        answer = find_equilibrium(problem, (guess - nodes).ravel(), pressure, goal)
        iterations += answer.iterations
        if isinstance(answer, Failure):
            step = 0.5 * (goal - depth)
            if step < SMALLEST_STEP:
                stop = (
                    f"{answer.reason}; at relative depth {depth:.3f} the face is {stretch:.1f} times as long where it "
                    "slides round the fillet; under a larger fillet it gets further"
                )
            continue
        earlier = (depth, here, places, p)
        depth, here, p, places = goal, edge, answer.p, nodes + answer.u.reshape(-1, 2)
        stretch = mesh.stretch(answer.u, depth)
        steps += 1
        if goal >= depths[len(found)] * (1.0 - 1e-12):
            found.append((goal, problem.force(answer.state), float(answer.state.J.min())))
            if visit:
                visit(goal, answer)
            if progress:
                progress(goal)
        if answer.iterations <= EASY:
            step = min(1.4 * step, LATTICE)
    table = np.array(found).reshape(-1, 3)
    return Path(
        table[:, 0], table[:, 1], table[:, 2], problem.pattern.n, steps, iterations, time.perf_counter() - began, stop
    )

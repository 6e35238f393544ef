"""Where points that come to touch within a load step are tied: at the place where their gap closed.

A point that sticks stays where it first touched. Tied where it is at the end of a step it has slid on for the rest of
it, and forces depend on the step: by 3 % on a crowned pad with steps of 0.03 of the thickness.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

Array = np.ndarray


class Contact(Protocol):
    """What a problem needs of a surface that touches: its unknowns, its forces, and what it remembers."""

    dofs: Array

    def settle(self, u: Array, punch: Any, depth: float) -> None:
        """Take the state at the end of a step as that from which the next one starts.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes, in the mesh's unit of length.
        punch : Punch
            Gives gap, normal and curvature at places; a plate of its own does without.
        depth : float
            How far the punch has come, in the same unit.
        """

    def forces(self, u: Array, punch: Any, depth: float) -> tuple[Array, Array]:
        """Internal force (full length) and its derivative (per side).

        Parameters
        ----------
        u, punch, depth
            As for :meth:`settle`.

        Returns
        -------
        force : ndarray, shape (displacements,)
        derivative : ndarray, shape (sides, dofs, dofs)
        """
        ...

    def begin(self) -> None:
        """Go back to what was tied at the last accepted step."""

    def tie(self, u: Array, punch: Any, depth: float) -> bool:
        """Tie what came to touch in this step; True when there is something new.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes, in the mesh's unit of length.
        punch : Punch
            Gives gap, normal and curvature at places; a plate of its own does without.
        depth : float
            How far the punch has come, in the same unit.
        """
        ...

    def memory(self) -> Any:
        """What is tied, for :meth:`restore`."""

    def restore(self, memory: Any) -> None:
        """Take back what was tied."""


class NoTies:
    """What contact does that ties nothing within a step."""

    def begin(self) -> None:
        """Go back to what was tied at the last accepted step."""

    def tie(self, u: Array, punch: Any, depth: float) -> bool:
        """Tie what came to touch in this step; True when there is something new.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes, in the mesh's unit of length.
        punch : Punch
            Its gap says what touches.
        depth : float
            How far the punch has come, in the same unit.
        """
        return False

    def memory(self) -> Any:
        """What is tied, for :meth:`restore`."""

    def restore(self, memory: Any) -> None:
        """Take back what was tied."""


def closure(r: Array, held: Array, touching: Array, room: Array) -> Array:
    """Share of a load step at which each point's gap closed; 1 where it did not.

    Where a contact grows on from points held before, its edge is taken to move evenly; a contact of its own is
    taken to close as its gaps were.

    Parameters
    ----------
    r : ndarray, shape (n,)
        Places along the surface, increasing.
    held, touching : ndarray of bool, shape (n,)
        What touched before and after the step.
    room : ndarray, shape (n,)
        Gap before the step.
    """
    share = np.ones(len(r))
    new = touching & ~held
    if not new.any():
        return share
    edges = np.diff(np.concatenate([[0], new.astype(int), [0]]))
    for first, last in zip(np.nonzero(edges == 1)[0], np.nonzero(edges == -1)[0] - 1):
        inside = slice(first, last + 1)
        left = first > 0 and held[first - 1] and touching[first - 1]
        right = last + 1 < len(r) and held[last + 1] and touching[last + 1]
        start = 0.5 * (r[first] + r[first - 1]) if first > 0 else r[first]
        stop = 0.5 * (r[last] + r[last + 1]) if last + 1 < len(r) else r[last]
        if left != right and stop > start:
            along = (r[inside] - start) / (stop - start)
            share[inside] = along if left else 1.0 - along
        else:
            ends = [room[k] for k in (first - 1, last + 1) if 0 <= k < len(r) and not touching[k]]
            widest = max([*ends, room[inside].max(), 1e-300])
            share[inside] = np.clip(room[inside] / widest, 0.0, 1.0)
    return share

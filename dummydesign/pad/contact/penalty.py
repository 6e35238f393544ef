"""Contact stiffness of all solves, and where points tie within a load step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Penalty:
    """How hard faces are kept apart, and points that stick are held."""

    contact: float
    grip_share: float
    over: str
    reason: str


GLUED_SLAB = Penalty(3000.0, 0.1, "rim", "ten times either moves the sharp-edge limit by less than 0.1 %")
BEADED_SQUARE = Penalty(1000.0, 0.3, "bead", "not varied alone; what a bead leaves is fitted and stated")
SLIDING_EDGE = Penalty(300.0, 1.0, "cell", "an edge that slides does not converge with a stiffer one")
PROFILE_PUNCH = Penalty(2000.0, 1.0, "cell", "no edge; not varied alone, half the cells move forces by 0.2 % at most")
ROUND_SHAPED_PAD = Penalty(2000.0, 0.1, "cell", "four times as stiff: 0.1 to 0.4 %, past the punch's edge up to 1.4 %")
SHAPED_PAD_IN_SPACE = Penalty(1000.0, 0.3, "cell", "not varied alone; the mesh as a whole is in the stated error")
RESTING_BASE = Penalty(3e4, 1.0, "thickness", "twice as stiff moves the force by less than 0.1 %")
FILLETED_PUNCH = Penalty(750.0, 1.0, "fillet", "half of it on cells of twice the size: extrapolated with them")
RUBBING_PUNCH = Penalty(750.0, 0.4, "fillet", "that of the glued fillet; 2.5 times the grip moves the force by 0.2 %")
PUCK_PLATES = Penalty(1e5, 1.0, "height", "penetration stays 1e-5 heights times the pressure in shear moduli")


Array = np.ndarray


class ContactSurface:
    """What a problem needs of a surface that touches: its unknowns, its forces, and what it remembers.

    This one remembers nothing and ties nothing within a step.
    """

    dofs: Array
    # Changes of contact that a step of the linearised solid may meet before the next state.
    changes = 0

    def forces(self, u: Array, punch: Any, depth: float) -> tuple[Array, Array]:
        """Internal force (full length) and its derivative (per side)."""
        raise NotImplementedError

    def pressed(self, u: Array, punch: Any, depth: float) -> tuple[Array, Callable[[], Array]]:
        """Internal force, and what gives its derivative: most states are left before anybody asks for it."""
        force, matrix = self.forces(u, punch, depth)
        return force, lambda: matrix

    def settle(self, u: Array, punch: Any, depth: float) -> None:
        """Take the state at the end of a step as that from which the next one starts."""

    def begin(self) -> None:
        """Go back to what was tied at the last accepted step."""

    def tie(self, u: Array, punch: Any, depth: float) -> bool:
        """Tie what came to touch in this step; True when there is something new."""
        return False

    def memory(self) -> Any:
        """What is tied, for :meth:`restore`."""

    def restore(self, memory: Any) -> None:
        """Take back what was tied."""


def closure(r: Array, held: Array, touching: Array, room: Array, *, grown: float = 1.0) -> Array:
    """Share of a load step at which each point's gap closed; 1 where it did not.

    Where a contact grows on from points held before, its edge is taken to move evenly, and ``grown`` is a factor of the
    share; a contact of its own is taken to close as its gaps were.
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
            share[inside] = grown * (along if left else 1.0 - along)
        else:
            ends = [room[k] for k in (first - 1, last + 1) if 0 <= k < len(r) and not touching[k]]
            widest = max([*ends, room[inside].max(), 1e-300])
            share[inside] = np.clip(room[inside] / widest, 0.0, 1.0)
    return share

"""A round pad under the circle of a punch's area, solved in a meridian plane beside a solve in space.

Cells in space are large at the punch's edge and round a foot that is narrow beside them, and their punch has a fillet.
Those in a plane resolve both at little cost. Solved once more on lines like those in space, the plane says what cells
and fillet do there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.pad.axisymmetric.case import Case, padded, unsolved
from dummydesign.pad.axisymmetric.self_contact import FOLDED
from dummydesign.pad.axisymmetric.shaped_pad import last_known, sharp
from dummydesign.pad.axisymmetric.shaped_problem import CELLS, RIMS, climb, meshed, shaped_problem
from dummydesign.pad.solve.continuation import follow

Array = np.ndarray

# Largest step over the smaller of radius and thickness, as in space.
LARGEST_STEP = 0.05


@dataclass(frozen=True)
class RoundTwin:
    """Force under a sharp edge at the depths, over the thickness, at which the pad is open.

    ``stop`` says why others are left out.
    """

    case: Case
    depths: Array
    force: Array
    stop: str | None

    @classmethod
    def solve(cls, case: Case, depths: Array) -> RoundTwin:
        """Follow both fillets that stand for a sharp edge."""
        case, deepest = meshed(case), float(depths[-1])
        small = climb(case, deepest, CELLS, RIMS[1])
        large = climb(case, deepest, CELLS, RIMS[0], smaller=small)
        why = large.path.stop or ""
        open_ones = depths[depths <= large.reached] if why.startswith(FOLDED) else depths
        if not len(open_ones):
            raise unsolved(why)
        force, _ = sharp(*(padded(path.at(open_ones), len(open_ones)) for path in (large, small)))
        stop = f"under the circle of the punch's area {why}" if len(open_ones) < len(depths) else None
        return cls(case, open_ones, force, stop)

    def change_on(self, lines: tuple[Array, Array], cells: int, rim: float, step: float = LARGEST_STEP) -> Array:
        """ln of the force over that on other lines under a punch with a fillet, held where not known.

        Parameters
        ----------
        lines : (ndarray, ndarray)
            Radii and shares of the column.
        cells : int
            Under the punch, for the stiffness of the contact.
        rim : float
            Fillet over the smaller of radius and thickness.
        step : float
            Largest load step over the same.
        """
        first = 0.25 * float(self.depths[0])
        problem = shaped_problem(self.case, cells, rim, lines=lines)
        path = follow(problem, self.depths, first, step * self.case.scale, first / 64.0)
        return last_known(np.log(self.force / padded(path, len(self.depths))), 0.0)

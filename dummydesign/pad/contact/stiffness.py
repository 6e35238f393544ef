"""Contact stiffness of all solves: pressure over penetration, in shear moduli over a length of the mesh.

Contact is a penalty: faces pass into each other by pressure over stiffness. A stiffer one is nearer to hard contact,
a softer one converges where points come to touch or slip. One table, with the length and the reason of each.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Penalty:
    """How hard faces are kept apart, and points that stick are held.

    Attributes
    ----------
    contact : float
        Pressure over penetration, in shear moduli over ``over``.
    grip_share : float
        What holds a sticking point (or the film of a glued face) along the face, as a share of ``contact``.
    over : str
        The length.
    reason : str
    """

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
FILLETED_PUNCH = Penalty(750.0, 1.0, "fillet", "half of it on cells of twice the size: carried on with them")
RUBBING_PUNCH = Penalty(750.0, 0.4, "fillet", "that of the glued fillet; 2.5 times the grip moves the force by 0.2 %")
PUCK_PLATES = Penalty(1e5, 1.0, "height", "penetration stays 1e-5 heights times the pressure in shear moduli")

"""An arm of finite stiffness and mass that executes the command which the trace implies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.person.drives.drive import (
    DAMPING,
    DAMPINGS,
    FASTER,
    MASS,
    MASSES,
    STIFFNESS,
    STIFFNESSES,
    RobotDrive,
    TraceSigns,
)
from dummydesign.person.integrate import RINGS, TOLERANCE, Input, PersonResponse, run_robot
from dummydesign.person.people import People
from dummydesign.person.press import Press
from dummydesign.person.smoothing import RobotArm
from dummydesign.person.validity_range import short_number

STEPS, FEWER = 48.0, 32.0
"""Steps a period of the arm after the stop, with curves and for draws. They are even: steps that grow and shrink with
the ringing would drive it."""


class SpringDrive(RobotDrive):
    """M x'' = K (x_c - x) + D (x_c' - x') - F with the command x_c that the trace on the pad implies.

    D is 2 zeta sqrt(K M) of the damping ratio zeta, 0 by itself.
    """

    name, form = "spring", "spring:N_PER_MM,KG[,DAMPING_RATIO]"
    numbers = ((STIFFNESS, STIFFNESSES), (MASS, MASSES), (DAMPING, DAMPINGS))
    defaults = (0.0,)
    words = "an arm with a spring and a mass that gets the same command on people as on the pad"

    def contradicted(self, signs: TraceSigns) -> str:
        """Where such an arm would have followed the force as it relaxed, and the path was kept."""
        if signs.creep_mm is None or signs.relaxed_N is None:
            return ""
        follows = signs.relaxed_N / self.values[0]
        if follows > 2.0 * signs.kept_mm and abs(signs.creep_mm) < follows / 3.0:
            moved = f"{signs.creep_mm:.2g} mm" if abs(signs.creep_mm) >= 0.005 else "less than 0.01 mm"
            fell = f"the force fell by {short_number(signs.relaxed_N, 2)} N in the hold and the punch moved {moved}"
            return f"{fell}; an arm of {self.values[0]:g} N/mm moves {short_number(follows, 2)} mm"
        return ""

    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Integrate from contact to the end of the hold, in the difference to the path on the pad."""
        return press_by_spring(press, people, self.arm, keep)

    @property
    def arm(self) -> RobotArm:
        """Stiffness, mass and damping."""
        return RobotArm(*self.values)


def press_by_spring(press: Press, people: People, arm: RobotArm, keep: bool = True) -> PersonResponse:
    """Press people by a spring and a mass; a stiffness of 0 leaves the mass with the force that acted on it."""
    count, nodes = len(people), press.time_s
    even, calm = arm.period_s / (STEPS if keep else FEWER), press.stop_s + RINGS * arm.period_s

    def longest(time: float) -> float:
        at = int(np.searchsorted(nodes, time * (1.0 + 1e-9) + 1e-12, side="right"))
        left = float(nodes[min(at, len(nodes) - 1)] - time)
        return left if not press.stop_s <= time < calm or left <= even else left / int(np.ceil(left / even - 1e-6))

    scale = np.full(count, float(np.max(press.depth_mm)))
    return run_robot(
        people,
        arm,
        _between_nodes(press),
        float(nodes[-1]),
        np.zeros(count),
        scale,
        longest,
        keep=keep,
        late_s=press.late_from_s,
        loose_after_s=press.stop_s,
        mean_from_s=press.mean_from_s,
        tolerance=TOLERANCE * (1.0 if keep else FASTER),
        lost_mm_s=press.lost_mm_s,
    )


def _between_nodes(press: Press) -> Input:
    """Force and path of the pad, linear between the nodes."""
    nodes = press.time_s

    def given(time: float) -> tuple[NDArray, NDArray]:
        at = min(max(int(np.searchsorted(nodes, time)), 1), len(nodes) - 1)
        share = float((time - nodes[at - 1]) / (nodes[at] - nodes[at - 1]))
        force, path = (
            row[..., at - 1] + share * (row[..., at] - row[..., at - 1]) for row in (press.force_N, press.x_mm)
        )
        return force, path

    return given

"""What is verified of contact: crowns against GetFEM, a program that has contact, and friction under a fillet."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
from dummydesign.pad.fields import solve_fields
from dummydesign.pad.force_source import solve_points
from dummydesign.pad.pad_under_punch import Pad
from studies.verification.check import Check
from studies.verification.edges import PRESSURE

FRICTION = "Friction under a filleted edge"
GETFEM = "GetFEM 5.4.2, its steps carried to none (benchmarks/accuracy/pad_getfem.py)"
# Force in N by d/h, and by depth in mm; punch of 15.8 mm, 30 kPa, pad of radius 75.7 mm.
GLUED_CROWN_N = {0.1: 0.25697, 0.15: 0.73717, 0.2: 1.74405, 0.25: 3.62345, 0.3: 6.0923}
FREE_CROWN_N = {0.1: 0.011969, 0.2: 0.035734, 0.4: 0.109963}


def crowns_by_getfem() -> Iterator[Check]:
    """The forefinger's crown under a filleted punch, glued where it touches, and a crown without friction."""
    share = np.array(list(GLUED_CROWN_N))
    crown = Pad(4.5, 0.03, 7.9, extent_mm=75.7, edge_radius_mm=0.5, geometry=Crowned(21.2, 2.0, 9.4))
    for d, expected, state in zip(share, GLUED_CROWN_N.values(), solve_fields(crown, (4.5 * share).tolist())[0]):
        name = f"crowned pad of 4.5 mm, fillet 0.5 mm, 30 kPa, d/h {d:g}, N"
        yield Check(PRESSURE, name, expected, state.force_N, 0.01, GETFEM)
    dome = Crowned(40.0, 1.5, 11.0)
    plain = Pad(20.0, 0.03, 7.9, extent_mm=75.7, condition="frictionless", geometry=dome)
    for depth, expected, state in zip(FREE_CROWN_N, FREE_CROWN_N.values(), solve_fields(plain, list(FREE_CROWN_N))[0]):
        name = f"crown of 20 mm without friction, {depth:g} mm, N"
        yield Check(PRESSURE, name, expected, state.force_N, 0.01, GETFEM)


def friction_under_a_fillet() -> Iterator[Check]:
    """Much friction is glue, little tends to none, and fields carry the curve's force."""
    for h, share in ((5.0, 0.3), (10.0, 0.3), (20.0, 0.3)):
        rubbing, glued = (
            solve_under_fillet(Pad(h, 0.025, 7.9, condition=face, edge_radius_mm=0.5), [0.1 * h, share * h])
            for face in ("friction:5", "bonded")
        )
        stated = sum(float(one.error_N[-1] / one.force_N[-1]) for one in (rubbing, glued))
        name = f"{h:g} mm, fillet 0.5 mm, d/h {share:g}, N: friction 5, 25 kPa"
        source = "the glued face; tolerance: the errors that both state"
        yield Check(FRICTION, name, float(glued.force_N[-1]), float(rubbing.force_N[-1]), stated, source)
    little = [
        solve_under_fillet(
            Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5, condition=f"friction:{friction}"), [1.0, 2.0]
        ).force_N
        for friction in (0.05, 0.1)
    ]
    none = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5, condition="frictionless"), [1.0, 2.0]).force_N
    for depth, expected, value in zip((0.1, 0.2), none, 2.0 * little[0] - little[1]):
        name = f"10 mm, fillet 0.5 mm, d/h {depth:g}, N: friction 0.05 and 0.1 carried to 0"
        yield Check(FRICTION, name, float(expected), float(value), 0.01, "the frictionless face, on its own mesh")
    from scipy.integrate import trapezoid

    pad = Pad(10.0, 0.025, 7.9, condition="friction:0.3", edge_radius_mm=0.5)
    face = solve_fields(pad, [2.0])[0][0].face
    # Drag is counted along the face outwards; on the fillet it presses as well.
    pressing = 2.0 * np.pi * face.radius_mm * np.stack([face.pressure_MPa, -face.shear_MPa])
    value = float(trapezoid(pressing[0], face.radius_mm) + trapezoid(pressing[1], face.height_mm))
    expected = float(solve_points(pad, np.array([2.0])).force_N[0])
    name = "friction 0.3, 10 mm, d/h 0.2, N: pressure and drag over the face"
    yield Check(FRICTION, name, expected, value, 0.01, "the curve's force")


CHECKS = (crowns_by_getfem, friction_under_a_fillet)

"""Every solve takes its contact stiffness from the one table."""

from dummydesign.pad.axisymmetric import case as problem
from dummydesign.pad.axisymmetric import filleted, puck
from dummydesign.pad.axisymmetric import friction as rubbing
from dummydesign.pad.axisymmetric import profile_punch as indentation
from dummydesign.pad.axisymmetric import shaped_problem as round_pad
from dummydesign.pad.contact import friction as resting_base
from dummydesign.pad.contact import penalty as stiffness
from dummydesign.pad.spatial import shaped_pad as spatial
from dummydesign.pad.spatial import square_punch as square_beaded


def test_each_solve_has_the_penalty_of_its_line_and_each_line_its_reason():
    lines = {name: value for name, value in vars(stiffness).items() if isinstance(value, stiffness.Penalty)}
    assert all(line.contact > 0.0 and 0.0 < line.grip_share <= 1.0 and line.reason for line in lines.values())
    taken = {
        "GLUED_SLAB": problem.CONTACT_STIFFNESS,
        "BEADED_SQUARE": square_beaded.CONTACT_STIFFNESS,
        "SLIDING_EDGE": indentation.EDGE_STIFFNESS,
        "PROFILE_PUNCH": indentation.SHAPED_STIFFNESS,
        "ROUND_SHAPED_PAD": round_pad.CONTACT_STIFFNESS,
        "SHAPED_PAD_IN_SPACE": spatial.CONTACT_STIFFNESS,
        "RESTING_BASE": resting_base.CONTACT_STIFFNESS,
        "FILLETED_PUNCH": filleted.FILLETED_PUNCH.contact,
        "RUBBING_PUNCH": rubbing.RUBBING_PUNCH.contact,
        "PUCK_PLATES": puck.CONTACT_STIFFNESS,
    }
    assert taken == {name: line.contact for name, line in lines.items()}
    assert (problem.FILM_STIFFNESS, square_beaded.GRIP_STIFFNESS) == (300.0, 300.0)

"""Every solve takes its contact stiffness from the one table."""

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.pad.axisymmetric import case as problem
from dummydesign.pad.axisymmetric import filleted
from dummydesign.pad.axisymmetric import profile_punch as indentation
from dummydesign.pad.axisymmetric import shaped_problem as round_pad
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.contact import axisymmetric as stiffness
from dummydesign.pad.contact.axisymmetric import FlatPunch
from dummydesign.pad.spatial import shaped_pad as spatial
from dummydesign.pad.spatial import square_punch as square_beaded


def test_each_penalty_has_its_reason():
    lines = {name: value for name, value in vars(stiffness).items() if isinstance(value, stiffness.Penalty)}
    assert all(line.contact > 0.0 and 0.0 < line.grip_share <= 1.0 and line.reason for line in lines.values())
    assert (problem.FILM_STIFFNESS, square_beaded.GRIP_STIFFNESS) == (300.0, 300.0)


CASE = Case(0.8, 2.4, condition="frictionless", edge=0.1)
ROUND = {
    "ROUND_SHAPED_PAD": (lambda: round_pad.shaped_problem(Case(0.8, 2.4, condition="frictionless"), 8), 0.8 / 8),
    "PROFILE_PUNCH": (
        lambda: indentation.indentation_problem(
            FlatPunch(0.8, 0.1), indentation.Region(0.5, 1.0, 0.05), CASE, stiffness.PROFILE_PUNCH
        ),
        0.05,
    ),
    "SLIDING_EDGE": (lambda: indentation.edge_problem(CASE), 0.1 / 3.0),
    "RUBBING_PUNCH": (lambda: filleted.rubbing_problem(replace(CASE, condition="friction:0.3"), 2), 0.1),
    "FILLETED_PUNCH": (lambda: filleted.SlidingMesh(CASE, 2).problem, 0.1),
}


@pytest.mark.parametrize("name", ROUND)
def test_a_round_punch_pushes_back_by_its_penalty_times_depth_and_area(name):
    """So little deep that fillet and film count for nothing: contact mu / length times pi times the flat's radius^2."""
    make, over = ROUND[name]
    problem, depth = make(), 1e-7
    force = problem.surface.forces(np.zeros(problem.solid.mesh.size), problem.punch, depth)[0]
    area = np.pi * problem.punch.flat_radius**2
    assert force[1::2].sum() == pytest.approx(getattr(stiffness, name).contact / over * depth * area, rel=0.03)


def test_a_punch_in_space_pushes_back_by_its_penalty_times_depth_and_area():
    grid = spatial.GridFineness(3, 0.2, 1.0, 2.5)
    load = spatial.Load((0.8, 0.6), (2.4, 2.0), condition="frictionless", thickness_mm=10.0)
    problem, depth = spatial.shaped_problem(load, grid), 1e-7
    force = problem.surface.forces(np.zeros(problem.solid.mesh.size), problem.punch, depth)[0]
    area = (0.8 - 0.12) * (0.6 - 0.12)
    wanted = stiffness.SHAPED_PAD_IN_SPACE.contact / (0.6 / 3) * depth * area
    assert force[2::3].sum() == pytest.approx(wanted, rel=0.05)
    block = square_beaded.SquareProblem((0.8, 0.8), (2.4, 2.4), condition="frictionless")
    problem = square_beaded.block_problem(block, square_beaded.CornerCells(0.3), 0.3)
    force = problem.surface.forces(np.zeros(problem.solid.mesh.size), problem.punch, depth)[0]
    # The face inside the last cell moves with the punch: contact is what lies between it and the fillet.
    glued = problem.solid.mesh.nodes[0, problem.driven // 3].max()
    bead = 0.3 * block.scale * np.sqrt(np.pi) / 2.0
    wanted = stiffness.BEADED_SQUARE.contact / bead * depth * ((0.8 - bead) ** 2 - glued**2)
    assert force[2::3].sum() == pytest.approx(wanted, rel=0.05)


def test_where_cells_grow_with_the_radius_the_contact_of_a_profile_is_as_much_softer():
    """Contact mu over the larger of the cell and its share of the radius, over the face: by Simpson's rule."""
    region, depth = indentation.Region(0.0, 0.8, 0.02, 0.2), 1e-7
    problem = indentation.indentation_problem(FlatPunch(1.0, 0.2), region, CASE, penalty=stiffness.PROFILE_PUNCH)
    force = problem.surface.forces(np.zeros(problem.solid.mesh.size), problem.punch, depth)[0]
    r = np.linspace(0.0, 0.8, 40001)
    wanted = np.trapezoid(2.0 * np.pi * r / np.maximum(0.02, 0.2 * r), r) * stiffness.PROFILE_PUNCH.contact * depth
    assert force[1::2].sum() == pytest.approx(wanted, rel=0.02)


@pytest.mark.parametrize("cell", [0.02, 0.1])
def test_a_face_slips_as_a_whole_before_it_has_gone_a_fifth_of_a_cell(cell):
    region, depth = indentation.Region(0.3, 1.0, cell), 1e-3
    case = replace(CASE, condition="friction:0.3")
    problem = indentation.indentation_problem(FlatPunch(0.8, 0.1), region, case)
    surface, size = problem.surface, problem.solid.mesh.size
    drags = []
    for way in (1e-4, 0.2):
        aside = np.tile([way * cell, 0.0], size // 2)
        force = surface.forces(aside, problem.punch, depth)[0]
        drags.append(force[0::2].sum() / force[1::2].sum())
    assert drags[0] < 0.02 * 0.3 and drags[1] == pytest.approx(0.3, rel=0.03)

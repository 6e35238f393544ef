"""Crowns whose foot folds: a face that meets itself ends the answer, and the message names the fold."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.self_contact import FoldWatch, RoundFace, crossing, opening_deg
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.axisymmetric.shaped_problem import shaped_problem
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import predict_static
from dummydesign.pad.solve.continuation import ForcePath

STEEP = read_shape("crowned:radius=3,height=4,foot=3.2")


def book(opening: float) -> np.ndarray:
    """A line that goes out, down a flank that leans back, and up again, with a notch of so many degrees."""
    up = np.radians(90.0 - opening)
    along = np.linspace(0.0, 1.0, 6)[:, None]
    foot = np.array([1.0, -1.0])
    return np.concatenate([[[0.0, 0.0], [1.0, 0.0]], foot + (1.0 - along) * [0.0, 0.9],
                           foot + along[1:] * 2.0 * np.array([np.cos(up), np.sin(up)])])  # fmt: skip


@pytest.mark.parametrize("opening", [90.0, 45.0, 5.0])
def test_a_notch_has_its_opening_and_does_not_cross(opening):
    assert opening_deg(book(opening)) == pytest.approx(opening)
    assert crossing(book(opening)) is None


def test_a_line_that_passes_through_itself_crosses_where_it_does():
    line = book(5.0)
    line[-1] = [0.95, -0.5]
    # Its last segment meets the flank at a height of -0.21, in the segment from -0.1 to -0.28.
    assert crossing(line) == 2
    assert crossing(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.5]])) is None


def face() -> RoundFace:
    return RoundFace(shaped_problem(Case(7.9 / 8.0, 9.0, shape=STEEP, thickness_mm=8.0), 8), 8.0)


def test_the_face_of_a_mesh_runs_from_the_axis_to_the_rim_over_the_crown():
    r, z = face().rest.T
    assert r[0] == 0.0 and r[-1] == pytest.approx(9.0) and np.all(np.diff(r) > 0.0)
    assert z == pytest.approx(-STEEP.drop_mm(8.0 * r, 0.0 * r) / 8.0, abs=1e-2)


def test_a_path_that_ends_with_a_nearly_shut_notch_names_it():
    found = FoldWatch(face())
    path = ForcePath(np.array([0.1]), np.ones(1), np.ones(1), 1, 1, 1, 0.0, "no equilibrium")
    found.opening = 60.0
    assert found.with_stop_reason(path).stop == "no equilibrium"
    found.opening = 12.0
    assert found.with_stop_reason(path).stop == "the crown's foot is folded to 12 degrees, and no equilibrium"


@pytest.mark.slow
def test_a_steep_crown_ends_where_it_folds_on_to_the_pad_and_says_so(monkeypatch):
    monkeypatch.setattr(Crowned, "check", lambda *_: None)  # no mould can make it
    depth = 8.0 * np.array([0.1, 0.3, 0.36, 0.38, 0.4, 0.45])
    curve = solve_shaped_pad(Pad(8.0, 0.03, 7.9, geometry=STEEP), depth)
    assert 0.3 * 8.0 <= curve.depth_mm[-1] < 0.45 * 8.0
    assert "the crown folds on to the pad beside its foot" in curve.notes[0] and "from the axis" in curve.notes[0]


@pytest.mark.slow
def test_a_flat_crown_does_not_fold():
    curve = solve_shaped_pad(
        Pad(8.0, 0.03, 7.9, geometry=read_shape("crowned:20,2,9")), 8.0 * np.array([0.1, 0.3, 0.5])
    )
    assert curve.notes == () and len(curve.depth_mm) == 3


@pytest.mark.slow
def test_a_crown_that_can_be_cast_and_folds_is_answered_up_to_there_and_the_error_names_the_fold():
    pad = Pad(8.0, 0.03, 7.9, geometry=read_shape("crowned:4.434,5.76,6.221"))
    with pytest.raises(NoAnswerError, match=r"d/h = 0\.\d+ .*(foot is folded to \d+ degrees|folds on to the pad)"):
        predict_static(pad, [2.0, 4.0, 4.4, 4.8], "axisymmetric")

"""Inside the pressed pad: deformed cross-sections with stress at the forces of the test, and the contact pressure.

Solved on coarse elements under the circle of the punch's area, static, at the depths of the design. The best slab
is solved beside a shaped pad, so that peak and position of the pressure can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.test_setup import pad_of_request
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import DesignCandidate
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.pad.specimen import Pad

# How far out is shown, over the punch's radius.
REACH = 1.6
COLUMNS, ABOVE_MM, TOP_PERCENTILE = 121, 2.0, 97.0


@dataclass(frozen=True)
class PressedPad:
    """A pad at one force of the test; lengths from the axis and from the base. [mm, kPa]"""

    title: str
    force_N: float
    static_N: float
    depth_mm: float
    radius_mm: NDArray
    height_mm: NDArray
    stress_kPa: NDArray
    face_mm: NDArray
    punch_mm: NDArray
    contact: dict[str, Any]


@dataclass(frozen=True)
class PressPictures:
    """What is shown of the inside of the pads."""

    pads: tuple[PressedPad, ...] = ()
    slab: tuple[PressedPad, ...] = ()
    ceiling_kPa: float = 1.0
    left_out: str = ""


def press_pictures(answer: Suggestion) -> PressPictures:
    """Solve the recommended pad, and the best slab beside a shaped one, at the forces of the test."""
    if not answer.request.verify:
        return PressPictures(left_out="left out, as finite elements were not requested")
    if not answer.shape.axisymmetric:
        kind = answer.shape.name
        return PressPictures(left_out=f"left out: {kind} pads are not round, and no one section stands for them")
    try:
        pads = _pressed(answer, answer.best, answer.shape)
    except NoAnswerError as problem:
        return PressPictures(left_out=f"left out: {problem}")
    slab: tuple[PressedPad, ...] = ()
    flat = next((item.candidate for item in answer.beside if item.kind == Slab.name and item.candidate), None)
    left_out = ""
    if flat is not None and not answer.shape.plain:
        try:
            slab = _pressed(answer, flat, Slab())
        except NoAnswerError as problem:
            left_out = f"the slab beside it is left out: {problem}"
    return PressPictures(pads, slab, max(_under_punch(pad) for pad in (*pads, *slab)), left_out)


def _under_punch(pad: PressedPad) -> float:
    """Stress below which nearly all of the pad under the contact is. [kPa]"""
    inside = pad.stress_kPa[:, np.abs(pad.radius_mm) < 0.9 * pad.contact["contact_radius_mm"]]
    known = inside[np.isfinite(inside)]
    return float(np.percentile(known, TOP_PERCENTILE)) if len(known) else 1.0


def _pressed(answer: Suggestion, candidate: DesignCandidate, shape: PadShape) -> tuple[PressedPad, ...]:
    """One pad at every force of the test that it reaches."""
    from dummydesign.core.cache import cached

    forces = np.array(answer.targets.protocol.forces_N)
    depths = candidate.evaluation.depth_mm[candidate.index, : len(forces)]
    reached = np.isfinite(depths)
    if not reached.any():
        raise NoAnswerError("no_feasible_design", "the pad reaches no force of the test", quantity="pad")
    young = float(np.asarray(answer.resin.young_MPa(candidate.ratio)))
    pad = replace(pad_of_request(answer.request, answer.punch, candidate.thickness_mm, young), geometry=shape)
    wanted = depths[reached]
    made = cached("pictures", {"pad": pad, "depth": wanted}, lambda: _solved(pad, wanted))
    return tuple(_drawn(pad, force, state) for force, state in zip(forces[reached].tolist(), made["states"]))


def _solved(pad: Pad, depth_mm: NDArray) -> dict[str, Any]:
    """States at rising depths as plain values."""
    from dummydesign.pad.fields.solve import solve_fields

    fields, _ = solve_fields(pad, np.maximum.accumulate(depth_mm).tolist(), coarse=True)
    return {"states": [
        {"depth_mm": one.depth_mm, "force_N": one.force_N, "place_mm": one.rest_mm + one.displacement_mm,
         "stress_kPa": 1e3 * one.von_mises_MPa, "punch_mm": one.punch_mm, "contact": one.contact(),
         "face_mm": np.stack([one.face.radius_mm, one.face.height_mm], axis=1)}
        for one in fields
    ]}  # fmt: skip


def _linear(place: NDArray, value: NDArray, at: NDArray) -> NDArray:
    """Values between scattered places, linear on their triangles; NaN outside."""
    # All of scipy.interpolate takes 0.3 s more to load.
    from scipy.spatial import Delaunay

    triangles = Delaunay(place)
    where = triangles.find_simplex(at)
    turn = triangles.transform[where]
    share = np.einsum("...ij,...j->...i", turn[..., :2, :], at - turn[..., 2, :])
    corner = value[triangles.simplices[where]]
    found = (share * corner[..., :2]).sum(axis=-1) + (1.0 - share.sum(axis=-1)) * corner[..., 2]
    return np.where(where >= 0, found, np.nan)


def _drawn(pad: Pad, force_N: float, state: dict[str, Any]) -> PressedPad:
    """One state on the picture's cells."""
    place, face = np.asarray(state["place_mm"], float), np.asarray(state["face_mm"], float)
    reach = REACH * pad.radius_mm
    size = 2.0 * reach / COLUMNS
    radius = (np.arange(COLUMNS) - 0.5 * (COLUMNS - 1)) * size
    height = (np.arange(int(np.ceil(float(face[:, 1].max()) / size))) + 0.5) * size
    near = place[:, 0] < 1.3 * reach
    out, up = np.meshgrid(np.abs(radius), height)
    at = np.stack([np.maximum(out, 1e-6), up], axis=-1)
    stress = _linear(place[near], np.asarray(state["stress_kPa"], float)[near], at)
    inside = up <= np.interp(out, face[:, 0], face[:, 1])
    inside &= up >= np.asarray(pad.geometry.bone_mm(out, 0.0 * out), float)
    return PressedPad(
        pad.geometry.name, force_N, float(state["force_N"]), float(state["depth_mm"]), radius, height,
        np.where(inside, stress, np.nan), face, np.asarray(state["punch_mm"], float), state["contact"],
    )  # fmt: skip

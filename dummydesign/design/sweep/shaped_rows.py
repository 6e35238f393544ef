"""Rows of shaped pads and of punches with a filleted edge: from response tables all at once, or one pad solved."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.scoring.presses import DEPTH_SHARE, SAMPLES, Curves, Slabs, join_curves
from dummydesign.design.search.shape_family import Designs
from dummydesign.design.sweep.pads import why_not_cast
from dummydesign.design.sweep.rows import Task, empty_row, rows_of
from dummydesign.geometry.shapes import read_shape
from dummydesign.pad.tables.punch import punch_sides_mm

SOLVED_SHARES = DEPTH_SHARE * np.linspace(0.04, 1.0, 16)


def work_shaped(task: Task) -> list[dict[str, Any]]:
    """Work out the rows of a task with shapes or an edge radius; see :func:`dummydesign.design.sweep.work.work`."""
    return _by_tables(task) if task.fidelity == "table" else _solved(task)


def _by_tables(task: Task) -> list[dict[str, Any]]:
    """Pads of each kind on its table, all at once."""
    from dummydesign.design.search.tabulated_shapes import load_family

    chosen = np.zeros(len(task.ratio), int) if task.shape is None else task.shape
    pads, place = np.unique(np.stack([chosen, task.thickness_mm]), axis=1, return_inverse=True)
    place = place.reshape(-1)
    shapes = [read_shape(task.shapes[int(index)]) for index in pads[0]]
    why: list[str | None] = [why_not_cast(str(shape), float(mm)) for shape, mm in zip(shapes, pads[1])]
    groups, curves, order = [], [], []
    for kind in dict.fromkeys(shape.name for shape in shapes):
        family = load_family(kind)
        own = np.array([n for n, shape in enumerate(shapes) if shape.name == kind and why[n] is None], dtype=int)
        for n in list(own):
            try:
                family.check(shapes[n])
            except InputError as problem:
                why[n] = str(problem)
        own = np.array([n for n in own if why[n] is None], dtype=int)
        if not len(own):
            continue
        lengths = [dict(shapes[n].parameters) for n in own]
        designs = Designs(kind, pads[1][own], {name: np.array([one[name] for one in lengths]) for name in lengths[0]})
        limit = np.minimum(family.limit_mm(designs, task.radius_mm), DEPTH_SHARE * designs.thickness_mm)
        for n in own[limit <= 0.0]:
            why[n] = f"outside the response table of {kind} pads; --fidelity {shapes[n].fidelity} solves it"
        designs, limit, own = designs.take(limit > 0.0), limit[limit > 0.0], own[limit > 0.0]
        if not len(own):
            continue
        area = family.area_mm2(designs, limit[:, None] * np.linspace(0.0, 1.0, SAMPLES), task.radius_mm)
        curves.append(Curves(designs.thickness_mm, limit, area))
        groups.append((family, designs))
        order.append(own)
    rows = [empty_row(task, index, why[pad] or "") if why[pad] else {} for index, pad in enumerate(place)]
    if not groups:
        return rows
    joined, known = join_curves(curves), np.concatenate(order)
    curve_of = np.full(pads.shape[1], -1)
    curve_of[known] = np.arange(len(known))
    able = np.nonzero(curve_of[place] >= 0)[0]
    part = task.take(able)
    slabs = Slabs(joined, curve_of[place[able]], part.young_MPa, part.tau_s, part.beta)
    starts = np.cumsum([0, *(len(own) for own in order)])

    def error(depth_mm: NDArray) -> NDArray:
        found = np.empty_like(depth_mm)
        for (family, designs), start, stop in zip(groups, starts, starts[1:]):
            here = (slabs.slab >= start) & (slabs.slab < stop)
            own = designs.take(slabs.slab[here] - start)
            found[here] = family.relative_error(own, depth_mm[here], task.radius_mm)
        return found

    for index, row in zip(able, rows_of(part, slabs, error)):
        rows[index] = row
    return rows


def _solved(task: Task) -> list[dict[str, Any]]:
    """One pad by finite elements, for all its ratios."""
    from scipy.interpolate import PchipInterpolator

    from dummydesign.pad.elastic import elastic_curve
    from dummydesign.pad.pad import Pad

    shape, thickness = task.shape_of(0), float(task.thickness_mm[0])
    refused = why_not_cast(shape, thickness)
    if refused:
        return [empty_row(task, index, refused) for index in range(len(task.ratio))]
    wanted = SOLVED_SHARES * thickness
    # corners are known of a glued square on a slab; all other punches are the circle of their area
    sides = punch_sides_mm(task.punch) if task.edge_radius_mm else None
    if sides is not None and sides[0] != sides[1]:
        sides = None
    pad = Pad(
        thickness, 1.0, task.radius_mm, base=task.base, condition=task.condition, sides_mm=sides,
        edge_radius_mm=task.edge_radius_mm, geometry=read_shape(shape),
    )  # fmt: skip
    try:
        found = elastic_curve(pad, task.fidelity, float(wanted[-1]), wanted, None)
    except NoAnswerError as problem:
        return [empty_row(task, index, str(problem)) for index in range(len(task.ratio))]
    depth = wanted[wanted <= found.limit_mm * (1.0 + 1e-9)]
    if len(depth) < 3:
        return [empty_row(task, index, "could not be solved to a useful depth") for index in range(len(task.ratio))]
    area, error = found.force(depth), found.relative_error(depth)
    # ln F over ln d without overshoot; before the first depth the power that the first two have
    spline = PchipInterpolator(np.log(depth), np.log(area))
    first = np.log(area[1] / area[0]) / np.log(depth[1] / depth[0])
    grid = float(depth[-1]) * np.linspace(0.0, 1.0, SAMPLES)[1:]
    below = area[0] * (grid / depth[0]) ** first
    inside = np.exp(spline(np.log(np.clip(grid, depth[0], depth[-1]))))
    curve = np.concatenate([[0.0], np.where(grid < depth[0], below, inside)])
    curves = Curves(np.array([thickness]), depth[-1:], curve[None])
    slabs = Slabs(curves, np.zeros(len(task.ratio), int), task.young_MPa, task.tau_s, task.beta)
    return rows_of(task, slabs, lambda at: np.interp(at, depth, error))

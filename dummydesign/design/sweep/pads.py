"""Shapes and punch edges of a study: lists and ranges as they are typed, and what is refused before any work."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.design.sweep.ranges import read_values
from dummydesign.geometry.shapes import Slab, make_shape, read_shape, shape_kinds
from dummydesign.geometry.standard import LARGEST_EDGE_RADIUS
from dummydesign.pad.tables.punch import equal_area_radius_mm, punch_sides_mm

if TYPE_CHECKING:
    from dummydesign.design.sweep.spec import Study

MOST_SHAPES = 100_000


def parse_shapes(text: str) -> tuple[str, ...]:
    """Read ``NAME[:KEY=RANGE,...],...``; a range is a value, START:STOP:STEP with STOP included, or A/B/C.

    Every combination of a shape's values is one shape. What does not begin with the name of a shape belongs to the one
    before it.

    Raises
    ------
    InputError
        For unknown shapes or parameters, and what is not a range.

    Examples
    --------
    >>> parse_shapes("slab,crowned:radius=10:14:2,height=2")
    ('slab', 'crowned:radius=10,height=2', 'crowned:radius=12,height=2', 'crowned:radius=14,height=2')
    """
    found: list[str] = []
    for name, items in _split(text):
        keys, values = [], []
        for place, item in enumerate(items):
            key, equals, given = item.rpartition("=")
            keys.append(key.strip() if equals else str(place))
            given = given.replace("/", ",")
            values.append(read_values(given, f"shape {name}: {keys[-1] if equals else f'value {place + 1}'}"))
        count = 1
        for one in values:
            count *= len(one)
        if count > MOST_SHAPES:
            raise InputError(f"shape {name}: {count} shapes are more than {MOST_SHAPES}; use wider steps")
        found += [str(make_shape(name, tuple(zip(keys, chosen)))) for chosen in itertools.product(*values)]
    return tuple(found)


def _split(text: str) -> list[tuple[str, list[str]]]:
    shapes: list[tuple[str, list[str]]] = []
    known = shape_kinds()
    for part in filter(None, (part.strip() for part in text.split(","))):
        head, colon, rest = part.partition(":")
        if head.lower() in known:
            shapes.append((head.lower(), [rest] if colon else []))
        elif shapes and ("=" in head or _number(head)):
            shapes[-1][1].append(part)
        else:
            raise unknown_name("shape", head, tuple(known))
    if not shapes:
        raise InputError("shape has no value; give at least one, such as slab")
    return shapes


def _number(text: str) -> bool:
    try:
        float(text.split("/")[0])
    except ValueError:
        return False
    return True


def check_pads(study: Study) -> None:
    """Refuse shapes and edges that no model of the study's fidelity knows, and shapes that no thickness can hold.

    Raises
    ------
    InputError
        With the option that helps.
    """
    shaped = [shape for shape in study.shapes if shape != Slab.name]
    edges = [edge for edge in study.edge_radii_mm if edge != 0.0]
    for edge in edges:
        for punch, _ in study.punches:
            sides = punch_sides_mm(punch)
            half = min(sides) / 2.0 if sides else equal_area_radius_mm(punch)
            if not 0.0 < edge <= LARGEST_EDGE_RADIUS * half:
                words = f"{LARGEST_EDGE_RADIUS:g} of the half-width of {punch}"
                raise out_of_range("edge radius in mm", edge, 0, f"{LARGEST_EDGE_RADIUS * half:g}", words)
    if edges and study.fidelity == "3d":
        raise InputError(f"edge radius in mm = {edges[0]:g} is not solved in space; leave out --fidelity 3d")
    if edges and study.fidelity == "table":
        _check_tabulated(study, edges)
    if edges:
        _check_edges_go_with(study, edges[0], shaped)
    if not shaped:
        return
    if study.fidelity == "3d":
        raise InputError("shapes are worked out by the tables or by --fidelity axisymmetric; press one in space with "
                         f"'dummydesign predict --shape {shaped[0]} --fidelity 3d'")  # fmt: skip
    if study.fidelity == "table":
        from dummydesign.design.search.tabulated_shapes import designable_kinds

        for base in study.bases:
            if base != "bonded":
                raise InputError(f"base = {base} of a shaped pad is not in the tables; add --fidelity axisymmetric")
        for shape in shaped:
            kind = shape.partition(":")[0]
            if kind not in designable_kinds():
                raise InputError(f"shape {kind} has no response surface; add --fidelity axisymmetric")
    else:
        for shape in shaped:
            if not read_shape(shape).axisymmetric:
                raise InputError(f"shape {shape} is not round; leave out --fidelity axisymmetric for its table")
    pads = itertools.product(study.shapes, study.thickness_mm)
    if Slab.name not in study.shapes and all(why_not_cast(shape, thickness) for shape, thickness in pads):
        why = why_not_cast(shaped[0], max(study.thickness_mm))
        raise InputError(f"no thickness of the study can hold any of its shapes; {shaped[0]}: {why}")


def why_not_cast(shape: str, thickness_mm: float) -> str | None:
    """Why a pad of this thickness cannot have the shape; None when it can."""
    try:
        read_shape(shape).check(thickness_mm)
    except InputError as problem:
        return str(problem)
    return None


def _check_edges_go_with(study: Study, edge: float, shaped: list[str]) -> None:
    """Refuse shapes and conditions that a fillet is not worked out for."""
    slides = next((condition for condition in study.conditions if condition != "bonded"), None)
    if shaped and study.fidelity == "table":
        raise InputError(f"edge radius in mm = {edge:g} of shaped pads has no table; add --fidelity axisymmetric")
    if shaped and slides:
        raise InputError(
            f"edge radius in mm = {edge:g} with condition = {slides} is solved for flat slabs only; leave out "
            f"--shape {shaped[0]}, --edge-radius or --condition"
        )


def _check_tabulated(study: Study, edges: list[float]) -> None:
    """Refuse fillets that their table does not hold."""
    from dummydesign.pad.tables.filleted import slab_table

    for edge in edges:
        for (punch, _), base in itertools.product(study.punches, study.bases):
            slab_table(base, edge, equal_area_radius_mm(punch))

"""Where the long-term force of a pad comes from: the response table, or a solve by the elements that fit it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError, unknown_name
from dummydesign.core.quantity import Quantity
from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.interface import BASES, Interface
from dummydesign.pad.first_touch import interpolate_curve, low_end, solvable_depths
from dummydesign.pad.force_law import (
    NO_COST,
    ForceCurve,
    ForceLaw,
    PadCurve,
    curve_at,
    depth_grid,
    scale_curve,
)
from dummydesign.pad.material.hyperelastic import Array, Yeoh
from dummydesign.pad.pad_under_punch import SLAB, Pad, Puck
from dummydesign.pad.tables.elastic_law import elastic_factor, exponent_of, mean_drop_mm
from dummydesign.pad.tables.slab import load_table, slab_table

FIDELITIES = ("table", "axisymmetric", "viscoelastic", "3d")


def elastic_curve(
    pad: Pad | Puck,
    fidelity: str,
    deepest_mm: float | None = None,
    depths_mm: Array | None = None,
) -> ForceCurve:
    """Long-term force as a function of depth, by the table or solved by finite elements."""
    if fidelity not in FIDELITIES:
        raise unknown_name("fidelity", fidelity, FIDELITIES)
    if isinstance(pad, Puck):
        if fidelity == "table":
            raise _not_tabulated("punch", "plate", "flat")
        if fidelity != "axisymmetric":
            message = f"fidelity = {fidelity} is not for pucks between plates; use --fidelity axisymmetric"
            raise InputError(message, "unsupported", "fidelity", fidelity, "axisymmetric")
        return _by_elements(pad, deepest_mm, depths_mm)
    if fidelity in ("3d", "viscoelastic"):
        if Interface.names_friction(pad.base):
            raise _unsupported("base", pad.base, fidelity)
        if pad.edge_radius_mm:
            raise _unsupported("edge_radius_mm", pad.edge_radius_mm, fidelity)
    if fidelity == "3d":
        return _in_space(pad, deepest_mm, depths_mm)
    if fidelity == "table" or (fidelity == "viscoelastic" and _in_table(pad)):
        curve = _by_table(pad)
    else:
        curve = _by_elements(pad, deepest_mm, depths_mm)
    return _under_corners(pad, curve)


def solved_curve(pad: Pad | Puck, depths_mm: Array, cells: int | None = None) -> ForceCurve:
    """Long-term force through given depths, solved by the elements that fit the pad (:func:`solve_points`)."""
    return _under_corners(pad, _through(pad, solve_points(pad, depths_mm, cells)))


def _under_corners(pad: Pad | Puck, curve: ForceCurve) -> ForceCurve:
    return scale_curve(curve, corners_of(pad)) if isinstance(pad, Pad) and has_square_factor(pad) else curve


def curve_without_solve(pad: Pad | Puck) -> ForceCurve | None:
    """Long-term force of a slab in the response table, or in closed form of a puck that slips freely; else None."""
    if isinstance(pad, Pad):
        return elastic_curve(pad, "table") if _tabulated(_of_table(pad)) else None
    from dummydesign.pad.tables.puck import DEEPEST, uniaxial

    alpha = exponent_of(pad.shape)
    if pad.plates != "frictionless" or pad.poisson < 0.5 or alpha is None:
        return None
    load = pad.young_MPa * np.pi * pad.radius_mm**2
    return ForceCurve(
        lambda depth: load * uniaxial(alpha, np.asarray(depth, float) / pad.thickness_mm),
        lambda depth: np.zeros(np.shape(depth)),
        DEEPEST * pad.thickness_mm,
        dict(NO_COST),
    )


def corners_of(pad: Pad) -> Callable[[Array], tuple[Array, Array]]:
    """Factor of a square punch over the circle of its area and its relative error, at depths. [mm]"""
    from dummydesign.pad.tables.square import DOUBTED_WITH_FILLET, crown_factor, square_factor

    def slab(depth: Array) -> tuple[Array, Array]:
        return square_factor(depth, pad.thickness_mm, pad.radius_mm, pad.base, bool(pad.edge_radius_mm))

    def crown(depth: Array) -> tuple[Array, Array]:
        value, error = crown_factor(depth, pad.thickness_mm, pad.radius_mm, dict(pad.geometry.parameters))
        usual = pad.base == "bonded" and not pad.edge_radius_mm and pad.condition == "bonded" and _plain_law(pad)
        return value, error if usual else error + DOUBTED_WITH_FILLET * np.abs(value - 1.0)

    return crown if pad.geometry.crowned else slab


def _unsupported(name: str, value: str | float, fidelity: str) -> InputError:
    shown = value if isinstance(value, str) else f"{value:g}"
    message = f"{name} = {shown} is not solved by fidelity {fidelity}; use --fidelity axisymmetric"
    return InputError(message, "unsupported", name, value)


def _not_tabulated(name: str, value: Any, held: Any) -> InputError:
    message = f"{name} = {value} is not in the table (only {held}); add --fidelity axisymmetric"
    return InputError(message, "not_tabulated", name.removeprefix("punch "), value, held)


def has_square_factor(pad: Pad) -> bool:
    """Whether the punch is a square whose factor over the circle of its area is tabulated."""
    if pad.sides_mm is None or pad.sides_mm[0] != pad.sides_mm[1]:
        return False
    if pad.geometry.crowned:
        return pad.geometry.axisymmetric and pad.profile_mm is None
    return _tabulated(replace(_of_table(pad), edge_radius_mm=0.0))


def _of_table(pad: Pad) -> Pad:
    """The pad without an elastic law that is a factor on the table."""
    return pad if exponent_of(pad.shape) is None else replace(pad, law=None)


def _tabulated(pad: Pad) -> bool:
    """Whether base, law and a / h are within the tables."""
    if pad.base not in BASES or not _in_table(pad):
        return False
    low, high = load_table(pad.base).ratio_range
    return low <= pad.radius_mm / pad.thickness_mm <= high


def _in_space(pad: Pad, deepest_mm: float | None, depths_mm: Array | None) -> ForceCurve:
    """The axisymmetric curve of the circle of equal area, times the ratio solved in space on twin cells."""
    from dummydesign.pad.solve.continuation import add_costs
    from dummydesign.pad.spatial.square_punch import FactorCurve, SquareProblem, solve_factor

    if pad.geometry != SLAB:
        return _shape_in_space(pad, deepest_mm, depths_mm)
    if pad.sides_mm is None:
        message = "fidelity = 3d is for square and rectangular punches; a round one is solved by axisymmetric"
        raise InputError(message, "unsupported", "fidelity", "3d", "axisymmetric")
    h = pad.thickness_mm
    (a, b), (length, width) = pad.sides_mm, pad.slab_mm
    block = SquareProblem(
        (0.5 * a / h, 0.5 * b / h), (0.5 * length / h, 0.5 * width / h), pad.base, pad.condition, pad.shape, pad.poisson
    )
    curve = _by_elements(pad, deepest_mm, depths_mm)
    if curve.notes and _tabulated(pad):
        # The table averages over many neighbouring solves and reaches where a single one may stop.
        note = f"the round twin's curve is the response table's: the solve was not complete ({curve.notes[0]})"
        curve = replace(_by_table(pad), solver=curve.solver, notes=(note,))
    deepest = min(deepest_mm or curve.limit_mm, curve.limit_mm) / h
    inputs = {"block": block, "deepest": deepest}
    solved = FactorCurve(**cached("3d", inputs, lambda: vars(solve_factor(block, deepest))))
    solver = add_costs(curve.solver, solved.solver) | {"unknowns": solved.solver["unknowns"]}
    return replace(scale_curve(curve, lambda depth: solved.factor(depth / h)), solver=solver)


def _in_table(pad: Pad) -> bool:
    plain = pad.profile_mm is None and pad.geometry == SLAB
    return plain and pad.condition == "bonded" and _plain_law(pad)


def _plain_law(pad: Pad) -> bool:
    return pad.poisson == 0.5 and pad.shape == Yeoh(1.0)


def _by_table(pad: Pad) -> ForceCurve:
    alpha = exponent_of(pad.shape)
    material = "neo-hookean" if alpha is not None else type(pad.shape).__name__.lower()
    for name, value, held in (
        ("punch", "profile" if pad.profile_mm else "flat", "flat"),
        ("punch condition", pad.condition, "bonded"),
        ("poisson", pad.poisson, 0.5),
        ("law", material, "neo-hookean"),
    ):
        if value != held:
            raise _not_tabulated(name, value, held)
    law: ForceLaw = slab_table(pad.base, pad.edge_radius_mm, pad.radius_mm) if pad.geometry == SLAB else _shape_law(pad)
    curve = curve_at(law, pad.thickness_mm, pad.young_MPa, pad.radius_mm)
    if alpha is None or pad.shape == Yeoh(1.0):
        return curve
    kind = pad.geometry.name if pad.base == "bonded" and not pad.edge_radius_mm else "other"
    known = Quantity(alpha, alpha, alpha, "assumed", "given")
    size = pad.thickness_mm, pad.radius_mm, known, kind, mean_drop_mm(pad.geometry, pad.radius_mm)
    return scale_curve(curve, lambda depth: elastic_factor(depth, *size))


def _shape_law(pad: Pad) -> ForceLaw:
    """Response table of a shaped pad on a bonded base under a sharp edge."""
    from dummydesign.pad.tables.shape import TabulatedShapeLaw

    if pad.edge_radius_mm:
        raise _not_tabulated("edge_radius_mm", pad.edge_radius_mm, 0.0)
    if pad.base != "bonded":
        raise _not_tabulated("base", pad.base, "bonded")
    if not pad.geometry.tabulated:
        why = "" if pad.geometry.axisymmetric else "is not round and "
        message = f"shape {pad.geometry} {why}has no table; add --fidelity {pad.geometry.fidelity}"
        raise InputError(message, "not_tabulated", "shape", str(pad.geometry))
    return TabulatedShapeLaw(pad.geometry)


def _by_elements(pad: Pad | Puck, deepest_mm: float | None, depths_mm: Array | None) -> ForceCurve:
    grid = depth_grid(pad.thickness_mm, deepest_mm, depths_mm)
    return _through(pad, solve_points(pad, solvable_depths(pad, grid)))


def _through(pad: Pad | Puck, solved: PadCurve) -> ForceCurve:
    depth, force = solved.depth_mm, solved.force_N
    if len(depth) < 2:
        message = f"the pad could be solved at {len(depth)} depth only: {solved.notes[0]}"
        raise NoAnswerError("no_convergence", message, quantity="force_N")
    return interpolate_curve(solved, low_end(pad, depth, force, solved.error_N / force))


def solve_points(pad: Pad | Puck, depth_mm: Array, cells: int | None = None, independent: bool = False) -> PadCurve:
    """Static force at given depths, solved by the elements that fit the pad, the punch and its contact.

    ``independent`` of the response table, to check it with (``solve_curve``).
    """
    if isinstance(pad, Puck):
        from dummydesign.pad.axisymmetric.puck import solve_puck

        return solve_puck(pad, depth_mm)
    from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
    from dummydesign.pad.axisymmetric.profile_punch import solve_profile
    from dummydesign.pad.axisymmetric.shaped_pad import solve_flat, solve_shaped_pad
    from dummydesign.pad.axisymmetric.sharp_edge import solve_curve

    depths = {"extent": pad.extent_mm or PAD_EXTENT_MM, "depth": depth_mm}
    if pad.geometry != SLAB:
        if not pad.geometry.axisymmetric:
            message = f"shape {pad.geometry} is not round; add --fidelity 3d"
            raise InputError(message, "unsupported", "shape", str(pad.geometry))
        more: dict[str, Any] = {} if cells is None else {"cells": cells}
        return _of_unit_modulus("shaped", pad, depths | more, lambda own: solve_shaped_pad(own, depth_mm, **more))
    if pad.profile_mm is not None:
        # A pad that rests by its weight is not the same at another modulus.
        unit = 1.0 if pad.base in BASES else pad.young_MPa
        return _of_unit_modulus("profile", pad, depths, lambda own: solve_profile(own, depth_mm), unit)
    if pad.edge_radius_mm:
        return solve_under_fillet(pad, depth_mm)
    if pad.condition == "bonded" and pad.base in BASES:
        return solve_curve(pad, depth_mm, independent)
    return solve_flat(pad, depth_mm)


def _of_unit_modulus(
    kind: str, pad: Pad, inputs: dict[str, Any], solve: Callable[[Pad], PadCurve], young_MPa: float = 1.0
) -> PadCurve:
    """Solve a pad with another modulus, kept in the cache, and scale its force."""
    own = replace(pad, young_MPa=young_MPa, prony=())
    made = cached(kind, {"pad": own, **inputs}, lambda: vars(solve(own)))
    scale = pad.young_MPa / young_MPa
    return PadCurve(**(made | {name: made[name] * scale for name in ("force_N", "error_N")}))


def _shape_in_space(pad: Pad, deepest_mm: float | None, depths_mm: Array | None) -> ForceCurve:
    """A shaped pad under its own punch, square or round, solved in space with unit modulus."""
    from dummydesign.pad.spatial.shaped_pad import solve_shaped_block

    grid = depth_grid(pad.thickness_mm, deepest_mm, depths_mm)
    grid = solvable_depths(pad, grid[1::2] if depths_mm is None else grid, in_space=True)

    def solve(own: Pad) -> PadCurve:
        if not own.geometry.flat_top:
            return solve_shaped_block(own, grid)
        plain = replace(own, geometry=SLAB)
        slab = (_by_elements if own.sides_mm is None else _in_space)(plain, float(grid[-1]), grid)
        return solve_shaped_block(own, grid[grid <= slab.limit_mm * (1.0 + 1e-9)], slab=slab)

    return _through(pad, _of_unit_modulus("shape-3d", pad, {"depth": grid}, solve))

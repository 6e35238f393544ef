"""Where the long-term force of a pad comes from: the response table, or a solve by the elements that fit it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.shapes import Slab
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.curve import ElasticCurve, depth_grid, through, times
from dummydesign.pad.force_law import AtThickness, ForceLaw
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad import Pad, Puck

if TYPE_CHECKING:
    from dummydesign.pad.slab.problem import PadCurve
    from dummydesign.pad.tables.shape import ShapeLaw

Array = np.ndarray
FIDELITIES = ("table", "axisymmetric", "viscoelastic", "3d")


def elastic_curve(
    pad: Pad | Puck,
    fidelity: str,
    deepest_mm: float | None,
    depths_mm: Array | None,
    progress: Callable[[float], None] | None,
    force_law: ForceLaw | None = None,
) -> ElasticCurve:
    """Long-term force as a function of depth, by the table or solved by finite elements.

    Parameters
    ----------
    pad : Pad
    fidelity : str
        One of :data:`FIDELITIES`.
    deepest_mm, depths_mm : float and ndarray, shape (n,), or None
        Largest depth that is needed, the whole valid range without it; depths that a solve meets exactly. [mm]
    progress : callable or None
        Called with each solved depth over thickness.
    force_law : ForceLaw, optional
        Takes the place of the response table (fidelity ``table``), whatever the pad is.

    Raises
    ------
    InputError, NoAnswerError
        For a case that the fidelity does not cover, with one that does; when a solve does not reach a depth.
    """
    if fidelity not in FIDELITIES:
        raise unknown_name("fidelity", fidelity, FIDELITIES)
    if force_law is not None:
        if fidelity != "table":
            raise InputError(f"fidelity = {fidelity} solves the pad; a force law of your own goes with table")
        return _by_law(pad, force_law)
    if isinstance(pad, Puck):
        return _of_puck(pad, fidelity, deepest_mm, depths_mm, progress)
    if fidelity in ("3d", "viscoelastic") and pad.base.startswith("friction"):
        raise InputError(f"base = {pad.base} is not solved by fidelity {fidelity}; use --fidelity axisymmetric")
    if fidelity in ("3d", "viscoelastic") and pad.edge_radius_mm:
        raise InputError(
            f"edge_radius_mm = {pad.edge_radius_mm:g} is not solved by fidelity {fidelity}; use --fidelity axisymmetric"
        )
    if fidelity == "3d":
        return _in_space(pad, deepest_mm, depths_mm, progress)
    if fidelity == "table" or (fidelity == "viscoelastic" and _in_table(pad)):
        curve = _by_table(pad)
    else:
        curve = _by_elements(pad, deepest_mm, depths_mm, progress)
    if not has_square_factor(pad):
        return curve
    from dummydesign.pad.tables.square import square_factor

    def factor(depth: Array) -> tuple[Array, Array]:
        return square_factor(depth, pad.thickness_mm, pad.radius_mm, pad.base, bool(pad.edge_radius_mm))

    return times(curve, factor)


def _of_puck(
    puck: Puck, fidelity: str, deepest_mm: float | None, depths_mm: Array | None,
    progress: Callable[[float], None] | None,
) -> ElasticCurve:  # fmt: skip
    """A puck between plates, solved by its own elements."""
    if fidelity == "table":
        raise InputError("punch = plate is not in the table (only flat); add --fidelity axisymmetric")
    if fidelity != "axisymmetric":
        raise InputError(f"fidelity = {fidelity} is not for pucks between plates; use --fidelity axisymmetric")
    grid, _ = depth_grid(puck.thickness_mm, deepest_mm, depths_mm)
    return through(1.0, solve_points(puck, grid, progress))


def has_square_factor(pad: Pad) -> bool:
    """Whether the punch is a square whose factor over the circle of its area is tabulated."""
    if pad.sides_mm is None or pad.sides_mm[0] != pad.sides_mm[1]:
        return False
    return _tabulated(replace(pad, edge_radius_mm=0.0))


def _tabulated(pad: Pad) -> bool:
    """Whether base, law and a / h are within the tables."""
    from dummydesign.pad.tables.slab import load_table

    if pad.base not in BASES or not _in_table(pad):
        return False
    low, high = load_table(pad.base).ratio_range
    return low <= pad.radius_mm / pad.thickness_mm <= high


def _in_space(
    pad: Pad, deepest_mm: float | None, depths_mm: Array | None, progress: Callable[[float], None] | None
) -> ElasticCurve:
    """The axisymmetric curve of the circle of equal area, times the ratio solved in space on twin cells."""
    from dummydesign.pad.slab.square_curve import FactorCurve, solve_factor
    from dummydesign.pad.slab.square_sharp import Block

    if pad.geometry != Slab():
        return _shape_in_space(pad, deepest_mm, depths_mm, progress)
    if pad.sides_mm is None:
        raise InputError("fidelity = 3d is for square and rectangular punches; a round one is solved by axisymmetric")
    h = pad.thickness_mm
    (a, b), (length, width) = pad.sides_mm, pad.slab_mm
    block = Block((0.5 * a / h, 0.5 * b / h), (0.5 * length / h, 0.5 * width / h), pad.base, pad.condition)
    curve = _by_elements(pad, deepest_mm, depths_mm, progress)
    if curve.notes and _tabulated(pad):
        # The table averages over many neighbouring solves and reaches where a single one may stop.
        note = f"the round twin's curve is the response table's: the solve was not complete ({curve.notes[0]})"
        curve = replace(_by_table(pad), solver=curve.solver, notes=(note,))
    deepest = min(deepest_mm or curve.limit_mm, curve.limit_mm) / h
    inputs = {"block": block, "law": pad.shape, "poisson": pad.poisson, "deepest": deepest}
    made = cached("3d", inputs, lambda: vars(solve_factor(block, pad.shape, pad.poisson, deepest, progress)))
    solved = FactorCurve(**made)
    solver = {name: curve.solver[name] + solved.solver[name] for name in solved.solver}
    solver["unknowns"] = solved.solver["unknowns"]
    return replace(times(curve, lambda depth: solved.factor(depth / h)), solver=solver)


def _in_table(pad: Pad) -> bool:
    plain = pad.profile_mm is None and pad.geometry == Slab()
    return plain and pad.condition == "bonded" and pad.poisson == 0.5 and pad.shape == Yeoh(1.0)


def _by_table(pad: Pad) -> ElasticCurve:
    from dummydesign.pad.tables.filleted import slab_table

    law = "neo-hookean" if pad.shape == Yeoh(1.0) else type(pad.shape).__name__.lower()
    for name, value, held in (
        ("punch", "profile" if pad.profile_mm else "flat", "flat"),
        ("punch condition", pad.condition, "bonded"),
        ("poisson", pad.poisson, 0.5),
        ("law", law, "neo-hookean"),
    ):
        if value != held:
            raise InputError(f"{name} = {value} is not in the table (only {held}); add --fidelity axisymmetric")
    if pad.geometry != Slab():
        if pad.edge_radius_mm:
            edge = f"edge_radius_mm = {pad.edge_radius_mm:g}"
            raise InputError(f"{edge} is not in the tables of shapes; add --fidelity axisymmetric")
        return _by_law(pad, _shape_law(pad))
    return _by_law(pad, slab_table(pad.base, pad.edge_radius_mm, pad.radius_mm))


def _by_law(pad: Pad | Puck, law: ForceLaw) -> ElasticCurve:
    from dummydesign.pad.solve.continuation import NOTHING

    at = AtThickness(law, pad.thickness_mm, pad.young_MPa, pad.radius_mm)
    return ElasticCurve(at.force, at.relative_error, at.limit_mm, dict(NOTHING), law.notes, law.provenance)


def _shape_law(pad: Pad) -> ShapeLaw:
    """Response table of a shaped pad on a bonded base."""
    from dummydesign.pad.tables.shape import ShapeLaw

    if pad.base != "bonded":
        raise InputError(f"base = {pad.base} is not in the tables of shapes (only bonded); add --fidelity axisymmetric")
    if not pad.geometry.tabulated:
        why = "" if pad.geometry.axisymmetric else "is not round and "
        raise InputError(f"shape {pad.geometry} {why}has no table; add --fidelity {pad.geometry.fidelity}")
    return ShapeLaw(pad.geometry)


def _by_elements(
    pad: Pad, deepest_mm: float | None, depths_mm: Array | None, progress: Callable[[float], None] | None
) -> ElasticCurve:
    grid, deepest = depth_grid(pad.thickness_mm, deepest_mm, depths_mm)
    if pad.condition != "bonded":
        # A face that slides needs some depth to start from.
        grid = grid[grid >= min(0.025 * pad.thickness_mm, 0.25 * deepest)]
    return through(pad.geometry.first_exponent, solve_points(pad, grid, progress))


def solve_points(
    pad: Pad | Puck, depth_mm: Array, progress: Callable[[float], None] | None = None, cells: int | None = None
) -> PadCurve:
    """Static force at given depths, solved by the elements that fit the pad, the punch and its contact.

    Parameters
    ----------
    pad : Pad or Puck
    depth_mm : ndarray, shape (n,)
        Depths above 0, within the validity of the model. [mm]
    progress : callable, optional
        Called with the share that is done.
    cells : int, optional
        Of a pad with a shape, between its axis and the punch's edge; those of a design without it.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` say why if some are missing.

    Raises
    ------
    InputError, NoAnswerError
        For a case that is not solved round; when no depth is reached.
    """
    if isinstance(pad, Puck):
        from dummydesign.pad.puck import solve_puck

        return solve_puck(
            pad.diameter_mm, pad.thickness_mm, pad.young_MPa, depth_mm, plates=pad.plates, poisson=pad.poisson,
            law=pad.shape, progress=progress,
        )  # fmt: skip
    from dummydesign.pad.slab.indentation import profile, solve_shaped
    from dummydesign.pad.slab.problem import PadCurve
    from dummydesign.pad.slab.sharp_edge import solve_curve
    from dummydesign.pad.slab.sliding_faces import solve_flat

    common: dict[str, Any] = {"poisson": pad.poisson, "law": pad.shape}
    extent = pad.extent_mm or PAD_EXTENT_MM
    if pad.geometry != Slab():
        return _solve_shape(pad, depth_mm, extent, progress, cells)
    if pad.profile_mm is not None:
        punch = profile(*pad.profile_mm)
        # A pad that rests by its weight is not the same at another modulus.
        unit = 1.0 if pad.base in BASES else pad.young_MPa
        inputs = {"pad": replace(pad, young_MPa=unit, prony=()), "extent": extent, "depth": depth_mm}
        args = (punch, pad.thickness_mm, unit, depth_mm, pad.radius_mm, pad.condition)
        made = cached("profile", inputs, lambda: vars(solve_shaped(*args, base=pad.base, extent_mm=extent, **common)))
        force, error = (made[name] * (pad.young_MPa / unit) for name in ("force_N", "error_N"))
        return PadCurve(**(made | {"force_N": force, "error_N": error}))
    if pad.edge_radius_mm:
        from dummydesign.pad.slab.rubbing.of_condition import solve_under_fillet

        return solve_under_fillet(
            pad.thickness_mm, pad.radius_mm, pad.edge_radius_mm, pad.young_MPa, depth_mm, pad.condition, base=pad.base,
            extent_mm=extent, progress=progress, **common,
        )  # fmt: skip
    solve = solve_curve if pad.condition == "bonded" and pad.base in BASES else solve_flat
    return solve(
        pad.thickness_mm, pad.radius_mm, pad.young_MPa, depth_mm, condition=pad.condition, base=pad.base,
        extent_mm=extent, progress=progress, **common,
    )  # fmt: skip


def _solve_shape(
    pad: Pad, grid: Array, extent_mm: float, progress: Callable[[float], None] | None, cells: int | None = None
) -> PadCurve:
    """Solve a round shaped pad with unit modulus, once for all moduli."""
    from dummydesign.pad.shaped.axisymmetric import solve_shaped_pad
    from dummydesign.pad.slab.problem import PadCurve

    if not pad.geometry.axisymmetric:
        raise InputError(f"shape {pad.geometry} is not round; add --fidelity 3d")
    inputs = {"pad": replace(pad, young_MPa=1.0, prony=()), "extent": extent_mm, "depth": grid}
    args = (pad.geometry, pad.thickness_mm, pad.radius_mm, 1.0, grid, pad.condition)
    more: dict[str, Any] = {"poisson": pad.poisson, "law": pad.shape, "base": pad.base, "progress": progress}
    more["edge_mm"] = pad.edge_radius_mm
    if cells is not None:
        inputs["cells"] = more["cells"] = cells
    made = cached("shaped", inputs, lambda: vars(solve_shaped_pad(*args, extent_mm=extent_mm, **more)))
    force, error = (made[name] * pad.young_MPa for name in ("force_N", "error_N"))
    return PadCurve(**(made | {"force_N": force, "error_N": error}))


def _shape_in_space(
    pad: Pad, deepest_mm: float | None, depths_mm: Array | None, progress: Callable[[float], None] | None
) -> ElasticCurve:
    """A shaped pad under its own punch, square or round, solved in space with unit modulus."""
    from dummydesign.pad.shaped.spatial import solve_shaped_block
    from dummydesign.pad.slab.problem import PadCurve

    grid, _ = depth_grid(pad.thickness_mm, deepest_mm, depths_mm)
    if depths_mm is None:
        grid = grid[1::2]
    punch = pad.radius_mm if pad.sides_mm is None else (0.5 * pad.sides_mm[0], 0.5 * pad.sides_mm[1])
    inputs = {"pad": replace(pad, young_MPa=1.0, prony=()), "depth": grid}
    more: dict[str, Any] = {"base": pad.base, "poisson": pad.poisson, "slab_mm": pad.slab_mm, "law": pad.shape}
    args = (pad.geometry, pad.thickness_mm, punch, 1.0, grid, pad.condition)
    made = cached("shape-3d", inputs, lambda: vars(solve_shaped_block(*args, progress=progress, **more)))
    force, error = (made[name] * pad.young_MPa for name in ("force_N", "error_N"))
    return through(pad.geometry.first_exponent, PadCurve(**(made | {"force_N": force, "error_N": error})))

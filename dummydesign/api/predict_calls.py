"""The call that presses one pad: :func:`predict`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Result
from dummydesign.api.asked_pad import asked_pad, numbers
from dummydesign.core.checks import (
    DECELERATION,
    EDGE,
    FORCE,
    HOLD,
    THICKNESS,
    VELOCITY,
    YOUNG,
    read_number,
)
from dummydesign.core.errors import InputError

if TYPE_CHECKING:
    from dummydesign.pad.pad import Pad, Puck
    from dummydesign.pad.predict import MotionPrediction, StaticPrediction

STATIC = ("depth_mm", "force_N", "force_low_N", "force_high_N", "local_exponent")
MOVED = ("time_s", "displacement_mm", "force_N", "force_low_N", "force_high_N")


def predict(
    thickness_mm: float | str,
    *,
    young_kPa: float | str | None = None,
    resin: str | None = None,
    ratio: float | None = None,
    depth_mm: str | float | Iterable[float] | None = None,
    motion: str | PathLike[str] | None = None,
    force_N: float | str | None = None,
    velocity_mm_s: float | str | None = None,
    hold_s: float | str = 10.0,
    deceleration_mm_s2: float | str = 30000.0,
    tissue: str | None = None,
    aim: str = "average",
    punch: str = "square:14",
    condition: str = "bonded",
    base: str = "bonded",
    pad: str = "slab:150x120",
    shape: str = "slab",
    poisson: float = 0.5,
    law: str = "neo-hookean",
    edge_radius_mm: float = 0.0,
    prony: str | None = None,
    fidelity: str = "table",
    out: str | PathLike[str] | None = None,
    fields: str | PathLike[str] | None = None,
    picture: str | PathLike[str] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Force of one pad at static depths, under a measured motion, or in a ramp and hold.

    Parameters
    ----------
    thickness_mm : float
        Of the undeformed pad, or height of a puck. [mm]
    young_kPa : float, optional
        Long-term (equilibrium) Young's modulus, in place of ``resin`` and ``ratio``. [kPa]
    resin : str, optional
        Name or path; modulus and relaxation are those of the resin at ``ratio``.
    ratio : float, optional
        Mixing ratio, in the resin's own definition.
    depth_mm : numbers or text
        Static depths such as ``[1, 2]`` or ``"1,2"``; or ``motion``, or ``force_N``. [mm]
    motion : path
        CSV with the columns time_s, displacement_mm.
    force_N, velocity_mm_s : float
        Force at the end of a ramp and hold, and speed of the ramp. [N, mm/s]
    hold_s, deceleration_mm_s2 : float
        Hold after the stop, and braking. [s, mm/s2]
    tissue, aim : str
        Hold the pad against a tissue as ``suggest`` does, under presses to 5, 10 and 15 N at 10 and 250 mm/s: the
        answer then has ``verdict`` and ``conditions``. Depths, a motion or a force may be left out.
    punch : str
        ``square:14``, ``round:D``, ``rectangle:AxB``, ``profile:FILE.csv`` or ``plate``.
    condition, base : str
        Face and base: ``bonded``, ``frictionless`` (face) or ``sliding`` (base), ``friction:MU``.
    pad : str
        ``slab:LxW`` or ``cylinder:DIAMETER``.
    shape : str
        Such as ``crowned:10,2``.
    poisson : float
        Poisson's ratio; other than 0.5 (incompressible) only by finite elements.
    law : str
        ``neo-hookean``, ``yeoh:C2_OVER_MU`` or ``ogden:MU,ALPHA;...``.
    edge_radius_mm : float
        Fillet of the punch's edge, 0 (sharp, sides never touch) to 0.3 of its smaller half-width; on a shaped pad with
        ``fidelity="axisymmetric"``. [mm]
    prony : str, optional
        Relaxation ``TAU:BETA,...``, beta relative to the long-term modulus; the resin's by default.
    fidelity : str
        ``table``, ``axisymmetric``, ``3d`` or ``viscoelastic``.
    out : path, optional
        CSV file of the curve.
    fields : path, optional
        ``NAME.vtu`` for displacement, stress and contact at the static depths, with fidelity ``axisymmetric``.
    picture : path, optional
        ``.png``, ``.svg`` or ``.pdf`` of the deformed cross-section with its stress, at up to four of the depths.
    progress : callable, optional
        Called with each solved depth over thickness.

    Returns
    -------
    Result
        The same as ``dummydesign predict --json`` prints for the same question.

    Raises
    ------
    InputError
        For values that are not allowed.
    NoAnswerError
        When the force is out of the pad's reach, or a solve fails.

    Examples
    --------
    >>> import dummydesign
    >>> pad = dummydesign.predict(12, young_kPa=25, depth_mm=[1, 2], punch="round:28")
    >>> [round(force, 2) for force in pad.to_dict()["force_N"]]
    [4.95, 10.74]
    """
    inputs = {name: _in_units(name, value) for name, value in locals().items() if name != "progress"}
    asked = [name for name in ("depth_mm", "motion", "force_N") if inputs[name] is not None]
    if len(asked) > 1 or (not asked and tissue is None):
        raise InputError(f"give exactly one of --depth, --motion and --force, not {len(asked)}")
    from dummydesign.pad.predict import predict_motion, predict_static

    if (fields or picture) and (depth_mm is None or fidelity != "axisymmetric"):
        raise InputError("fields and pictures are of static depths: --depth with --fidelity axisymmetric")
    made, young, sources = asked_pad(inputs)
    warnings = _punch_warnings(made, fidelity) + _sites_warnings(made)
    common: dict[str, Any] = {"inputs": inputs, "sources": sources, "warnings": warnings, "young_kPa": young}
    common["prony"] = [term.to_dict() for term in made.prony]
    found: StaticPrediction | MotionPrediction
    if tissue is not None:
        common |= _against(made, inputs, young)
        common["sources"] = [*sources, *common.pop("tissue_sources")]
        warnings += common.pop("tissue_said")
        if not asked:
            depths = sorted({row["depth_mm"] for row in common["conditions"] if row["depth_mm"] is not None})
            depth_mm = depths or [0.25 * made.thickness_mm]
            asked = ["depth_mm"]
    if depth_mm is not None:
        found = predict_static(made, numbers("depth", depth_mm), fidelity, progress)
    else:
        pressed, reached = _motion(made, inputs)
        common |= reached
        found = predict_motion(made, pressed, fidelity, progress)
    result = {**common, **found.to_dict()}
    result["warnings"] = warnings + [{"code": "stopped_early", "message": note} for note in result.pop("notes")]
    files: dict[str, Any] = {}
    if depth_mm is not None and fidelity == "axisymmetric":
        files = _add_fields(made, result, fields, picture)
    if out:
        files = {"curve": str(_write(out, STATIC if asked == ["depth_mm"] else MOVED, result))} | files
    return Result(found, result | ({"files": files} if files else {}), "predict")


PURPOSES = {
    "thickness_mm": THICKNESS, "young_kPa": YOUNG, "force_N": FORCE, "velocity_mm_s": VELOCITY, "hold_s": HOLD,
    "deceleration_mm_s2": DECELERATION, "edge_radius_mm": EDGE,
}  # fmt: skip


def _in_units(name: str, value: Any) -> Any:
    """A number with the unit it came with, or as it is."""
    return value if value is None or name not in PURPOSES else read_number(value, PURPOSES[name])


def _against(made: Pad | Puck, inputs: dict[str, Any], young: dict[str, float]) -> dict[str, Any]:
    """Verdict and presses of the pad against a tissue."""
    from dummydesign.design.assessment.verdict_of_pad import verdict_of_pad
    from dummydesign.design.scoring.presses import Sampling
    from dummydesign.design.suggestion import condition_rows
    from dummydesign.pad.elastic import elastic_curve
    from dummydesign.pad.pad import Puck
    from dummydesign.tissue.model.tissue_file import load_tissue

    if isinstance(made, Puck):
        raise InputError(f"tissue = {inputs['tissue']}: a puck between plates stands for nobody; give pad and punch")
    site, sampling = load_tissue(inputs["tissue"]), Sampling(
        hold_s=inputs["hold_s"], deceleration_mm_s2=inputs["deceleration_mm_s2"]
    )
    curve = elastic_curve(made, inputs["fidelity"], None, None, None)
    judged, candidate, targets = verdict_of_pad(made, curve, young, site, inputs["aim"], sampling)
    rows = condition_rows(candidate, targets, made.geometry)
    said = [] if site.said is None else [{"code": site.said[0], "message": site.said[1]}]
    sources = list(site.sources)
    return {"verdict": judged.to_dict(), "conditions": rows, "tissue_sources": sources, "tissue_said": said}


def _add_fields(
    made: Pad | Puck, result: dict[str, Any], path: str | PathLike[str] | None, picture: str | PathLike[str] | None
) -> dict[str, Any]:
    """Put the contact pressures into the answer, and write fields and picture where they are asked for."""
    from dummydesign.pad.fields.solve import contact_pressures, has_fields, solve_fields

    depths = [depth for depth in result["depth_mm"] if depth > 0.0]
    if not (path or picture):
        if depths and has_fields(made):
            contact, notes = contact_pressures(made, depths)
            result["contact_pressure"] = contact
            result["warnings"] += [{"code": "contact_pressure", "message": note} for note in notes]
        return {}
    fields, notes = solve_fields(made, depths)
    result["contact_pressure"] = [pressed.contact() for pressed in fields]
    result["warnings"] += [{"code": "contact_pressure", "message": note} for note in notes]
    files: dict[str, Any] = {}
    if path:
        from dummydesign.pad.fields.vtu import write_fields

        files["fields"] = [str(file) for file in write_fields(fields, fspath(path))]
    if picture:
        from dummydesign.pad.fields.picture import write_picture
        from dummydesign.pad.pad import Pad

        assert isinstance(made, Pad)  # a puck was refused by the solve
        title = f"{made.geometry}, {made.thickness_mm:g} mm, {made.young_MPa * 1e3:.3g} kPa"
        files["picture"] = str(write_picture(fields, fspath(picture), title))
    return files


def _motion(made: Pad | Puck, inputs: dict[str, Any]) -> tuple[Any, dict[str, float]]:
    """The measured motion, or the ramp and hold that ends at the force, with its depth."""
    from dummydesign.measurement.motion import ramp_and_hold
    from dummydesign.pad.predict import depth_for_steady_force

    if inputs["motion"] is not None:
        from dummydesign.measurement.motion_file import read_motion

        return read_motion(inputs["motion"]), {}
    velocity, hold = inputs["velocity_mm_s"], inputs["hold_s"]
    if velocity is None:
        raise InputError("--force needs --velocity, the speed of the ramp in mm/s")

    def motion_to(depth: float) -> Any:
        return ramp_and_hold(velocity, depth, hold, inputs["deceleration_mm_s2"])

    depth = depth_for_steady_force(made, inputs["force_N"], hold, motion_to, inputs["fidelity"])
    return motion_to(depth), {"depth_mm": depth}


def _punch_warnings(made: Pad | Puck, fidelity: str) -> list[dict[str, str]]:
    """Warn where a square or rectangle is taken as the circle of equal area."""
    from dummydesign.pad.elastic import has_square_factor
    from dummydesign.pad.pad import Puck

    if isinstance(made, Puck) or made.sides_mm is None or fidelity == "3d":
        return []
    if has_square_factor(made):
        if not made.edge_radius_mm:
            return []
        message = "what a square adds to the circle of its area is that of sharp edges; half of it is stated as error"
        return [{"code": "square_with_fillet", "message": message}]
    message = (
        "the punch is taken as the circle of equal area; a square is 0 to 3 % stiffer (5 to 20 mm pads), "
        "a rectangle more; --fidelity 3d solves it"
    )
    return [{"code": "equal_area_punch", "message": message}]


def _sites_warnings(made: Pad | Puck) -> list[dict[str, str]]:
    """Say that one of several crowns is pressed as if it were alone."""
    from dummydesign.design.sites.pressed_alone import pressed_alone
    from dummydesign.pad.pad import Puck

    return pressed_alone([] if isinstance(made, Puck) else [len(made.geometry.places_mm)])


def _write(path: str | PathLike[str], columns: tuple[str, ...], result: dict[str, Any]) -> Path:
    from dummydesign.core.files import write_text

    rows = zip(*(result[name] for name in columns))
    lines = [",".join(columns), *(",".join(f"{value:.8g}" for value in row) for row in rows)]
    return write_text(fspath(path), "\n".join(lines) + "\n")

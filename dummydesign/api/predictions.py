"""The call that presses one pad: `predict`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import inf, pi, sqrt
from os import fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Predicted
from dummydesign.core import parsing
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.files import FilePath, write_text
from dummydesign.core.parsing import one_of, parts_of, read_allowed, read_number, read_numbers, twin_of

if TYPE_CHECKING:
    from dummydesign.measurement.motion import Motion
    from dummydesign.pad.material.hyperelastic import Ogden
    from dummydesign.pad.material.relaxation import PronyTerm
    from dummydesign.pad.pad_under_punch import Pad, Puck
    from dummydesign.pad.predict import MotionPrediction, StaticPrediction
    from dummydesign.tissue.model.tissue import Tissue


def pad_of_inputs(inputs: dict[str, Any]) -> tuple[Pad | Puck, dict[str, float], list[str]]:
    """Make the pad or puck of the question; also its modulus with interval, and sources."""
    from dummydesign.geometry.dimensions import check_covers
    from dummydesign.geometry.interface import BASES, FACES, Interface
    from dummydesign.geometry.punch import read_punch
    from dummydesign.geometry.shape_registry import read_shape
    from dummydesign.pad.material.hyperelastic import read_law
    from dummydesign.pad.pad_under_punch import SLAB, Pad, Puck

    # a value that nothing can solve is refused before a table or solver says that another one is needed
    Interface.parse(inputs["base"], "base", BASES)
    Interface.parse(inputs["condition"], "condition", FACES)
    if not 0.0 < inputs["poisson"] <= 0.5:
        message = f"Poisson's ratio = {inputs['poisson']:g} is outside the allowed range 0 (excluded) to 0.5"
        raise InputError(message, "out_of_range", "poisson", inputs["poisson"], (0.0, 0.5))
    young, sources, prony, own_law = _material(inputs)
    size_text, punch = inputs["pad"], inputs["punch"]
    kind, _, size = size_text.partition(":")
    count = {"slab": 2, "cylinder": 1}.get(kind)
    sides = read_numbers(size.replace("x", ","), "pad in mm") if count else ()
    if count != len(sides) or not min(sides) > 0:
        message = f"pad '{size_text}' is not of the form slab:LENGTHxWIDTH or cylinder:DIAMETER in mm"
        raise InputError(message, "malformed", "pad", size_text)
    cylinder, plate = kind == "cylinder", punch == "plate"
    if cylinder != plate:
        message = f"pad '{size_text}' and punch '{punch}': plates press cylinders only"
        raise InputError(message, "conflict", "punch", punch)
    law, geometry = own_law or read_law(inputs["law"], young["value"] * 1e-3), read_shape(inputs["shape"])
    if cylinder:
        if geometry != SLAB:
            message = f"shape {geometry} is pressed by a flat punch, not by a profile or plates"
            raise InputError(message, "conflict", "shape", str(geometry))
        if inputs["base"] != "bonded":
            message = f"base = {inputs['base']}: both plates hold a puck alike; say how by --condition"
            raise InputError(message, "not_applicable", "base", inputs["base"])
        if inputs["edge_radius_mm"]:
            message = f"edge_radius_mm = {inputs['edge_radius_mm']:g} is of a punch; plates have no edge"
            raise InputError(message, "not_applicable", "edge_radius_mm", inputs["edge_radius_mm"])
        given = inputs["thickness_mm"], young["value"] * 1e-3, sides[0], prony, inputs["condition"], inputs["poisson"]
        return Puck(*given, law), young, sources
    face = read_punch(punch)
    widest = max(face.sides_mm or (2.0 * face.radius_mm,))
    check_covers(size, sides, widest, punch)
    same = {name: inputs[name] for name in ("thickness_mm", "base", "condition", "poisson", "edge_radius_mm")}
    made = Pad(
        **same,
        young_MPa=young["value"] * 1e-3,
        radius_mm=face.radius_mm,
        prony=prony,
        law=law,
        geometry=geometry,
        extent_mm=sqrt(sides[0] * sides[-1] / pi),
        sides_mm=face.sides_mm,
        slab_mm=(sides[0], sides[-1]),
        profile_mm=face.profile_mm,
    )
    return made, young, sources


def _material(inputs: dict[str, Any]) -> tuple[dict[str, float], list[str], tuple[PronyTerm, ...], Ogden | None]:
    """Modulus with interval, sources and relaxation, given or from a resin, and its elastic law where it has one."""
    prony = _prony(inputs["prony"])
    either = "give either --young KPA or --resin NAME with --ratio R"
    if (inputs["young_kPa"] is None) == (inputs["resin"] is None):
        code = "missing" if inputs["resin"] is None else "conflict"
        raise InputError(either, code, "young")
    if inputs["young_kPa"] is not None and inputs["ratio"] is not None:
        message = f"ratio = {inputs['ratio']:g} has no effect on a given modulus: {either}"
        raise InputError(message, "conflict", "ratio", inputs["ratio"])
    if inputs["young_kPa"] is not None:
        return dict.fromkeys(("value", "low", "high"), inputs["young_kPa"]), [], prony, None
    from dummydesign.pad.tables.elastic_law import ogden_law
    from dummydesign.resin import load_resin

    if inputs["ratio"] is None:
        raise InputError("--resin needs --ratio, the mixing ratio", "missing", "ratio")
    resin = load_resin(inputs["resin"])
    modulus = resin.modulus_kPa(inputs["ratio"])
    prony = prony if inputs["prony"] is not None else resin.prony(inputs["ratio"])
    young = {"value": modulus.value, "low": modulus.low, "high": modulus.high}
    alpha = resin.ogden_alpha if inputs["law"] == "neo-hookean" else None
    sources = [modulus.source, *([] if alpha is None else [f"elastic law: {alpha.source}"]), *resin.references]
    return young, sources, prony, None if alpha is None else ogden_law(alpha.value)


def modulus_warnings(young: dict[str, float]) -> list[dict[str, str]]:
    """Warn where no gel or tissue has the modulus."""
    low, high = parsing.YOUNG.usual
    if low <= young["value"] <= high:
        return []
    message = f"a modulus of {young['value']:g} kPa is not one of a gel ({low:g} to {high:g} kPa): check its unit"
    return [{"code": "implausible_unit", "message": message}]


def relaxation_warnings(made: Pad | Puck, moves: bool) -> list[dict[str, str]]:
    """Warn where a pad without relaxation is pressed in time; ``moves`` says whether it is."""
    if made.prony or not moves:
        return []
    message = (
        "this pad has no relaxation: its force does not depend on speed. "
        "Give --resin with --ratio, or --young with --prony TAU:BETA"
    )
    return [{"code": "no_relaxation", "message": message}]


def pad_warnings(made: Pad | Puck, fidelity: str) -> list[dict[str, str]]:
    """Warn where a square or rectangle is taken as the circle of its area, or one of several crowns as if alone."""
    from dummydesign.design.crown_array import pressed_alone
    from dummydesign.pad.force_source import has_square_factor
    from dummydesign.pad.pad_under_punch import Puck

    if isinstance(made, Puck):
        return []
    alone = pressed_alone([len(made.geometry.places_mm)])
    if made.sides_mm is None or fidelity == "3d":
        return alone
    if not has_square_factor(made):
        message = "the punch is taken as the circle of equal area; its corners are left out; --fidelity 3d solves them"
        return [{"code": "equal_area_punch", "message": message}, *alone]
    message = "what a square adds to the circle of its area is that of sharp edges; half of it is stated as error"
    return [{"code": "square_with_fillet", "message": message}, *alone] if made.edge_radius_mm else alone


def _prony(text: str | None) -> tuple[PronyTerm, ...]:
    """Terms from ``TAU:BETA,...``."""
    from dummydesign.pad.material.relaxation import PronyTerm

    if not text:
        return ()
    terms = []
    for part in text.split(","):
        pair = part.split(":")
        if len(pair) != 2:
            raise InputError(f"--prony '{part}' is not TAU:BETA, such as 0.1:0.3,1.5:0.3", "malformed", "prony", part)
        terms.append(PronyTerm(*(read_number(number, "prony") for number in pair)))
    return tuple(terms)


STATIC = ("depth_mm", "force_N", "force_low_N", "force_high_N", "local_exponent")
MOVED = ("time_s", "displacement_mm", "force_N", "force_low_N", "force_high_N")


def predict(
    thickness_mm: float | str,
    *,
    young_kPa: float | str | None = None,
    resin: str | None = None,
    ratio: float | None = None,
    depth_mm: str | float | Iterable[float] | None = None,
    motion: FilePath | None = None,
    force_N: float | str | Iterable[float] | None = None,
    velocity_mm_s: float | str | Iterable[float] | None = None,
    hold_s: float | str = 10.0,
    deceleration_mm_s2: float | str = 30_000.0,
    drive: str = "position",
    tissue: str | None = None,
    aim: str = "average",
    punch: str = "square:14",
    condition: str = "bonded",
    base: str = "bonded",
    pad: str = "slab:150x120",
    shape: str = "slab",
    poisson: float = 0.5,
    law: str = "neo-hookean",
    edge_radius_mm: float | str = 0.0,
    prony: str | None = None,
    fidelity: str = "table",
    out: FilePath | None = None,
    rate_Hz: float | str | None = None,
    units: str = "mm",
    fields: FilePath | None = None,
    picture: FilePath | None = None,
    progress: Callable[[float], None] | None = None,
) -> Predicted:
    """Force of one pad at static depths, under a measured motion, in a ramp and hold, or as it stops a free mass.

    Parameters
    ----------
    thickness_mm : --thickness MM
        Of the pad at its highest point. [mm]

        Height of a puck.
    young_kPa : KPA
        Long-term Young's modulus in kPa. [kPa]

        In place of ``resin`` and ``ratio``.
    resin : NAME|FILE
        Resin, with --ratio (default polyurethane-nagoya).

        Modulus and relaxation are those of the resin at this ratio.
    ratio : R
        Mixing ratio of the resin.
    depth_mm : D1,D2,...
        Static depths in mm. [mm]

        Such as ``[1, 2]`` or ``"1,2"``; or ``motion``, or ``force_N``.
    motion : FILE.csv
        Measured motion: columns time_s, displacement_mm.
    force_N : N,...
        Force at the end of the hold, with --velocity; one or several. [N]

        Several of force or speed make ``presses`` with one entry for each force at each speed; the other keys are those
        of the last press.
    velocity_mm_s : MM_S,...
        Speed of the ramp; one or several. [mm/s]
    hold_s : S
        Hold after the stop (default 10 s). [s]
    deceleration_mm_s2 : MM_S2
        Braking (default 30000 mm/s2). [mm/s2]
    drive : NAME
        ``position`` (default), or ``mass:KG``: the pad stops a free mass that hits at --velocity.

        The curves begin with a short free flight and end after the rebound; ``out`` is a trace for
        :func:`dummydesign.on_person`.
    tissue : NAME|FILE
        Compare the pad with a tissue: the verdict and its numbers.

        As ``suggest`` does, under presses to 5, 10 and 15 N at 10 and 250 mm/s: the answer then has ``verdict`` and
        ``conditions``. Depths, a motion or a force may be left out.
    aim : AIM
        With --tissue: ``average`` (default), ``safe-side``, ``subject:NAME`` or ``people:PERCENT``.
    punch : KIND:SIZE
        ``square:14`` (default), ``round:D``, ``rectangle:AxB``, ``ball:D``, ``profile:FILE.csv``, ``plate``.
    edge_radius_mm : MM
        Fillet of the punch's edge, 0 (default, sharp) to 0.3 of its half-width; shapes: --fidelity axisymmetric. [mm]
    condition : NAME
        ``bonded`` (default), ``frictionless``, ``friction:MU``.
    base : NAME
        ``bonded`` (default), ``sliding`` or ``friction:MU``.
    pad : slab:LxW
        Slab (default 150x120 mm) or cylinder:DIAMETER.
    shape : NAME[:P,..]
        Of the pad: a shape of the package; as crowned:RADIUS,HEIGHT.
    poisson : NU
        Poisson's ratio (default 0.5).

        Other than 0.5 (incompressible) only by finite elements.
    law : NAME
        ``neo-hookean`` (default), ``yeoh:C2_OVER_MU``, ``ogden:MU,ALPHA``;.. or ogden-abaqus:MU,ALPHA;.. (scaled to the
        modulus).
    prony : TAU:BETA,...
        Relaxation, beta relative to the long-term modulus.

        The resin's by default.
    fidelity : NAME
        ``table`` (default), ``axisymmetric``, ``3d`` or ``viscoelastic``.
    out : FILE.csv
        Write the curve as CSV; several presses to a file each.

        Named as in ``NAME_5N_10mm_s.csv``.
    rate_Hz : HZ
        Uniform sampling rate in --out (default: the computed times). [Hz]
    units : NAME
        Of --out: ``mm`` (mm, N; default) or ``in`` (inches, pounds-force).
    fields : FILE.vtu
        Stress and contact at the depths, for ParaView (axisymmetric).
    picture : FILE.png
        Deformed cross-section with stress and contact pressure (axisymmetric).

        Also ``.svg`` or ``.pdf``, at up to four of the depths.
    progress : callable, optional
        Called with each solved depth over thickness.

    Returns
    -------
    Predicted
        The same as ``dummydesign predict --json`` prints for the same question.

    Raises
    ------
    InputError
        For values that are not allowed.
    NoAnswerError
        When the force is out of the pad's reach, the pad bottoms out under the mass, or a solve fails.

    Examples
    --------
    >>> import dummydesign
    >>> pad = dummydesign.predict(12, young_kPa=25, depth_mm=[1, 2], punch="round:28")
    >>> [round(force, 2) for force in pad.to_dict()["force_N"]]
    [4.95, 10.74]
    """
    inputs = {name: _in_units(name, value) for name, value in locals().items() if name != "progress"}
    if ratio is not None and resin is None and young_kPa is None:
        from dummydesign.resin.model.resin_file import DEFAULT

        inputs["resin"] = DEFAULT
    mass_kg = _free_mass_kg(drive)
    asked = [name for name in ("depth_mm", "motion", "force_N") if inputs[name] is not None]
    asked += [] if mass_kg is None else [DRIVE]
    if len(asked) > 1 or (not asked and tissue is None):
        given = f"{len(asked)} of them are given" if asked else "none is given"
        message = f"give exactly one of --depth, --motion, --force (with --velocity) and --drive mass:KG; {given}"
        raise InputError(message, "conflict" if asked else "missing", "depth")
    if velocity_mm_s is not None and asked in (["depth_mm"], ["motion"]) and tissue is None:
        why = "forces at a depth are static" if asked == ["depth_mm"] else "a motion has its own speed"
        given = asked[0].removesuffix("_mm")
        message = f"--velocity is of a ramp, and {why}: leave it out, or give --force in place of --{given}"
        raise InputError(message, "not_applicable", "velocity_mm_s")
    _check_unused(inputs, asked, tissue)
    from dummydesign.measurement.trace import read_motion
    from dummydesign.pad.predict import predict_motion, predict_static

    if (fields or picture) and (depth_mm is None or fidelity != "axisymmetric"):
        message = "fields and pictures are of static depths: --depth with --fidelity axisymmetric"
        raise InputError(message, "not_applicable", "fields" if fields else "picture")
    one_of("units", units, parsing.SYSTEMS)
    if units != parsing.SYSTEMS[0] and out is None:
        raise InputError("--units is of the table that --out writes: give --out", "not_applicable", "units", units)
    if rate_Hz is not None and (out is None or asked in ([], ["depth_mm"])):
        message = "--rate is of curves over time in a file: give --out, and --motion, --force or --drive mass:KG"
        raise InputError(message, "not_applicable", "rate_Hz", rate_Hz)
    made, young, sources = pad_of_inputs(inputs)
    moves = asked != ["depth_mm"] or tissue is not None
    warnings = modulus_warnings(young) + relaxation_warnings(made, moves) + pad_warnings(made, fidelity)
    common: dict[str, Any] = {"inputs": inputs, "sources": sources, "warnings": warnings, "young_kPa": young}
    common["prony"] = [term.to_dict() for term in made.prony]
    prediction: StaticPrediction | MotionPrediction
    if tissue is not None:
        compared, site = _against(made, inputs, young)
        common |= {**compared, "sources": [*sources, *site.sources]}
        warnings += [] if site.notice is None else [{"code": site.notice[0], "message": site.notice[1]}]
        if not asked:
            depths = sorted({row["depth_mm"] for row in common["conditions"] if row["depth_mm"] is not None})
            depth_mm = depths or [0.25 * made.thickness_mm]
            asked = ["depth_mm"]
    if depth_mm is not None:
        depths = [read_number(depth, parsing.DEPTH) for depth in parts_of(depth_mm)]
        prediction = predict_static(made, depths, fidelity, progress)
    elif motion is not None:
        moved = read_motion(Path(motion))
        prediction = predict_motion(made, moved, fidelity, progress)
        common |= _measured(Path(motion), moved, prediction, warnings)
    elif mass_kg is not None:
        from dummydesign.person.free_mass import mass_on_pad

        speed = _one_speed(inputs["velocity_mm_s"], drive)
        try:
            stopped = mass_on_pad(made, mass_kg, speed, fidelity, progress)
        except NoAnswerError as problem:
            raise NoAnswerError(problem.code, str(problem), common | problem.result, problem.quantity) from None
        prediction = stopped.prediction
        common |= stopped.to_dict()
    else:
        prediction, reached = _presses(made, inputs, progress)
        common |= reached
    result = {**common, **prediction.to_dict()}
    result["warnings"] = warnings + [{"code": "stopped_early", "message": note} for note in result.pop("notes")]
    files: dict[str, Any] = {}
    if depth_mm is not None and fidelity == "axisymmetric":
        files = _add_fields(made, result, fields, picture)
    if out:
        columns = STATIC if asked == ["depth_mm"] else MOVED
        files = _write(fspath(out), columns, result, inputs["rate_Hz"], units) | files
    return Predicted(prediction, result | ({"files": files} if files else {}))


AVERAGE = "average"
"""Value of ``aim`` when it is not given."""


DRIVE = "drive"


def _free_mass_kg(drive: str) -> float | None:
    """Mass of ``mass:KG``; None for ``position``, a press that the robot leads. [kg]"""
    from dummydesign.person.drives import read_drive

    read = read_drive(drive)
    if read.name not in ("position", "mass"):
        message = f"drive = {drive} is of a press that was measured: predict knows position and mass:KG"
        raise InputError(message, "not_applicable", DRIVE, drive, ["position", "mass:KG"])
    return read.values[0] if read.values else None


def _one_speed(velocity_mm_s: float | list[float] | None, drive: str) -> float:
    """The speed at which a mass hits. [mm/s]"""
    if velocity_mm_s is None or isinstance(velocity_mm_s, list):
        code, message = "missing", f"--drive {drive} needs --velocity, the speed at which the mass hits, in mm/s"
        if velocity_mm_s is not None:
            code, message = "conflict", f"--drive {drive} takes one --velocity; {len(velocity_mm_s)} are given"
        raise InputError(message, code, "velocity")
    return velocity_mm_s


def _check_unused(inputs: dict[str, Any], asked: list[str], tissue: str | None) -> None:
    """Refuse an aim, a hold and a braking that nothing reads."""
    from dummydesign.measurement.motion import DECELERATION_MM_S2, HOLD_S

    if tissue is not None:
        return
    if inputs["aim"] != AVERAGE:
        message = f"aim = {inputs['aim']} is of a tissue's subjects: give --tissue, or leave --aim out"
        raise InputError(message, "not_applicable", "aim", inputs["aim"])
    if asked == ["force_N"]:
        return
    words = "is of a ramp: leave it out, or give --force with --velocity"
    if inputs["hold_s"] != HOLD_S:
        raise InputError(f"--hold {inputs['hold_s']:g} {words}", "not_applicable", "hold_s", inputs["hold_s"])
    if (braking := inputs["deceleration_mm_s2"]) != DECELERATION_MM_S2:
        raise InputError(f"--deceleration {braking:g} {words}", "not_applicable", "deceleration_mm_s2", braking)


def _measured(
    path: Path, motion: Motion, prediction: MotionPrediction, warnings: list[dict[str, Any]]
) -> dict[str, Any]:
    """Error against the force of the motion's own file, where it has one; largest forces over five samples."""
    import numpy as np

    from dummydesign.measurement.trace import read_motion_force

    try:
        force = read_motion_force(path)
    except InputError as problem:
        message = f"the prediction is not compared with the file's force: {problem}"
        warnings.append({"code": "force_not_compared", "message": message})
        return {}
    if force is None:
        return {}
    solved = motion.time_s <= prediction.time_s[-1] + 1e-9  # a solution may stop early
    if solved.sum() < 2:
        return {}
    force, own = force[solved], np.interp(motion.time_s[solved], prediction.time_s, prediction.force_N)
    kernel = np.ones(min(5, len(force))) / min(5, len(force))
    peak, measured = (float(np.convolve(one, kernel, "valid").max()) for one in (own, force))
    rmse = float(np.sqrt(np.mean((own - force) ** 2)))
    return {"measured": {"rmse_N": rmse, "peak_error_N": peak - measured, "peak_force_N": measured}}


ALLOWED = {
    "thickness_mm": (parsing.THICKNESS, 0.01, 1000.0),
    "young_kPa": (parsing.YOUNG, *parsing.YOUNG_KPA),
    "force_N": (parsing.FORCE, 1e-4, 1e5),
    "velocity_mm_s": (parsing.VELOCITY, 1e-4, 1e5),
    "hold_s": (parsing.HOLD, 1e-6, 1e6),
    "deceleration_mm_s2": (parsing.DECELERATION, 1e-3, inf),
    "rate_Hz": (parsing.RATE, *parsing.RATES_HZ),
}
"""Purpose, smallest and largest of each number; those of the edge follow from the punch."""
SEVERAL = ("force_N", "velocity_mm_s")
"""Of which there may be several."""


def _in_units(name: str, value: Any) -> Any:
    """A number with the unit it came with, several where they are taken, or as it is."""
    if value is None or name not in ALLOWED:
        return read_number(value, parsing.EDGE) if name == "edge_radius_mm" else value
    purpose, low, high = ALLOWED[name]
    if name not in SEVERAL or isinstance(value, int | float):
        return read_allowed(value, purpose, low, high)
    values = [read_allowed(part, purpose, low, high) for part in parts_of(value)]
    if not values:
        raise InputError(f"{purpose.quantity} has no value; give at least one", "missing", name)
    return values[0] if len(values) == 1 else values


def _against(made: Pad | Puck, inputs: dict[str, Any], young: dict[str, float]) -> tuple[dict[str, Any], Tissue]:
    """Verdict and presses of the pad against a tissue, and the tissue."""
    from dummydesign.design.pad_evaluator import verdict_of_pad
    from dummydesign.design.scoring.press_simulation import Sampling
    from dummydesign.design.suggestion import condition_rows
    from dummydesign.pad.force_source import elastic_curve
    from dummydesign.pad.pad_under_punch import Puck
    from dummydesign.tissue.model.tissue_file import load_tissue

    if isinstance(made, Puck):
        message = f"tissue = {inputs['tissue']}: a puck between plates stands for nobody; give pad and punch"
        raise InputError(message, "not_applicable", "tissue", inputs["tissue"])
    site = load_tissue(inputs["tissue"])
    sampling = Sampling(hold_s=inputs["hold_s"], deceleration_mm_s2=inputs["deceleration_mm_s2"])
    curve = elastic_curve(made, inputs["fidelity"])
    resin = None
    if inputs.get("resin") is not None and inputs.get("ratio") is not None:
        from dummydesign.resin import load_resin

        resin = load_resin(inputs["resin"]), float(inputs["ratio"])
    judged, candidate, targets = verdict_of_pad(made, curve, young, site, inputs["aim"], sampling, resin)
    return {"verdict": judged.to_dict(), "conditions": condition_rows(candidate, targets, made.geometry)}, site


def _add_fields(
    made: Pad | Puck, result: dict[str, Any], path: FilePath | None, picture: FilePath | None
) -> dict[str, Any]:
    """Put the contact pressures into the answer, and write fields and picture where requested."""
    from dummydesign.pad.fields import contact_pressures, has_fields, solve_fields

    depths = [depth for depth in result["depth_mm"] if depth > 0.0]
    if path or picture:
        fields, notes = solve_fields(made, depths)
        contacts = [pressed.contact() for pressed in fields]
    elif depths and has_fields(made):
        contacts, notes = contact_pressures(made, depths)
    else:
        return {}
    result["contact_pressure"] = contacts
    result["warnings"] += [{"code": "contact_pressure", "message": note} for note in notes]
    files: dict[str, Any] = {}
    if path:
        from dummydesign.pad.field_files import write_fields

        files["fields"] = [str(file) for file in write_fields(fields, fspath(path))]
    if picture:
        from dummydesign.pad.field_files import write_picture
        from dummydesign.pad.pad_under_punch import Pad

        assert isinstance(made, Pad)  # a puck was refused by the solve
        title = f"{made.geometry}, {made.thickness_mm:g} mm, {made.young_MPa * 1e3:.3g} kPa"
        files["picture"] = str(write_picture(fields, fspath(picture), title))
    return files


def _presses(
    made: Pad | Puck, inputs: dict[str, Any], progress: Callable[[float], None] | None
) -> tuple[MotionPrediction, dict[str, Any]]:
    """The press to the force, or the last in reach of several, with its depth and all of the several."""
    from dummydesign.pad.predict import press_to_forces

    if inputs["velocity_mm_s"] is None:
        raise InputError("--force needs --velocity, the speed of the ramp in mm/s", "missing", "velocity")
    forces, speeds = (value if isinstance(value, list) else [value] for value in (inputs[name] for name in SEVERAL))
    braking, fidelity = inputs["deceleration_mm_s2"], inputs["fidelity"]
    presses = press_to_forces(made, forces, speeds, inputs["hold_s"], braking, fidelity, progress)
    last = [press for press in presses if press.prediction is not None][-1]
    assert last.prediction is not None
    several = {} if len(presses) == 1 else {"presses": [press.to_dict() for press in presses]}
    return last.prediction, {"depth_mm": last.depth_mm, **several}


def _write(
    path: str, columns: tuple[str, ...], result: dict[str, Any], rate_Hz: float | None, units: str
) -> dict[str, str]:
    """Write the curve, or one file a press that is in reach; return them by role."""
    if "presses" not in result:
        curves, names = [result], [""]
    else:
        curves = [press for press in result["presses"] if columns[0] in press]
        names = [f"_{press['steady_force_N']:g}N_{press['velocity_mm_s']:g}mm_s" for press in curves]
    if rate_Hz is not None:
        curves = _at_rate(curves, columns, rate_Hz)
    target, files = Path(path), {}
    for curve, name in zip(curves, names):
        file = target.with_name(f"{target.stem}{name}{target.suffix}") if name else target
        files[f"curve{name}"] = str(write_text(file, _csv(columns, curve, units)))
    return files


def _at_rate(curves: list[dict[str, Any]], columns: tuple[str, ...], rate_Hz: float) -> list[dict[str, Any]]:
    """The curves at a uniform rate, each from its first time on."""
    import numpy as np

    from dummydesign.core.interpolation import uniform_times

    times = uniform_times([(curve["time_s"][0], curve["time_s"][-1]) for curve in curves], rate_Hz)
    return [
        {"time_s": time, **{name: np.interp(time, curve["time_s"], curve[name]) for name in columns[1:]}}
        for curve, time in zip(curves, times)
    ]


def _csv(columns: tuple[str, ...], curve: dict[str, Any], units: str) -> str:
    names, sizes = zip(*(twin_of(name, units) for name in columns))
    rows = zip(*([value / size for value in curve[name]] for name, size in zip(columns, sizes)))
    return "\n".join([",".join(names), *(",".join(f"{value:.8g}" for value in row) for row in rows)]) + "\n"

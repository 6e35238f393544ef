"""The calls that design a pad and sweep over designs: `suggest`, `whatif`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace as replace_fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Answer, Rows, answer_folder, question
from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.files import FilePath, write_text
from dummydesign.core.progress import quiet
from dummydesign.core.serialise import json_text

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from dummydesign.core.outputs import Output
    from dummydesign.design.plot_data import PressPictures
    from dummydesign.design.request import Request
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.design.sweep.spec import Study
    from dummydesign.mold.client import CadChild
    from dummydesign.resin.model.resin import Resin


Numbers = float | str | Iterable[float | str]


def suggest(
    tissue: str,
    *,
    aim: str = "average",
    resin: str = "polyurethane-nagoya",
    thickness_mm: tuple[float, float] | str | None = None,
    ratio: tuple[float, float] | str | None = None,
    shape: str = "auto",
    mould: FilePath | None = None,
    calibration: FilePath | None = None,
    effects: Iterable[FilePath] = (),
    verify: bool = True,
    cad: bool = True,
    punch: str = "square:14",
    force_N: Numbers = (5.0, 10.0, 15.0),
    velocity_mm_s: Numbers = (10.0, 250.0),
    hold_s: float | str = 10.0,
    deceleration_mm_s2: float | str = 30_000.0,
    pad: tuple[float, float] | str = "150x120",
    base: str = "bonded",
    edge_radius_mm: float | str = 0.0,
    condition: str | None = None,
    preset: str = "open",
    sites: tuple[int, int] | str | None = None,
    out: FilePath | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Answer:
    """Recommend ratio, thickness and, on request, shape of a pad for a tissue; with ``out`` its mould and report.

    Parameters
    ----------
    tissue : --tissue NAME|FILE
        See 'dummydesign tissues list'.
    aim : AIM
        ``average`` (default), ``safe-side``, ``subject:NAME`` or ``people:PERCENT``.
    resin : NAME|FILE
        See 'dummydesign resins list'.
    thickness_mm : MIN:MAX
        Search range in mm, in 3 to 30. [mm]

        Also as two numbers; both ends are included.
    ratio : MIN:MAX
        Search range of the mixing ratio, within the resin's range.
    shape : NAME[:P,..]
        ``auto`` (default), a shape of the package; lengths not given are searched.
    mould : DIR|FILE
        Keep shape and thickness of a mould that was made; choose the ratio for the resin at hand.
    calibration : FILE
        File written by 'dummydesign loop'; none: ignore the project's.
    effects : --effect FILE.py ...
        File with one effect class of your own; its code is run; may be repeated.
    verify
        Do not check the design by finite elements.

        In Python ``verify=False``.
    cad
        Skip the mould; write recipe and report only.

        In Python ``cad=False``. A mould is made into ``out`` unless the verdict is red
        (``answer.outcome.verdict.acceptable``); the recipe is then that of the solids' volumes.
    punch : KIND:SIZE
        ``square:14`` (default), ``rectangle:AxB``, ``round:D``, ``ball:D``, ``profile:FILE.csv``.
    edge_radius_mm : MM
        Fillet of the punch's edge (default 0, sharp). [mm]

        To 0.3 of its half-width; solved for slabs.
    condition : NAME
        ``bonded`` (default; under a ball or a profile frictionless), ``frictionless``, ``friction:MU``.

        How the punch holds the pad's face; solved for slabs.
    force_N : F1,F2,...
        Steady forces (default 5,10,15 N). [N]
    velocity_mm_s : V1,V2,...
        Speeds (default 10,250 mm/s). [mm/s]
    hold_s : S
        Hold after the stop (default 10 s). [s]
    deceleration_mm_s2 : MM_S2
        Braking (default 30000 mm/s2). [mm/s2]
    pad : LxW
        Length and width of the pad (default 150x120 mm).
    base : NAME
        ``bonded`` (default), ``sliding`` or ``friction:MU``.
    sites : NxM
        Crowns along and across one pad, such as 4x3, far enough apart to be independent.
    preset : NAME|FILE
        Mould preset: ``open`` (default), ``lidded``, ``printed`` or a TOML file.
    out : DIR
        Folder of the files (default suggest-TISSUE).

        Without it nothing is written, and no mould made; the next free number when it holds the answer to another
        question.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).
    progress : callable, optional
        Called with the name of each step as it begins.

    Returns
    -------
    Answer
        The same as ``dummydesign suggest --json`` prints for the same question.

    Raises
    ------
    InputError
        For unknown names or ranges outside what is allowed.
    NoAnswerError
        When no pad reaches 10 N steady, or the mould could not be made: the report is then written and the rest of
        the answer in the error's ``result``.

    Examples
    --------
    >>> import dummydesign
    >>> answer = dummydesign.suggest("forefinger", shape="crowned", verify=False).to_dict()
    >>> answer["recommendation"]["thickness_mm"], answer["recommendation"]["ratio"]
    (4.5, 15.5)
    >>> [(part["name"], part["mass_g"]) for part in answer["recommendation"]["recipe"]["components"]]
    [('polyol', 54.2), ('isocyanate', 8.4)]
    """
    given = dict(locals())
    from dummydesign.design.request import Request

    request, folder = Request.read(**given), None if out is None else Path(out)
    if folder is None:
        request = replace_fields(request, cad=False)
    with _effects(request):
        return _answer(request, folder, replace, progress or quiet)


def _effects(request: Request) -> AbstractContextManager[None]:
    """The effects of some files; nothing of the loop is loaded where neither they nor a calibration are given."""
    if not request.effects and request.calibration is None:
        return nullcontext()
    from dummydesign.loop.effects.registry import own_effects

    return own_effects(request.effects)


def _child(output: Output | None, cad: bool) -> AbstractContextManager[CadChild | None]:
    """The CAD child, loading the kernel beside the search; none where no mould may be made."""
    if output is None or not cad:
        return nullcontext()
    from dummydesign.mold.client import child_ahead

    return child_ahead()


@one_blas_thread()
def _answer(request: Request, folder: Path | None, replace: bool, progress: Callable[[str], None]) -> Answer:
    """Resolve, design, and write what there is a folder for."""
    from dummydesign.design.next_steps import whole_answer
    from dummydesign.design.problem import read_problem
    from dummydesign.design.suggest import design

    wanted = read_problem(request)
    inputs = request.to_dict() | {"out": None if folder is None else str(folder)}
    inputs["weights"] = wanted.targets.weights.to_dict()
    profile = request.punch.partition("profile:")[2] or None
    read = (request.calibration, *request.effects, profile)
    asked = question(
        "suggest", inputs, tissue=request.tissue, resin=request.resin, files=read, named=dict(wanted.files)
    )
    with answer_folder(folder, asked, replace) as output, _child(output, request.cad) as child:
        suggestion = design(wanted, progress)
        if output is None:
            return Answer(suggestion, whole_answer(suggestion, inputs))
        cad = request.cad and suggestion.verdict.acceptable
        inputs = {**inputs, "cad": cad, "out": str(output.folder)}
        progress("mould and report" if cad else "report")
        drawn: list[PressPictures] = []

        def draw() -> None:
            from dummydesign.design.plot_data import press_pictures

            drawn.append(press_pictures(suggestion))

        if child is not None:
            child.meanwhile = draw
        mould, missing = _mould(suggestion, output) if cad else (None, None)
        if not drawn:
            draw()
        result = _written(suggestion, whole_answer(suggestion, inputs, mould), output, drawn[0])
        best = result["recommendation"]
        output.extra["summary"] = {name: best[name] for name in ("shape", "thickness_mm", "ratio", "resin")} | {
            "tissue": inputs["tissue"],
            "young_kPa": best["young_kPa"]["value"],
            "verdict": result["verdict"]["level"],
            **_share_and_correction(result),
            "text": result["verdict"]["text"],
            "next": result["next"][0],
            **({"mould": True} if mould else {}),
        }
    if missing is not None:
        raise NoAnswerError(missing.code, output.settled(str(missing)), result, missing.quantity)
    return Answer(suggestion, result)


def _share_and_correction(result: dict[str, Any]) -> dict[str, float]:
    """The share of castings that decides and its factor: with the batch measured, else after one puck."""
    decides, factor = result["shares"]["after_puck"], result["shares"]["after_puck"]["factor"]
    if result["batch_measured"]:
        decides, factor = result["shares"]["as_poured"], result["verdict"]["correction"]["factor"]
    usable = {"usable_fraction": decides["usable"]}
    helps = factor is not None and result["verdict"]["light"] != "red"
    return usable | {"correction_factor": factor} if helps else usable


def _mould(suggestion: Suggestion, output: Output) -> tuple[dict[str, Any] | None, NoAnswerError | None]:
    """Make the mould; one that cannot be made leaves the report, and the reason is returned."""
    from dummydesign.design.suggestion import make_mould

    try:
        mould = make_mould(suggestion, output.work)
    except NoAnswerError as reason:
        return None, reason
    output.extra["hash"] = mould["spec_hash"]
    return mould, None


def _written(suggestion: Suggestion, result: dict[str, Any], output: Output, pictures: PressPictures) -> dict[str, Any]:
    """Write the report and the answer, and return the answer with all files."""
    from dummydesign.report.suggest import write_suggestion

    report = write_suggestion(output.work, suggestion, result, pictures)
    result = {**result, "files": {**result["files"], **report}}
    return output.answer(
        {**result, "files": {**result["files"], "json": str(_write_answer(output, result, suggestion))}}
    )


def _write_answer(output: Output, result: dict[str, Any], suggestion: Suggestion) -> Path:
    """Keep the answer with its steady curve; files are named from the folder, so that it can be moved."""
    from dummydesign.design.plot_data import force_grids
    from dummydesign.design.request import ANSWER

    grids = force_grids(suggestion.targets.protocol)
    low, high = suggestion.targets.depth_range_mm(grids.measured)
    kept = output.settled({key: value for key, value in result.items() if key != "files"})
    kept["inputs"] = {key: value for key, value in kept["inputs"].items() if key != "out"}
    kept["files"] = {role: Path(file).relative_to(output.work).as_posix() for role, file in result["files"].items()}
    kept["steady_curve"] = {
        "force_N": grids.pad,
        "depth_mm": suggestion.best.steady_depth_mm(grids.pad),
        "subjects": {"force_N": grids.measured, "depth_low_mm": low, "depth_high_mm": high},
    }
    return write_text(output.path(ANSWER), json_text("suggest", kept) + "\n")


Values = float | str | Iterable[float]
"""One number, numbers, or text as on the command line: ``"3:30:0.5"`` (end included) or ``"5,15"``."""


def whatif(
    thickness_mm: Values,
    ratio: Values | None = None,
    *,
    resin: str = "polyurethane-nagoya",
    tissue: str | None = None,
    aim: str = "average",
    punch: str | Iterable[str] = "square:14",
    condition: str | Iterable[str] = "bonded",
    base: str | Iterable[str] = "bonded",
    shape: str | Iterable[str] = "slab",
    edge_radius_mm: Values = 0.0,
    velocity_mm_s: Values = (10.0, 250.0),
    force_N: Values = (1.0, 5.0, 10.0, 15.0),
    hold_s: float | str = 10.0,
    deceleration_mm_s2: float | str = 30_000.0,
    fidelity: str = "table",
    workers: int = 1,
    scheduler: str | None = None,
    executor: Executor | None = None,
    out: FilePath | None = None,
    replace: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Rows:
    """Work out every combination of slabs, ratios, punches and supports.

    Parameters
    ----------
    thickness_mm : --thickness RANGE|LIST
        In mm, inside 3 to 30, such as 3:30:0.5 or 5,15. [mm]

        See :data:`Values`.
    ratio : RANGE|LIST
        Mixing ratios (default the resin's reference).
    resin : NAME|FILE
        Default polyurethane-nagoya.
    tissue : NAME|FILE
        Score every design for this tissue.
    aim : AIM
        ``average`` (default), ``safe-side``, ``subject:NAME`` or ``people:PERCENT``.
    punch : LIST
        Such as square:14,round:16 (default square:14).
    condition : LIST
        Face: ``bonded`` (default), ``frictionless`` or ``friction:MU``.
    base : LIST
        Pad on its base: ``bonded`` (default), ``sliding``.
    shape : NAME[:KEY=RANGE,..],..
        Such as slab,crowned:radius=10:20:2,height=1.5/2; every combination of its lengths (default slab).
    edge_radius_mm : RANGE|LIST
        Fillets of the punch's edge in mm, for slabs (default 0, sharp). [mm]
    velocity_mm_s : RANGE|LIST
        In mm/s (default 10,250). [mm/s]
    force_N : RANGE|LIST
        In N (default 1,5,10,15). [N]
    hold_s : S
        Hold after the stop (default 10 s). [s]
    deceleration_mm_s2 : MM_S2
        Braking (default 30000 mm/s2). [mm/s2]
    fidelity : NAME
        ``table`` (default), ``axisymmetric`` or ``3d``.
    workers : N
        Processes of this machine (default 1).

        A script must then start its work below ``if __name__ == "__main__":``.
    scheduler : ADDRESS
        A running Dask scheduler, such as tcp://host:8786.
    executor : concurrent.futures.Executor
        Runs the tasks side by side, from any library with this interface, instead of ``workers`` or ``scheduler``.
    out : DIR
        Folder of rows.csv and report.html (default whatif-RESIN).

        Without it nothing is written; the next free number when it holds the answer to another question.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).
    progress : callable, optional
        Called with the number of designs that are done and that of all.

    Returns
    -------
    Rows
        The same as ``dummydesign whatif --json`` prints for the same question.

    Raises
    ------
    InputError
        For names, ranges or a number of designs that are not allowed.
    NoAnswerError
        When a worker was lost; nothing is written then.

    Examples
    --------
    >>> import dummydesign
    >>> rows = dummydesign.whatif([8, 12], [14, 16], tissue="palm").rows
    >>> [(row["thickness_mm"], row["ratio"]) for row in rows]
    [(8.0, 14.0), (8.0, 16.0), (12.0, 14.0), (12.0, 16.0)]
    """
    from dummydesign.core import parsing
    from dummydesign.core.parsing import DECELERATION, HOLD, read_names, read_number, read_numbers
    from dummydesign.design.sweep.run import open_executor
    from dummydesign.design.sweep.spec import Study, parse_shapes
    from dummydesign.geometry.punch import equal_area_radius_mm
    from dummydesign.resin import load_resin

    material = load_resin(resin)
    study = Study(
        read_numbers(thickness_mm, parsing.THICKNESS),
        (material.relaxation_ratio_ref,) if ratio is None else read_numbers(ratio, "ratio"),
        tuple((name, equal_area_radius_mm(name)) for name in read_names(punch)),
        read_numbers(velocity_mm_s, parsing.VELOCITY),
        read_numbers(force_N, parsing.FORCE),
        resin,
        tissue,
        aim,
        fidelity,
        read_names(condition),
        read_names(base),
        tuple(text for item in ([shape] if isinstance(shape, str) else shape) for text in parse_shapes(item)),
        read_numbers(edge_radius_mm, parsing.EDGE),
        read_number(hold_s, HOLD),
        read_number(deceleration_mm_s2, DECELERATION),
    )
    study.check(material)
    folder = None if out is None else Path(out)
    inputs = {
        **study.to_dict(),
        "workers": workers if executor is None else None,
        "scheduler": scheduler,
        "out": None if folder is None else str(folder),
    }
    opened = open_executor(workers, scheduler) if executor is None else nullcontext(executor)
    return _work_out(study, material, opened, folder, inputs, replace, progress)


def _work_out(
    study: Study,
    resin: Resin,
    opened: Any,
    folder: Path | None,
    inputs: dict[str, Any],
    replace: bool,
    progress: Callable[[int, int], None] | None,
) -> Rows:
    """Run a study that was checked, and write rows and report when there is a folder."""
    from dummydesign.design.sweep.run import targets_of
    from dummydesign.design.sweep.run import whatif as work_out

    targets = targets_of(study)  # a tissue that has no such press is refused before there is a folder
    sites = None if targets is None else targets.tissue
    sources = (*resin.references, *(() if sites is None else sites.sources))
    from dummydesign.design.scoring.settings import settings_files
    from dummydesign.design.sweep.rows import settings_of, write_rows

    asked = question("whatif", inputs, tissue=study.tissue, resin=study.resin, named=settings_files())
    with opened as executor, answer_folder(folder, asked, replace) as output:
        swept = work_out(study, executor=executor, progress=progress, targets=targets)
        answered = {"inputs": inputs, "warnings": swept["warnings"], "files": {}}
        if output is not None:
            from dummydesign.report.whatif import write_whatif

            rows = write_rows(output.work, study, settings_of(study, resin, sites), swept["rows"])
            page = write_whatif(output.work, study, swept["rows"], resin, sites, swept["warnings"])
            answered = output.answer(answered | {"files": {"rows": str(rows), **page}})
            answered["inputs"] = {**inputs, "out": str(output.folder)}
    warnings = tuple(answered["warnings"])
    return Rows(study, tuple(swept["rows"]), swept["seconds"], answered["inputs"], warnings, sources, answered["files"])

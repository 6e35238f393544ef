"""The call that makes a mould."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from dummydesign.api.answers import Result
from dummydesign.api.questions import question
from dummydesign.core.errors import NoAnswerError


def make_mould(
    thickness_mm: float,
    *,
    length_mm: float = 150.0,
    width_mm: float = 120.0,
    shape: str = "slab",
    preset: str = "open",
    resin: str | None = None,
    ratio: float = 15.0,
    base_ratio: float | None = None,
    out: str | PathLike[str] | None = None,
    replace: bool = False,
) -> Result:
    """Make the silicone mould of a pad: STEP files, printable master and frame, pour sheet, all checked.

    Parameters
    ----------
    thickness_mm, length_mm, width_mm : float
        Size of the pad. [mm]
    shape : str
        ``slab``, ``crowned``, ``puck``, ..., with its lengths.
    preset : str
        ``open``, ``lidded`` or a TOML file.
    resin : str, optional
        Name or file of the resin to weigh; the paper's polyurethane by default.
    ratio, base_ratio : float
        Mixing ratio, and that of a layered pad's base (by default from its modulus ratio).
    out : path, optional
        Folder of the files, ``mould_tMM`` by default; the next free number when it holds another answer.
    replace : bool
        Take the place of the other answer instead.

    Returns
    -------
    Result
        The same as ``dummydesign mold --json`` prints for the same question.

    Raises
    ------
    InputError
        For sizes, names or files that are not allowed.
    NoAnswerError
        Without CAD, or when the mould fails a check; what there is of the answer stands in the error's ``result``.

    Examples
    --------
    CadQuery needs about a minute.

    >>> import dummydesign
    >>> made = dummydesign.make_mould(8, length_mm=60, width_mm=50, out="mould")  # doctest: +SKIP
    >>> {check["verdict"] for check in made.to_dict()["checks"]}  # doctest: +SKIP
    {'pass'}
    """
    from dummydesign.core.outputs.write import new_folder
    from dummydesign.mold.model.pad_kind import read_kind
    from dummydesign.mold.model.preset import mould_spec
    from dummydesign.mold.runner import make_mold

    kind, parameters = read_kind(shape)
    spec = mould_spec(thickness_mm, length_mm, width_mm, preset, resin, ratio, kind, parameters, base_ratio)
    folder = Path(out) if out else Path(f"mould_{spec.tag}")
    inputs = {
        "thickness_mm": spec.pad.thickness_mm, "length_mm": spec.pad.length_mm, "width_mm": spec.pad.width_mm,
        "shape": spec.pad.name, "preset": spec.preset, "resin": spec.pour.resin,
        "ratio": spec.pour.ratio, "ratio_meaning": spec.pour.ratio_meaning, "out": str(folder),
    }  # fmt: skip
    if spec.base is not None:
        inputs |= {"base_ratio": spec.base.pour.ratio, "modulus_ratio_of_base": spec.base.modulus_ratio}
    asked = question("mold", {**inputs, "specification": spec.hash}, resin=resin, preset=preset)
    with new_folder(folder, asked, replace=replace) as output:
        head = {"inputs": {**inputs, "out": str(output.folder)}, "sources": list(spec.sources)}
        try:
            found = make_mold(spec, output.work)
        except NoAnswerError as reason:
            result = output.settled({**head, **reason.result})
            raise NoAnswerError(reason.code, output.settled(str(reason)), result) from None
        output.extra["hash"] = spec.hash
        output.extra["summary"] = {name: inputs[name] for name in ("shape", "thickness_mm", "ratio", "resin", "preset")}
        result = output.answer({**head, **found.to_dict(), "spec": spec.to_dict()})
    # Memory differs from run to run; the same question shall get the same answer but for seconds.
    del result["memory_MB"]
    return Result(found, result, "make_mould")

"""The pads of moulds that were made, as a campaign of presses needs them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from dummydesign.core.errors import InputError
from dummydesign.core.files import FilePath
from dummydesign.mold.model.spec import MouldSpec

SPEC = "spec.json"


@dataclass(frozen=True)
class MouldedPads:
    """Pads of one campaign."""

    shapes: tuple[tuple[float, str], ...]
    outline: str
    pours: tuple[tuple[str, float], ...]
    folders: tuple[str, ...]

    @property
    def pads_mm(self) -> tuple[float, ...]:
        """Thicknesses. [mm]"""
        return tuple(thickness for thickness, _ in self.shapes)

    @property
    def shape(self) -> str:
        """The shape of the first pad, and of all where they have one."""
        return self.shapes[0][1]

    @property
    def mixed(self) -> bool:
        """Whether the pads differ in shape."""
        return len({shape for _, shape in self.shapes}) > 1

    def pour(self) -> tuple[str, float]:
        """Return resin and ratio of all pads."""
        if len(self.pours) > 1:
            listed = ", ".join(f"{resin} at ratio {ratio:g}" for resin, ratio in self.pours)
            message = f"the moulds differ in resin or ratio ({listed}): a campaign has one; plan one for each"
            raise InputError(message, "inconsistent", "resin")
        return self.pours[0]


def moulded_pads(folders: Sequence[FilePath]) -> MouldedPads:
    """Read the pads of some moulds."""
    from dummydesign.mold.pour.record import read_spec

    places = [mould for folder in folders for mould in mould_folders(Path(folder))]
    if not places:
        raise InputError("give the folder of at least one mould", "missing", "from_mould")
    known: dict[float, Path] = {}
    pads: list[tuple[float, str, str, Path]] = []
    pours: dict[tuple[str, float], None] = {}
    for mould in places:
        spec = read_spec(mould)
        pad, thickness = spec.pad, float(spec.pad.thickness_mm)
        if (other := known.setdefault(thickness, mould)) is not mould:
            raise InputError(
                f"moulds '{other}' and '{mould}' both have {thickness:g} mm: a campaign tells pads by their thickness; "
                "plan one for each",
                "duplicate",
                "thickness_mm",
                thickness,
            )
        size = f"cylinder:{pad.length_mm:g}" if pad.is_puck else f"{pad.length_mm:g}x{pad.width_mm:g}"
        pads.append((thickness, pad.name, size, mould))
        pours.setdefault((spec.pour.resin, float(spec.pour.ratio)))
    pads.sort(key=lambda one: one[0])
    for _, _, outline, mould in pads[1:]:
        if outline != pads[0][2]:
            raise InputError(
                f"moulds '{pads[0][3]}' ({pads[0][2]}) and '{mould}' ({outline}) differ in outline: a campaign has "
                "one; plan one for each",
                "inconsistent",
                "outline",
                outline,
                pads[0][2],
            )
    shapes = tuple((h, "slab" if outline.startswith("cylinder") else shape) for h, shape, outline, _ in pads)
    return MouldedPads(shapes, pads[0][2], tuple(pours), tuple(str(mould) for *_, mould in pads))


def mould_command(
    thickness_mm: float,
    ratio: float,
    shape: str = "",
    resin: str = "",
    outline_mm: tuple[float, float] | None = None,
    preset: str = "",
) -> str:
    """Return the command that makes a mould; what is empty is left to its default."""
    given = {"resin": resin, "ratio": f"{ratio:g}", "shape": shape}
    if outline_mm is not None:
        given |= {"length": f"{outline_mm[0]:g}", "width": f"{outline_mm[1]:g}"}
    typed = [f" --{name} {quote(one)}" for name, one in {**given, "preset": preset}.items() if one]
    return f"dummydesign mold --thickness {thickness_mm:g}{''.join(typed)}"


def one_mould(place: FilePath) -> MouldSpec:
    """Read the specification of one mould of a pad: its folder, a folder that holds it alone, or its ``spec.json``.

    Raises
    ------
    InputError
        Where there is none, where there are several, and for the mould of a puck.
    """
    from dummydesign.mold.pour.record import read_spec

    path = Path(place)
    folders = [path.parent] if path.name == SPEC and path.is_file() else mould_folders(path, "mould")
    if len(folders) > 1:
        names = ", ".join(str(folder) for folder in folders)
        raise InputError(f"folder '{path}' holds {len(folders)} moulds; give one of {names}", "conflict", "mould")
    spec = read_spec(folders[0])
    if spec.pad.is_puck:
        message = f"mould '{path}' is that of a puck; give the mould of a pad"
        raise InputError(message, "not_applicable", "mould", str(path))
    return spec


def mould_folders(folder: Path, quantity: str = "from_mould") -> list[Path]:
    """The folder itself where it holds a mould, else the moulds directly in it."""
    if (folder / SPEC).is_file():
        return [folder]
    moulds = sorted(path.parent for path in folder.glob(f"*/{SPEC}") if not path.parent.name.startswith("."))
    if not moulds:
        message = f"folder '{folder}' holds no mould: give folders that 'dummydesign mold' wrote"
        raise InputError(message, "nothing_found", quantity, str(folder))
    return moulds

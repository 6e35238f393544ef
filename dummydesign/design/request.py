"""The question of ``suggest``: one table from which command, Python call, project and inputs of the answer are made."""

from __future__ import annotations

from dataclasses import MISSING, asdict, dataclass
from functools import partial
from os import fspath
from typing import TYPE_CHECKING, Any

from dummydesign.core import parsing
from dummydesign.core.errors import InputError
from dummydesign.core.parsing import option, parse_limits, read_number, read_numbers, read_options, read_size
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, PUNCH

if TYPE_CHECKING:
    from dummydesign.design.protocol import Protocol

# File of the answer in the folder of `suggest`.
ANSWER = "suggest.json"


def face_of(punch: str, condition: str | None) -> str:
    """How a punch as typed holds a face: by the condition, else glued, but sliding freely where it is not flat."""
    return condition or ("frictionless" if punch.startswith(("ball:", "profile:")) else "bonded")


def read_sites(text: str | tuple[int, int]) -> tuple[int, int]:
    """Read ``NxM``, crowns along the length times across the width."""
    from dummydesign.geometry.shapes.crowned import MOST_SITES

    parts = text.lower().split("x") if isinstance(text, str) else [str(value) for value in text]
    if len(parts) != 2 or not all(part.strip().isdigit() and 1 <= int(part) <= MOST_SITES for part in parts):
        shown = text if isinstance(text, str) else "x".join(parts)
        message = f"sites = {shown} is not NxM with 1 to {MOST_SITES} crowns each way, such as 4x3"
        raise InputError(message, "malformed", "sites", shown)
    return int(parts[0]), int(parts[1])


def base_words(base: str) -> str:
    """Return in words how a pad lies on its base."""
    return {"bonded": "glued to a rigid base", "sliding": "sliding on a rigid base"}.get(base, f"resting, {base}")


def _shape_help() -> str:
    from dummydesign.geometry.shape_registry import shape_help

    return shape_help("auto", default="auto") + "; lengths not given are searched"


@dataclass(frozen=True)
class Request:
    """The question, in the order of the answer's inputs: default, option, metavar, help, reader.

    Ranges are (low, high) with both ends included, None for all that is allowed. ``punch``, ``force_N``,
    ``velocity_mm_s``, ``hold_s``, ``pad_mm``, ``base``, ``edge_radius_mm`` and ``condition`` are the test that the pad
    and the people behind the tissue are pressed by; ``preset`` is of its mould. ``sites`` are how
    many crowns stand along and across the pad. ``cad`` is whether the mould of a pad that is not red is made,
    ``effects`` are files of own effects.
    """

    tissue: str = option(MISSING, "tissue", "NAME|FILE", "see 'dummydesign tissues list'")
    aim: str = option("average", "aim", "AIM", "average (default), safe-side, subject:NAME or people:PERCENT")
    resin: str = option("polyurethane-nagoya", "resin", "NAME|FILE", "see 'dummydesign resins list'")
    thickness_mm: tuple[float, float] | None = option(
        None,
        "thickness",
        "MIN:MAX",
        "search range in mm, in 3 to 30",
        read=partial(parse_limits, quantity="thickness in mm"),
        between=":",
    )
    ratio: tuple[float, float] | None = option(
        None,
        "ratio",
        "MIN:MAX",
        "search range of the mixing ratio, within the resin's range",
        read=partial(parse_limits, quantity="ratio"),
        between=":",
    )
    shape: str = option("auto", "shape", "NAME[:P,..]", _shape_help)
    mould: str | None = option(
        None,
        "mould",
        "DIR|FILE",
        "keep shape and thickness of a mould that was made; choose the ratio for the resin at hand",
        read=fspath,
    )
    verify: bool = option(True, "no-verify", "", "do not check the design by finite elements")
    hold_s: float = option(
        10.0, "hold", "S", "hold after the stop (default 10 s)", read=partial(read_number, purpose=parsing.HOLD)
    )
    deceleration_mm_s2: float = option(
        30_000.0,
        "deceleration",
        "MM_S2",
        "braking (default 30000 mm/s2)",
        read=partial(read_number, purpose=parsing.DECELERATION),
    )
    calibration: str | None = option(
        None, "calibration", "FILE", "file written by 'dummydesign loop'; none: ignore the project's", read=fspath
    )
    punch: str = option(
        PUNCH, "punch", "KIND:SIZE", "square:14 (default), rectangle:AxB, round:D, ball:D, profile:FILE.csv"
    )
    force_N: tuple[float, ...] = option(
        (5.0, 10.0, 15.0),
        "force",
        "F1,F2,...",
        "steady forces (default 5,10,15 N)",
        read=partial(read_numbers, purpose=parsing.FORCE),
    )
    velocity_mm_s: tuple[float, ...] = option(
        (10.0, 250.0),
        "velocity",
        "V1,V2,...",
        "speeds (default 10,250 mm/s)",
        read=partial(read_numbers, purpose=parsing.VELOCITY),
    )
    pad_mm: tuple[float, float] = option(
        (PAD_LENGTH_MM, PAD_WIDTH_MM),
        "pad",
        "LxW",
        "length and width of the pad (default 150x120 mm)",
        read=partial(read_size, quantity="pad"),
        argument="pad",
        between="x",
    )
    base: str = option("bonded", "base", "NAME", "bonded (default), sliding or friction:MU")
    edge_radius_mm: float = option(
        0.0,
        "edge-radius",
        "MM",
        "fillet of the punch's edge (default 0, sharp)",
        read=partial(read_number, purpose=parsing.EDGE),
    )
    condition: str | None = option(
        None, "condition", "NAME", "bonded (default; under a ball or a profile frictionless), frictionless, friction:MU"
    )
    preset: str = option("open", "preset", "NAME|FILE", "mould preset: open (default), lidded, printed or a TOML file")
    sites: tuple[int, int] | None = option(
        None,
        "sites",
        "NxM",
        "crowns along and across one pad, such as 4x3, far enough apart to be independent",
        read=read_sites,
        between="x",
    )
    cad: bool = option(True, "no-cad", "", "skip the mould; write recipe and report only")
    effects: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """The shape that is searched: several sites are those of crowns."""
        return "crowned" if self.sites and self.shape.lower() == "auto" else self.shape

    @property
    def face(self) -> str:
        """How the punch holds the pad's face: as asked, else glued, or freely sliding under one without a flat face."""
        return face_of(self.punch, self.condition)

    @property
    def protocol(self) -> Protocol:
        """Steady forces and speeds, rising."""
        from dummydesign.design.protocol import Protocol

        return Protocol(tuple(sorted(set(self.force_N))), tuple(sorted(set(self.velocity_mm_s))))

    @property
    def punch_text(self) -> str:
        """The punch in words, such as ``14 x 14 mm``."""
        kind, _, size = self.punch.partition(":")
        if kind == "square":
            return f"{size} x {size} mm"
        return f"{size.replace('x', ' x ')} mm" if kind == "rectangle" else f"{kind} {size}"

    @classmethod
    def read(cls, **given: Any) -> Request:
        """Read texts or values by the names of the arguments of ``suggest``."""
        return read_options(cls, given | {"effects": tuple(fspath(path) for path in given.get("effects", ()))})

    def to_dict(self) -> dict[str, Any]:
        """Return what was asked, defaults included."""
        asked = asdict(self) | {"condition": self.face}
        return {name: value for name, value in asked.items() if name != "effects"}

"""Files as test machines, spreadsheets and robots write them, each with its true presses. Seeded.

A file is drawn from format x units x signs x offsets x presses; the importer is not used here.
"""

from __future__ import annotations

import datetime
from dataclasses import dataclass

import numpy as np

from tests.support.machine_presses import Recording, recording

_TIME = {"s": (1.0, 4), "ms": (1e3, 1), "min": (1 / 60, 7)}
_LENGTH = {"mm": (1.0, 4), "m": (1e-3, 7), "um": (1e3, 1), "cm": (0.1, 5), "in": (1 / 25.4, 6)}
_FORCE = {
    "N": (1.0, 4),
    "kN": (1e-3, 7),
    "mN": (1e3, 1),
    "cN": (1e2, 2),
    "gf": (1 / 9.80665e-3, 2),
    "lbf": (1 / 4.4482216, 5),
}


@dataclass(frozen=True)
class MachineFile:
    """A file, what is in it, and how it was made (``facts``)."""

    name: str
    data: bytes
    recording: Recording
    facts: dict[str, object]


@dataclass(frozen=True)
class _Dialect:
    """How a program writes: names with units, rows of the header, signs, encodings."""

    names: tuple[str, str, str]
    layout: str  # "bracket", "paren", "in", "slash", "underscore", "row"
    separator: str
    decimal: str
    encodings: tuple[str, ...]
    preamble: tuple[str, ...] = ()
    footer: tuple[str, ...] = ()
    quoted: bool = False
    comment: str = ""
    order: tuple[int, int, int] = (0, 1, 2)
    units: dict[str, str] | None = None
    extra: tuple[tuple[str, str], ...] = ()
    stamp: str = ""
    ending: str = ".csv"
    brackets: str = "[]"


_GERMAN_HEAD = ("Prüfprotokoll", "Prüfer;Müller", "Prüfgeschwindigkeit;10;mm/s", "Datum;19.11.2025")
_DIALECTS: dict[str, _Dialect] = {
    "canonical": _Dialect(("time", "displacement", "force"), "underscore", ",", ".", ("utf-8",)),
    "capitals": _Dialect(("Time", "Displacement", "Force"), "underscore", ",", ".", ("utf-8", "utf-8-sig")),
    "german excel": _Dialect(("Zeit", "Weg", "Kraft"), "bracket", ";", ",", ("cp1252", "utf-8-sig", "latin-1")),
    "german in": _Dialect(
        ("Prüfzeit", "Traversenweg", "Prüfkraft"), "in", "\t", ",", ("cp1252", "utf-8", "utf-16"), ending=".txt"
    ),
    "german slash": _Dialect(("Messzeit", "Eindringtiefe", "Normalkraft"), "slash", ";", ",", ("utf-8-sig", "cp1252")),
    "zwick": _Dialect(
        ("Prüfzeit", "Standardweg", "Standardkraft"),
        "row",
        ";",
        ",",
        ("cp1252", "utf-8-sig", "utf-16"),
        _GERMAN_HEAD,
        ending=".txt",
    ),
    "zwick english": _Dialect(
        ("Test time", "Standard travel", "Standard force"),
        "row",
        "\t",
        ".",
        ("utf-8", "utf-16"),
        ending=".TRA",
        extra=(("Crosshead absolute", "mm"),),
    ),
    "french excel": _Dialect(("Temps", "Déplacement", "Force"), "paren", ";", ",", ("cp1252", "utf-8-sig", "latin-1")),
    "french machine": _Dialect(
        ("Durée", "Course", "Charge"),
        "row",
        ";",
        ",",
        ("cp1252", "utf-8"),
        ("Essai de compression", "Opérateur;Dupont", "Éprouvette;n° 12"),
        ("Fin de l'essai",),
    ),
    "french quoted": _Dialect(("Temps", "Enfoncement", "Effort"), "paren", ",", ",", ("utf-8",), quoted=True),
    "instron": _Dialect(
        ("Time", "Compressive extension", "Compressive load"),
        "row",
        ",",
        ".",
        ("utf-8", "utf-8-sig"),
        ('"Specimen label","P01 thenar"', '"Rate","10.00","mm/s"', ""),
        quoted=True,
        brackets="()",
    ),
    "instron raw": _Dialect(
        ("Time", "Extension", "Load"),
        "paren",
        ",",
        ".",
        ("utf-8",),
        ("Results Table 1", ",Maximum Load,Date", "1,17.5,19/11/2025", ""),
        extra=(("Compressive stress", "MPa"),),
    ),
    "mts": _Dialect(
        ("Axial Displacement", "Axial Force", "Time"),
        "row",
        "\t",
        ".",
        ("utf-8", "latin-1"),
        (
            "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A",
            "",
            "Data Header:\tTime:\t10.88\tSec\t19.11.2025 14:02:11",
            "Data Acquisition:\tTimed\t\t\tRun Time:",
        ),
        order=(1, 2, 0),
        units={"s": "Sec"},
        ending=".dat",
    ),
    "shimadzu": _Dialect(
        ("時間", "変位", "試験力"),
        "row",
        ",",
        ".",
        ("cp932", "utf-8-sig", "utf-16"),
        ("試験日,2025/11/19", "試験名,圧縮"),
        quoted=True,
        units={"s": "sec"},
    ),
    "japanese": _Dialect(("経過時間", "押込み深さ", "荷重"), "bracket", ",", ".", ("utf-8", "cp932"), brackets="（）"),
    "savetxt": _Dialect(("time", "depth", "load"), "bracket", " ", ".", ("utf-8",), comment="# ", ending=".txt"),
    "columns": _Dialect(
        ("Elapsed Time", "Position", "Force"),
        "paren",
        "  ",
        ".",
        ("utf-8",),
        ending=".asc",
        footer=("", "End of test", "Maximum force reached"),
    ),
    "logger": _Dialect(
        ("Time", "LVDT", "Load Cell"),
        "bracket",
        "\t",
        ".",
        ("utf-8",),
        ("% sampled by DAQ", "% gain 10"),
        comment="%",
        extra=(("Temperature", "°C"), ("Sample", "")),
    ),
    "robot": _Dialect(
        ("timestamp", "tcp_z", "fz"),
        "bracket",
        ",",
        ".",
        ("utf-8",),
        order=(0, 1, 2),
        extra=(("tcp_x", "mm"), ("fx", "N")),
        stamp="iso",
        ending=".log",
    ),
    "robot german": _Dialect(
        ("Zeitstempel", "Position", "Kraft"), "bracket", ";", ",", ("utf-8-sig", "cp1252"), stamp="clock"
    ),
    "epoch": _Dialect(
        ("timestamp", "position", "force"), "bracket", ",", ".", ("utf-8",), stamp="epoch", ending=".csv"
    ),
    "unicode text": _Dialect(("Zeit", "Verschiebung", "Kraft"), "paren", "\t", ",", ("utf-16",), ending=".txt"),
    "thousands": _Dialect(
        ("Time", "Position", "Load"), "paren", ",", ".", ("utf-8",), quoted=True, units={"*": "thousands"}
    ),
    "thousands german": _Dialect(("Zeit", "Weg", "Kraft"), "paren", ";", ",", ("cp1252",), units={"*": "thousands"}),
}
DIALECTS = tuple(_DIALECTS)


def machine_file(seed: int, fast: bool = False) -> MachineFile:
    """Make one file. The same seed makes the same file.

    Parameters
    ----------
    seed : int
    fast : bool
        50 or 250 mm/s in coordinates whose zero is not at contact: more than the force alone can tell.
    """
    draw = np.random.default_rng([seed, 1])
    kind = DIALECTS[seed % len(DIALECTS)]
    style = _DIALECTS[kind]
    presses = int(draw.choice([1, 1, 1, 2, 3]))
    zero = str(draw.choice(["own", "own", "late", "robot"]))
    lead_in = not (zero == "own" and presses == 1 and draw.random() < 0.15)
    # Where contact has to be told from the force alone, a fast press behind an unknown filter cannot tell it.
    velocity = float(draw.choice([2.0, 10.0])) if zero != "own" else None
    if fast:
        zero, lead_in, velocity = str(draw.choice(["late", "robot"])), True, float(draw.choice([50.0, 250.0]))
    record = recording(seed, presses, velocity, lead_in=lead_in)
    units = {
        "time": str(draw.choice(["s", "s", "s", "ms", "min"])),
        "length": str(draw.choice(["mm", "mm", "mm", "m", "um", "cm", "in"])),
        "force": str(draw.choice(["N", "N", "N", "kN", "mN", "cN", "gf", "lbf"])),
    }
    if kind in ("canonical", "capitals") and draw.random() < 0.6:
        units = {"time": "s", "length": "mm", "force": "N"}
    if style.stamp:
        units["time"] = "s"
    if style.units and "*" in style.units:
        units |= {"force": "mN", "length": "um"}
    way, push = float(draw.choice([1.0, -1.0])), float(draw.choice([1.0, -1.0]))
    offset = float(draw.choice([0.0, 0.0, 1.0]) * draw.uniform(-2.0, 2.0)) if lead_in else 0.0
    place = {"own": 0.0, "late": float(draw.uniform(0.6, 1.5)), "robot": float(draw.uniform(50.0, 400.0))}[zero]
    x = way * (record.displacement_mm + (place if way > 0 else -place))
    force = push * (record.force_N + offset)
    start = float(draw.choice([0.0, 0.0, 1.0]) * draw.uniform(0.0, 500.0))
    text = _write(draw, style, record.time_s + start, x, force, units)
    encoding = str(draw.choice(style.encodings))
    newline = str(draw.choice(["\n", "\r\n", "\r\n", "\r"]))
    facts = {
        "dialect": kind,
        "units": units,
        "way": way,
        "push": push,
        "offset_N": offset,
        "zero": zero,
        "place_mm": place,
        "encoding": encoding,
        "presses": presses,
        "lead_in": lead_in,
        "seed": seed,
    }
    return MachineFile(f"press {seed:05d}{style.ending}", newline.join(text).encode(encoding), record, facts)


def _write(draw, style: _Dialect, time, x, force, units) -> list[str]:
    """Lines of the file."""
    names = _header(style, units)
    columns = [_times(style, time, units["time"])]
    columns.append(_numbers(style, x, *_LENGTH[units["length"]]))
    columns.append(_numbers(style, force, *_FORCE[units["force"]]))
    columns = [columns[i] for i in style.order]
    for title, unit in style.extra:
        if title == "Crosshead absolute":
            columns.append(_numbers(style, x + 123.4, *_LENGTH["mm"]) if units["length"] == "mm" else ["0.0"] * len(x))
        elif unit == "":
            columns.append([str(i) for i in range(len(x))])
        else:
            columns.append(_numbers(style, draw.normal(20.0, 0.01, len(x)), 1.0, 3))
    separator = {"  ": "   "}.get(style.separator, style.separator)
    lines = list(style.preamble)
    lines += [style.comment + separator.join(row) for row in names]
    lines += [separator.join(row) for row in zip(*columns)]
    return [*lines, *style.footer, ""]


def _header(style: _Dialect, units) -> list[list[str]]:
    spelled = [units["time"], units["length"], units["force"]]
    spelled = [(style.units or {}).get(unit, unit) for unit in spelled]
    if "um" in spelled and "cp932" not in style.encodings:
        spelled[spelled.index("um")] = "µm" if style.separator != "  " else "um"
    ordered = [spelled[i] for i in style.order]
    titles = list(style.names) + [title for title, _ in style.extra]
    shown = ordered + [unit for _, unit in style.extra]
    if style.stamp:
        shown[0] = ""
    quote = (lambda text: f'"{text}"') if style.quoted else (lambda text: text)
    if style.layout == "row":
        a, b = style.brackets if style.brackets != "[]" else ("", "")
        return [[quote(title) for title in titles], [quote(f"{a}{unit}{b}") for unit in shown]]
    forms = {
        "bracket": "{0} {2}{1}{3}",
        "paren": "{0} ({1})",
        "in": "{0} in {1}",
        "slash": "{0}/{1}",
        "underscore": "{0}_{1}",
    }
    form = forms[style.layout]
    if style.separator in (" ",):
        form = form.replace(" ", "")
    return [[quote(form.format(title, unit, *style.brackets) if unit else title) for title, unit in zip(titles, shown)]]


def _numbers(style: _Dialect, values, factor: float, digits: int) -> list[str]:
    grouped = bool(style.units and "*" in style.units)
    text = [f"{value:{',' if grouped else ''}.{digits}f}" for value in (values * factor).tolist()]
    if style.decimal == ",":
        text = [cell.translate(str.maketrans({",": ".", ".": ","})) for cell in text]
    return [f'"{cell}"' for cell in text] if style.quoted else text


def _times(style: _Dialect, time, unit: str) -> list[str]:
    if not style.stamp:
        factor, digits = _TIME[unit]
        return _numbers(style, time, factor, digits)
    if style.stamp == "epoch":
        return [f"{1763561000.0 + value:.4f}" for value in time.tolist()]
    begin = datetime.datetime(2025, 11, 19, 14, 2, 11)
    stamps = [begin + datetime.timedelta(seconds=round(value, 4)) for value in time.tolist()]
    if style.stamp == "iso":
        return [stamp.isoformat(sep="T", timespec="microseconds") for stamp in stamps]
    return [stamp.strftime("%d.%m.%Y %H:%M:%S,%f") for stamp in stamps]

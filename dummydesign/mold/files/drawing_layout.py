"""Where views, dimensions and enlarged details are on the paper."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dummydesign.geometry.pad_shape import PadShape
from dummydesign.mold.files.drawing_sheet import (
    PAPERS,
    TEXT_MM,
    Box,
    Dimension,
    Drawing,
    Line,
    Point,
    Text,
    number_text,
    text_width,
)

SCALES = (10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05)
"""Preferred scales of ISO 5455, paper over part."""
FIRST_MM, LANE_MM, NAME_MM, HATCH_MM, GAP_MM = 7.0, 6.0, 3.5, 3.0, 6.0
LEADER_MM = 5.0
ASIDE_MM = tuple(2.0 * step for step in range(13))
"""How much further off its arrows a number may stand, so that no line crosses it. [mm]"""


def ratio(scale: float) -> str:
    """Scale as it stands in a title block: ``1:2``."""
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def hatch(loops: Sequence[Sequence[Point]], pitch: float) -> list[tuple[Point, ...]]:
    """Lines at 45 degrees inside closed loops (even-odd rule), ``pitch`` apart. [mm on paper]"""
    root = math.sqrt(0.5)
    # Turn by -45 degrees, so that hatching runs along the first axis.
    turned = [[(root * (x + y), root * (y - x)) for x, y in loop] for loop in loops]
    edges = [(loop[i], loop[(i + 1) % len(loop)]) for loop in turned for i in range(len(loop))]
    if not edges:
        return []
    low, high = min(a[1] for a, _ in edges), max(a[1] for a, _ in edges)
    pieces = []
    level = math.ceil(low / pitch) * pitch + 1e-7
    while level < high:
        crossings = sorted(
            a[0] + (level - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            for a, b in edges
            if (a[1] <= level) != (b[1] <= level)
        )
        for start, end in zip(crossings[::2], crossings[1::2]):
            pieces.append(tuple((root * (u - level), root * (u + level)) for u in (start, end)))
        level += pitch
    return pieces


@dataclass(frozen=True)
class Measure:
    """A length to be dimensioned, between two points of a view, on one of its sides.

    ``side`` is ``above``, ``below``, ``left`` or ``right``; the first two measure along x, the others along y.
    """

    start: Point
    end: Point
    side: str

    @property
    def vertical(self) -> bool:
        """Whether it is measured along y."""
        return self.side in ("left", "right")

    @property
    def value(self) -> float:
        """True length. [mm]"""
        axis = int(self.vertical)
        return abs(self.end[axis] - self.start[axis])


@dataclass(frozen=True)
class View:
    """One view in the part's own coordinates, with what is measured in it and notes that point at places.

    A view that is ``enlarged`` has a larger scale than the sheet, which stands in its name. ``marks`` are letters over
    places of its upper edge. Lines of the layer ``bound``, where there are some, bound what is hatched, else the cut.
    """

    name: str
    runs: tuple[tuple[tuple[Point, ...], str], ...]
    measures: tuple[Measure, ...] = ()
    leaders: tuple[tuple[Point, str], ...] = ()
    filled: bool = False
    enlarged: bool = False
    marks: tuple[tuple[Point, str], ...] = ()

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x low, y low, x high, y high. [mm]"""
        xs = [x for run, _ in self.runs for x, _ in run]
        ys = [y for run, _ in self.runs for _, y in run]
        return min(xs), min(ys), max(xs), max(ys)


@dataclass
class Placed:
    """A view on paper, its own lower left at the origin of the part's coordinates times the scale."""

    lines: list[Line]
    texts: list[Text]
    dimensions: list[Dimension]
    box: Box

    @property
    def width(self) -> float:
        """Width on paper. [mm]"""
        return self.box[2] - self.box[0]

    @property
    def height(self) -> float:
        """Height on paper. [mm]"""
        return self.box[3] - self.box[1]


def arrange(views: Sequence[View], title: Title, notes: Sequence[str], paper: str = "A3") -> Drawing:
    """Stack views on a sheet at the largest preferred scale that fits, with frame, title block and notes."""
    w, h = PAPERS[paper]
    low = MARGIN_MM + max(HIGH_MM, notes_beside(notes, w)[1]) + 3.0
    room = w - 2 * MARGIN_MM - 4.0, h - MARGIN_MM - 3.0 - low
    # The largest first, each with those of its enlarged detail; the same where there is none.
    scales = [(scale, scale) for scale in SCALES]
    if any(view.enlarged for view in views):
        scales = [(scale, larger) for scale in SCALES for larger in SCALES if larger >= 2.0 * scale]
    for scale, larger in scales:
        placed = [_at_scale(view, scale, larger) for view in views]
        rows = _rows(placed, room[0])
        deep = sum(max(one.height for one in row) for row in rows) + GAP_MM * (len(rows) - 1)
        # Views one below the other share the middle line of the part.
        left = max(-row[0].box[0] for row in rows)
        right = max(row[0].box[2] + sum(one.width + GAP_MM for one in row[1:]) for row in rows)
        if deep <= room[1] and left + right <= room[0]:
            break
    for view, one in zip(views, placed):
        if view.filled:
            bound = [line.points for line in one.lines if line.layer == "bound"]
            closed = bound or [line.points for line in one.lines if line.layer == "cut"]
            one.lines += [Line(piece, "hatch", not view.enlarged) for piece in hatch(closed, HATCH_MM)]
    sheet = Drawing(title.part, scale, paper)
    level = h - MARGIN_MM - 3.0 - (room[1] - deep) / 2
    for row in rows:
        x = w / 2 + (left - right) / 2
        tall = max(one.height for one in row)
        for number, one in enumerate(row):
            x -= one.box[0] if number else 0.0
            put(sheet, one, (x, level - tall - one.box[1] + (tall - one.height) / 2))
            x += one.box[2] + GAP_MM
        level -= tall + GAP_MM
    frame_and_title(sheet, title, notes)
    return sheet


def _at_scale(view: View, scale: float, larger: float) -> Placed:
    """A view at the scale of the sheet, or a detail at its own with its scale in its name."""
    if not view.enlarged:
        return lay_out_view(view, scale)
    one = lay_out_view(replace(view, name=f"{view.name} ({ratio(larger)})"), larger)
    one.lines = [replace(line, of_part=False) for line in one.lines]
    one.dimensions = [replace(d, enlarged=larger / scale) for d in one.dimensions]
    return one


def _rows(placed: list[Placed], room_mm: float) -> list[list[Placed]]:
    """One view below the other; a third and a fourth lie next to the first two where there is room."""
    rows = [[one] for one in placed[:2]]
    for one in placed[2:]:
        for row in rows[:2]:
            if sum(other.width + GAP_MM for other in row) + one.width <= room_mm:
                row.append(one)
                break
        else:
            rows.append([one])
    return rows


def put(sheet: Drawing, one: Placed, shift: Point) -> None:
    """Place lines, texts and dimensions of a drawing on a sheet. [mm]"""

    def moved(point: Point) -> Point:
        return point[0] + shift[0], point[1] + shift[1]

    sheet.lines += [replace(line, points=tuple(moved(p) for p in line.points)) for line in one.lines]
    sheet.texts += [replace(text, at=moved(text.at)) for text in one.texts]
    for d in one.dimensions:
        at = d.at + shift[0 if d.vertical else 1]
        sheet.dimensions.append(replace(d, start=moved(d.start), end=moved(d.end), at=at))


def lay_out_view(view: View, scale: float) -> Placed:
    """A view at a scale with its dimensions in lanes, its leaders on the left and its name above."""

    def on_paper(point: Point) -> Point:
        return point[0] * scale, point[1] * scale

    lines = [Line(tuple(on_paper(point) for point in run), layer, True) for run, layer in view.runs]
    x0, y0, x1, y1 = (scale * value for value in view.bounds)
    edges = {"above": y1, "below": y0, "left": x0, "right": x1}
    dimensions: list[Dimension] = []
    for side, edge in edges.items():
        measures = [(on_paper(m.start), on_paper(m.end), m.value) for m in view.measures if m.side == side]
        made = _lanes(measures, side, edge)
        if side == "right" and any(_meet(one, other) for one in made for other in dimensions):
            # A number that has no room between its arrows stands beyond the view's right edge.
            made = _lanes(measures, side, max(other.text.box[2] for other in dimensions) - 2.0)
        dimensions += made
    texts = [Text((scale * x, y1 + 1.5), words, TEXT_MM, True) for (x, _), words in view.marks]
    left = min([x0, *(d.text.box[0] for d in dimensions)])
    taken = y1 + 1e9
    for (x, y), words in sorted(view.leaders, key=lambda one: -one[0][1]):
        # Texts of leaders stand one below the other.
        high = min(scale * y, taken - 2.0 * TEXT_MM)
        taken = high
        wide = text_width(words, TEXT_MM)
        texts.append(Text((left - LEADER_MM - wide - 1.0, high - TEXT_MM / 2), words))
        lines.append(Line(((scale * x, scale * y), (left - 2.0, high), (left - LEADER_MM, high)), "thin"))
    boxes = [text.box for text in texts] + [box for d in dimensions for box in d.boxes]
    low, high = min([y0, *(box[1] for box in boxes)]), max([y1, *(box[3] for box in boxes)])
    name = Text(((x0 + x1) / 2, high + 3.0), view.name, NAME_MM, True)
    boxes.append(name.box)
    box = min([x0, *(b[0] for b in boxes)]), low, max(b[2] for b in boxes), name.box[3]
    return Placed(lines, [*texts, name], dimensions, box)


def _crossed(one: Dimension, places: Sequence[float]) -> bool:
    """Whether a line across its lane at one of the places goes through its number."""
    axis = int(one.vertical)
    return any(one.text.box[axis] < position < one.text.box[axis + 2] for position in places)


def _meet(one: Dimension, other: Dimension) -> bool:
    """Whether the number of one stands on the number or the lines of the other."""
    pairs = [(one.text.box, box) for box in other.boxes] + [(box, other.text.box) for box in one.boxes]
    return any(a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3] for a, b in pairs)


def _lanes(measures: list[tuple[Point, Point, float]], side: str, edge: float) -> list[Dimension]:
    """Dimensions of one side, the shortest nearest; two share a lane where they and their numbers do not meet."""
    vertical, outwards = side in ("left", "right"), 1.0 if side in ("above", "right") else -1.0
    lanes: list[list[Dimension]] = []
    ordered, axis = sorted(measures, key=lambda one: one[2]), int(vertical)
    for rank, (start, end, value) in enumerate(ordered):
        # The lines up to those further out cross this one's lane; its number is next to them.
        crossing = [point[axis] for other in ordered[rank + 1 :] for point in other[:2]]
        tried = [
            Dimension(start, end, 0.0, vertical, value, before, aside=aside)
            for aside in ASIDE_MM
            for before in (False, True)
        ]
        clear = next((one for one in tried if not _crossed(one, crossing)), tried[0])
        for number, lane in enumerate([*lanes, []]):
            made = replace(clear, at=edge + outwards * (FIRST_MM + LANE_MM * number))
            low, high = made.reach
            if all(low > other.reach[1] + 2.0 or high < other.reach[0] - 2.0 for other in lane):
                break
        lane.append(made)
        if number == len(lanes):
            lanes.append(lane)
    return [one for lane in lanes for one in lane]


MARGIN_MM, WIDE_MM, ROW_MM = 10.0, 180.0, 8.0
ROWS = 4
HIGH_MM = ROWS * ROW_MM
NOTE_MM = 4.4
HEAD_MM = 2.5


@dataclass(frozen=True)
class Title:
    """What a title block says."""

    project: str
    part: str
    material: str
    tolerance: str
    revision: str
    date: str
    number: str


def frame_and_title(sheet: Drawing, title: Title, notes: Sequence[str]) -> None:
    """Add frame, title block at the lower right and notes beside or above it."""
    w, h = sheet.size
    m = MARGIN_MM
    left, top = w - m - WIDE_MM, m + HIGH_MM
    middle = left + 92.0
    sheet.lines += [Line(((m, m), (w - m, m), (w - m, h - m), (m, h - m), (m, m)), "frame"),
                    Line(((left, m), (left, top), (w - m, top)), "frame"),
                    *(Line(((left, y), (w - m, y)), "thin") for y in (m + row * ROW_MM for row in range(1, ROWS))),
                    Line(((middle, m), (middle, top)), "thin")]  # fmt: skip
    cells = (
        (("project", title.project), ("part", title.part)),
        (("material", title.material), ("scale", f"{ratio(sheet.scale)}  {sheet.paper}  lengths in mm")),
        (("tolerance", title.tolerance), ("revision", title.revision)),
        (("date", title.date), ("sheet", title.number)),
    )
    for row, pair in enumerate(cells):
        y = top - (row + 1) * ROW_MM + 2.7
        for x, (name, words) in zip((left + 2.0, middle + 2.0), pair):
            room = (middle if x < middle else w - m) - x - 21.0
            sheet.texts.append(Text((x, y), name, HEAD_MM))
            sheet.texts.append(Text((x + 19.0, y), shortened(words, room), TEXT_MM))
    _projection(sheet, (w - m - 21.0, m + ROW_MM / 2))
    lines, tall = notes_beside(notes, w)
    for row, words in enumerate(lines):
        sheet.texts.append(Text((m + 3.0, m + tall - 3.2 - NOTE_MM * row), words, TEXT_MM))


def notes_beside(notes: Sequence[str], wide_mm: float) -> tuple[list[str], float]:
    """Lines of notes beside the title block, and the height that they take above the frame's lower edge. [mm]"""
    lines = wrapped(notes, wide_mm - 2 * MARGIN_MM - WIDE_MM - 6.0)
    return lines, 4.0 + NOTE_MM * len(lines)


def wrapped(notes: Sequence[str], room_mm: float) -> list[str]:
    """Notes broken into lines that fit a width; a longer word is cut."""
    lines = []
    for note in notes:
        lines.append("")
        for word in note.split():
            longer = f"{lines[-1]} {word}".lstrip()
            if lines[-1] and text_width(longer, TEXT_MM) > room_mm:
                lines.append(word)
            else:
                lines[-1] = longer
    return [shortened(line, room_mm) for line in lines]


def shortened(words: str, room_mm: float) -> str:
    """Text cut at its end so that it fits a width."""
    if text_width(words, TEXT_MM) <= room_mm:
        return words
    while words and text_width(words + "...", TEXT_MM) > room_mm:
        words = words[:-1]
    return words.rstrip() + "..."


def _projection(sheet: Drawing, at: Point) -> None:
    """The symbol of first-angle projection: a cone's side view, its end seen from the left on the right."""
    x, y = at
    side = ((x, y - 1.5), (x + 6.0, y - 2.6), (x + 6.0, y + 2.6), (x, y + 1.5), (x, y - 1.5))
    sheet.lines.append(Line(side, "outline"))
    for radius in (1.5, 2.6):
        turn = [2 * math.pi * k / 36 for k in range(37)]
        circle = tuple((x + 12.5 + radius * math.cos(t), y + radius * math.sin(t)) for t in turn)
        sheet.lines.append(Line(circle, "outline"))
    axes = ((x - 1.5, y), (x + 7.5, y)), ((x + 9.0, y), (x + 16.0, y)), ((x + 12.5, y - 3.5), (x + 12.5, y + 3.5))
    sheet.lines += [Line(ends, "thin") for ends in axes]


LETTER = "A"
BEYOND, UNDER = 1.3, 0.5
"""How far a detail reaches beyond the foot, over the foot, and below the flat, over the height."""
POINTS, SEARCH_MM, SCAN_MM = 161, 200.0, 0.01


def foot_mm(shape: PadShape) -> float:
    """Distance from the tip at which a raised face has come down to its flat. [mm]"""
    for known in shape.lines_mm():
        if _drop(shape, np.array([known]))[0] >= shape.relief_mm - 1e-9:
            return float(known)
    at = np.arange(0.0, SEARCH_MM, SCAN_MM)
    low = at[np.argmax(_drop(shape, at) >= shape.relief_mm - 1e-9)] - SCAN_MM
    fine = low + np.linspace(0.0, SCAN_MM, 1001)
    return float(fine[np.argmax(_drop(shape, fine) >= shape.relief_mm - 1e-9)])


def _drop(shape: PadShape, at_mm: np.ndarray) -> np.ndarray:
    """Drop below the tip, across what runs along the length. [mm]"""
    still = np.zeros_like(at_mm)
    return shape.drop_mm(still, at_mm) if shape.runs_out else shape.drop_mm(at_mm, still)


PROFILE_POINTS = 9


def profile_words(shape: PadShape, factor: float = 1.0, zone_mm: float | None = None) -> str:
    """The profile of a crown as points from its tip, and how far a point may lie off it."""
    across = np.linspace(0.0, foot_mm(shape), PROFILE_POINTS)
    points = zip(factor * across, factor * _drop(shape, across))
    listed = ", ".join(f"{r:.2f}/{z:.3f}" for r, z in points)
    within = "" if zone_mm is None else f"; profile tolerance {zone_mm:.2f} to the flat, half of it to either side"
    return f"Profile, distance from the axis/drop below the tip: {listed}{within}."


def crown_detail(shape: PadShape, factor: float = 1.0, radii_mm: tuple[float, float] | None = None) -> View:
    """Show the crown, or the highest cap, enlarged, with its dimensions and the limits of its tip radius."""
    foot, high = foot_mm(shape), shape.relief_mm
    wide, low = factor * BEYOND * foot, -factor * (1.0 + UNDER) * high
    across = np.union1d(np.linspace(-BEYOND * foot, BEYOND * foot, POINTS), [-foot, 0.0, foot])
    # Other caps than this one are not shown.
    drop = np.where(np.abs(across) < foot, _drop(shape, across), high)
    profile = tuple((factor * float(x), -factor * float(z)) for x, z in zip(across, drop))
    border = (*profile, (wide, low), (-wide, low), profile[0])
    foot, high = factor * foot, factor * high
    axis = ((0.0, 0.15 * high), (0.0, low))
    measures = (Measure((0.0, 0.0), (foot, -high), "above"), Measure((wide, -high), (0.0, 0.0), "right"))
    leaders: tuple[tuple[Point, str], ...] = ()
    if shape.tip_radius_mm is not None:
        at = -0.35 * foot
        depth = float(_drop(shape, np.array([abs(at) / factor]))[0])
        words = f"R{number_text(factor * shape.tip_radius_mm)} at the tip"
        if radii_mm is not None:
            words += " ({} to {})".format(*(number_text(factor * one) for one in radii_mm))
        leaders = (((at, -factor * depth), words),)
    runs = ((border, "bound"), (profile, "cut"), (axis, "thin"))
    return View(f"detail {LETTER}", runs, measures, leaders, True, True)

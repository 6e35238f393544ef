"""The drawing of every part that is made: what is shown and what is measured. CAD child only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.files.drawings import projection
from dummydesign.mold.files.drawings.layout import LETTER, Measure, View, arrange, crown_detail
from dummydesign.mold.files.drawings.projection import Hole, Run, Section
from dummydesign.mold.files.drawings.sheet import Drawing, Title
from dummydesign.mold.pour.steps import shape_mark

TURNED = ("strike_off", "spacer", "carrier", "lid", "pad")
"""Parts whose interesting side is below: drawn turned over."""
LEFT_OUT = ("layer_top", "layer_base")
"""Parts that another drawing shows."""
DETAILED = ("pad", "master")
"""Parts whose crown is shown enlarged."""
MOST_WIDTHS, NEAR_MM = 6, 0.3
NAMES = {"strike_off": "strike-off plate", "lid_master": "master of the lid", "lid_frame": "frame of the lid",
         "face_sheet": "face sheet", "sprue_pin": "sprue pin", "vent_pin": "vent pin"}  # fmt: skip


@dataclass(frozen=True)
class DocumentInfo:
    """What all papers of a mould carry besides: the project, the date, the command line that made them."""

    project: str = ""
    date: str = ""
    command: str = ""


NO_PAPERS = DocumentInfo()


def part_views(made: Parts) -> dict[str, list[View]]:
    """What is shown of every part that is made, by its name."""
    return {name: _views(made, name) for name in made.parts if name not in LEFT_OUT}


def sheets(
    made: Parts, views: dict[str, list[View]], papers: DocumentInfo = NO_PAPERS, paper: str = "A3"
) -> dict[str, Drawing]:
    """Arrange what is shown of the parts, a sheet each."""
    pad, limits, found = made.spec.pad, made.spec.acceptance, {}
    thickness = f"; thickness +-{pad.thickness_mm * limits.thickness_percent / 100:.2f}"
    for count, name in enumerate(views, 1):
        title = Title(
            project=papers.project or f"{pad.title}, {made.spec.preset} mould",
            part=f"{_called(made, name)}, t = {pad.thickness_mm:g}",
            material=_material(made, name),
            tolerance=f"ISO 2768-m{thickness if name == 'pad' else ''}",
            revision=made.spec.hash,
            date=papers.date or "-",
            number=f"{count} of {len(views)}",
        )
        found[name] = arrange(views[name], title, _notes(made, name), paper)
    return found


def _called(made: Parts, name: str) -> str:
    if made.spec.is_printed and name in ("mould", "frame"):
        return {"mould": "base of the mould", "frame": "ring of the mould"}[name]
    return NAMES.get(name, name)


def _material(made: Parts, name: str) -> str:
    spec = made.spec
    kind = made.parts[name].material
    if kind == "rigid":
        return spec.plastic.name.upper() if spec.plastic else "rigid plastic"
    if kind == "glass":
        return "float glass or acrylic"
    if kind == "silicone" and spec.silicone is not None:
        return f"silicone {spec.silicone.name}"
    return f"{spec.pour.resin}, ratio {spec.pour.ratio:g}"


def _notes(made: Parts, name: str) -> list[str]:
    """What holds for the whole part: sizes, factors, draft and radii."""
    spec, plan, pad = made.spec, made.plan, made.spec.pad
    mark = shape_mark(spec)
    if name == "pad":
        size = f"Tested face {pad.length_mm:g} x {pad.width_mm:g} to its sharp corner."
        draft = f"Draft {pad.draft_deg:g} deg, widening from the tested face."
        radii = f"Vertical corners R{pad.corner_radius_mm:g}, edge of the tested face R{pad.edge_radius_mm:g}."
        return ["After cure; tested face up.", size, draft, radii, *([f"{pad.kind}: {mark}."] if mark else [])]
    notes = [f"For a {pad.title} after cure.{' Drawn turned over.' if name in TURNED else ''}"]
    if name in ("mould", "lid") or (spec.is_printed and name == "frame"):
        notes.append(f"Cavity x {plan.scale:.5f} of the pad; draft {pad.draft_deg:g} deg, outside "
                     f"{spec.body.outer_draft_deg:g} deg.")  # fmt: skip
        notes.append(f"Corners of the cavity R{plan.floor_outline.radius_mm:.2f}, edge of its floor "
                     f"R{plan.scale * pad.edge_radius_mm:.2f}, outside R{plan.top.radius_mm:.3g}.")  # fmt: skip
        notes += [f"{pad.kind}: {mark}."] if mark and name == "mould" else []
    elif name in ("master", "frame", "lid_master", "lid_frame"):
        notes.append(f"x {plan.silicone_scale:.5f} of the silicone part; draft {pad.draft_deg:g} deg inside, "
                     f"{spec.body.outer_draft_deg:g} deg outside; flange R{plan.flange.radius_mm:.3g}.")  # fmt: skip
    if name == "face_sheet":
        return [*notes, "Cut to size, edges broken; bonded into the master, flush with the plug's top."]
    if name == "carrier" and made.with_bone is None:
        return [*notes, "Glue the pad on by its free face, its middle on the plate's; each groove points at a row of "
                "tips, and the punch is set down where the lines cross."]
    if made.parts[name].material == "rigid":
        against = "resin" if spec.is_printed else "silicone"
        notes.append(f"Print solid skins; faces against {against} sanded or sealed.")
    return notes


def _views(made: Parts, name: str) -> list[View]:
    """A section and a view from above under it; a part whose interesting side is below is shown turned over."""
    solid = made.pad_nominal if name == "pad" else made.solid(name)
    if name in TURNED:
        solid = projection.turned_over(solid)
    rims = projection.holes(solid)
    shape = made.spec.pad.shape
    sites = shape.places_mm if name in ("pad", "carrier") and len(shape.places_mm) > 1 else ()
    views = [_section(made, name, solid, rims), _from_above(solid, rims, sites)]
    if name in ("mould", "pad") and shape.runs_out:
        # Along a ridge or a bar the usual section shows a straight line.
        views.append(_section(made, name, solid, rims, across=True))
    if name in DETAILED and shape.relief_mm:
        factor = 1.0 if name == "pad" else made.plan.scale * made.plan.silicone_scale
        views.append(crown_detail(shape, factor))
        shown = 2 if name == "pad" and shape.runs_out else 0
        x, _ = min(shape.places_mm, key=lambda place: (abs(place[1]), abs(place[0])))
        views[shown] = replace(views[shown], marks=(((factor * x, 0.0), LETTER),))
    return views


def _section(made: Parts, name: str, solid: Any, rims: Sequence[Hole], across: bool = False) -> View:
    cut = projection.cut_at_x if across else projection.cut_at_y
    x0, y0 = section_origin(made, name)
    solid = solid.translate((-x0, -y0, 0.0)) if x0 or y0 else solid
    found = cut(solid)
    measures = [*_heights(solid, found.loops), *_widths(found, rims)]
    runs: list[tuple[Run, str]] = [(loop, "cut") for loop in found.loops]
    if name == "mould":
        measures += _of_cavity(made, found.loops)
        for other in ("spacer", "carrier"):
            if other in made.parts and not (other == "carrier" and made.with_bone is None):
                runs += [(loop, "thin") for loop in cut(made.solid(other)).loops]
    plane = f"x = {x0:.4g}" if across else f"y = {y0:.4g}"
    return View(f"section {plane}", tuple(runs), tuple(measures), (), True)


def section_origin(made: Parts, name: str) -> tuple[float, float]:
    """What a section goes through: the middle of the first of several cavities, in it the row of crowns next to it."""
    grow, printed = made.plan.silicone_scale, made.spec.is_printed
    x = y = 0.0
    if len(made.plan.places) > 1 and name in ("mould", "frame", "master", "face_sheet", "strike_off"):
        first = made.plan.places[0]
        # The casting frame is larger than the mould and turned over.
        cast = name == "master" or (name in ("frame", "face_sheet") and not printed)
        x = first.x_mm * (grow if cast else 1.0)
        y = first.y_mm * (-grow if cast else -1.0 if name in TURNED else 1.0)
    if name not in ("mould", "master", "pad"):
        return x, y
    factor = 1.0 if name == "pad" else made.plan.scale * (grow if name == "master" else 1.0)
    return x, y + factor * min((across for _, across in made.spec.pad.shape.places_mm), key=abs)


def _heights(solid: Any, loops: Sequence[Run]) -> list[Measure]:
    """Overall height on the left, the other levels from the lowest on the right."""
    found = projection.levels(solid)
    xs = [x for loop in loops for x, _ in loop]
    low, high = found[0], found[-1]
    left, right = min(xs), max(xs)
    return [Measure((left, low), (left, high), "left"),
            *(Measure((right, low), (right, z), "right") for z in found[1:-1])]  # fmt: skip


def _of_cavity(made: Parts, loops: Sequence[Run]) -> list[Measure]:
    """Heights in the cavity from its floor: a crown's foot, the interface of layers, the tip of a bone, the fill."""
    plan, pad = made.plan, made.spec.pad
    bone = plan.scale * pad.least_gel_mm if pad.shape.bone_height_mm else 0.0
    left = min(x for loop in loops for x, _ in loop)
    heights = [z for z in (plan.face_mm, plan.interface_mm, bone, plan.depth_mm) if z]
    return [Measure((left, 0.0), (left, z), "left") for z in heights]


def _widths(cut: Section, rims: Sequence[Hole]) -> list[Measure]:
    """Widths of a symmetrical section at its corners, those of nearly the same width and of holes left out."""
    holes = [abs(x) + side * d / 2 for one in rims for x, _ in one.places for d in one.diameters_mm for side in (1, -1)]
    found: list[tuple[float, float]] = []
    for x, z in sorted(cut.corners, reverse=True):
        partner = any(abs(a + x) < 1e-3 and abs(b - z) < 1e-3 for a, b in cut.corners)
        fresh = all(abs(x - other) > NEAR_MM for other, _ in found)
        if x > NEAR_MM and partner and fresh and all(abs(x - rim) > 1e-2 for rim in holes):
            found.append((x, z))
    heights = [z for loop in cut.loops for _, z in loop]
    middle = (max(heights) + min(heights)) / 2
    kept = found if len(found) <= MOST_WIDTHS else [*found[: MOST_WIDTHS - 1], found[-1]]
    return [Measure((-x, z), (x, z), "above" if z > middle else "below") for x, z in kept]


def _from_above(solid: Any, rims: Sequence[Hole], sites: Sequence[tuple[float, float]] = ()) -> View:
    runs = projection.edges_from_above(solid)
    xs = [x for run, _ in runs for x, _ in run]
    ys = [y for run, _ in runs for _, y in run]
    x0, x1, y0, y1 = min(xs), max(xs), min(ys), max(ys)
    measures = [Measure((x0, y0), (x1, y0), "below"), Measure((x1, y0), (x1, y1), "right")]
    leaders = []
    for hole in rims:
        measures += _pattern(hole.places)
        first = min(hole.places)
        leaders.append(((first[0] - hole.diameters_mm[0] / 2, first[1]), hole.words))
    if sites:
        measures += _pattern(sites)
        half = 0.05 * min(x1 - x0, y1 - y0)
        for x, y in sites:
            runs = [*runs, (((x - half, y), (x + half, y)), "thin"), (((x, y - half), (x, y + half)), "thin")]
        leaders.append((min(sites), f"{len(sites)} sites"))
    unique = {(round(m.value, 3), m.side): m for m in measures if m.value > 1e-6}
    return View("view from above", tuple(runs), tuple(unique.values()), tuple(leaders))


def _pattern(places: Sequence[tuple[float, float]]) -> list[Measure]:
    """Distances across a pattern of holes, or from the middle line where a hole has no partner."""
    found = []
    for axis, side in ((0, "above"), (1, "right")):
        for at in sorted({abs(place[axis]) for place in places}):
            row = [place for place in places if abs(abs(place[axis]) - at) < 1e-6]
            both = any(place[axis] > 0 for place in row) and any(place[axis] < 0 for place in row)
            level = max(place[1 - axis] for place in row)
            start, end = ((one, level) if axis == 0 else (level, one)
                          for one in ((-at, at) if both else (0.0, row[0][axis])))  # fmt: skip
            found.append(Measure(start, end, side))
    return found

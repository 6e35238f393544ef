"""What a what-if study varies, and what is refused before any work."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from dummydesign.core.errors import InputError, out_of_range, quantity_name, unknown_name
from dummydesign.core.parsing import DECELERATION, positive, read_numbers
from dummydesign.core.serialise import Serialised
from dummydesign.design.request import NAGOYA_PROTOCOL, Protocol
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.test_conditions import check_numbers
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS, THICKNESS_MM
from dummydesign.geometry.interface import BASES, CONDITIONS, FRICTION, Interface
from dummydesign.geometry.punch import equal_area_radius_mm, punch_sides_mm
from dummydesign.geometry.shape_registry import make_shape, read_shape, shape_kinds
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.measurement.motion import DECELERATION_MM_S2, HOLD_S
from dummydesign.pad.tables.slab import load_table, slab_table
from dummydesign.resin.model.resin import Resin

MOST_SHAPES, MOST_DESIGNS = 100_000, 1_000_000
AVERAGE = "average"
# Forces at which rows are given by default. [N]
SHOWN_N = (1.0, 5.0, 10.0, 15.0)
FIDELITIES = ("table", "axisymmetric", "3d")

Key = tuple[str, str, str, str, float, float, float]
"""Names one design: punch, condition, base, shape, edge radius of the punch [mm], thickness [mm], ratio."""


def parse_shapes(text: str) -> tuple[str, ...]:
    """Read ``NAME[:KEY=RANGE,...],...``; a range is a value, START:STOP:STEP with STOP included, or A/B/C.

    Every combination of a shape's values is one shape. What does not begin with the name of a shape belongs to the one
    before it.

    Examples
    --------
    >>> parse_shapes("slab,crowned:radius=10:14:2,height=2")
    ('slab', 'crowned:radius=10,height=2', 'crowned:radius=12,height=2', 'crowned:radius=14,height=2')
    """
    shapes: list[str] = []
    for name, items in _split(text):
        keys, values = [], []
        for number, item in enumerate(items):
            key, equals, given = item.rpartition("=")
            keys.append(key.strip() if equals else str(number))
            given = given.replace("/", ",")
            values.append(read_numbers(given, f"shape {name}: {keys[-1] if equals else f'value {number + 1}'}"))
        count = math.prod(len(one) for one in values)
        if count > MOST_SHAPES:
            message = f"shape {name}: {count} shapes are more than {MOST_SHAPES}; use wider steps"
            raise InputError(message, "too_large", "shape", count, MOST_SHAPES)
        shapes += [str(make_shape(name, tuple(zip(keys, chosen)))) for chosen in itertools.product(*values)]
    return tuple(shapes)


def _split(text: str) -> list[tuple[str, list[str]]]:
    shapes: list[tuple[str, list[str]]] = []
    known = shape_kinds()
    for part in filter(None, (part.strip() for part in text.split(","))):
        head, colon, rest = part.partition(":")
        if head.lower() in known:
            shapes.append((head.lower(), [rest] if colon else []))
        elif shapes and ("=" in head or _number(head)):
            shapes[-1][1].append(part)
        else:
            raise unknown_name("shape", head, tuple(known))
    if not shapes:
        raise InputError("shape has no value; give at least one, such as slab", "missing", "shape")
    return shapes


def _number(text: str) -> bool:
    try:
        float(text.split("/")[0])
    except ValueError:
        return False
    return True


def check_pads(study: Study) -> None:
    """Refuse shapes and edges that no model of the study's fidelity knows, and shapes that no thickness can hold."""
    shaped = [shape for shape in study.shapes if shape != Slab.name]
    edges = [edge for edge in study.edge_radii_mm if edge != 0.0]
    for edge in edges:
        for punch, _ in study.punches:
            sides = punch_sides_mm(punch)
            half = min(sides) / 2.0 if sides else equal_area_radius_mm(punch)
            if not 0.0 < edge <= LARGEST_EDGE_RADIUS * half:
                words = f"{LARGEST_EDGE_RADIUS:g} of the half-width of {punch}"
                raise out_of_range("edge radius in mm", edge, 0, f"{LARGEST_EDGE_RADIUS * half:g}", words)
    if edges:
        _check_edges(study, edges, shaped)
    if not shaped:
        return
    if study.fidelity == "3d":
        raise InputError(
            "shapes are worked out by the tables or by --fidelity axisymmetric; press one in space with "
            f"'dummydesign predict --shape {shaped[0]} --fidelity 3d'",
            "unsupported",
            "shape",
            shaped[0],
        )
    if study.fidelity == "table":
        from dummydesign.design.search.shape_family import designable_kinds

        for base in study.bases:
            if base != "bonded":
                message = f"base = {base} of a shaped pad is not in the tables; add --fidelity axisymmetric"
                raise InputError(message, "not_tabulated", "base", base, "bonded")
        for shape in shaped:
            kind = shape.partition(":")[0]
            if kind not in designable_kinds():
                message = f"shape {kind} has no response surface; add --fidelity axisymmetric"
                raise InputError(message, "not_tabulated", "shape", shape)
    else:
        for shape in shaped:
            if not read_shape(shape).axisymmetric:
                message = f"shape {shape} is not round; leave out --fidelity axisymmetric for its table"
                raise InputError(message, "unsupported", "shape", shape)
    pads = itertools.product(study.shapes, study.thickness_mm)
    if Slab.name not in study.shapes and all(why_not_cast(shape, thickness) for shape, thickness in pads):
        why = why_not_cast(shaped[0], max(study.thickness_mm))
        message = f"no thickness of the study can hold any of its shapes; {shaped[0]}: {why}"
        raise InputError(message, "cannot_be_made", "shape", shaped[0])


def why_not_cast(shape: str, thickness_mm: float) -> str | None:
    """Why a pad of this thickness cannot have the shape; None when it can."""
    try:
        read_shape(shape).check(thickness_mm)
    except InputError as problem:
        return str(problem)
    return None


def _check_edges(study: Study, edges: list[float], shaped: list[str]) -> None:
    """Refuse shapes, conditions and fidelities that a fillet is not worked out for, and fillets outside their table."""
    edge = edges[0]
    if study.fidelity == "3d":
        message = f"edge radius in mm = {edge:g} is not solved in space; leave out --fidelity 3d"
        raise InputError(message, "unsupported", "edge_radius_mm", edge)
    if study.fidelity == "table":
        for one, (punch, _), base in itertools.product(edges, study.punches, study.bases):
            slab_table(base, one, equal_area_radius_mm(punch))
    slides = next((condition for condition in study.conditions if condition != "bonded"), None)
    if shaped and study.fidelity == "table":
        message = f"edge radius in mm = {edge:g} of shaped pads has no table; add --fidelity axisymmetric"
        raise InputError(message, "not_tabulated", "edge_radius_mm", edge)
    if shaped and slides:
        raise InputError(
            f"edge radius in mm = {edge:g} with condition = {slides} is solved for flat slabs only; leave out "
            f"--shape {shaped[0]}, --edge-radius or --condition",
            "unsupported",
            "edge_radius_mm",
            edge,
        )


@dataclass(frozen=True)
class Study(Serialised):
    """What is varied. All combinations are worked out, the ratio fastest, then thickness."""

    thickness_mm: tuple[float, ...]
    ratio: tuple[float, ...]
    punches: tuple[tuple[str, float], ...]
    velocities_mm_s: tuple[float, ...] = (10.0, 250.0)
    forces_N: tuple[float, ...] = SHOWN_N
    resin: str = "polyurethane-nagoya"
    tissue: str | None = None
    aim: str = AVERAGE
    fidelity: str = "table"
    conditions: tuple[str, ...] = ("bonded",)
    bases: tuple[str, ...] = ("bonded",)
    shapes: tuple[str, ...] = (Slab.name,)
    edge_radii_mm: tuple[float, ...] = (0.0,)
    hold_s: float = HOLD_S
    deceleration_mm_s2: float = DECELERATION_MM_S2

    @property
    def protocol(self) -> Protocol:
        """The test that scores are of: forces and speeds requested, those of the paper in place of defaults.

        The default forces are shown, 1 N among them, and are no test; so scores of a study that names none are those
        that ``suggest`` gives.
        """
        shown = tuple(sorted(set(self.forces_N)))
        forces = NAGOYA_PROTOCOL.forces_N if shown == SHOWN_N else shown
        return Protocol(forces, tuple(sorted(set(self.velocities_mm_s))))

    @property
    def sampling(self) -> Sampling:
        """Hold and braking of the presses."""
        return Sampling(hold_s=self.hold_s, deceleration_mm_s2=self.deceleration_mm_s2)

    @property
    def size(self) -> int:
        """Number of designs."""
        return len(self.thickness_mm) * len(self.ratio) * len(self.setups) * len(self.pads)

    @property
    def setups(self) -> list[tuple[tuple[str, float], str, str]]:
        """Combinations of punch (name, radius), condition and base."""
        return list(itertools.product(self.punches, self.conditions, self.bases))

    @property
    def pads(self) -> list[tuple[str, float]]:
        """Combinations of shape and edge radius of the punch [mm]."""
        return list(itertools.product(self.shapes, self.edge_radii_mm))

    def keys(self) -> list[Key]:
        """Name every design, in the order of the rows."""
        each = itertools.product(self.setups, self.pads, self.thickness_mm, self.ratio)
        return [
            (punch, condition, base, shape, edge, thickness, ratio)
            for ((punch, _), condition, base), (shape, edge), thickness, ratio in each
        ]

    def check(self, resin: Resin) -> None:
        """Refuse what is not allowed before any work (InputError)."""
        if self.fidelity not in FIDELITIES:
            raise unknown_name("fidelity", self.fidelity, FIDELITIES)
        if self.size > MOST_DESIGNS:
            message = f"number of designs = {self.size} is above {MOST_DESIGNS}; use wider steps"
            raise InputError(message, "too_large", "designs", self.size, MOST_DESIGNS)
        for value in self.thickness_mm:
            if not THICKNESS_MM[0] <= value <= THICKNESS_MM[1]:
                raise out_of_range("thickness in mm", value, *THICKNESS_MM, "slabs that can be cast")
        resin.check_ratio(self.ratio)
        for name, values in (("force in N", self.forces_N), ("velocity in mm/s", self.velocities_mm_s)):
            for value in values:
                if not value > 0:
                    raise out_of_range(name, value, "above 0", "any finite value")
        check_numbers(None, None, self.hold_s)
        if self.tissue is None and self.aim != AVERAGE:
            message = f"aim = {self.aim} is of a tissue's subjects: give --tissue, or leave --aim out"
            raise InputError(message, "not_applicable", "aim", self.aim)
        positive(DECELERATION.quantity, self.deceleration_mm_s2)
        self._check_setups()
        check_pads(self)
        varied: dict[str, Sequence[float | str]] = {
            "thickness in mm": self.thickness_mm,
            "ratio": self.ratio,
            "punch": [punch for punch, _ in self.punches],
            "condition": self.conditions,
            "base": self.bases,
            "shape": self.shapes,
            "edge radius in mm": self.edge_radii_mm,
        }
        for name, listed in varied.items():
            for twice in [value for value, count in Counter(listed).most_common(1) if count > 1]:
                raise InputError(f"{name} = {twice} is listed twice", "duplicate", quantity_name(name), twice)

    def _check_setups(self) -> None:
        """Refuse conditions and bases that no model of this fidelity knows, and punches outside the table."""
        for base in self.bases:
            if base not in BASES:
                raise unknown_name("base", base, BASES)
        if self.fidelity == "table":
            for condition in self.conditions:
                if condition != "bonded":
                    raise InputError(
                        f"condition = '{condition}' is not in the response table (only bonded); "
                        "add --fidelity axisymmetric",
                        "not_tabulated",
                        "condition",
                        condition,
                        "bonded",
                    )
            low, high = load_table(self.bases[0]).ratio_range
            for name, radius in self.punches:
                for thickness in (min(self.thickness_mm), max(self.thickness_mm)):
                    if not low * (1 - 1e-9) <= radius / thickness <= high * (1 + 1e-9):
                        words = f"punch radius over thickness of {name} on {thickness:g} mm"
                        advice = "of the response table; add --fidelity axisymmetric"
                        raise out_of_range(words, f"{radius / thickness:.3g}", low, high, advice)
            return
        for condition in self.conditions:
            if Interface.names_friction(condition) and self.fidelity == "axisymmetric":
                check_friction(condition)
            elif condition not in CONDITIONS:
                more = (FRICTION,) if self.fidelity == "axisymmetric" else ()
                raise unknown_name("condition", condition, (*CONDITIONS, *more))
        for name, _ in self.punches:
            if self.fidelity == "3d" and name.startswith("round"):
                message = f"punch '{name}' is round; fidelity 3d is for square and rectangle, use axisymmetric"
                raise InputError(message, "unsupported", "punch", name)

    @property
    def reduced(self) -> list[str]:
        """Punches that this study takes as the circle of their area although they differ from it."""
        if self.fidelity == "3d":
            return []
        return [name for name, radius in self.punches if not self._corners_known(name, radius)]

    def _corners_known(self, punch: str, radius_mm: float) -> bool:
        """Whether the corners of a punch are in every row of this study."""
        sides, shaped = punch_sides_mm(punch), any(shape != Slab.name for shape in self.shapes)
        if self.fidelity == "table":
            square = sides is not None and sides[0] == sides[1]
            return punch.startswith("round") or (square and not shaped)
        from dummydesign.pad.fe_force_law import corners_known
        from dummydesign.pad.pad_under_punch import Pad

        # The slabs between the thinnest and the thickest lie in the same table when both do.
        ends = (min(self.thickness_mm), max(self.thickness_mm))
        each = itertools.product(ends, self.bases, self.conditions)
        pads = [Pad(mm, 1.0, radius_mm, base=base, condition=face, sides_mm=sides) for mm, base, face in each]
        return not shaped and all(corners_known(pad, self.fidelity) for pad in pads)


def check_friction(condition: str) -> None:
    """Refuse a coefficient of friction outside 0 to 5 (InputError)."""
    if Interface.find(condition, ()) is None:
        raise out_of_range(
            f"friction of condition '{condition}'", condition.partition(":")[2], 0, 5, FRICTION, "friction"
        )

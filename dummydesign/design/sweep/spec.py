"""What a what-if study varies, and what is refused before any work."""

from __future__ import annotations

import itertools
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.core.checks import DECELERATION, positive
from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.design.own_test.checks import check_numbers
from dummydesign.design.request import PAPER, Protocol
from dummydesign.design.scoring.presses import Sampling
from dummydesign.design.search.slabs import THICKNESS_MM
from dummydesign.design.sweep.pads import check_pads
from dummydesign.geometry.interface import BASES, CONDITIONS, FRICTION, Interface
from dummydesign.geometry.shapes import Slab
from dummydesign.measurement.motion import DECELERATION_MM_S2, HOLD_S
from dummydesign.pad.tables.punch import punch_sides_mm

if TYPE_CHECKING:
    from dummydesign.resin.model.resin import Resin

MOST_DESIGNS = 1_000_000
SHOWN_N = (1.0, 5.0, 10.0, 15.0)
"""Forces at which rows are given by default. [N]"""
FIDELITIES = ("table", "axisymmetric", "3d")

Key = tuple[str, str, str, str, float, float, float]
"""Names one design: punch, condition, base, shape, edge radius of the punch [mm], thickness [mm], ratio."""


@dataclass(frozen=True)
class Study:
    """What is varied. All combinations are worked out, the ratio fastest, then thickness.

    Attributes
    ----------
    thickness_mm, ratio : tuple of float
        Designs. [mm, resin's ratio]
    punches : tuple of (name, radius in mm)
        Punches by the radius of the circle of their area.
    velocities_mm_s, forces_N : tuple of float
        Speeds for peak over steady, and relaxed forces for depth, stiffness and exponent; both for the scores, see
        :attr:`protocol`.
    resin : str
    tissue : str or None
        Score for this tissue when given (with its aim).
    fidelity : str
        ``table``, ``axisymmetric`` or ``3d`` (one finite-element solve a thickness, punch, condition and base).
    conditions, bases : tuple of str
        Face under the punch and base of the pad; the table knows a glued face on a glued or sliding base.
    shapes : tuple of str
        Shapes of the pads with all their lengths, as their text.
    edge_radii_mm : tuple of float
        Fillets of the punch's edge; 0 is sharp. [mm]
    hold_s, deceleration_mm_s2 : float
        Hold after the stop, and braking, of the presses that scores and peak over steady are of. [s, mm/s2]
    """

    thickness_mm: tuple[float, ...]
    ratio: tuple[float, ...]
    punches: tuple[tuple[str, float], ...]
    velocities_mm_s: tuple[float, ...] = (10.0, 250.0)
    forces_N: tuple[float, ...] = SHOWN_N
    resin: str = "polyurethane-nagoya"
    tissue: str | None = None
    aim: str = "average"
    fidelity: str = "table"
    conditions: tuple[str, ...] = ("bonded",)
    bases: tuple[str, ...] = ("bonded",)
    shapes: tuple[str, ...] = (Slab.name,)
    edge_radii_mm: tuple[float, ...] = (0.0,)
    hold_s: float = HOLD_S
    deceleration_mm_s2: float = DECELERATION_MM_S2

    @property
    def protocol(self) -> Protocol:
        """The test that scores are of: forces and speeds that were asked for, those of the paper in place of defaults.

        The default forces are shown, 1 N among them, and are no test; so scores of a study that names none are those
        that ``suggest`` gives.
        """
        shown = tuple(sorted(set(self.forces_N)))
        forces = PAPER.forces_N if shown == SHOWN_N else shown
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
        return [
            (punch[0], condition, base, shape, edge, thickness, ratio)
            for punch, condition, base in self.setups
            for shape, edge in self.pads
            for thickness in self.thickness_mm
            for ratio in self.ratio
        ]

    def check(self, resin: Resin) -> None:
        """Refuse what is not allowed before any work (InputError)."""
        if self.fidelity not in FIDELITIES:
            raise unknown_name("fidelity", self.fidelity, FIDELITIES)
        if self.size > MOST_DESIGNS:
            raise InputError(f"number of designs = {self.size} is above {MOST_DESIGNS}; use wider steps")
        for value in self.thickness_mm:
            if not THICKNESS_MM[0] <= value <= THICKNESS_MM[1]:
                raise out_of_range("thickness in mm", value, *THICKNESS_MM, "slabs that can be cast")
        resin.check_ratio(self.ratio)
        for name, values in (("force in N", self.forces_N), ("velocity in mm/s", self.velocities_mm_s)):
            for value in values:
                if not value > 0:
                    raise out_of_range(name, value, "above 0", "any finite value")
        check_numbers(None, None, self.hold_s)
        positive(DECELERATION.quantity, self.deceleration_mm_s2)
        self._check_setups()
        check_pads(self)
        for name, values in (
            ("thickness in mm", self.thickness_mm),
            ("ratio", self.ratio),
            ("punch", [punch for punch, _ in self.punches]),
            ("condition", self.conditions),
            ("base", self.bases),
            ("shape", self.shapes),
            ("edge radius in mm", self.edge_radii_mm),
        ):
            twice = [value for value in values if list(values).count(value) > 1] if len(values) < 1000 else []
            if twice or len(set(values)) < len(values):
                raise InputError(f"{name} = {twice[0] if twice else 'a value'} is given twice; name each value once")

    def _check_setups(self) -> None:
        """Refuse conditions and bases that no model of this fidelity knows, and punches outside the table."""
        for base in self.bases:
            if base not in BASES:
                raise unknown_name("base", base, BASES)
        if self.fidelity == "table":
            from dummydesign.pad.tables.slab import load_table

            for condition in self.conditions:
                if condition != "bonded":
                    raise InputError(
                        f"condition = '{condition}' is not in the response table (only bonded); "
                        "add --fidelity axisymmetric"
                    )
            low, high = load_table(self.bases[0]).ratio_range
            for name, radius in self.punches:
                for thickness in (min(self.thickness_mm), max(self.thickness_mm)):
                    if not low * (1 - 1e-9) <= radius / thickness <= high * (1 + 1e-9):
                        raise out_of_range(
                            f"punch radius over thickness of {name} on {thickness:g} mm",
                            f"{radius / thickness:.3g}",
                            low,
                            high,
                            "of the response table; add --fidelity axisymmetric",
                        )
            return
        for condition in self.conditions:
            if Interface.names_friction(condition) and self.fidelity == "axisymmetric":
                check_friction(condition)
            elif condition not in CONDITIONS:
                more = (FRICTION,) if self.fidelity == "axisymmetric" else ()
                raise unknown_name("condition", condition, (*CONDITIONS, *more))
        for name, _ in self.punches:
            if self.fidelity == "3d" and name.startswith("round"):
                raise InputError(f"punch '{name}' is round; fidelity 3d is for square and rectangle, use axisymmetric")

    @property
    def reduced(self) -> list[str]:
        """Punches that this study takes as the circle of their area although they differ from it."""
        if self.fidelity == "3d":
            return []
        return [name for name, radius in self.punches if not self._corners_known(name, radius)]

    def _corners_known(self, punch: str, radius_mm: float) -> bool:
        """Whether the corners of a punch are in every row of this study."""
        if self.fidelity == "table":
            shaped = any(shape != Slab.name for shape in self.shapes)
            return punch.startswith("round") or (_is_square(punch) and not shaped)
        from dummydesign.design.search.solved_slabs import SlabCase

        # The slabs between the thinnest and the thickest lie in the same table when both do.
        ends = (min(self.thickness_mm), max(self.thickness_mm))
        each = itertools.product(ends, self.bases, self.conditions)
        sides = punch_sides_mm(punch)
        cases = [SlabCase(mm, radius_mm, base, condition, sides_mm=sides) for mm, base, condition in each]
        return all(shape == Slab.name for shape in self.shapes) and all(case.corners_known for case in cases)

    def to_dict(self) -> dict[str, Any]:
        """Return what is varied as plain values."""
        return asdict(self)


def check_friction(condition: str) -> None:
    """Refuse a coefficient of friction outside 0 to 5 (InputError)."""
    if Interface.find(condition, ()) is None:
        raise out_of_range(f"friction of condition '{condition}'", condition.partition(":")[2], 0, 5, FRICTION)


def _is_square(punch: str) -> bool:
    sides = punch_sides_mm(punch)
    return sides is not None and sides[0] == sides[1]

"""A crown, or a ridge, on a flat pad."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry import dimensions as limits
from dummydesign.geometry.conic import FOOT_SHARES, ConicProfile, wall_slope
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import Array, PadBlock, Similarity, grid, stack

# Crowns that are tried: height over thickness, and R c / b^2, by which a cap is a point (0.1) or blunt (0.65).
HEIGHT_SHARES = np.linspace(0.2, 0.74, 10)
POINTEDNESS = np.array([0.1, 0.14, 0.19, 0.25, 0.32, 0.4, 0.48, 0.56, 0.65])
MOST_SITES = 20


@dataclass(frozen=True)
class Crowned(ConicProfile):
    """A conic top over a flat pad: apex radius, height of the crown, foot radius (0: that of a sphere).

    With ``ridge`` = 1 the profile is a cylinder's: it runs along the whole length and varies across the width.

    One pad may have several such crowns, ``sites_along`` its length times ``sites_across`` its width, their tips
    ``pitch_along`` and ``pitch_across`` apart about the pad's middle. One is pressed at a time, and the origin of
    ``drop_mm`` is its tip; how little the others change the force is solved where sites are requested
    (:mod:`dummydesign.design.crown_array`).
    """

    name: ClassVar[str] = "crowned"
    order: ClassVar[int] = 1
    flat_top: ClassVar[bool] = False
    crowned: ClassVar[bool] = True
    closed_form: ClassVar[str] = ", its crown by the conic's integral"
    required_warnings: ClassVar[frozenset[str]] = frozenset({"curved_master", "thickness_varies"})
    similarity: ClassVar[Similarity | None] = Similarity(
        ("thickness over punch radius", "crown height over thickness", "foot over punch radius", "R c / b^2"),
        (True, False, True, True),
        over_tip=True,
    )
    ridge: float = 0.0
    sites_along: float = 1.0
    sites_across: float = 1.0
    pitch_along_mm: float = 0.0
    pitch_across_mm: float = 0.0

    @property
    def parameters(self) -> tuple[tuple[str, float], ...]:
        """Names and values; those of the sites where there is more than one."""
        every = super().parameters
        return every if self.sites != (1, 1) else every[:-4]

    @property
    def sites(self) -> tuple[int, int]:
        """Crowns along the length and across the width."""
        return int(self.sites_along), int(self.sites_across)

    @property
    def places_mm(self) -> tuple[tuple[float, float], ...]:
        """Tips of the crowns about the pad's middle, row by row."""
        (n, m), dx, dy = self.sites, self.pitch_along_mm, self.pitch_across_mm
        return tuple(((i - 0.5 * (n - 1)) * dx, (j - 0.5 * (m - 1)) * dy) for j in range(m) for i in range(n))

    @property
    def along(self) -> bool:
        """A ridge runs along the length."""
        return bool(self.ridge)

    @property
    def relief_mm(self) -> float:
        """The crown's height."""
        return self.height_mm

    @property
    def tip_radius_mm(self) -> float:
        """The apex radius."""
        return self.radius_mm

    @property
    def sharp_edge(self) -> str:
        """An edge rounded under a ridge would leave a notch at its ends."""
        return "a ridge must be 0: its ends run out in the walls" if self.ridge else ""

    def drop_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the crown has fallen."""
        return self.sag_mm(self.across_mm(x_mm, y_mm))

    def ends(self, block: PadBlock) -> tuple[float, float]:
        """The ridge meets the end walls, which lean outwards from the flat of the tested face."""
        slope = wall_slope(block)
        return block.length_mm / 2 - slope * self.face_height_mm(block), slope

    def top_volume_mm3(self, block: PadBlock) -> float:
        """Volume of the crowns or the ridge."""
        return len(self.places_mm) * self.volume_mm3(block)

    def check(self, thickness_mm: float, length_mm: float = PAD_LENGTH_MM, width_mm: float = PAD_WIDTH_MM) -> None:
        """Refuse tips, slopes and rests that cannot be cast."""
        limits.check_flag("ridge", self.ridge)
        self.check_cap("crown", limits.STEEPEST_TOP_DEG)
        limits.check_left("crown", self.height_mm, thickness_mm, limits.THINNEST_GEL_MM)
        self._check_sites(length_mm, width_mm)

    def _check_sites(self, length_mm: float, width_mm: float) -> None:
        """Refuse crowns that run into each other or over the rim."""
        for name, count, pitch, across in (
            ("along", self.sites_along, self.pitch_along_mm, length_mm),
            ("across", self.sites_across, self.pitch_across_mm, width_mm),
        ):
            if not (count == int(count) and 1 <= count <= MOST_SITES):
                message = f"sites_{name} = {count:g} is not a whole number from 1 to {MOST_SITES}"
                raise InputError(message, "out_of_range", f"sites_{name}", count, (1, MOST_SITES))
            if count == 1:
                if not (self.ridge and name == "along"):
                    limits.check_inside("crown", self.foot_mm, across)
                continue
            if self.ridge:
                message = f"sites_{name} = {count:g}: a ridge has one site; leave the sites or the ridge out"
                raise InputError(message, "conflict", f"sites_{name}", count)
            if not pitch >= 2.0 * self.foot_mm:
                least = 2.0 * self.foot_mm
                message = f"pitch_{name} = {pitch:g} mm is below {least:.4g} mm: the crowns meet at their feet"
                raise InputError(message, "out_of_range", f"pitch_{name}_mm", pitch, (least, None))
            limits.check_inside("the outermost crown", 0.5 * (count - 1) * pitch + self.foot_mm, across)

    def mark(self, block: PadBlock, scale: float) -> str:
        """Tip, height and foot."""
        what = "ridge along the length" if self.ridge else "crown"
        where = "the middle; edges of the tested face stay sharp" if self.ridge else "the middle"
        if self.sites != (1, 1):
            pitches = zip(self.sites, (self.pitch_along_mm, self.pitch_across_mm))
            distances = " x ".join(f"{pitch:g}" for count, pitch in pitches if count > 1)
            where = f"each tip; {self.sites[0]} x {self.sites[1]} of them, {distances} mm apart about the pad's middle"
        sizes = f"tip radius {self.radius_mm:g} mm, height {self.height_mm:g} mm, foot {self.foot_mm:.4g} mm"
        return f"{what}: {sizes} from {where}"

    @classmethod
    def candidates(cls, thickness_mm: Array, radius_mm: float) -> tuple[Array, dict[str, Array]]:
        """Round crowns."""
        h, share, foot, point = grid(thickness_mm, HEIGHT_SHARES, FOOT_SHARES, POINTEDNESS)
        height, foot = np.round(share * h, 1), np.round(foot * radius_mm, 1)
        return h, {"radius": np.round(point * foot**2 / height, 1), "height": height, "foot": foot}

    @classmethod
    def numbers(cls, parameters: Mapping[str, Array], thickness_mm: Array, radius_mm: Array) -> Array:
        """h / a, c / h, b / a and R c / b^2."""
        radius, height, foot = (parameters[name] for name in ("radius", "height", "foot"))
        return stack(thickness_mm / radius_mm, height / thickness_mm, foot / radius_mm, radius * height / foot**2)

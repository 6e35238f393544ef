"""The force law of a campaign, how deep it reaches, and how well it is known before a fit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.interpolation import group_near
from dummydesign.core.progress import Progress, quiet
from dummydesign.core.quantity import Quantity
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS, PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.loop.data.trials import Presses, stack
from dummydesign.loop.model.campaign_pad_law import CampaignPadLaw
from dummydesign.loop.model.effect import SetupLaw, UnitForce
from dummydesign.loop.model.material import material_of
from dummydesign.measurement.campaign import Campaign, Trial
from dummydesign.pad.force_source import curve_without_solve, has_square_factor
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.tables.elastic_law import ogden_law

SLAB_ERROR = ((0.005, 0.35), (0.015, 0.35), (0.008, 0.4), (0.001, 0.7))
"""Error of a law per thickness in level, slope and curvature at d/h = 0.4, and waves: median size and spread of its
logarithm.
Slabs: half a per cent from pad to pad, and at depth what the table and the square-punch factor state, each known
within a factor of two (0.35 = ln 2 / 1.96); waves: slabs of 6, 10 and 16 mm under a filleted punch differ from GetFEM's
by 0.05 to 0.09 % (root mean square) beside a parabola in depth, known within a factor of four. Pucks: the closed form
is exact for the neo-Hookean law; the allowance is for the law."""
ROUND_ERROR = (SLAB_ERROR[0], (0.005, 0.35), (0.005, 0.4), SLAB_ERROR[3])
"""The same under a round punch, without the square's factor: the table states 0.7 to 1.1 % (95 %) at d/h = 0.4 of pads
of 8 and 15 mm."""
OUTLINE_ERROR = 0.01  # error of taking a square for the circle of its area on a pad whose own factor is not solved
THICKNESS_SLOPE = 1.0
"""-d ln F / d ln h of a usual pad (0.7 at 15 mm, 1.4 at 5 mm), for the error of a measured thickness."""
ROUGHNESS = 0.0015
"""Relative roughness over depth of a pad whose contact grows cell by cell: crowns of 7, 10 and 14 mm on 24 and on 32
cells differ by 0.12 to 0.18 % (root mean square) beside a parabola in depth. Taken for other growing contacts too."""
# A press may end so much deeper than its law: the last secant is good for that.
BEYOND = 1.02
LEAST_LEFT = 2


def error_priors(
    relative_error: float = 0.0,
    outline: bool = False,
    thickness: float = 0.0,
    rough: bool = False,
    usual: tuple = SLAB_ERROR,
    bend: float = 0.0,
) -> tuple:
    """Median size and spread of the law error: the usual one with the stated error of a force, of thickness, and of the
    bend over depth by an elastic law that is known to an interval."""
    stated, shape = 0.5 * relative_error, OUTLINE_ERROR if outline else 0.0
    more = (
        (stated, shape, THICKNESS_SLOPE * thickness),
        (stated, shape, 0.5 * bend),
        (0.5 * stated, 0.5 * bend),
        (ROUGHNESS if rough else 0.0,),
    )
    return tuple((float(np.linalg.norm([size, *added])), spread) for (size, spread), added in zip(usual, more))


@dataclass(frozen=True, eq=False)
class CampaignLaw:
    """The law of each pad of a campaign, by its shape as typed (empty for a slab or a puck) and its thickness.

    ``rows`` are the pads of the rows of depths that it is asked at; without them they are the pads of the first shape
    that are as thick.
    """

    pads: dict[tuple[str, float], CampaignPadLaw]
    error_priors: tuple = SLAB_ERROR
    rows: tuple[tuple[str, float], ...] = ()

    @property
    def shape(self) -> str:
        """``slab`` where all are slabs under a sharp edge in the response table, ``cylinder``, else ``shaped``."""
        if any(isinstance(law.pad, Puck) for law in self.pads.values()):
            return "cylinder"
        return "slab" if all(law.sharp for law in self.pads.values()) else "shaped"

    @property
    def offers(self) -> frozenset[str]:
        """What every pad offers."""
        return frozenset.intersection(*(law.offers for law in self.pads.values()))

    @property
    def radius_mm(self) -> float:
        """Radius of the punch, or of the circle of its area; of a puck. [mm]"""
        return next(iter(self.pads.values())).pad.radius_mm

    def law_of(self, pad: tuple[str, float]) -> CampaignPadLaw:
        """The law of a pad; where none is of its own, that of the nearest in thickness, at its thickness if that needs
        no solve."""
        if pad in self.pads:
            return self.pads[pad]
        shape, thickness = pad
        own = [known for known in self.pads if known[0] == shape]
        return self.pads[min(own, key=lambda known: abs(math.log(known[1] / thickness)))].at(thickness)

    def on(self, trials: Sequence[Trial]) -> CampaignLaw:
        """The law of these trials, row by row."""
        return replace(self, rows=tuple(trial.pad for trial in trials))

    def limit_of(self, trials: Sequence[Trial]) -> NDArray:
        """Depth to which the law of each trial's pad holds, shape (T,). [mm]"""
        return np.array([self.law_of(trial.pad).limit_mm for trial in trials])

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2] at depths (T, N) of pads of thicknesses (T, 1)."""
        return self._by_pad(depth_mm, thickness_mm, CampaignPadLaw.__call__)

    def sliding(self) -> UnitForce:
        """The same pads on a base that slides."""
        return lambda depth, h: self(depth, h) * np.exp(self._read(depth, h, lambda law: law.log_sliding))

    def compressibility_coefficient(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """c of a compressible pad, F / (1 + (1 - 2 nu) c)."""
        return self._read(depth_mm, thickness_mm, lambda law: law.bulk_coefficient)

    def edge_factor(self, edge_radius_mm: float, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """Force under a punch with a fillet over that of the sharp one."""
        return np.exp(self._read(depth_mm, thickness_mm, lambda law: law.log_filleted(edge_radius_mm)))

    def _read(self, depth_mm: NDArray, thickness_mm: NDArray, values: Callable[[CampaignPadLaw], NDArray]) -> NDArray:
        """Values that each pad keeps over depth."""
        return self._by_pad(depth_mm, thickness_mm, lambda law, depth, _: law.read(values(law), depth))

    def _by_pad(self, depth_mm: NDArray, thickness_mm: NDArray, of: Callable[..., NDArray]) -> NDArray:
        depth, first = np.asarray(depth_mm, float), next(iter(self.pads))[0]
        thickness = np.broadcast_to(np.asarray(thickness_mm, float), (len(depth), 1))
        own = thickness[:, 0].tolist()
        rows = self.rows or [(first, h) for h in own]
        laws = [self.law_of(pad).at(h) for pad, h in zip(rows, own)]
        out = np.empty_like(depth)
        for law in dict.fromkeys(laws):
            same = [row for row, other in enumerate(laws) if other is law]
            out[same] = of(law, depth[same], thickness[same])
        return out


def within_reach(
    campaign: Campaign, presses: Presses, law: SetupLaw, least: int = LEAST_LEFT
) -> tuple[Campaign, Presses, str]:
    """A campaign without the presses that go deeper than their law."""
    limit = law.limit_of(presses.trials)
    deep = presses.depth_mm > BEYOND * limit
    if not deep.any():
        return campaign, presses, ""
    files = ", ".join(trial.file for trial, out in zip(presses.trials, deep) if out)
    depth, end = float(presses.depth_mm[deep].max()), float(np.min(limit[deep]))
    why = f"up to {depth:.3g} mm, where the force law of the pad is known to {end:.3g} mm"
    kept = tuple(trial for trial, out in zip(presses.trials, deep) if not out)
    if len(kept) < least:
        message = f"presses go deeper than can be modelled, {why}: {files}; press less deep, or a thicker pad"
        raise InputError(message, "out_of_range", "displacement_mm", depth, (0.0, end))
    own = replace(campaign, trials=kept)
    return own, stack(kept, campaign.lowpass), f"{int(deep.sum())} of {len(deep)} presses are left out, {why}: {files}"


ONE_PAD = 0.06
"""Thicknesses that differ by at most this share of them are on one solved curve, whose change is solved too."""
DEPTHS = (0.3, 0.45, MAX_DEPTH_OVER_THICKNESS)
"""Depths over thickness to which pads are solved: the first that covers what was pressed."""
MARGIN = 1.1


def law_of(campaign: Campaign, progress: Progress = quiet) -> CampaignLaw:
    """The force law that a campaign declares."""
    by_shape: dict[str, list[Trial]] = {}
    for trial in campaign.trials:
        by_shape.setdefault(trial.pad[0], []).append(trial)
    laws: dict[tuple[str, float], CampaignPadLaw] = {}
    priors = []
    for trials in by_shape.values():
        own = _laws(campaign, trials, progress)
        priors.append(_error_of(list(own.values()), trials, material_of(campaign).alpha))
        laws |= own
    return CampaignLaw(laws, tuple(max(terms) for terms in zip(*priors)))


def law_without_solve(pads: Iterable[Pad | Puck]) -> CampaignLaw:
    """The law of slabs or pucks that are only planned: they may need no solve."""
    laws = [CampaignPadLaw(pad, MAX_DEPTH_OVER_THICKNESS * pad.thickness_mm) for pad in pads]
    for law in laws:
        if law.known is None:
            message = f"the {law.name} has no tabulated force; 'dummydesign loop' solves it once it is pressed"
            raise InputError(message, "not_tabulated", "pad")
    return CampaignLaw({("", law.pad.thickness_mm): law for law in laws})


def level_error(trial: Trial) -> float:
    """What is not known of a pad's level: errors of its measured thickness and of its modulus' factor, in ln force."""
    return math.hypot(THICKNESS_SLOPE * (trial.thickness_sd_mm or 0.0) / trial.thickness_mm, trial.young_factor_sd)


def check_round(geometry: PadShape) -> None:
    """Refuse a shape whose force is not solved round."""
    if geometry.axisymmetric:
        return
    raise InputError(
        f"shape = {geometry} is not round: its force under a punch is solved in space, minutes for each pad and "
        "for each change of it that an effect asks for, which the loop does not do; press a crowned, layered or "
        f"boned pad, or compare its traces with 'dummydesign predict --shape {geometry} --fidelity 3d'",
        "unsupported",
        "shape",
        str(geometry),
    )


def _laws(campaign: Campaign, trials: Sequence[Trial], progress: Progress) -> dict[tuple[str, float], CampaignPadLaw]:
    """The laws of the pads of one shape; those that have to be solved, for every group of thicknesses."""
    geometry, cylinder = trials[0].geometry, campaign.pad.shape == "cylinder"
    check_round(geometry)
    young = 1.0 if campaign.pad.base in BASES or cylinder else 1e-3 * material_of(campaign).young_kPa.value
    pads = {h: pad_of(campaign, h, young, geometry) for h in sorted({trial.thickness_mm for trial in trials})}
    solved = [h for h, pad in pads.items() if curve_without_solve(pad) is None]
    groups = group_near(solved, float, 1.0 + ONE_PAD + 1e-9, of=0)  # the end belongs to it
    laws: dict[tuple[str, float], CampaignPadLaw] = {}
    for number, group in enumerate([*groups, *([h] for h in pads if h not in solved)], 1):
        pad = replace(pads[group[0]], thickness_mm=float(np.mean(group)))
        own = [trial for trial in trials if trial.thickness_mm in group]
        share = MARGIN * max(float(trial.trace.displacement_mm.max()) / trial.thickness_mm for trial in own)
        deepest = next((depth for depth in DEPTHS if depth >= share), DEPTHS[-1]) * pad.thickness_mm
        law = CampaignPadLaw(pad, deepest)
        if number <= len(groups):
            progress(f"force law of the {law.name} ({number} of {len(groups)})")
        laws |= {trial.pad: law for trial in own}
    return laws


def _error_of(laws: Sequence[CampaignPadLaw], trials: Sequence[Trial], alpha: Quantity | None = None) -> tuple:
    """The error of the laws of pads of one shape before a fit; of slabs and pucks without a solve the usual one."""
    stated = max((law.relative_error for law in laws if not law.sharp), default=0.0)
    bend = 0.0 if alpha is None else max(law.error_by_exponent(alpha) for law in laws)
    square = [law.pad for law in laws if isinstance(law.pad, Pad) and law.pad.sides_mm]
    thickness = float(np.sqrt(np.mean([level_error(trial) ** 2 for trial in trials]))) / THICKNESS_SLOPE
    outline = not all(map(has_square_factor, square))
    usual = ROUND_ERROR if not square and all(isinstance(law.pad, Pad) for law in laws) else SLAB_ERROR
    return error_priors(stated, outline, thickness, any(law.grows for law in laws), usual, bend)


def pad_of(
    campaign: Campaign, thickness_mm: float, young_MPa: float, geometry: PadShape, prony: tuple[PronyTerm, ...] = ()
) -> Pad | Puck:
    """A pad of a campaign under its punch, as the pad model takes it."""
    pad, punch, alpha = campaign.pad, campaign.punch, material_of(campaign).alpha
    law = None if alpha is None else ogden_law(alpha.value)
    if pad.shape == "cylinder":
        return Puck(thickness_mm, young_MPa, pad.diameter_mm or 0.0, prony, punch.contact, law=law)
    size = (pad.length_mm, pad.width_mm) if pad.length_mm and pad.width_mm else None
    return Pad(
        thickness_mm,
        young_MPa,
        punch.radius_mm,
        prony=prony,
        law=law,
        base=pad.base,
        condition=punch.contact,
        extent_mm=math.sqrt(size[0] * size[1] / math.pi) if size else None,
        sides_mm=(punch.side_mm, punch.side_mm) if punch.side_mm else None,
        profile_mm=punch.profile_mm,
        geometry=geometry,
        edge_radius_mm=punch.edge_radius_mm,
        slab_mm=size or (PAD_LENGTH_MM, PAD_WIDTH_MM),
    )

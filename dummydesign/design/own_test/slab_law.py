"""What slabs do under one's own punch, on one's own base and pad: the table, or what is solved over it."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt
from typing import TYPE_CHECKING

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.design.own_test.over_table import in_table, near_rim
from dummydesign.design.own_test.over_table import own_slab_law as solved_over
from dummydesign.design.own_test.punch import AskedPunch
from dummydesign.design.request import Request
from dummydesign.design.scoring.presses import ForceLaw
from dummydesign.design.search.slabs import THICKNESS_MM
from dummydesign.geometry.interface import BASES
from dummydesign.pad.pad import Pad
from dummydesign.pad.tables.punch import punch_law

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.resin.model.resin import Resin


def tabulated(thickness_mm: NDArray, request: Request, punch: AskedPunch) -> NDArray:
    """Those thicknesses (T,) that the table holds for the punch's size.

    Parameters
    ----------
    thickness_mm : ndarray, shape (T,)
        [mm]
    request : Request
    punch : AskedPunch

    Raises
    ------
    InputError
        When there is none, with the range that is tabulated.
    """
    from dummydesign.pad.tables.slab import load_table

    base = request.base if request.base in BASES else "bonded"
    smallest, largest = load_table(base=base).ratio_range
    kept = thickness_mm[(punch.radius_mm / thickness_mm >= smallest) & (punch.radius_mm / thickness_mm <= largest)]
    if not len(kept):
        low, high = (max(punch.radius_mm / largest, THICKNESS_MM[0]), min(punch.radius_mm / smallest, THICKNESS_MM[1]))
        if low > high:
            raise InputError(
                f"punch {request.punch} is outside what is tabulated: the circle of its area has a radius of "
                f"{punch.radius_mm:.3g} mm, allowed is {smallest * THICKNESS_MM[0]:.3g} to "
                f"{largest * THICKNESS_MM[1]:.3g}"
            )
        raise out_of_range("thickness in mm", f"{thickness_mm[0]:g}:{thickness_mm[-1]:g}", f"{low:.3g}", f"{high:.3g}",
                           f"under the punch {request.punch}")  # fmt: skip
    return kept


def own_slab_law(request: Request, punch: AskedPunch, thickness_mm: NDArray) -> ForceLaw:
    """Force law of the slabs of a request: the table of its base under its punch, or what is solved over it.

    Parameters
    ----------
    request : Request
        Punch, edge, base and size of the pad.
    punch : AskedPunch
    thickness_mm : ndarray, shape (T,)
        Thicknesses that are searched. [mm]
    """
    from dummydesign.pad.tables.filleted import slab_table

    base = request.base if request.base in BASES else "bonded"
    pad, edge = asked_pad(request, punch), request.edge_radius_mm
    if request.face != "bonded" and punch.profile_mm is None:
        # the fillets' tables and the square's factor are of glued punches
        return solved_over(slab_table(base, 0.0, punch.radius_mm), pad, thickness_mm)
    law: ForceLaw = solved_over(slab_table(base, edge, punch.radius_mm), replace(pad, edge_radius_mm=0.0), thickness_mm)
    if request.base not in BASES or punch.profile_mm:
        return law
    return punch_law(law, request.punch, base, bool(edge))


def table_alone(request: Request, punch: AskedPunch) -> ForceLaw:
    """The table of a request's base under a flat punch with sharp edges, without anything solved.

    Parameters
    ----------
    request : Request
        Base of the pad.
    punch : AskedPunch
        Without a profile.
    """
    from dummydesign.pad.tables.slab import load_table

    return punch_law(load_table(base=request.base), request.punch, request.base)


def why_solved(request: Request, punch: AskedPunch, thickness_mm: float) -> str:
    """Why a slab of a request is not pressed by the table alone; empty when it is.

    Parameters
    ----------
    request : Request
    punch : AskedPunch
    thickness_mm : float
        [mm]
    """
    pad = asked_pad(request, punch)
    if not in_table(pad):
        return f"pads under the punch {punch.text} are not in the tables"
    if near_rim(pad, thickness_mm):
        return f"the rim of a pad {thickness_mm:g} mm thick is felt under the punch {punch.text}"
    return ""


def check_calibrated(request: Request, punch: AskedPunch, thickness_mm: NDArray) -> None:
    """Refuse to design with a calibration where its corrections have nothing to act on: the tables of glued slabs.

    Parameters
    ----------
    request : Request
    punch : AskedPunch
    thickness_mm : ndarray, shape (T,)
        That are searched, rising. [mm]

    Raises
    ------
    InputError
        Saying why, and what to do.
    """
    why = why_solved(request, punch, float(thickness_mm[-1]))
    free = [one for one in thickness_mm if not why_solved(request, punch, float(one))]
    instead = f" or up to --thickness {free[0]:g}:{free[-1]:g}" if free else ""
    if request.edge_radius_mm:
        why = f"the edge radius of {request.edge_radius_mm:g} mm is not in them"
    elif request.base != "bonded":
        why = f"base = {request.base} is not in them"
    elif request.face != "bonded" and punch.profile_mm is None:
        why = f"condition = {request.face} is not in them"
    if why:
        raise InputError("a calibration corrects the tables of glued pads under flat punches with sharp edges, and "
                         f"{why}: design without it (--calibration none){instead}")  # fmt: skip


def asked_pad(request: Request, punch: AskedPunch, thickness_mm: float = 10.0, young_MPa: float = 1.0) -> Pad:
    """The slab of a request as the pad model takes it.

    Parameters
    ----------
    request : Request
    punch : AskedPunch
    thickness_mm, young_MPa : float
        Of the slab. [mm, MPa]
    """
    return Pad(
        thickness_mm, young_MPa, punch.radius_mm, base=request.base, sides_mm=punch.sides_mm,
        extent_mm=sqrt(request.pad_mm[0] * request.pad_mm[1] / pi), slab_mm=request.pad_mm,
        profile_mm=punch.profile_mm, edge_radius_mm=request.edge_radius_mm,
        condition=request.face,
    )  # fmt: skip


def check_mould(request: Request, resin: Resin, thickness_mm: float, ratio: float) -> None:
    """Refuse presets, machines and silicones that are not known, and pads that they cannot make.

    Parameters
    ----------
    request : Request
    resin : Resin
    thickness_mm, ratio : float
        The thinnest pad that is searched. [mm, resin's ratio]

    Raises
    ------
    InputError
        Naming what does not fit.
    """
    from dummydesign.mold.model.preset import mould_spec

    mould_spec(
        thickness_mm, *request.pad_mm, request.preset, resin, ratio, machines=request.machine, silicone=request.silicone
    )

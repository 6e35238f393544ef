"""What a printed mould asks of the workshop: surface, release, putting together, taking apart. No CAD."""

from __future__ import annotations

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.print_fit import print_words
from dummydesign.mold.pour.steps import BLANK


def release_words(spec: MouldSpec) -> str:
    """The warning: plastic does not let go by itself."""
    return (
        "a printed mould is rigid and polyurethane bonds to plastic: finish the faces to valleys of at most "
        f"{spec.surface.depth_mm:g} mm, wax them, lay on a film of PVA, and try a scrap of print and resin first"
        if spec.surface is not None
        else ""
    )


def mould_steps(spec: MouldSpec, plastic: str, face: str) -> tuple[str, ...]:
    """From the printer to the empty mould.

    Parameters
    ----------
    spec : MouldSpec
        Of a printed mould.
    plastic : str
        What it is printed of, in words.
    face : str
        How the tested face is made, in words.

    Returns
    -------
    tuple of str
    """
    assert spec.surface is not None
    return (
        f"Print base and ring solid where resin touches ({plastic}; 6 perimeters; base floor up, ring flange down), "
        f"and the plates. {face}{print_words(spec)}",
        f"Fill and sand floor and walls until no valley is deeper than {spec.surface.depth_mm:g} mm (gauge a "
        f"scrap), 400 grit last; the walls' draft of {spec.pad.draft_deg:g} deg lets go of no "
        f"more. Really: {BLANK}",
        "Test on a scrap of the same print, finished and released alike: resin must cure without a tacky border and "
        f"lift off by hand. Lifted off: {BLANK}",
        "Wax base and ring, polish, twice; then a thin film of PVA, dried. No silicone spray on the floor: it is the "
        "tested face.",
        "Put the ring on the base by its two pins (it goes on in one way) and draw the bolts up crosswise, with a bead "
        "of wax or plasticine around the joint from outside: the joint must hold the resin.",
    )


def demould_steps(spec: MouldSpec) -> tuple[str, ...]:
    """How the pad is taken out of a rigid mould."""
    pad = spec.pad
    hold = formula.suction_force_N(pad.length_mm * pad.width_mm)
    peel = formula.peel_force_N(min(pad.length_mm, pad.width_mm), 5.0)
    return (
        f"Never pull the pad out of the ring: air pressure alone can hold {hold:.0f} N on the sealed face. Turn the "
        "mould over onto release film on a flat board and take the bolts out.",
        f"Lift the base on one edge with wedges in the joint and let air in along it (about {peel:.1f} N at 5 J/m2); a "
        "little water dissolves the PVA from the edge.",
        "Lift the ring straight up: its walls open towards the board. Wash the PVA off with water, dry the pad.",
    )

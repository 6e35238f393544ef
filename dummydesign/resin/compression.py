"""The modulus of a batch from one compression curve of its puck, and the resin it becomes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.errors import InputError, out_of_range
from dummydesign.files import output_folder
from dummydesign.library import entries, user_folder
from dummydesign.quantity import Quantity
from dummydesign.resin.load import DEFAULT, KIND, load_resin
from dummydesign.resin.update import Point, update_resin
from dummydesign.resin.write import save_resin

Array = np.ndarray

FIRST_SHARE, LAST_SHARE = 0.03, 0.5
"""Compressions that are used, in heights: past the toe, and short of where the side lies on the plates."""

STEPS = 60


@dataclass(frozen=True)
class Compressed:
    """What one puck's curve says; ``young_kPa`` is of this puck alone."""

    name: str
    base: str
    ratio: float
    young_kPa: Quantity
    alpha: float
    friction: dict[str, float | None]
    rmse_N: float
    compression_mm: tuple[float, float]
    file: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; ``law`` names the elastic law that was fitted."""
        return {
            "name": self.name,
            "base": self.base,
            "ratio": self.ratio,
            "young_kPa": self.young_kPa.to_dict(),
            "law": {"name": "ogden, one term", "alpha": self.alpha},
            "friction": self.friction,
            "rmse_N": self.rmse_N,
            "compression_mm": list(self.compression_mm),
            "files": {"resin": self.file},
        }


def loading(displacement_mm: Array, force_N: Array) -> tuple[Array, Array]:
    """The first loading of a trace: up to its largest displacement, on rising displacements only.

    Returns
    -------
    compression, load : ndarray
        Strictly rising compressions [mm] and the mean load at each [N].
    """
    end = int(np.argmax(displacement_mm)) + 1
    rising = np.maximum.accumulate(displacement_mm[:end])
    place, index = np.unique(rising, return_inverse=True)
    return place, np.bincount(index, force_N[:end]) / np.bincount(index)


def add_compression(
    file: str | Path, diameter_mm: float, height_mm: float, name: str, ratio: float, base: str | None = None
) -> Compressed:
    """Fit a puck's compression curve and keep the resin that its modulus makes of a law.

    Load = A E u(c; alpha) B(c; alpha, friction), see :mod:`dummydesign.pad.puck_fit`: modulus, stiffening,
    plate friction and contact offset together; what friction leaves open is in the interval. The modulus is
    that of the press, slow against relaxation: press slowly, or what has not relaxed counts as stiffness.

    Parameters
    ----------
    file : path
        Trace CSV of one slow loading; displacement is the compression. [s, mm, N]
    diameter_mm, height_mm : float
        Undeformed puck, of the proportions 50 to 30. [mm]
    name : str
        Name of the resin that results; one of that name in the user's folder gets this point besides its own.
    ratio : float
        Mixing ratio of the puck.
    base : str, optional
        Resin whose law is updated; by default the user's own NAME, else the paper's polyurethane.

    Raises
    ------
    InputError
        For a bad file, shape, name or ratio, or a compression that is too small.
    """
    from dummydesign.pad.puck_fit import Curve, fit_pucks
    from dummydesign.pad.puck_table import load_puck_table
    from dummydesign.protocol.trace import read_trace

    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", name):
        raise InputError(f"name = '{name}' cannot be a file name; use letters, digits, '-' and '_'")
    for what, value in (("diameter_mm", diameter_mm), ("height_mm", height_mm)):
        if not (np.isfinite(value) and value > 0.0):
            raise out_of_range(what, value, "above 0", "any finite value")
    known = entries(KIND).get(name.lower())
    own = known is not None and known.origin == "user"
    resin = load_resin(base or (name if own else DEFAULT))
    resin.check_ratio(ratio)
    table = load_puck_table()
    shape = 2.0 * table.radius_over_height
    if abs(diameter_mm / height_mm / shape - 1.0) > 0.005:
        raise InputError(
            f"diameter over height = {diameter_mm / height_mm:.4g} is not {shape:.4g} (such as 50 x 30 mm), the one "
            "shape whose friction is solved and shipped; cast the witness puck of the pour sheet"
        )
    trace = read_trace(file)
    place, load = loading(trace.displacement_mm, trace.force_N)
    first, last = FIRST_SHARE * height_mm, min(LAST_SHARE * height_mm, float(place[-1]))
    if last < 4.0 * first:
        raise InputError(
            f"{trace.name}: largest displacement_mm = {place[-1]:.3g} is too small; compress the puck by at least "
            f"{4.0 * first:.3g} mm, better {LAST_SHARE * height_mm:.3g} mm"
        )
    grid = np.concatenate([[0.0], np.linspace(first, last, STEPS)])
    curve = Curve(trace.name, "puck", grid, np.interp(grid, place, load))
    found = fit_pucks([curve], diameter_mm, height_mm, table, (first * (1 - 1e-9), last))
    source = f"puck {diameter_mm:g} x {height_mm:g} mm, {trace.name}, fitted with plate friction left open"
    young = Quantity(found.young_kPa, found.young_low_kPa, found.young_high_kPa, "fitted", source)
    kept = update_resin(resin, [Point(ratio, young)], name)
    path = save_resin(kept, output_folder(user_folder() / KIND) / f"{name}.toml")
    friction = {
        key: value if np.isfinite(value) else None
        for key, value in (("value", found.friction), ("low", found.friction_low), ("high", found.friction_high))
    }
    absolute = found.rmse * float(np.sqrt(np.mean(curve.load_N[1:] ** 2)))
    return Compressed(name, resin.name, ratio, young, found.alpha, friction, absolute, (first, last), str(path))

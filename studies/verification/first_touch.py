"""What is verified of the law of first touch: closed forms over six decades of depth, for every punch and shape.

``python -m studies.verification.first_touch`` runs these checks alone and prints their table.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator

import numpy as np

from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import ball_profile
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.pad_under_punch import Pad, Puck
from studies.verification.check import Check

GROUP = "First touch, six decades of depth"
HERTZ = "Hertz, 16 E / 9 sqrt(R) d^1.5, on a half-space"
LAYER = "ball on a bonded layer, Dimitriadis et al., Biophys. J. 82 (2002) 2798"
CONE = "Sneddon's cone, 8 E / (3 pi tan) d^2, on a half-space"
HAYES = "layer solution of Hayes et al., J. Biomech. 5 (1972) 541, integral equation solved anew"
LINEAR = "F / d of the table at d/h 1e-7"
DECADES = 10.0 ** np.arange(-7, -1)  # depths over the thickness, six of them
SHARE = 0.05
"""Tolerance, as is required of every force of this law."""
# Closed forms are of small strain: they count where the contact is at most this share of the thickness, and for a form
# of the half-space of this.
ON_LAYER, ON_HALF_SPACE = 0.35, 0.035
# A ball's height is that of a paraboloid where it is pressed to this share of its radius.
SHALLOW_BALL = 0.03
# Radii that balls have, over the thickness.
BALLS = (0.5, 1.0, 4.0)


def _rows(
    name: str,
    pad: Pad | Puck,
    form: Callable[[np.ndarray], np.ndarray],
    source: str,
    fidelity: str = "axisymmetric",
    deepest: float = DECADES[-1],
) -> Iterator[Check]:
    """Force at six decades of depth up to one, as `predict --depth` has it."""
    h = pad.thickness_mm
    depth = deepest * h * 10.0 ** np.arange(-5, 1)
    curve = elastic_curve(pad, fidelity, float(depth[-1]), depth)
    for d, exact, force, error in zip(depth, form(depth), curve.force(depth), curve.relative_error(depth)):
        how = "solved" if d >= curve.first_mm * (1.0 - 1e-9) else "first touch"
        shown = how if fidelity != "table" else "table"
        yield Check(
            GROUP,
            f"{name}, d/h {d / h:.1e}, N ({shown}, stated {100.0 * error:.1f} %)",
            float(exact),
            float(force),
            SHARE,
            source,
        )


def power(factor: float, exponent: float = 1.0) -> Callable[[np.ndarray], np.ndarray]:
    """Force that is a factor times a power of depth."""
    return lambda depth: factor * depth**exponent


def layer(radius_mm: float, h: float, young: float) -> Callable[[np.ndarray], np.ndarray]:
    """Force of a ball on a bonded incompressible layer."""

    def force(depth: np.ndarray) -> np.ndarray:
        c = np.sqrt(radius_mm * depth) / h
        factor = 1.0 + 1.133 * c + 1.283 * c**2 + 0.769 * c**3 + 0.0975 * c**4
        return 16.0 / 9.0 * young * np.sqrt(radius_mm) * depth**1.5 * factor

    return force


def ball(radius_mm: float, h: float, condition: str) -> Pad:
    """A slab of unit modulus under a ball."""
    punch = ball_profile(2.0 * radius_mm)
    return Pad(h, 1.0, punch[0][-1], condition=condition, profile_mm=punch)


def balls() -> Iterator[Check]:
    """Balls on slabs: free, sticking and rubbing, from a half-space to a wide contact."""
    for ratio in BALLS:
        deepest = min(0.01, ON_LAYER**2 / ratio)
        pad = ball(10.0 * ratio, 10.0, "frictionless")
        yield from _rows(
            f"ball, R/h {ratio:g}, frictionless", pad, layer(10.0 * ratio, 10.0, 1.0), LAYER, deepest=deepest
        )
    for condition in ("bonded", "friction:0.3"):
        yield from _rows(
            f"ball, R/h 1, {condition}", ball(10.0, 10.0, condition), layer(10.0, 10.0, 1.0), LAYER, deepest=0.01
        )
    thick = ball(2.0, 60.0, "frictionless")
    yield from _rows("ball, R/h 1/30", thick, power(16.0 / 9.0 * np.sqrt(2.0), 1.5), HERTZ, deepest=SHALLOW_BALL / 30.0)


def cones() -> Iterator[Check]:
    """A pointed profile, steep and blunt."""
    r = np.linspace(0.0, 10.0, 201)
    for angle in (10.0, 20.0):
        steep = np.tan(np.radians(angle))
        pad = Pad(40.0, 1.0, 10.0, condition="frictionless", profile_mm=(tuple(r), tuple(steep * r)))
        yield from _rows(
            f"cone, {angle:g} deg",
            pad,
            power(8.0 / (3.0 * np.pi * steep), 2.0),
            CONE,
            deepest=ON_HALF_SPACE * 0.5 * np.pi * steep,
        )


def crowns() -> Iterator[Check]:
    """Crowns under a flat punch, by the elements and by the table: a ball upside down."""
    for radius, h in ((21.2, 10.0), (21.2, 7.0)):
        pad = Pad(h, 1.0, 7.9, geometry=Crowned(radius, 2.0, 9.4))
        for fidelity in ("axisymmetric", "table"):
            yield from _rows(
                f"crown, tip radius {radius:g} mm on {h:g} mm",
                pad,
                layer(radius, h, 1.0),
                LAYER,
                fidelity,
                min(0.01, ON_LAYER**2 * h / radius),
            )


# kappa of the layer solution by a / h, as in the group "Small depth".
KAPPA = {("bonded", 0.4): 1.684, ("bonded", 1.0): 3.619, ("sliding", 0.4): 1.385, ("sliding", 1.0): 2.199}


def flats() -> Iterator[Check]:
    """Flat punches that slide: sharp, and with a fillet, whose flat face is what touches first."""
    for (base, ratio), kappa in KAPPA.items():
        pad = Pad(10.0, 1.0, 10.0 * ratio, base=base, condition="frictionless")
        yield from _rows(
            f"flat punch, a/h {ratio:g}, frictionless, base {base}", pad, power(8.0 / 3.0 * kappa * 10.0 * ratio), HAYES
        )
    rim = 0.5
    pad = Pad(10.0, 1.0, 10.0 + rim, condition="frictionless", edge_radius_mm=rim)
    # beyond, the contact rolls on to the fillet
    yield from _rows(
        "flat punch with a fillet, flat face a/h 1, frictionless",
        pad,
        power(8.0 / 3.0 * 3.619 * 10.0),
        HAYES,
        deepest=1e-3,
    )


def glued() -> Iterator[Check]:
    """What is glued touches at once: F / d is one number, that of the table where it has one."""
    cases: dict[str, tuple[float, PadShape]] = {
        "slab": (0.0, Slab()),
        "slab, fillet 0.8 mm": (0.8, Slab()),
        "boned": (0.0, read_shape("boned:height=3,radius=7.5")),
        "layered": (0.0, Layered(4.0, 2.0)),
    }
    for name, (rim, shape) in cases.items():
        pad = Pad(10.0, 1.0, 7.9, edge_radius_mm=rim, geometry=shape, extent_mm=PAD_EXTENT_MM)
        table = elastic_curve(pad, "table")
        first = float(table.force(np.array([1e-6]))[0]) / 1e-6
        yield from _rows(f"glued flat punch, {name}", pad, power(first), LINEAR, deepest=2e-3)
    puck = Puck(20.0, 1.0, 30.0)
    yield from _rows(
        "puck between plates without friction", puck, power(np.pi * 15.0**2 / 20.0), "E A d / h", deepest=2e-3
    )


CHECKS = (balls, cones, crowns, flats, glued)


def main() -> None:
    """Print the table of these checks."""
    from studies.verification.document import table_of

    os.environ["DUMMYDESIGN_CACHE"] = "off"
    checks: list[Check] = []
    for make in CHECKS:
        began = time.perf_counter()
        checks += list(make())
        print(f"{make.__name__}: {time.perf_counter() - began:.0f} s", flush=True)
    print("\n".join(table_of(checks)))
    worst = max(abs(check.deviation) for check in checks)
    print(f"{len(checks)} checks, {sum(not check.passed for check in checks)} failed; worst {100.0 * worst:.1f} %")


if __name__ == "__main__":
    main()

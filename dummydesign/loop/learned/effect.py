"""An effect without a name: a factor on the force that is a smooth function of one quantity, read off a campaign."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.base_law import UnitForce, wrap
from dummydesign.loop.model.effect import Effect, Parameter, Values

FOLLOWED = {
    "depth_mm": "depth in mm",
    "depth_share": "depth over thickness",
    "force_N": "force in N",
    "since_stop_s": "time since the stop in s",
    "temperature_C": "temperature in C",
    "age_days": "age in days",
    "thickness_mm": "thickness of the pad in mm",
}
"""Quantities that a learned effect can follow, in words; thickness only together with the time since the stop: alone,
or with depth, it is the law error of each pad."""
FADE = 0.25
"""Share of the range seen over which the effect fades out beyond it."""
PREFIX = "learned_"


@dataclass(frozen=True)
class Shape:
    """A piecewise-linear function on rising knots, zero well beyond them.

    Attributes
    ----------
    follows : str
        One of :data:`FOLLOWED`.
    knots, values : tuple of float
        Where it was seen, and the relative change of the force there.
    """

    follows: str
    knots: tuple[float, ...]
    values: tuple[float, ...]

    @property
    def name(self) -> str:
        """Name of the quantity."""
        return self.follows

    @property
    def flat(self) -> NDArray:
        """All values, (k,)."""
        return np.array(self.values)

    def with_flat(self, values: NDArray) -> Shape:
        """The shape with other values (k,)."""
        return replace(self, values=tuple(np.asarray(values).tolist()))

    def roughness(self) -> NDArray:
        """Second differences of the values, a row each."""
        count = len(self.knots)
        return np.diff(np.eye(count), 2, axis=0) if count > 2 else np.zeros((0, count))

    def effect(self) -> Learned:
        """The effect of this shape."""
        return Learned(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the entries that a calibration file holds beside name and size."""
        return {"knots": list(self.knots), "relative_change": list(self.values)}

    def __call__(self, at: NDArray) -> NDArray:
        """Relative change of the force at values of the quantity; fades to zero beyond the range seen."""
        return np.interp(at, self.knots, self.values) * fading(at, self.knots)


def fading(at: NDArray, knots: tuple[float, ...]) -> NDArray:
    """One in the range of the knots, zero from :data:`FADE` of it beyond."""
    low, high = knots[0], knots[-1]
    beyond = np.maximum(np.maximum(low - at, at - high), 0.0) / (FADE * (high - low))
    return np.clip(1.0 - beyond, 0.0, 1.0)


class Learned(Effect):
    """Force x (1 + size g(u)): g was read off a campaign, u is the quantity it follows.

    Depths act on the elastic law, the force on the signal, the time since the stop on the force of the pad, and
    temperature and age on single trials.
    """

    hook = "pad"
    signature = "what the named effects leave, as a smooth function of one quantity"
    reference = "penalised splines: Eilers and Marx, Stat. Sci. 11 (1996) 89"
    parameters = (Parameter("size", "1", 0.0, 0.0, 1.0, 1.0),)
    held = True

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self.name = PREFIX + shape.follows.lower()
        self.belongs_to = "sensor" if shape.follows == "force_N" else "pad"
        if shape.follows in ("temperature_C", "age_days"):
            self.needs, self.hook = (shape.follows,), "batch"
        seen = f"{FOLLOWED[shape.follows]} from {shape.knots[0]:.3g} to {shape.knots[-1]:.3g}"
        acts = shape.follows in ("depth_mm", "depth_share")
        self.designed_for = f"{seen}, where the change was seen" if acts else "a pad without it"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        if self.shape.follows not in ("depth_mm", "depth_share"):
            return law

        def changed(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            depth = np.maximum(depth_mm, 0.0)
            at = depth if self.shape.follows == "depth_mm" else depth / thickness_mm
            return law(depth_mm, thickness_mm) * (1.0 + values["size"] * self.shape(at))

        return wrap(law, changed)

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        if self.shape.follows not in self.needs:
            return np.ones((1, 1))
        return 1.0 + values["size"] * self.shape(getattr(presses.history, self.shape.follows))[:, None]

    def surface(self, presses: Presses, depth_mm: NDArray, force_N: NDArray, values: Values) -> NDArray:
        if self.shape.follows != "since_stop_s":
            return force_N
        since = presses.time_s - presses.stop_s[:, None]
        return force_N * (1.0 + values["size"] * np.where(since > 0.0, self.shape(np.maximum(since, 0.0)), 0.0))

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N * (1.0 + values["size"] * self.shape(force_N)) if self.shape.follows == "force_N" else force_N


def followed(presses: Presses, forces_N: NDArray) -> dict[str, NDArray]:
    """The quantities of the bins that carry force, (k,) each; those that a campaign does not vary are left out.

    ``forces_N`` (T, B) are the modelled forces. [N]
    """
    middle = 0.5 * (presses.bins.start + presses.bins.end)
    depth = np.maximum(presses.measure(presses.displacement_mm), 0.0)
    loaded = presses.used & (forces_N > 0.02 * forces_N.max()) & (depth > 0.0)
    since = middle - presses.stop_s[:, None]
    quantities: dict[str, Callable[[], NDArray]] = {
        "depth_mm": lambda: depth[loaded],
        "depth_share": lambda: (depth / presses.thickness_mm[:, None])[loaded],
        "force_N": lambda: forces_N[loaded],
        "since_stop_s": lambda: since[loaded & (since > 2e-3)],
        "temperature_C": lambda: presses.history.temperature_C,
        "age_days": lambda: presses.history.age_days,
        "thickness_mm": lambda: presses.thickness_mm,
    }
    values = {name: make() for name, make in quantities.items()}
    return {name: v for name, v in values.items() if len(v) and np.all(np.isfinite(v)) and np.ptp(v) > 1e-6}

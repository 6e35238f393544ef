"""An effect without a name: a smooth factor on the force of one or two quantities."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.interpolation import locate_on_grid
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import PadEffect, Parameter, UnitForce, Values, wrap

FOLLOWED = {
    "depth_mm": "depth in mm",
    "depth_share": "depth over thickness",
    "force_N": "force in N",
    "reading_N": "reading in N",
    "since_stop_s": "time since the stop in s",
    "temperature_C": "temperature in C",
    "age_days": "age in days",
    "thickness_mm": "thickness of the pad in mm",
}
"""Quantities that a learned effect can follow, in words; thickness only together with the time since the stop: alone,
or with depth, it is the law error of each pad."""
ACTS_ON = {
    "depth_mm": "law",
    "depth_share": "law",
    "force_N": "sensor",
    "reading_N": "reading",
    "since_stop_s": "surface",
    "temperature_C": "scale",
    "age_days": "scale",
}
"""The method of :class:`Effect` through which a learned effect of one quantity acts; one of two acts on the surface."""
BY_TRIAL = ("temperature_C", "age_days")
FADE = 0.25  # share of the range seen over which the effect fades out beyond it
PREFIX, AND = "learned_", "_and_"


@dataclass(frozen=True)
class SmoothChange:
    """Relative change of the force over one or two quantities: linear or bilinear between rising knots of each, zero
    well beyond them. ``values`` are nested as deep as there are quantities."""

    follows: tuple[str, ...]
    knots: tuple[tuple[float, ...], ...]
    values: tuple[Any, ...]

    @property
    def name(self) -> str:
        """Names of the quantities."""
        return AND.join(self.follows)

    @property
    def text(self) -> str:
        """The quantities in words."""
        return " and ".join(FOLLOWED[one] for one in self.follows)

    @property
    def flat(self) -> NDArray:
        """All values, (k,)."""
        return np.array(self.values).ravel()

    def with_flat(self, values: NDArray) -> SmoothChange:
        """The change with other values (k,)."""
        rows = np.reshape(values, [len(knots) for knots in self.knots]).tolist()
        return replace(self, values=tuple(tuple(row) if isinstance(row, list) else row for row in rows))

    def roughness(self) -> NDArray:
        """Second differences of the values along each quantity, a row each."""
        eyes = [np.eye(len(knots)) for knots in self.knots]
        bends = [np.diff(eye, 2, axis=0) for eye in eyes]
        if len(eyes) == 1:
            return bends[0]
        return np.concatenate([np.kron(bends[0], eyes[1]), np.kron(eyes[0], bends[1])])

    def to_dict(self) -> dict[str, Any]:
        """Return the entries that a calibration file holds beside name and size."""
        knots = [list(one) for one in self.knots]
        values = [list(row) if isinstance(row, tuple) else row for row in self.values]
        return {"knots": knots if len(knots) > 1 else knots[0], "relative_change": values}

    def __call__(self, *at: NDArray) -> NDArray:
        """Relative change of the force at values of each quantity; fades to zero beyond the range seen."""
        at = np.broadcast_arrays(*at)
        if len(at) == 1:
            change = np.interp(at[0], self.knots[0], self.values)
        else:
            (i, right), (j, up) = (locate_on_grid(np.array(knots), values) for values, knots in zip(at, self.knots))
            table = np.array(self.values)
            low = table[i, j] + right * (table[i + 1, j] - table[i, j])
            high = table[i, j + 1] + right * (table[i + 1, j + 1] - table[i, j + 1])
            change = low + up * (high - low)
        for values, knots in zip(at, self.knots):
            change = change * fading(values, knots)
        return change


def fading(at: NDArray, knots: tuple[float, ...]) -> NDArray:
    """One in the range of the knots, zero from :data:`FADE` of it beyond."""
    low, high = knots[0], knots[-1]
    beyond = np.maximum(np.maximum(low - at, at - high), 0.0) / (FADE * (high - low))
    return np.clip(1.0 - beyond, 0.0, 1.0)


class Learned(PadEffect):
    """Force x (1 + size g(u)) or (1 + size g(u, v)): g was read off a campaign, u and v are quantities it follows.

    Of one quantity: depths act on the elastic law, the force on the signal, the time since the stop on the force of
    the pad, and temperature and age on single trials. Of two: on the force of the pad.
    """

    reference = "penalised splines: Eilers and Marx, Stat. Sci. 11 (1996) 89"
    parameters = (Parameter("size", "1", 0.0, 0.0, 1.0, 1.0),)
    held = True

    def __init__(self, shape: SmoothChange) -> None:
        self.shape = shape
        self.name = PREFIX + shape.name.lower()
        self.belongs_to = "sensor" if {"force_N", "reading_N"} & set(shape.follows) else "pad"
        self.needs = tuple(one for one in shape.follows if one in BY_TRIAL)
        self.designed_for = "a pad without it"
        alone = len(shape.follows) == 1
        self._acts_on = ACTS_ON.get(shape.name, "") if alone else "surface"
        count = "one quantity" if alone else "two quantities"
        self.signature = f"what the named effects leave, as a smooth function of {count}"
        self.hook = "batch" if self._acts_on == "scale" else "pad"
        if self._acts_on == "law":
            low, high = shape.knots[0][0], shape.knots[0][-1]
            self.designed_for = f"{shape.text} from {low:.3g} to {high:.3g}, where the change was seen"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        if self._acts_on != "law":
            return law

        def changed(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            at = np.maximum(depth_mm, 0.0) / (thickness_mm if self.shape.name == "depth_share" else 1.0)
            return law(depth_mm, thickness_mm) * (1.0 + values["size"] * self.shape(at))

        return wrap(law, changed)

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        if self._acts_on != "scale":
            return np.ones((1, 1))
        return 1.0 + values["size"] * self.shape(getattr(presses.history, self.shape.name))[:, None]

    def surface(self, presses: Presses, depth_mm: NDArray, force_N: NDArray, values: Values) -> NDArray:
        if self._acts_on != "surface":
            return force_N
        at = [at_nodes(name, presses, depth_mm, force_N) for name in self.shape.follows]
        seen = np.all(np.isfinite(at), axis=0)
        change = self.shape(*(np.where(seen, one, knots[0]) for one, knots in zip(at, self.shape.knots)))
        return force_N * (1.0 + values["size"] * np.where(seen, change, 0.0))

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N * (1.0 + values["size"] * self.shape(force_N)) if self._acts_on == "sensor" else force_N

    def reading(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N * (1.0 + values["size"] * self.shape(force_N)) if self._acts_on == "reading" else force_N


def followed(presses: Presses, forces_N: NDArray) -> dict[str, NDArray]:
    """The quantities of the bins that carry force, (k,) each; those that a campaign does not vary are left out.

    ``forces_N`` (T, B) are the modelled forces. [N]
    """
    depth = np.maximum(presses.measure(presses.displacement_mm), 0.0)
    loaded = presses.used & (forces_N > 0.02 * forces_N.max()) & (depth > 0.0)
    since = presses.since_stop_s
    values: dict[str, NDArray] = {
        "depth_mm": depth[loaded],
        "depth_share": (depth / presses.thickness_mm[:, None])[loaded],
        "force_N": forces_N[loaded],
        "reading_N": forces_N[loaded],
        "since_stop_s": since[loaded & (since > 2e-3)],
        "temperature_C": presses.history.temperature_C,
        "age_days": presses.history.age_days,
        "thickness_mm": presses.thickness_mm,
    }
    return {name: v for name, v in values.items() if len(v) and np.all(np.isfinite(v)) and np.ptp(v) > 1e-6}


def followed_by(name: str) -> tuple[str, ...] | None:
    """The quantities that a learned effect of this name follows; None when it is none."""
    known = {one.lower(): one for one in FOLLOWED}
    parts = name.removeprefix(PREFIX).split(AND)
    if not name.startswith(PREFIX) or len(parts) > 2 or not all(part in known for part in parts):
        return None
    return tuple(known[part] for part in parts)


def at_nodes(name: str, presses: Presses, depth_mm: NDArray, force_N: NDArray) -> NDArray:
    """A quantity at the nodes, shape (T, N); NaN where it is not defined."""
    since = presses.time_s - presses.stop_s[:, None]
    quantities: dict[str, Callable[[], NDArray]] = {
        "depth_mm": lambda: np.maximum(depth_mm, 0.0),
        "depth_share": lambda: np.maximum(depth_mm, 0.0) / presses.thickness_mm[:, None],
        "force_N": lambda: force_N,
        "reading_N": lambda: force_N,
        "since_stop_s": lambda: np.where(since > 0.0, since, np.nan),
        "thickness_mm": lambda: presses.thickness_mm[:, None],
        "temperature_C": lambda: presses.history.temperature_C[:, None],
        "age_days": lambda: presses.history.age_days[:, None],
    }
    return np.broadcast_to(quantities[name](), force_N.shape)


def largest_change(surface: SmoothChange, information: NDArray) -> str:
    """Where a change over two quantities is largest, in words."""
    values = surface.flat
    # where the campaign says nothing the values are extrapolated from their neighbours
    seen = np.diag(information) > 1e-3 * np.diag(information).max()
    most = int(np.argmax(np.where(seen, np.abs(values), 0.0)))
    row, column = divmod(most, len(surface.knots[1]))
    return (
        f"relative change of the force with {surface.text} together, largest {100 * values[most]:+.1f} % at "
        f"{surface.knots[0][row]:.3g} and {surface.knots[1][column]:.3g}; vary one of them alone to tell which acts"
    )

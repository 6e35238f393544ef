"""An effect without a name that follows two quantities at once: a factor on the force, bilinear between knots."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.learned.effect import FOLLOWED, PREFIX, Learned, fading
from dummydesign.loop.model.base_law import UnitForce
from dummydesign.loop.model.effect import Values

AND = "_and_"


@dataclass(frozen=True)
class Surface:
    """A function of two quantities, bilinear between rising knots, zero well beyond them.

    Attributes
    ----------
    follows : tuple of str
        Two of :data:`FOLLOWED`.
    knots : tuple of two tuples of float
        Where it was seen.
    values : tuple of tuples of float
        Relative change of the force there, a row for each knot of the first quantity.
    """

    follows: tuple[str, str]
    knots: tuple[tuple[float, ...], tuple[float, ...]]
    values: tuple[tuple[float, ...], ...]

    @property
    def name(self) -> str:
        """Names of both quantities."""
        return AND.join(self.follows)

    @property
    def flat(self) -> NDArray:
        """All values, (k,)."""
        return np.array(self.values).ravel()

    def with_flat(self, values: NDArray) -> Surface:
        """The surface with other values (k,)."""
        rows = np.reshape(values, (len(self.knots[0]), len(self.knots[1])))
        return replace(self, values=tuple(tuple(row) for row in rows.tolist()))

    def roughness(self) -> NDArray:
        """Second differences of the values along either quantity, a row each."""
        first, second = (np.eye(len(knots)) for knots in self.knots)
        along = np.kron(np.diff(first, 2, axis=0), second), np.kron(first, np.diff(second, 2, axis=0))
        return np.concatenate(along)

    def effect(self) -> LearnedPair:
        """The effect of this surface."""
        return LearnedPair(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the entries that a calibration file holds beside name and size."""
        return {"knots": [list(k) for k in self.knots], "relative_change": [list(row) for row in self.values]}

    def __call__(self, first: NDArray, second: NDArray) -> NDArray:
        """Relative change of the force at values of both; fades to zero beyond the range seen of either."""
        first, second = np.broadcast_arrays(first, second)
        weights = [hats(at, np.array(knots)) for at, knots in zip((first, second), self.knots)]
        inside = np.einsum("...i,ij,...j->...", weights[0], np.array(self.values), weights[1])
        return inside * fading(first, self.knots[0]) * fading(second, self.knots[1])


def followed_by(name: str) -> tuple[str, ...] | None:
    """The quantities that a learned effect of this name follows; None when it is none."""
    known = {one.lower(): one for one in FOLLOWED}
    parts = name.removeprefix(PREFIX).split(AND)
    if not name.startswith(PREFIX) or len(parts) > 2 or not all(part in known for part in parts):
        return None
    return tuple(known[part] for part in parts)


def hats(at: NDArray, knots: NDArray) -> NDArray:
    """Weights (..., k) of linear interpolation on knots (k,), constant outside."""
    clipped = np.clip(at, knots[0], knots[-1])
    low = np.clip(np.searchsorted(knots, clipped, side="right") - 1, 0, len(knots) - 2)
    share = (clipped - knots[low]) / (knots[low + 1] - knots[low])
    out = np.zeros((*np.shape(at), len(knots)))
    np.put_along_axis(out, low[..., None], (1.0 - share)[..., None], axis=-1)
    np.put_along_axis(out, low[..., None] + 1, share[..., None], axis=-1)
    return out


class LearnedPair(Learned):
    """Force x (1 + size g(u, v)): g was read off a campaign, u and v are the quantities it follows."""

    hook = "pad"
    signature = "what the named effects leave, as a smooth function of two quantities"

    def __init__(self, shape: Surface) -> None:
        self.shape = shape
        self.name = PREFIX + shape.name.lower()
        self.belongs_to = "sensor" if "force_N" in shape.follows else "pad"
        self.needs = tuple(one for one in shape.follows if one in ("temperature_C", "age_days"))
        self.designed_for = "a pad without it"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        return law

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        return np.ones((1, 1))

    def surface(self, presses: Presses, depth_mm: NDArray, force_N: NDArray, values: Values) -> NDArray:
        u, v = (at_nodes(name, presses, depth_mm, force_N) for name in self.shape.follows)
        seen = np.isfinite(u) & np.isfinite(v)
        change = self.shape(np.where(seen, u, self.shape.knots[0][0]), np.where(seen, v, self.shape.knots[1][0]))
        return force_N * (1.0 + values["size"] * np.where(seen, change, 0.0))

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N


def at_nodes(name: str, presses: Presses, depth_mm: NDArray, force_N: NDArray) -> NDArray:
    """A quantity at the nodes, shape (T, N); NaN where it is not defined.

    Parameters
    ----------
    name : str
        One of :data:`FOLLOWED`.
    presses : Presses
        T trials of N nodes.
    depth_mm : ndarray, shape (T, N)
        Depth of the punch in the pad. [mm]
    force_N : ndarray, shape (T, N)
        Force of the pad. [N]
    """
    since = presses.time_s - presses.stop_s[:, None]
    match name:
        case "depth_mm":
            return np.maximum(depth_mm, 0.0)
        case "depth_share":
            return np.maximum(depth_mm, 0.0) / presses.thickness_mm[:, None]
        case "force_N":
            return force_N
        case "since_stop_s":
            return np.where(since > 0.0, since, np.nan)
        case "thickness_mm":
            return np.broadcast_to(presses.thickness_mm[:, None], force_N.shape)
        case _:
            return np.broadcast_to(getattr(presses.history, name)[:, None], force_N.shape)


def said(surface: Surface, information: NDArray) -> str:
    """Where a surface is largest, in words.

    Parameters
    ----------
    surface : Surface
    information : ndarray, shape (k, k)
        Inverse covariance of its values by the data.
    """
    values = surface.flat
    # where the campaign says nothing the values are carried on from their neighbours
    seen = np.diag(information) > 1e-3 * np.diag(information).max()
    most = int(np.argmax(np.where(seen, np.abs(values), 0.0)))
    row, column = divmod(most, len(surface.knots[1]))
    names = [FOLLOWED[one] for one in surface.follows]
    return (
        f"relative change of the force with {names[0]} and {names[1]} together, largest {100 * values[most]:+.1f} % at "
        f"{surface.knots[0][row]:.3g} and {surface.knots[1][column]:.3g}; vary one of them alone to tell which acts"
    )

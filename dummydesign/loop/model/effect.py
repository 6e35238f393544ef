"""The contract of an effect: parameters, where in the forward model it acts, whose it is, and what it needs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.measurement.campaign import Trial
from dummydesign.pad.material.relaxation import PronyTerm

HOOKS = ("motion", "pad", "batch", "sensor")
"""Where an effect acts: depth of the punch, law and relaxation of the pad, trials by their pad's history, signal."""
OWNERS = ("pad", "rig", "sensor")
SETUP = {
    "flat_faces": "a flat face under a flat punch on every pad",
    "base_that_can_slip": "pads glued to their base under a glued flat punch",
    "bulk_that_gives": "pads glued to their base under a glued flat punch",
    "frictionless_plates": "pucks whose plates are declared frictionless",
    "sharp_edge": "slabs under a glued flat punch declared with a sharp edge",
}  # what an effect may need of a set-up (its force law's ``offers``), in words
PADS = {"slab": "slabs", "cylinder": "pucks between plates", "shaped": "shaped pads, other punches and contacts"}
Values = dict[str, float]


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect.

    Attributes
    ----------
    name, unit : str
    null : float
        Value at which the effect is absent (for a second parameter: its usual value).
    low, high : float
        Bounds.
    typical : float
        A size that matters in practice: the step of the screening and the scale of the fit.
    log : bool
        Fitted as a logarithm (times).
    starts : tuple of float
        Further values to start from.
    spread : float
        Standard deviation of the coordinate about the null before any data: finite for a parameter of form, of a law
        that is a convention.
    """

    name: str
    unit: str
    null: float
    low: float
    high: float
    typical: float
    log: bool = False
    starts: tuple[float, ...] = ()
    spread: float = float("inf")

    @property
    def of_form(self) -> bool:
        """Whether it is the form of a law, known before any data within its spread."""
        return bool(np.isfinite(self.spread))

    def to_coordinate(self, value: float) -> float:
        """Value as a number of order one."""
        return float(np.log(value / self.typical)) if self.log else (value - self.null) / self.typical

    def to_value(self, coordinate: float) -> float:
        """Inverse of :meth:`to_coordinate`, within the bounds."""
        value = self.typical * np.exp(coordinate) if self.log else self.null + self.typical * coordinate
        return float(np.clip(value, self.low, self.high))


@dataclass(frozen=True)
class Arm:
    """A relaxing arm: time [s] and strength, scalars or (T, 1), a time that changes (T, N).

    ``weight`` (T, N) scales what is loaded into it.
    """

    tau_s: float | NDArray
    beta: float | NDArray
    weight: NDArray | None = None

    def changed(self, **values: Any) -> Arm:
        """Return a copy with other values."""
        return replace(self, **values)


UnitForce = Callable[[NDArray, NDArray], NDArray]
"""F / E [mm2] of depths (T, N) and thicknesses (T, 1) [mm]; zero at and above the surface."""


class SetupLaw(Protocol):
    """What the law of a set-up offers, see :class:`dummydesign.loop.model.campaign_law.CampaignLaw`."""

    @property
    def shape(self) -> str:
        """``slab`` under a flat glued punch, ``cylinder`` (a puck) or ``shaped`` (any other pad, punch or contact)."""

    @property
    def offers(self) -> frozenset[str]:
        """What effects may ask of it, see :data:`SETUP`."""

    @property
    def error_priors(self) -> tuple:
        """Median size and spread of level, slope and curvature of its error."""

    @property
    def radius_mm(self) -> float:
        """Radius of the punch, or of the circle of its area; of a puck. [mm]"""

    def on(self, trials: Sequence[Trial]) -> UnitForce:
        """The law of these trials, row by row."""

    def limit_of(self, trials: Sequence[Trial]) -> NDArray:
        """Depth to which the law of each trial's pad holds, shape (T,). [mm]"""


def wrap(law: UnitForce, changed: UnitForce) -> UnitForce:
    """A law that an effect made of another one, marked so that :func:`root_law` finds what lies under it.

    Parameters
    ----------
    law : callable
        The law so far, F / E [mm2] of depths (T, N) and thicknesses (T, 1) [mm].
    changed : callable
        The new one, of the same arguments.
    """
    changed.__wrapped__ = law  # type: ignore[attr-defined]
    return changed


def root_law(law: Any) -> Any:
    """The base law under all that effects have wrapped around it."""
    while hasattr(law, "__wrapped__"):
        law = law.__wrapped__
    return law


class Effect:
    """A physical effect that the base model lacks. A class overrides the methods through which it acts; the others
    leave things as they are.

    The first parameter is the size; at its null value the forward model leaves the effect out, so the model is
    the base to the last bit. :func:`dummydesign.loop.check_effect` tries a class against this contract.
    """

    name: str = ""
    hook: str = ""
    """One of :data:`HOOKS`."""
    belongs_to: str = ""
    """``pad`` (material, batch, history: goes into a design), ``rig`` (robot, punch, plates, glue) or ``sensor``."""
    by_convention: bool = False
    """Whether it, alone or with another, may follow any function of depth: pucks of one shape never exclude it."""
    lubricated: bool = False
    """Whether lubricated plates take it away."""
    designed_for: str = ""
    """State that a design takes when the effect depends on one and is absent there; empty when it acts at all times."""
    needs: tuple[str, ...] = ()
    """What it needs: columns that a campaign must declare for every trial (``temperature_C``, ``age_days``,
    ``rest_s``), or something of the set-up (a name of :data:`SETUP`)."""
    shapes: tuple[str, ...] = ("slab", "cylinder", "shaped")
    """Set-ups on which the effect is defined: ``slab`` (a flat glued punch on a slab, from the response table),
    ``cylinder`` (a puck), ``shaped`` (any other pad, punch or contact, solved by finite elements)."""
    parameters: tuple[Parameter, ...] = ()
    signature: str = ""
    reference: str = ""
    cause: str = ""  # as a rule
    remedy: str = ""  # what a laboratory does about it, as an order
    feeds_back: bool = False
    held: bool = False  # its parameters stay at their start in a fit: they are known with the effect itself
    always_fitted: bool = False
    """Fitted whatever its score: for effects whose first-order change the base can imitate."""

    negligible: float = 0.0
    """Distance of the size from its null value below which the effect is not named: instruments and force laws are no
    better."""

    seen_raw: bool = False
    """Seen in the raw readings, without a fit: no plan decides whether it can be."""

    def undefined(self, presses: Presses, law: SetupLaw) -> str:
        """Say why the effect has no value on these trials (another shape, nothing declared); empty if it has."""
        if law.shape not in self.shapes:
            return f"for {' and '.join(PADS[shape] for shape in self.shapes)} only"
        lacking = [SETUP[name] for name in self.needs if name in SETUP and name not in law.offers]
        if lacking:
            return f"needs {' and '.join(lacking)}"
        columns = [name for name in self.needs if name not in SETUP]
        missing = [name for name in columns if np.any(np.isnan(getattr(presses.history, name)))]
        return f"needs {' and '.join(missing)} of every trial" if missing else ""

    def untestable(self, presses: Presses) -> str:
        """Say why trials on which the effect is defined cannot show it; empty when they can."""
        return ""

    def unseen(self, presses: Presses) -> str:
        """Say why the raw readings rule the effect out; empty when they do not."""
        return ""

    def unavailable(self, presses: Presses, law: SetupLaw) -> str:
        """Say why the effect cannot be fitted to these trials; empty when it can."""
        return self.undefined(presses, law) or self.untestable(presses)

    def depth(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        """Motion: depth of the punch in the pad.

        Parameters
        ----------
        presses : Presses
            T trials of N samples, with their conditions.
        depth_mm : ndarray, shape (T, N)
            The depth so far. [mm]
        values : mapping of str to float
            The effect's parameters, each in its own unit.

        Returns
        -------
        ndarray, shape (T, N)
            [mm]
        """
        return depth_mm

    def yielding(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        """Motion: how much the set-up gives way under the force; what is taken off the displacement. [mm]

        Parameters
        ----------
        presses, values
            As for :meth:`depth`.
        force_N : ndarray, shape (T, N)
            The force on the set-up. [N]
        """
        return np.zeros_like(force_N)

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        """Pad: the elastic law in place of the one so far."""
        return law

    def adds_terms(self, values: Values) -> tuple[PronyTerm, ...]:
        """Pad: Prony terms that join the relaxation of the material, in presses and in a design."""
        return ()

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        """Batch: factor (T, 1) or (T, N) on the elastic force; see :meth:`Effect.depth`."""
        return np.ones((1, 1))

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        """Pad: the relaxing arms in place of those so far; by default those of :meth:`adds_terms` join them.

        Parameters
        ----------
        presses, depth_mm, values
            As for :meth:`depth`.
        arms : tuple of Arm
            Those so far.
        """
        return (*arms, *(Arm(term.tau_s, term.beta) for term in self.adds_terms(values)))

    def pressed_arms(
        self, arms: tuple[Arm, ...], share: NDArray, velocity_mm_s: NDArray, values: Values
    ) -> tuple[Arm, ...]:
        """Pad: the arms in a press that is designed; by default those so far, for the state of :attr:`designed_for`.

        Parameters
        ----------
        arms, values
            As for :meth:`arms`.
        share : ndarray, shape (T, N)
            Depth over thickness.
        velocity_mm_s : ndarray, shape (T, 1)
            Speed of the ramp. [mm/s]
        """
        return arms

    def surface(self, presses: Presses, depth_mm: NDArray, force_N: NDArray, values: Values) -> NDArray:
        """Pad: the force on the punch (T, N), from the one that cannot pull. [N]

        Parameters
        ----------
        presses, depth_mm, values
            As for :meth:`depth`.
        force_N : ndarray, shape (T, N)
            The force so far, not below the floor. [N]
        """
        return force_N

    def floor(self, presses: Presses, floor_N: NDArray, values: Values) -> NDArray:
        """Pad: the least force (T, N) that the contact can carry; zero in the base. [N]

        Parameters
        ----------
        presses, values
            As for :meth:`depth`.
        floor_N : ndarray, shape (T, N)
            The least force so far. [N]
        """
        return floor_N

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        """Sensor: the signal (T, N) before the declared filter, from that so far; see :meth:`Effect.yielding`. [N]"""
        return force_N

    def reading(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        """Sensor: what is read of filtered readings of any shape, one by one; see :meth:`Effect.yielding`. [N]"""
        return force_N

    def ends(self, parameter: Parameter, tau_s: NDArray) -> tuple[float, float]:
        """Bounds of a parameter beside declared arms of these times, rising [s]: narrower where arms take its place."""
        return parameter.low, parameter.high

    def base_starts(self, logs: NDArray) -> list[NDArray]:
        """Where to start the base's logarithms when this effect is added; the best is kept."""
        return [logs]

    @property
    def relaxes(self) -> bool:
        """Whether it changes the relaxation, which a campaign of one speed without holds cannot show."""
        own = type(self)
        return own.arms is not Effect.arms or own.adds_terms is not Effect.adds_terms

    def null_values(self) -> Values:
        """All parameters at their null values."""
        return {p.name: p.null for p in self.parameters}


class PadEffect(Effect):
    """An effect of the pad's material and geometry; it enters a design."""

    hook = "pad"
    belongs_to = "pad"


class HistoryEffect(PadEffect):
    """An effect of what was done to the pad before: cycles, rests, temperature, age."""

    hook = "batch"


class RigEffect(Effect):
    """An effect of the machine and the set-up, as a rule on the force of the pad; it stays in the laboratory."""

    hook = "pad"
    belongs_to = "rig"


class SensorEffect(Effect):
    """An effect of the force sensor and the record; it stays in the laboratory."""

    hook = "sensor"
    belongs_to = "sensor"


def usual_starts(effect: Effect, logs: NDArray) -> list[NDArray]:
    """The base's logarithms, and where no arms are declared (5,) those with times and strengths of a usual soft gel."""
    return [logs, np.r_[logs[0], np.log([0.07, 0.3, 1.5, 0.3])]] if len(logs) == 5 else [logs]


def effect_classes(module: ModuleType) -> list[type[Effect]]:
    """Effect classes that a module defines, in the order they stand in it."""
    own = [value for value in vars(module).values() if isinstance(value, type) and issubclass(value, Effect)]
    return [one for one in own if one.__module__ == module.__name__]


def members(module: ModuleType) -> tuple[Effect, ...]:
    """The effects of a module: its ``MEMBERS``, or one instance of each of its classes."""
    return getattr(module, "MEMBERS", None) or tuple(one() for one in effect_classes(module))

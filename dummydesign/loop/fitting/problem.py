"""A campaign with a force law and effects as a function of one vector, with its slopes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Effect, SetupLaw
from dummydesign.loop.model.forward_model import (
    LAW_TERMS,
    SMOOTH_TERMS,
    Active,
    BaseParameters,
    LawError,
    base_and_law_columns,
    pad_state,
    readings,
    simulate_yielding,
    wave_columns,
)
from dummydesign.loop.model.material import UNDECLARED, BasePrior

STEP = 4e-3


@dataclass(frozen=True)
class CampaignProblem:
    """A campaign with a force law, what is known of its material, and the effects that are fitted beside the base.

    The vector is [logarithms of modulus and arms | coordinates of the effects' parameters | law level, slope, curvature
    and waves per thickness]. What it gave is kept: ``sensed`` at the last vector, ``seen`` at all vectors and offsets.
    """

    presses: Presses
    law: SetupLaw
    effects: tuple[Effect, ...] = ()
    prior: BasePrior = UNDECLARED
    sensed: dict[bytes, NDArray] = field(default_factory=dict, init=False, repr=False, compare=False)
    seen: dict[tuple[bytes, bytes], NDArray] = field(default_factory=dict, init=False, repr=False, compare=False)

    def plus(self, *effects: Effect) -> CampaignProblem:
        """Return the problem with further effects."""
        return replace(self, effects=(*self.effects, *effects))

    @property
    def base_count(self) -> int:
        """Number of base parameters, with which the vector begins."""
        return len(self.prior.mean)

    @property
    def centre(self) -> NDArray:
        """Vector at which the priors have their middle: the declared material, no effects, an exact law."""
        return np.r_[self.prior.mean, np.zeros(self.fixed - self.base_count + LAW_TERMS * len(self.presses.pads))]

    @property
    def fixed(self) -> int:
        """Number of base and effect parameters."""
        return self.base_count + sum(len(effect.parameters) for effect in self.effects)

    @cached_property
    def entries(self) -> dict[str, range]:
        """Entries of the vector that hold the parameters of each effect, by its name."""
        ends = self.base_count + np.cumsum([len(effect.parameters) for effect in self.effects], dtype=int)
        return {one.name: range(end - len(one.parameters), end) for one, end in zip(self.effects, ends.tolist())}

    def law_entries(self, term: int) -> slice:
        """Entries of the vector that hold a term of the law error, one a pad."""
        count = len(self.presses.pads)
        return slice(self.fixed + term * count, self.fixed + (term + 1) * count)

    def frozen(self) -> list[int]:
        """Entries of the vector that are not fitted: the arms, without holds and with one speed, and held effects."""
        held = [entry for effect in self.effects if effect.held for entry in self.entries[effect.name]]
        return [*(range(1, self.base_count) if self.presses.elastic_only else ()), *held]

    def bounds(self) -> tuple[NDArray, NDArray]:
        """Bounds of the vector."""
        tau_s = np.sort(np.exp(self.prior.mean[1::2])) if self.prior.declared else np.empty(0)
        ends = [
            sorted(p.to_coordinate(end) for end in effect.ends(p, tau_s))
            for effect in self.effects
            for p in effect.parameters
        ]
        free = np.full(LAW_TERMS * len(self.presses.pads), 0.5)
        low, high = self.prior.bounds()
        return np.r_[low, [one[0] for one in ends], -free], np.r_[high, [one[1] for one in ends], free]

    def base_of(self, vector: NDArray) -> BaseParameters:
        """The base parameters in a vector."""
        return BaseParameters.from_logs(vector[: self.base_count])

    def active_of(self, vector: NDArray) -> tuple[Active, ...]:
        """The effects with their values in a vector."""
        return tuple(
            Active(one, {p.name: p.to_value(vector[at]) for p, at in zip(one.parameters, self.entries[one.name])})
            for one in self.effects
        )

    def nodes(self, vector: NDArray, offset_mm: NDArray | float = 0.0, near_mm: NDArray | None = None) -> NDArray:
        """Force at the nodes before the sensor filter (T, N). [N]"""
        return simulate_yielding(self.presses, self.law, *self.model(vector), offset_mm, near_mm)[0]

    def model(self, vector: NDArray) -> tuple[BaseParameters, tuple[Active, ...], LawError]:
        """Base parameters, effects with their values, and the law error per trial in a vector."""
        error = LawError(vector[self.fixed :].reshape(LAW_TERMS, -1)[:, self.presses.pad])
        return self.base_of(vector), self.active_of(vector), error

    def predict(self, vector: NDArray, offset_mm: NDArray | float = 0.0) -> NDArray:
        """Bin means (T, B), kept. [N]"""
        if (key := (vector.tobytes(), np.asarray(offset_mm, float).tobytes())) not in self.seen:
            measured = self.presses.measure(self.nodes(vector, offset_mm))
            self.seen[key] = readings(self.presses, measured, self.active_of(vector))
        return self.seen[key]

    def change_by(self, effect: Effect, vector: NDArray, forces: NDArray) -> NDArray:
        """What one of the effects changes of the bins with ``forces`` (T, B), the rest of the model as it is. [N]"""
        without = vector.copy()
        without[self.entries[effect.name]] = [p.to_coordinate(p.null) for p in effect.parameters]
        return np.where(self.presses.used, forces - self.predict(without), 0.0)

    def at_samples(self, vector: NDArray, offset_mm: NDArray | float = 0.0) -> list[NDArray]:
        """Readings at the raw samples of each trial. [N]"""
        active = self.active_of(vector)
        return [readings(self.presses, one, active) for one in self.presses.at_samples(self.nodes(vector, offset_mm))]

    def slope(self, vector: NDArray, forces: NDArray) -> NDArray:
        """Change of the bins with the contact position (T, B). [N/mm]"""
        step = 2e-3
        return (forces - self.predict(vector, step)) / step

    def jacobian(self, vector: NDArray, forces: NDArray) -> NDArray:
        """Sensitivities by forward differences, of the law's error those to each trial's own pad: (T, B, base, effects
        and one pad's terms), see :meth:`spread`; those at the last vector are kept."""
        if (key := vector.tobytes()) not in self.sensed:
            self.sensed.clear()
            self.sensed[key] = self._jacobian(vector, forces)
        return self.sensed[key]

    def _jacobian(self, vector: NDArray, forces: NDArray) -> NDArray:
        (_low, high), count = self.bounds(), self.base_count
        out = np.zeros((*forces.shape, self.fixed + LAW_TERMS))
        # where the depth does not depend on the force, one evaluation of the law serves base and law error
        shared = not any(one.effect.feeds_back for one in self.active_of(vector) if not one.absent)
        near = None if shared else simulate_yielding(self.presses, self.law, *self.model(vector))[1]
        units, free = np.eye(len(vector)), sorted({*range(count if shared else 0, self.fixed)} - {*self.frozen()})
        steps = [(entry, STEP if vector[entry] + STEP <= high[entry] else -STEP) for entry in free]
        moved = [vector + step * units[entry] for entry, step in steps]
        if not shared:
            moved += [vector + STEP * units[self.law_entries(term)].sum(axis=0) for term in range(SMOOTH_TERMS)]
        if moved:
            bins = self.presses.operator @ np.stack([self.nodes(one, near_mm=near) for one in moved], axis=-1)
            read = [readings(self.presses, bins[..., at], self.active_of(one)) for at, one in enumerate(moved)]
            change = np.stack(read, axis=-1) - forces[..., None]
        for number, (entry, step) in enumerate(steps):
            out[..., entry] = change[..., number] / step
        pad = pad_state(self.presses, self.law, *self.model(vector), 0.0 if near is None else near)
        if shared:
            out[..., :count], by_pad = base_and_law_columns(self.presses, pad, vector[:count], STEP)
        else:
            by_pad = change[..., len(steps) :] / STEP
        out[..., self.fixed :] = np.concatenate([by_pad, wave_columns(self.presses, pad)], axis=-1)
        out[..., self.frozen()] = 0.0
        return out

    def spread(self, columns: NDArray) -> NDArray:
        """Columns (T, B, base, effects and one pad's terms) at their entries of the vector (T, B, len(vector))."""
        pad, own = self.presses.pad, columns[..., self.fixed :]
        law = np.zeros((*own.shape, len(self.presses.pads)))
        law[np.arange(len(pad)), :, :, pad] = own
        return np.concatenate([columns[..., : self.fixed], law.reshape(*own.shape[:2], -1)], axis=-1)

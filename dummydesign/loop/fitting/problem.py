"""A campaign with a force law and effects as a function of one vector: forces, their slopes and sensitivities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.noise import LAW_TERMS
from dummydesign.loop.fitting.sensitivities import base_and_law_columns, shares_the_law
from dummydesign.loop.model.base_law import SetupLaw
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.forward_model import Active, LawError, given_way, simulate
from dummydesign.loop.model.parameters import HIGH, LOW, BaseParameters

STEP = 4e-3
BASE = 5


@dataclass(frozen=True)
class Problem:
    """A campaign with a force law and the effects that are fitted beside the base.

    The vector is [5 logarithms | coordinates of the effects' parameters | law level, slope, curvature per
    thickness].
    """

    presses: Presses
    law: SetupLaw
    effects: tuple[Effect, ...] = ()

    @property
    def thicknesses(self) -> NDArray:
        """Thickness of each pad of the campaign, in the order of ``presses.pads``. [mm]"""
        return np.array([thickness for _, thickness in self.presses.pads])

    @property
    def fixed(self) -> int:
        """Number of base and effect parameters."""
        return BASE + sum(len(effect.parameters) for effect in self.effects)

    def frozen(self) -> list[int]:
        """Entries of the vector that are not fitted: the arms, without holds and with one speed, and held effects."""
        out, place = [1, 2, 3, 4] if self.presses.elastic_only else [], BASE
        for effect in self.effects:
            count = len(effect.parameters)
            out += range(place, place + count) if effect.held else ()
            place += count
        return out

    def bounds(self) -> tuple[NDArray, NDArray]:
        """Bounds of the vector."""
        low, high = [*LOW], [*HIGH]
        for effect in self.effects:
            for p in effect.parameters:
                ends = sorted((p.to_coordinate(p.low), p.to_coordinate(p.high)))
                low.append(ends[0])
                high.append(ends[1])
        free = np.full(LAW_TERMS * len(self.thicknesses), 0.5)
        return np.r_[low, -free], np.r_[high, free]

    def base_of(self, vector: NDArray) -> BaseParameters:
        """The base parameters in a vector."""
        return BaseParameters.from_logs(vector[:BASE])

    def active_of(self, vector: NDArray) -> tuple[Active, ...]:
        """The effects with their values in a vector."""
        out, place = [], BASE
        for effect in self.effects:
            values = {}
            for parameter in effect.parameters:
                values[parameter.name] = parameter.to_value(vector[place])
                place += 1
            out.append(Active(effect, values))
        return tuple(out)

    def law_error_of(self, vector: NDArray) -> LawError:
        """The law error per trial in a vector."""
        place = self.presses.pad
        return LawError(*(term[place] for term in np.split(vector[self.fixed :], LAW_TERMS)))

    def nodes(
        self, vector: NDArray, offset_mm: NDArray | float = 0.0, near_mm: NDArray | None = None
    ) -> NDArray:
        """Force at the nodes before the sensor filter (T, N). [N]

        Parameters
        ----------
        vector : ndarray, shape (n,)
            See :class:`Problem`.
        offset_mm : ndarray, shape (T,), or float
            Contact position of each trial. [mm]
        near_mm : ndarray, shape (T, N), optional
            Where to start looking for how much the set-up gives way. [mm]
        """
        base, active, error = self.base_of(vector), self.active_of(vector), self.law_error_of(vector)
        return simulate(self.presses, self.law, base, active, error, offset_mm, near_mm)

    def predict(
        self, vector: NDArray, offset_mm: NDArray | float = 0.0, near_mm: NDArray | None = None
    ) -> NDArray:
        """Bin means (T, B). [N]

        Parameters
        ----------
        vector : ndarray, shape (n,)
            See :class:`Problem`.
        offset_mm : ndarray, shape (T,), or float
            Contact position of each trial. [mm]
        near_mm : ndarray, shape (T, N), optional
            Where to start looking for how much the set-up gives way. [mm]
        """
        return self.presses.measure(self.nodes(vector, offset_mm, near_mm))

    def slope(self, vector: NDArray, forces: NDArray) -> NDArray:
        """Change of the bins with the contact position (T, B). [N/mm]"""
        step = 2e-3
        return (forces - self.predict(vector, step)) / step

    def jacobian(self, vector: NDArray, forces: NDArray) -> NDArray:
        """Sensitivities (T, B, len(vector)) by forward differences."""
        _low, high = self.bounds()
        out = np.zeros((*forces.shape, len(vector)))
        shared, near = shares_the_law(self, vector), None
        if not shared:
            base, active, error = self.base_of(vector), self.active_of(vector), self.law_error_of(vector)
            near = given_way(self.presses, self.law, base, active, error)
        frozen, steps, moved = set(self.frozen()), [], []
        for column in range(BASE if shared else 0, self.fixed):
            if column in frozen:
                continue
            steps.append((column, STEP if vector[column] + STEP <= high[column] else -STEP))
            moved.append(vector.copy())
            moved[-1][column] += steps[-1][1]
        count = len(self.thicknesses)
        place = self.presses.pad
        rows = np.arange(len(place))
        if not shared:
            for part in range(LAW_TERMS):
                moved.append(vector.copy())
                moved[-1][self.fixed + part * count : self.fixed + (part + 1) * count] += STEP
        if moved:
            shown = np.stack([self.nodes(one, near_mm=near) for one in moved], axis=-1)
            change = self.presses.measured(shown) - forces[..., None]
        for number, (column, step) in enumerate(steps):
            out[..., column] = change[..., number] / step
        if shared:
            out[..., :BASE], by_pad = base_and_law_columns(self, vector, STEP)
        else:
            by_pad = change[..., len(steps) :] / STEP
        for part in range(LAW_TERMS):
            out[rows, :, self.fixed + part * count + place] = by_pad[..., part]
        out[..., self.frozen()] = 0.0
        return out

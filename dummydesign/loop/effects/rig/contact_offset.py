"""The surface lies deeper than displacement zero."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, RigEffect, Values


class ContactOffset(RigEffect):
    """All trials touch later than declared: depth = displacement - offset.

    The same length at all depths, speeds and pads, so the relative change of force, n dx / x, is largest
    at small depth. Single trials also scatter about it; this is their common part.
    """

    name = "contact_offset"
    hook = "motion"
    parameters = (Parameter("offset_mm", "mm", 0.0, -1.0, 1.0, 0.05),)
    signature = "late or early onset by the same length on all pads and speeds"
    cause = "zero of the displacement set by eye, or a skin, a film or dust on the pad"
    remedy = "find the contact from the force of a slow press on each pad, and set zero there"
    reference = "Crick and Yin, Biomech. Model. Mechanobiol. 6 (2007) 199 (contact point and modulus)"

    def depth(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        return depth_mm - values["offset_mm"]

"""A spring constant alone: force in proportion to depth, at any speed and after any hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.maxwell_law import MaxwellLaw, MotionResponse


class Spring(MaxwellLaw):
    """F = k x with the effective spring constant k of a body region, as ISO/TS 15066:2016, annex A, models contact."""

    name = "spring"
    words = "one spring constant"
    reference = "the model of contact of ISO/TS 15066:2016, annex A"
    elements = (1,)
    power = 1.0
    steady_name = "k_N_per_mm"
    fitted = False

    def notice_of(self, name: str) -> tuple[str, str]:
        """Say that it says nothing of speed and relaxation."""
        return "spring_tissue", (
            f"{name} is a spring constant: it says nothing of speed and relaxation, so peaks are compared with the "
            "steady force itself; a pad that relaxes reads high in them, and one that does not may still be below a "
            "person's"
        )

    def drive(self, motion: Motion) -> MotionResponse:
        """Drive by the depth as it is: X = x. [mm]"""
        drive = MotionResponse()
        drive.elastic = np.maximum(np.asarray(motion.displacement_mm, float), 0.0)
        return drive

    def stretch_rates(self, depth_mm: NDArray, rate: NDArray) -> tuple[NDArray, NDArray]:
        """There is no arm."""
        return np.ones_like(rate), np.zeros_like(rate)


SPRING = Spring()

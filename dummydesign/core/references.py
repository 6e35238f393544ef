"""The sources that many places cite, written once; docs/references.md says what is known of each."""

from __future__ import annotations

PAPER = (
    "Development of Dummy Based on Impedance Properties of Human Soft Tissue Using a Nonlinear Viscoelastic Model, "
    "IEEE Access (Nagoya University)"
)
"""What code and documents call "the paper"."""

ISO_TS_15066 = "ISO/TS 15066:2016, Robots and robotic devices - Collaborative robots"

HAND_STIFFNESS = (
    f"{ISO_TS_15066}, annex A: spring constant of hands and fingers 75 N/mm, second-hand as in the published code of "
    "V. Gupta, human_robot_collision_RL (the standard itself was not at hand)"
)

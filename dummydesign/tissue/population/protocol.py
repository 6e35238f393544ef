"""The protocol of the paper that inferred tissues are described by."""

LAW = "ode"
"""Law of the inferred tissues."""

SPEEDS_MM_S = (10.0, 250.0)
"""Speeds at which dampers are given. [mm/s]"""

STEADY_N = 10.0
"""Force at the end of the hold at which depths and relaxation times are compared. [N]"""

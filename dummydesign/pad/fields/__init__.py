"""Displacement, stress and contact pressure inside a pressed pad: solved, written for ParaView, drawn."""

"""Simulated presses of a design, the tissue's targets and the score."""

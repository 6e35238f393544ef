"""Equilibrium along a motion: continuation, motion paths and linear solvers."""

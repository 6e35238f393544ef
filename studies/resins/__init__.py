"""Fits of the built-in resins."""

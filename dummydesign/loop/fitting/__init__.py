"""Fits of the base model and of candidates, with their noise."""

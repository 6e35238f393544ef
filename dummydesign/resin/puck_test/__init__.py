"""Compression test of a puck: reduction, model, noise, fit of loading and relaxation."""

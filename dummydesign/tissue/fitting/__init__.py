"""Fit of the five-element law to traces, and comparison with a tissue."""

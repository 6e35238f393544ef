"""Benchmarks of what the answers state of accuracy, on data of others."""

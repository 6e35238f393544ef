"""Tissue: the nonlinear five-element Maxwell law, its fit, bands and ranges."""

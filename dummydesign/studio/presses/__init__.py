"""Presses that come in: plans, files of presses, pads that were pressed, campaigns from elsewhere."""

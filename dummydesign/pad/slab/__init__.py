"""Flat pads: the sharp punch edge as a limit, sliding faces, the square punch in space."""

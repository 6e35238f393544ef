"""Shapes of pads and what follows from them without mechanics: outlines, volumes, limits, words."""

"""A bone from a file: scaled, placed, cut at its plate, and the dome that stands for it in the finite elements."""

"""One's own test: its punch, what it can be pressed with, and what slabs do under it."""

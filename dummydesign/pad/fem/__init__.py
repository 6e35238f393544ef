"""Finite elements: meshes and the mixed displacement-pressure element."""

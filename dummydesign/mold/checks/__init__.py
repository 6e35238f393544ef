"""Checks of solids, files, meshes and process, made on what was read back."""

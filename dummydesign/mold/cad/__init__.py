"""Solids of the mould and its aids by CadQuery."""

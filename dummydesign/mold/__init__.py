"""Mould: spec, formulas, CadQuery builders, checks, STEP writer, pour sheet."""

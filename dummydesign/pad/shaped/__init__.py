"""Pads with a shaped top or an inner layer, axisymmetric and in space."""

"""Round pads and punches: slabs, shaped pads, pucks, by axisymmetric finite elements."""

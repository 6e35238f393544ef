"""Shapes of pads, one module a shape: the registry finds them; :class:`PadShape` has what each must answer."""

"""Pads in space: square punches, shaped pads, self-contact."""

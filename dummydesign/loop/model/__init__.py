"""The forward model of a press: base law, effects, relaxation, sensor."""

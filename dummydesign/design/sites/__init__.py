"""Several crowns on one pad, far enough apart that each is pressed as if it were alone."""

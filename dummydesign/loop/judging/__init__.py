"""Acceptance, verdict, lack of fit, left-out error, what a residual depends on."""

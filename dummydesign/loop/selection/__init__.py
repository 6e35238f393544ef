"""Search for effects, their acceptance, the verdict, and what a residual depends on."""

"""Statistics shared by tissue fits, the loop and the puck test: reduction, noise, least squares, profile likelihood."""

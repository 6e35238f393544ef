"""How the surface of crowned pads is fitted: where the edge is reached, a regression by level, the pieces."""

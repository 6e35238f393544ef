"""The pads that can win, solved by finite elements."""

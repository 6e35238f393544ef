"""Curves that are kept as they are: the reduction of presses, and whether a law follows them."""

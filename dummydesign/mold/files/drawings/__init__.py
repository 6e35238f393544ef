"""Dimensioned drawings of every part: what is drawn, where it stands on the paper, and its files."""

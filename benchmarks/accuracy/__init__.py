"""How right the answers are, by drawn inputs whose truth is known."""

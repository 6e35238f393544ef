"""Effects of the pad's material and geometry; they enter a design."""

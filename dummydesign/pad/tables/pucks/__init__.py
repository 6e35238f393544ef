"""Tables of pucks between plates: of one size, and of any proportions."""

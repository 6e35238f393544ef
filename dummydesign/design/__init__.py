"""Design: scores, search, tolerance, what-if; does not know how a number was made."""

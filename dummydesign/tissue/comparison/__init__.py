"""A measured dummy held against a tissue, in a test of its own."""

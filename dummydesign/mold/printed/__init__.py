"""A mould that is printed and cast in without silicone: base with the floor, ring with the walls."""

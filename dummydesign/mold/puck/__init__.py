"""Witness pucks: the ring they are cast in, what is weighed, how they are pressed."""

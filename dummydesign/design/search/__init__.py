"""Search among slabs and shapes, in tables and by finite elements."""

"""A slab under a filleted punch without friction, on a mesh that stays with the fillet."""

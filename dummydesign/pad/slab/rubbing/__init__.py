"""A slab under a filleted punch along which its face rubs with Coulomb friction."""

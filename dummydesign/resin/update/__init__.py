"""Own measurements into a resin: modulus rows and relaxation."""

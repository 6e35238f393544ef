"""Resin: ratio to modulus, relaxation and liquid properties; batches of the user."""

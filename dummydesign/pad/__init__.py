"""Pad mechanics: geometry, material laws, finite elements, the response table, relaxation."""

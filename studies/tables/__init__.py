"""Builders of the response tables."""

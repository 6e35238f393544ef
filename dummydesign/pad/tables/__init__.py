"""Readers of the shipped response tables; what builds them is in studies."""

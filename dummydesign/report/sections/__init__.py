"""Sections of the reports that are a topic of their own."""

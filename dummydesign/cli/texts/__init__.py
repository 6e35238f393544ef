"""Answers of commands as text for the terminal."""

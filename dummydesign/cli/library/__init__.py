"""Commands that list, show and add tissues and resins."""

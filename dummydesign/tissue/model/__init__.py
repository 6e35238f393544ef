"""The five-element law, its parameters, bands and ranges, and tissue files."""

"""The version, by itself so that every room can read it without the package's front door."""

__version__ = "1.0.0"

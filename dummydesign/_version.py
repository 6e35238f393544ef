"""The version, by itself so that every room can read it without the package's front door."""

__version__ = "2.0.0"

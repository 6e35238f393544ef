"""Effects of the force sensor and the record."""

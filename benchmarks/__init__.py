"""Studies of speed, coverage and blind recovery; run from the project folder."""

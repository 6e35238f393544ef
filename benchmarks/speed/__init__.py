"""What the slow parts of the program cost: counts and processor time."""

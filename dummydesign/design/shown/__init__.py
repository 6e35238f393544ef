"""What reports show of a design besides its curves, worked out once."""

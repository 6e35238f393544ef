"""What a workshop has, read from data files."""

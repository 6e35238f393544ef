"""What several tests share: laws by formula, presses summed elsewhere, a browser."""

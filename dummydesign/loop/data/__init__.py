"""Trials of a campaign as the loop sees them: reduced, with their history."""

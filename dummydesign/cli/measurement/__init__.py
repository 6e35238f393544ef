"""Commands that read measured data: import files, fit traces, learn from a campaign, compare."""

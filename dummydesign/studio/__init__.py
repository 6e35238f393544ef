"""A local page in the browser over a project folder: every step starts the command that does the same."""

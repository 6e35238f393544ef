"""A project folder: what was asked, and where the files of each step lie. Everything works without one."""

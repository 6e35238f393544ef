"""Commands that the pages start, each in a process and a folder of its own."""

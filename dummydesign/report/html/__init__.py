"""One HTML page without anything from outside, its script and its viewer."""

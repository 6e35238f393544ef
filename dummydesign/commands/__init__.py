"""One module a command: its arguments, the one function it calls, and how the answer is printed."""

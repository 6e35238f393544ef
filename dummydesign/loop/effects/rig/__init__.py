"""Effects of the machine and the set-up; they stay in the laboratory."""

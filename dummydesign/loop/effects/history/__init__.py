"""Effects of what was done to the pad before: cycles, rests, temperature, age."""

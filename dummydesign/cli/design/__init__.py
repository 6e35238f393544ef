"""Commands that design: predict a pad, search and vary designs, make the mould."""

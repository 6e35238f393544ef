"""The response table of fields of caps: what caps and punch overlap by, and a surface in two pieces over it."""

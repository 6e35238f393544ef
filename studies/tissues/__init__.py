"""Inference of the built-in tissues from published statements and in vivo anchors."""

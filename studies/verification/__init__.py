"""The checks behind VERIFICATION.md."""

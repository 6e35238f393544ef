"""Tissues of the user: from traces, points, curves or springs."""

"""Where the thickness of a cast pad is gauged, and how readings by name are judged."""

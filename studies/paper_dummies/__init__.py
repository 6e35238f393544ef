"""The three dummies of the published method, as a study."""

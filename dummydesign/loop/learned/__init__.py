"""Effects learned from what a model leaves: a smooth factor on the force that follows one quantity."""

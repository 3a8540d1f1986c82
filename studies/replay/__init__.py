"""Watching a log: robots, what they sensed and believed, where the model says they should be."""

"""The blind battery: effects hidden at random, diagnosed by a process that gets only the log."""

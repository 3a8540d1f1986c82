"""Naming what is wrong with sensors, lamps and the task, from the log alone."""

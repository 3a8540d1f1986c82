"""Measure the reality gap of a robot swarm's simulator: show it, name its cause, close it."""

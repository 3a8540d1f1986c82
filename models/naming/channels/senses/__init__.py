"""Infrared, light and the nest."""

"""The gap of a log: what the simulation gets wrong, as tables, figures and a page of JSON."""

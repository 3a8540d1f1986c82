"""One run: its configuration, its world and swarm, what is recorded of it, its picture."""

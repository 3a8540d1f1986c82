"""What a lab measured: logs, how they are written, and whether they can be what they claim."""

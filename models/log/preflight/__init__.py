"""What a log says of itself before anything is asked of it: measured, never judged."""

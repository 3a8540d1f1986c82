"""What to let the robots do next: the manoeuvre in which two rival causes differ most."""

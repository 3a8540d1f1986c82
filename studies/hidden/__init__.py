"""What can be hidden in reality, and what the diagnosis calls it."""

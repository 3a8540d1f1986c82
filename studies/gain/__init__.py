"""What naming a cause is worth: prediction on runs that nothing was named from."""

"""What may be said and exported: what helps on parts of a log that it was not fitted to."""

"""How wrong a belief is, against a measured log."""

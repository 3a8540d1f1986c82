"""From a log and a belief to a diagnosis."""

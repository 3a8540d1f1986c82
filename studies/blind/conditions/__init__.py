"""Logs as labs make them: what a diagnosis says of one log under many conditions."""

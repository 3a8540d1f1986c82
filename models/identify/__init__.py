"""Which causes, how large, for which robots: fits of the catalogue's causes to a measured log."""

"""The catalogue: every cause that can be named, one module each, found by being here."""

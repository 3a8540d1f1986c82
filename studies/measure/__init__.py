"""What the documents say of this program, measured again: `realitygap measure --help`."""

"""What is given to a command: measured logs and models, as files or in memory."""

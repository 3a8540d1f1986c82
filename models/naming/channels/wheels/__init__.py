"""What lies between a command and a wheel, told by the wheels' own encoders."""

"""Pose windows, and the wheels' encoders where a log has them."""

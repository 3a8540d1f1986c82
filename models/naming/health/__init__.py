"""What healthy robots are like, learned from healthy logs."""

"""What people read: pages, and results in a notebook."""

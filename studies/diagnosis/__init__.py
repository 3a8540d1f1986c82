"""A diagnosis: what is asked, what is answered, and the files and pages that it is told in."""

"""The paper's whole study (section IV), and the study of how its text may be read."""

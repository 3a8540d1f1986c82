"""The gap in fitness: what a simulator promised (F_S) less what reality paid (F_R), taken apart."""

"""Equations for what no listed cause explains: proposed, proved on held-out blocks, told."""

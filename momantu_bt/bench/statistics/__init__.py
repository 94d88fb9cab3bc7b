"""Compute statistics from the rows of a bench."""

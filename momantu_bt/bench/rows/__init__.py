"""Rows of a bench, one for each episode: their fields, their outcome, and their file."""

"""Motions of the arm: search a path, time it, follow it."""

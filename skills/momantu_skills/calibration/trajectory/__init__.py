"""Poses over time: read from files, interpolated, and aligned with each other."""

"""Replaying recorded runs: their moments, their tree without a world, and their differences."""

"""Showing a simulation to people: films and a live view; nothing here changes a run."""

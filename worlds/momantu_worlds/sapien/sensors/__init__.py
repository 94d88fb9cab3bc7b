"""Cameras, lasers, lidars and the wrist sensor, with their errors."""

"""Choosing goal poses, and planning the path to them."""

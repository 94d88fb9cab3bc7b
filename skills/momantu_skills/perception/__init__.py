"""Perception: points, planes, objects on them, tags."""

"""Perception: point clouds, planes, the objects on them, tags."""

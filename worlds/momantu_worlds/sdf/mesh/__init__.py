"""Mesh files: reading, simplifying, convex decomposition, and GLB assets."""

"""Gazebo's SDF worlds, converted to world files and assets."""

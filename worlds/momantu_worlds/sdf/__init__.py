"""Gazebo's SDF worlds, read and turned into world files and assets of ours."""

"""Readers of recorded scans and odometry."""

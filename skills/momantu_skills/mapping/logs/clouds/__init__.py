"""Turns of a lidar, an IMU and frames of a bag, for a map in three dimensions."""

"""Mapping in three dimensions, from the turns of a lidar with several rings and an IMU."""

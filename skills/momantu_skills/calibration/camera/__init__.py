"""Calibration of a camera's lens from pictures of a board."""

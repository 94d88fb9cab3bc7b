"""Calibration of a whole robot: joints, camera and wheels at once, from views of tags."""

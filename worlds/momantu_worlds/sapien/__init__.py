"""Episodes in SAPIEN: physics, drives, sensors and ground truth."""

"""Hand-eye calibration: estimate how a camera is mounted, from pairs of poses."""

"""The camera: points from depth pictures, joints that aim it, one picture with its pose."""

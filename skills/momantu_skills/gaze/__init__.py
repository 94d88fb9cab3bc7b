"""Pointing the camera, with a head or an arm: at a point, over a surface, along the hand's path."""

"""Pointing the camera, by head or by arm: at a place, over a surface, along a path of the hand."""

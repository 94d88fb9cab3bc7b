"""Pointing the camera, by head or by arm: at one place, over a surface, along a way of the hand."""

"""Calibration: a camera's lens and where it is mounted, from recorded data.

The estimation takes poses and points and knows no robots; `trajectory` and `pictures` read files.
"""

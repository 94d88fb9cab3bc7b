"""Calibration: where a camera is mounted, from poses that somebody recorded.

The estimation takes poses and knows neither files nor robots; `trajectory` reads files.
"""

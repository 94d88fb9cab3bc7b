"""Scan matching: likelihood grids, search in large windows, points to lines, submaps."""

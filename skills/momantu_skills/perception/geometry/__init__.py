"""Plane geometry that perception stands on: regions, grids, rectangles, revolution."""

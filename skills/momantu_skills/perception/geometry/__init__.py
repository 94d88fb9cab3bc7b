"""Geometry for perception: regions, grids, rectangles, bodies of revolution."""

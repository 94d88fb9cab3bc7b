"""Mapping: scans to submaps, submaps to a pose graph, the graph to a floor plan."""

"""A world from a floor plan in map_server's format."""

"""Maps of the floor: map files, distance fields, what sensors see, the costmap."""

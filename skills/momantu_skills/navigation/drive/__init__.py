"""A whole trip: the vehicle, simple moves, following a path, arriving, recovering."""
